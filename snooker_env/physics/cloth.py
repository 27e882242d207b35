"""How does a ball move on the cloth, and when does each phase end? Closed forms, in SI units.

[MJP14] 2.5, eq. 16 to 21 (misprints corrected). Slip: u = v + R (-w_y, w_x) [m/s]. While the ball slides,
du/dt = -(7/2) mu_s g u/|u|: the direction of u is constant and the path a parabola, for the time
T = 2 |u| / (7 mu_s g). Rolling decelerates by mu_r g, spin about the vertical, always, by ``spin_decel``.

Nap. The fibres lean towards +y. Of the force on a rolling ball, resistance is the part odd in v/|v|; the
lowest even part is a constant: dv/dt = -mu_r g v/|v| + nap y, as on a small slope. ``_bend`` is the closed
form; the engine follows it in pieces of constant acceleration with exact ends. A sliding ball's friction is a
thousand times as strong: the nap is neglected there.

Drag. The resistance may grow with speed: dv/dt = -(mu_r g + drag v^2) along v. ``_drag`` is the closed
form; the engine follows the straight path in pieces of constant deceleration, exact in both ends and in the
last speed. This leaves the first speed no choice: it is below the speed at the end before, by at most
(d2v/dt2)^(1/3) (81 _STRAY / 2)^(2/3) / 6, 1.3e-4 m/s at 5 m/s and 0.015/m. A ball so never gains energy. One
that slides has no drag: the air's is 5 % of its friction at 5 m/s.

A row of ``motion`` (columns below) with a ``state`` holds from T0 to T_END; LO_X to HI_Y bound the path. A
ball over a pocket (``FALLING``, ``pocket.py``) or in the air (``AIR``, ``flight.py``) moves at constant velocity in the plane;
Z is its height above the bed and UZ the rate of that, at T0.
"""

from math import atan, copysign, exp, expm1, inf, log1p, sqrt

from .._lib.jit import kernel
from .columns import P_G, P_MU_R, P_MU_S, P_NAP, P_R, P_ROLL_DRAG, P_SPIN

GONE, REST, ROLL, SLIDE, FALLING, BEND, AIR = range(7)
# ROLL: straight, to rest; BEND: a piece of a roll with nap or drag; FALLING: over a pocket
X, Y, VX, VY, AX, AY, WX, WY, WZ, T0, T_END, LO_X, HI_X, LO_Y, HI_Y, Z, UZ = range(17)
COLUMNS = 17
SEGMENT_BALL, SEGMENT_STATE = COLUMNS, COLUMNS + 1
SEGMENT = COLUMNS + 2
"""Columns of a segment, a row of the path log: those of ``motion``, then the ball and its state."""

_STILL = 1e-12  # m/s: a slower ball is at rest (it would roll 4e-24 m)
_STRAY = 2e-6  # m; the largest distance of a ball in a piece from its place on the true path
_NO_DRAG = 1e-16  # drag v^2 over the deceleration: less changes no digit of the way and time to rest


@kernel
def extent(x, v, a, T):
    """Lowest and highest value of x + v t + a t^2 / 2 for t in [0, T]."""
    end = x + (v + 0.5 * a * T) * T
    low, high = min(x, end), max(x, end)
    if v * a < 0.0 and abs(v) < abs(a) * T:
        turn = x - 0.5 * v * v / a
        low, high = min(low, turn), max(high, turn)
    return low, high


@kernel
def _fade(rate, s):
    """Integral of exp(-rate s) from 0 to s."""
    return -expm1(-rate * s) / rate


@kernel
def _bend(vx, vy, s, decel, nap):
    """Motion of a ball that rolls at (vx, vy) [m/s] until the integral of dt/|v| is s [s^2/m]; inf: to rest.

    Returns t [s], the displacement x, y [m] and the velocity there. ``decel`` = mu_r g, ``nap`` [m/s^2]. In s
    it is linear: v_x falls as exp(-decel s), p = (|v| + v_y)/2 as exp(-(decel - nap) s), m = (|v| - v_y)/2 as
    exp(-(decel + nap) s); t integrates |v| = p + m, x v_x (p + m), and y v_y (p + m) = p^2 - m^2.
    """
    v = sqrt(vx * vx + vy * vy)
    p, m = 0.5 * (v + vy), 0.5 * (v - vy)
    t = p * _fade(decel - nap, s) + m * _fade(decel + nap, s)
    x = vx * (p * _fade(2.0 * decel - nap, s) + m * _fade(2.0 * decel + nap, s))
    y = p * p * _fade(2.0 * (decel - nap), s) - m * m * _fade(2.0 * (decel + nap), s)
    return t, x, y, vx * exp(-decel * s), p * exp(-(decel - nap) * s) - m * exp(-(decel + nap) * s)


@kernel
def _piece(vx, vy, decel, nap):
    """The length, as s of ``_bend``, of a piece that starts at (vx, vy) [m/s]; inf: straight, to rest.

    With the share b c of the speed, b = decel - |nap|, it strays from the true path by decel |nap v_x| |v|
    c^3 / 40 if short, and by at most c^3 / 10 of the same (tests/physics/test_nap.py).
    """
    b = decel - abs(nap)
    cube = 10.0 * _STRAY * b * b * b
    bend = decel * abs(nap * vx) * sqrt(vx * vx + vy * vy)
    return -log1p(-((cube / bend) ** (1.0 / 3.0))) / b if cube < bend else inf


@kernel
def _roll_on_nap(motion, state, i, vx, vy, decel, nap):
    """Ball i rolls at (vx, vy) [m/s]: write its next piece; returns its duration [s]."""
    s = _piece(vx, vy, decel, nap)
    T, x, y, _, _ = _bend(vx, vy, s, decel, nap)
    state[i] = BEND
    if s == inf:  # straight, or nearly so: one piece to the place where it stops
        state[i] = ROLL
        vx, vy = 2.0 * x / T, 2.0 * y / T
    motion[i, VX], motion[i, VY] = vx, vy
    motion[i, AX], motion[i, AY] = 2.0 * (x / T - vx) / T, 2.0 * (y / T - vy) / T
    return T


@kernel
def _drag(v, s, decel, drag):
    """Motion of a ball at v [m/s] that rolls against decel + drag v^2 [m/s^2]; ``drag`` [1/m].

    Returns the time t [s], the way [m] and the speed then. With c = sqrt(decel drag), atan(v drag / c) falls
    at the rate c. s = tan(c t) / c [s] stands for t: by the tangent of a difference v falls to
    (v - decel s) / (1 + drag v s), to rest at s = v / decel. The way is the growth of ln cos of that angle,
    over drag.
    """
    c = sqrt(decel * drag)
    way = (log1p(drag * v * s) - 0.5 * log1p(decel * drag * s * s)) / drag
    return atan(c * s) / c, way, (v - decel * s) / (1.0 + drag * v * s)


@kernel
def _roll_with_drag(motion, state, i, vx, vy, decel, drag):
    """Ball i rolls at (vx, vy) [m/s]: write its next piece; returns its duration [s].

    A parabola through both places with the last speed is behind the ball by d2v/dt2 t (T - t)^2 / 6 at t
    (Hermite), at most 2/81 d2v/dt2 T^3; d2v/dt2 = 2 drag v (decel + drag v^2) is largest at the start. s
    stands for T, which is less.
    """
    v = sqrt(vx * vx + vy * vy)
    rest = v / decel
    s = (20.25 * _STRAY / (drag * v * (decel + drag * v * v))) ** (1.0 / 3.0)
    state[i], s = (ROLL, rest) if s >= rest else (BEND, min(s, 0.5 * rest))  # so no piece is a splinter
    T, way, last = _drag(v, s, decel, drag)
    if state[i] == ROLL:
        last = 0.0
    first = 2.0 * way / T - last
    ux, uy, slows = vx / v, vy / v, (last - first) / T
    motion[i, VX], motion[i, VY], motion[i, AX], motion[i, AY] = (
        first * ux,
        first * uy,
        slows * ux,
        slows * uy,
    )
    return T


@kernel
def begin(motion, state, i, t, r, v, w, phys):
    """Write ball i's next phase: at t [s] at r = (x, y) [m] with v = (vx, vy) [m/s] and spin w [rad/s]."""
    R, g = phys[P_R], phys[P_G]
    (x, y), (vx, vy), (wx, wy, wz) = r, v, w
    ux, uy = vx - R * wy, vy + R * wx
    u = sqrt(ux * ux + uy * uy)
    speed = sqrt(vx * vx + vy * vy)
    motion[i, X], motion[i, Y], motion[i, T0], motion[i, WZ] = x, y, t, wz
    if u > _STILL:
        decel = phys[P_MU_S] * g
        state[i] = SLIDE
        motion[i, VX], motion[i, VY] = vx, vy
        motion[i, AX], motion[i, AY] = -decel * ux / u, -decel * uy / u
        motion[i, WX], motion[i, WY] = wx, wy
        motion[i, T_END] = t + u / (3.5 * decel)  # eq. 19
    elif speed > _STILL and phys[P_NAP] != 0.0:
        motion[i, T_END] = t + _roll_on_nap(motion, state, i, vx, vy, phys[P_MU_R] * g, phys[P_NAP])
        motion[i, WX], motion[i, WY] = -motion[i, VY] / R, motion[i, VX] / R
    elif speed > _STILL and phys[P_ROLL_DRAG] * speed * speed > _NO_DRAG * phys[P_MU_R] * g:
        T = _roll_with_drag(motion, state, i, vx, vy, phys[P_MU_R] * g, phys[P_ROLL_DRAG])
        motion[i, WX], motion[i, WY] = -motion[i, VY] / R, motion[i, VX] / R
        motion[i, T_END] = t + T
    elif speed > _STILL:
        decel = phys[P_MU_R] * g
        state[i] = ROLL
        motion[i, VX], motion[i, VY] = vx, vy
        motion[i, AX], motion[i, AY] = -decel * vx / speed, -decel * vy / speed
        motion[i, WX], motion[i, WY] = -vy / R, vx / R
        motion[i, T_END] = t + speed / decel
    else:
        state[i] = REST
        motion[i, VX] = motion[i, VY] = motion[i, AX] = motion[i, AY] = motion[i, WX] = motion[i, WY] = 0.0
        motion[i, T_END] = float("inf")
        motion[i, LO_X] = motion[i, HI_X] = x
        motion[i, LO_Y] = motion[i, HI_Y] = y
        return
    motion[i, LO_X], motion[i, HI_X] = extent(x, motion[i, VX], motion[i, AX], motion[i, T_END] - t)
    motion[i, LO_Y], motion[i, HI_Y] = extent(y, motion[i, VY], motion[i, AY], motion[i, T_END] - t)


@kernel
def spin_after(wz, dt, decel):
    """Spin about the vertical after dt [rad/s], eq. 21."""
    return copysign(max(0.0, abs(wz) - decel * dt), wz)


@kernel
def evaluate(motion, state, i, t, phys):
    """Ball i at time t [s] within its present phase: (x, y) [m], (vx, vy) [m/s], (wx, wy, wz) [rad/s]; not in the air."""
    dt = t - motion[i, T0]
    ax, ay = motion[i, AX], motion[i, AY]
    vx, vy = motion[i, VX] + ax * dt, motion[i, VY] + ay * dt
    x, y = (
        motion[i, X] + (motion[i, VX] + 0.5 * ax * dt) * dt,
        motion[i, Y] + (motion[i, VY] + 0.5 * ay * dt) * dt,
    )
    R = phys[P_R]
    wz = spin_after(motion[i, WZ], dt, phys[P_SPIN])
    # friction at the cloth changes the spin: dw = (5/2) z x (-a) / R; in the air a is 0
    if state[i] == SLIDE or state[i] == FALLING:
        wx, wy = motion[i, WX] + 2.5 * ay * dt / R, motion[i, WY] - 2.5 * ax * dt / R
    else:
        wx, wy = -vy / R, vx / R
    return (x, y), (vx, vy), (wx, wy, wz)


@kernel
def next_phase(motion, state, i, phys):
    """Ball i is at T_END: slide -> roll or rest, bend -> bend or roll, roll -> rest; it rolls exactly."""
    t = motion[i, T_END]
    r, (vx, vy), (_wx, _wy, wz) = evaluate(motion, state, i, t, phys)
    if state[i] == SLIDE:
        R = phys[P_R]
        # final v = v0 - (2/7) u0 without the rounding of v0 + a T: u is then zero by construction
        vx = motion[i, VX] - (motion[i, VX] - R * motion[i, WY]) / 3.5
        vy = motion[i, VY] - (motion[i, VY] + R * motion[i, WX]) / 3.5
        begin(motion, state, i, t, r, (vx, vy), (-vy / R, vx / R, wz), phys)
    elif state[i] == BEND:
        R, decel, nap = phys[P_R], phys[P_MU_R] * phys[P_G], phys[P_NAP]
        if nap != 0.0:  # with drag a piece ends at the ball's speed
            vx, vy = motion[i, VX], motion[i, VY]
            _, _, _, vx, vy = _bend(vx, vy, _piece(vx, vy, decel, nap), decel, nap)
        begin(motion, state, i, t, r, (vx, vy), (-vy / R, vx / R, wz), phys)
    else:
        begin(motion, state, i, t, r, (0.0, 0.0), (0.0, 0.0, wz), phys)
