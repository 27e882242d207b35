"""Where does a shot end, whose balls may leave the bed? An integrator with small fixed steps in three dimensions.

An oracle for the engine. Each step of length ``dt`` moves every ball under the forces of the moment. Nothing is predicted
beyond a step; a step in which a slip, a roll or a spin would reverse is cut there; a contact is found in the step in which
it happens, by bisection of the motion itself.

State of a ball: centre (x, y, z), z above its height on the bed; velocity v; spin w. It is on the bed (z = 0, v_z = 0),
in the air, or gone.

* Cloth (at -R z): slip u = v + w x (-R z). Friction mu_s g against the slip; when rolling (u = 0), a deceleration
  mu_r g + roll_drag v^2, of the step's middle; w_z falls at ``spin_decel`` in every state.
* Air: dv_z/dt = -g; v_x, v_y and w are constant.
* Bed (z = 0): from the downward speed d the normal impulse is p = (1 + e_t) d, and v_z = e_t d; below ``SETTLE``
  p = d, v_z = 0. The impulse rubs: at most mu_s p against the slip u = v + w x (-R z), at most what ends it (2/7).
* Noses and jaws: for a ball on the bed the impact of ``ball_cushion``. For one in the air the nose is a sharp edge
  at height H = R sin_theta, R cos_theta in front of the centre of a ball on the bed that touches: a free sphere
  meets a fixed body, e from the speed along the normal.
* Two balls: both on the bed, ``ball_ball``, and the bed throws the pressed one up with e_t; both in the air, free
  spheres; one on the bed, ``moreau_tilted``. Without flight (``physics.flight`` False) no ball leaves the bed.
* The rail's top, beyond an edge line, is a bed at the height H + R. A ball ``RAIL`` beyond an edge line is off.
  A ball that comes to z = 0 in a fall circle is potted, and one that flies out of it at the back at z <= H; higher, but
  below the rail's top, it is off.

Slow contacts on the bed part as the package's text says (``meetings``): at ``PART`` or more, below it without
friction, with energy from the spins.

SI units, mass 1. Table frame: right-handed, z up.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numba
import numpy as np

from snooker_env.physics.columns import (
    FALL_RADIUS,
    FALL_X,
    FALL_Y,
    JAW_COS,
    JAW_RADIUS,
    JAW_UX,
    JAW_UY,
    JAW_X,
    JAW_Y,
    NOSE_AXIS,
    NOSE_HIGH,
    NOSE_LEVEL,
    NOSE_LOW,
    NOSE_SIDE,
)

from .ball_ball import ball_ball
from .ball_cushion import ball_cushion
from .moreau import moreau_tilted

SETTLE = 0.03  # [m/s] a ball that would leave the bed more slowly stays on it
RAIL = 0.127  # [m] how far beyond a nose's edge a ball is off the table
PART = 2e-3  # [m/s] bodies on the bed part at least so fast
ZERO_SLIP = 1e-12  # [m/s] a slip below this is rolling; a real slip ends by a cut step, exactly
APPROACH = 1e-10  # [m/s] touching bodies that approach more slowly than this are left alone
TOUCH = 1e-12  # [m] bodies this close touch: contacts are located to this distance
DEEP = 1e-6  # [m] a ball so far past a nose, jaw or plane did not come to it from the front
MOST = 120.0  # [s] the longest shot
MARLOW = (9.951e-3, 0.108, 1.088)  # the law of friction between balls called "marlow"
Law = tuple[float, float, float]  # (a, b, c) of the friction between balls, mu = a + b exp(-c s), s [m/s]
UP = np.array([0.0, 0.0, 1.0])

X, Y, VX, VY, WX, WY, WZ, Z, VZ, MODE = range(10)
BED, AIR, POTTED, OFF_TABLE = range(4)
BALL, CUSHION, JAW, LAND, RAIL_TOP, POT, OFF = range(7)
KINDS = ("ball", "cushion", "jaw", "land", "rail", "pot", "off")


class Model(NamedTuple):
    """What the stepping needs: lengths [m], decelerations [m/s^2], ``spin`` [rad/s^2], ``drag`` [1/m].

    ``height``: of the nose above the centre of a ball on the bed. ``ahead``: the edge's distance from it.
    """

    R: float
    g: float
    slides: float
    rolls: float
    spin: float
    drag: float
    height: float
    ahead: float


# ---------------------------------------------------------------- motion and contacts


@numba.njit
def _move(ball, h, radius, mu_s_g, mu_r_g, spin_decel, drag):
    """Advance one ball on the bed by h under the forces of the moment, in place."""
    turn = spin_decel * h
    ball[6] = 0.0 if abs(ball[6]) <= turn else ball[6] - math.copysign(turn, ball[6])
    left = h
    while left > 0.0:
        ux, uy = ball[2] - radius * ball[5], ball[3] + radius * ball[4]
        slip = math.sqrt(ux * ux + uy * uy)
        if slip > ZERO_SLIP:  # sliding: the slip loses 7/2 of the friction's acceleration
            t = min(left, slip / (3.5 * mu_s_g))
            ax, ay = -mu_s_g * ux / slip, -mu_s_g * uy / slip
            ball[0] += ball[2] * t + 0.5 * ax * t * t
            ball[1] += ball[3] * t + 0.5 * ay * t * t
            ball[2] += ax * t
            ball[3] += ay * t
            ball[4] += 2.5 / radius * ay * t  # (-R z) x (M a) / (2/5 M R^2)
            ball[5] -= 2.5 / radius * ax * t
            if t < left:  # the slip has ended in this step
                ball[4], ball[5] = -ball[3] / radius, ball[2] / radius
        else:
            speed = math.sqrt(ball[2] * ball[2] + ball[3] * ball[3])
            if speed == 0.0:
                return
            middle = max(0.0, speed - 0.5 * left * (mu_r_g + drag * speed * speed))
            slows = mu_r_g + drag * middle * middle
            t = left if slows * left < speed else speed / slows
            ax, ay = -slows * ball[2] / speed, -slows * ball[3] / speed
            ball[0] += ball[2] * t + 0.5 * ax * t * t
            ball[1] += ball[3] * t + 0.5 * ay * t * t
            if t < left:
                ball[2] = ball[3] = 0.0
            else:
                ball[2] += ax * t
                ball[3] += ay * t
            ball[4], ball[5] = -ball[3] / radius, ball[2] / radius
        left -= t


@numba.njit
def _advance(ball, t, m):
    """Move one ball by t under the forces of the moment, in place."""
    if ball[MODE] == AIR:
        ball[X] += ball[VX] * t
        ball[Y] += ball[VY] * t
        ball[Z] += ball[VZ] * t - 0.5 * m.g * t * t
        ball[VZ] -= m.g * t
    elif ball[MODE] == BED:
        _move(ball, t, m.R, m.slides, m.rolls, m.spin, m.drag)


@numba.njit
def _edge_line(nose, m):
    """Coordinate, along the side of a nose, of its edge."""
    return nose[NOSE_LEVEL] - m.R + m.ahead


@numba.njit
def _to_jaw(ball, jaw, m):
    """From a ball in the air to the nearest place on a jaw's edge, in the plane: unit vector and distance [m]. From behind
    the edge, too; beside the arc that place is its end."""
    dx, dy, half = ball[X] - jaw[JAW_X], ball[Y] - jaw[JAW_Y], math.acos(jaw[JAW_COS])
    middle = math.atan2(jaw[JAW_UY], jaw[JAW_UX])
    turn = math.atan2(math.sin(math.atan2(dy, dx) - middle), math.cos(math.atan2(dy, dx) - middle))
    at, radius = middle + min(max(turn, -half), half), jaw[JAW_RADIUS] + m.R - m.ahead
    dx, dy = radius * math.cos(at) - dx, radius * math.sin(at) - dy
    far = max(math.sqrt(dx * dx + dy * dy), 1e-300)
    return dx / far, dy / far, far


@numba.njit
def _gap(kind, a, b, part, m):
    """How far [m] ball a is from a contact, and the rate [m/s]. ``b``: the other ball; ``part``: the table's row."""
    if kind == BALL:
        dx, dy, dz = b[X] - a[X], b[Y] - a[Y], b[Z] - a[Z]
        d = math.sqrt(dx * dx + dy * dy + dz * dz)
        rate = ((b[VX] - a[VX]) * dx + (b[VY] - a[VY]) * dy + (b[VZ] - a[VZ]) * dz) / d
        return d - 2.0 * m.R, rate
    if kind == LAND:
        return a[Z], a[VZ]
    if kind == RAIL_TOP:
        return a[Z] - m.height - m.R, a[VZ]
    if kind == POT:  # a ball on the bed comes to the fall, one in the air leaves it
        dx, dy = a[X] - part[FALL_X], a[Y] - part[FALL_Y]
        d = max(math.sqrt(dx * dx + dy * dy), 1e-300)
        way = 1.0 if a[MODE] == BED else -1.0
        return way * (d - part[FALL_RADIUS]), way * (dx * a[VX] + dy * a[VY]) / d
    if kind == JAW and a[MODE] == AIR:
        hx, hy, off = _to_jaw(a, part, m)
        away = -(hx * a[VX] + hy * a[VY])
    elif kind == JAW:
        dx, dy = a[X] - part[JAW_X], a[Y] - part[JAW_Y]
        far = max(math.sqrt(dx * dx + dy * dy), 1e-300)
        off, away = far - part[JAW_RADIUS] - m.R + m.ahead, (dx * a[VX] + dy * a[VY]) / far
    else:
        side, x = part[NOSE_SIDE], int(part[NOSE_AXIS])
        off, away = _edge_line(part, m) - side * a[X + x], -side * a[VX + x]
        if kind == OFF:
            return off + RAIL, away
    if a[MODE] == BED:
        return off - m.ahead, away
    up = a[Z] - m.height
    d = max(math.sqrt(off * off + up * up), 1e-300)
    return d - m.R, (off * away + up * a[VZ]) / d


@numba.njit
def _outside(ball, noses, m):
    """Is the centre beyond the edge line of a nose, wherever that nose ends?"""
    outside = False
    for nose in noses:
        outside = outside or nose[NOSE_SIDE] * ball[X + int(nose[NOSE_AXIS])] > _edge_line(nose, m)
    return outside


@numba.njit
def _over(ball, falls):
    """The fall circle that the centre is in; -1: none."""
    for k in range(falls.shape[0]):
        if math.hypot(ball[X] - falls[k, FALL_X], ball[Y] - falls[k, FALL_Y]) < falls[k, FALL_RADIUS]:
            return k
    return -1


@numba.njit
def _counts(kind, ball, part, noses, falls, m):
    """Is there something to meet at this place, where the gap is zero?"""
    if kind == CUSHION:
        along = ball[Y - int(part[NOSE_AXIS])]
        return part[NOSE_LOW] <= along <= part[NOSE_HIGH]
    if kind == JAW and ball[MODE] == BED:
        dx, dy = ball[X] - part[JAW_X], ball[Y] - part[JAW_Y]
        far = math.sqrt(dx * dx + dy * dy)
        in_sector = dx * part[JAW_UX] + dy * part[JAW_UY] >= part[JAW_COS] * far
        return in_sector and far > part[JAW_RADIUS] + m.R - m.ahead
    if kind == RAIL_TOP:
        return _outside(ball, noses, m) and _over(ball, falls) < 0
    if kind == POT and ball[MODE] == AIR:
        return ball[Z] <= m.height + m.R and _outside(ball, noses, m)
    return True


@numba.njit
def _gap_after(kind, a, b, part, t, m):
    p = a.copy()
    _advance(p, t, m)
    if kind != BALL:
        return _gap(kind, p, p, part, m)
    q = b.copy()
    _advance(q, t, m)
    return _gap(kind, p, q, part, m)


@numba.njit
def _turn(kind, a, b, part, h, m, sign):
    """The moment in [0, h] where the rate of the gap, of this sign at first, changes it: the two sides of it."""
    near, far = 0.0, h
    for _ in range(60):
        middle = 0.5 * (near + far)
        if sign * _gap_after(kind, a, b, part, middle, m)[1] > 0.0:
            near = middle
        else:
            far = middle
    return near, far


@numba.njit
def _contact(kind, a, b, part, h, m):
    """When, within h, does the gap close? Bisection on the motion itself; infinity if it does not."""
    gap0, rate0 = _gap(kind, a, b, part, m)
    if kind != BALL and gap0 < -DEEP:
        return np.inf
    if gap0 <= TOUCH and rate0 < -APPROACH:
        return 0.0
    gap1, rate1 = _gap_after(kind, a, b, part, h, m)
    lo, hi = 0.0, h
    if rate0 < 0.0:
        if rate1 > 0.0 and gap1 > 0.0:  # it came and went
            hi = _turn(kind, a, b, part, h, m, -1.0)[0]
            gap1 = _gap_after(kind, a, b, part, hi, m)[0]
    else:
        if rate1 >= -APPROACH:
            return np.inf
        lo = _turn(kind, a, b, part, h, m, 1.0)[1]  # it went and came back
        if gap1 <= 0.0 and _gap_after(kind, a, b, part, lo, m)[0] <= 0.0:
            return h  # pressed together throughout: one impact per step
    if gap1 > 0.0:
        return np.inf
    for _ in range(60):
        middle = 0.5 * (lo + hi)
        if middle <= lo or middle >= hi:
            break
        if _gap_after(kind, a, b, part, middle, m)[0] > 0.0:
            lo = middle
        else:
            hi = middle
    return hi


@numba.njit
def _first(balls, h, reach, noses, jaws, falls, m):
    """The first contact within h: (time, kind, ball, other ball or row of the table); kind -1: none.

    ``reach``: a larger gap cannot close within h.
    """
    best = (np.inf, -1, -1, -1)
    for i in range(balls.shape[0]):
        a = balls[i]
        if a[MODE] > AIR:
            continue
        for kind in range(7):
            if kind in (LAND, RAIL_TOP, OFF) and a[MODE] == BED:
                continue
            rows, start = noses, 0  # of planes one row of any kind is enough
            if kind == BALL:
                rows, start = balls, i + 1
            elif kind == JAW:
                rows = jaws
            elif kind == POT:
                rows = falls
            many = 1 if kind in (LAND, RAIL_TOP) else rows.shape[0]
            for k in range(start, many):
                if kind == BALL and balls[k, MODE] > AIR:
                    continue
                part = a if kind in (BALL, LAND, RAIL_TOP) else rows[k]
                b = balls[k] if kind == BALL else a
                gap = _gap(kind, a, b, part, m)[0]
                if gap > reach or (kind != BALL and gap < -DEEP):
                    continue
                t = _contact(kind, a, b, part, h, m)
                if t < best[0]:
                    there = a.copy()
                    _advance(there, t, m)
                    if _counts(kind, there, part, noses, falls, m):
                        best = (t, kind, i, k)
    return best


@numba.njit
def _run_to_contact(balls, time, into_step, dt, noses, jaws, falls, m):
    """Step all balls, in place, to the next contact. Returns (time, into_step, kind, i, k); kind -1: all rest,
    -2: ``MOST`` is past. ``into_step``: how much of the current step has passed."""
    while time < MOST:
        h = dt - into_step
        fastest, moving = 0.0, False
        for ball in balls:
            if ball[MODE] > AIR:
                continue
            speed = math.sqrt(ball[VX] ** 2 + ball[VY] ** 2 + ball[VZ] ** 2)
            slip = math.hypot(ball[VX] - m.R * ball[WY], ball[VY] + m.R * ball[WX])
            fastest = max(fastest, speed)
            moving = moving or ball[MODE] == AIR or speed > 0.0 or slip > ZERO_SLIP
        if not moving:
            return time, 0.0, -1, -1, -1
        reach = 2.0 * (fastest + (m.slides + m.g) * h) * h + 1e-9
        t, kind, i, k = _first(balls, h, reach, noses, jaws, falls, m)
        t = min(t, h)
        if t > 0.0:
            for ball in balls:
                _advance(ball, t, m)
        time += t
        if kind >= 0:
            return time, into_step + t if into_step + t < dt else 0.0, kind, i, k
        into_step = 0.0
    return time, 0.0, -2, -1, -1


# ---------------------------------------------------------------- impacts of bodies that are free or fixed


def _rubbed(v, w, m, most, R):
    """Friction of at most ``most`` at R m, m the unit vector to the contact, on one free ball."""
    slip = v + R * np.cross(w, m)
    slip = slip - (slip @ m) * m
    size = math.sqrt(slip @ slip)
    if size == 0.0:
        return v, w
    push = -min(most, 2.0 / 7.0 * size) / size * slip
    return v + push, w + 2.5 / R * np.cross(m, push)


def fixed(v, w, m, *, e, mu, R):
    """A free ball meets a fixed body at R m (m from the centre to the contact)."""
    p = (1.0 + e) * (v @ m)
    return _rubbed(v - p * m, w, m, mu * p, R)


def free(v1, w1, v2, w2, n, *, e, mu: Law, R):
    """Two free balls; n from ball 1 to ball 2 in three dimensions. The slip s falls by ds/dp = -7 mu(s)."""
    p = 0.5 * (1.0 + e) * ((v1 - v2) @ n)
    slip = v1 - v2 + R * np.cross(w1 + w2, n)
    slip = slip - (slip @ n) * n
    size = math.sqrt(slip @ slip)

    def rate(s):
        return -7.0 * (mu[0] + mu[1] * math.exp(-mu[2] * max(s, 0.0)))

    s, steps = size, 200
    for _ in range(steps):  # Runge-Kutta of the fourth order; below zero the law goes on, to be cut off
        h = p / steps
        k1 = rate(s)
        k2 = rate(s + 0.5 * h * k1)
        k3 = rate(s + 0.5 * h * k2)
        s += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + rate(s + h * k3))
        if s <= 0.0:
            s = 0.0
            break
    push = -p * n - ((size - s) / 7.0 / size * slip if size > 0.0 else 0.0)
    turn = 2.5 / R * np.cross(n, push)
    return v1 + push, w1 + turn, v2 - push, w2 + turn


def hop(closing, spin_energy, mass):
    """A slow contact on the bed: the speed of parting, and the factor on the spins, which pay for it."""
    gain = min(0.5 * mass * (PART**2 - closing**2), spin_energy)
    if gain <= 0.0:
        return closing, 1.0
    return math.sqrt(closing**2 + 2.0 * gain / mass), math.sqrt(max(0.0, 1.0 - gain / spin_energy))


# ---------------------------------------------------------------- a shot


class _Shot:
    """What each kind of contact does to the balls, under the constants ``physics``."""

    def __init__(self, physics, noses, jaws, falls):
        if physics.nap:
            raise ValueError("the oracle has no nap")
        self.p, self.e_t, self.flies = physics, physics.e_t, physics.flight
        self.noses, self.jaws, self.falls = noses, jaws, falls
        self.mu_bb: Law = MARLOW if physics.mu_bb == "marlow" else (float(physics.mu_bb), 0.0, 0.0)
        R, g, sin = physics.R, physics.g, physics.sin_theta
        ahead = R * math.sqrt(1.0 - sin * sin)
        slides, rolls = physics.mu_s * g, physics.mu_r * g
        self.model = Model(R, g, slides, rolls, physics.spin_decel, physics.roll_drag, R * sin, ahead)

    def put(self, ball, v, w):
        """New velocity and spin; a ball without height or vertical velocity is on the bed."""
        ball[[VX, VY, VZ]], ball[[WX, WY, WZ]] = v, w
        ball[MODE] = AIR if ball[Z] > 0.0 or ball[VZ] != 0.0 else BED

    def restitution(self, jaw, speed):
        """Of a jaw at every speed; of a nose, falling with the speed into it above the knee."""
        p = self.p
        if jaw:
            return p.e_c if p.e_j is None else p.e_j
        fades = p.e_c_power > 0.0 and speed > p.e_c_knee
        return p.e_c * (speed / p.e_c_knee) ** -p.e_c_power if fades else p.e_c

    def bounce(self, v, w):
        """Off the bed or the rail's top at -v_z."""
        down = -v[2]
        up = self.e_t * down if self.e_t * down >= SETTLE else 0.0
        v, w = _rubbed(v, w, -UP, self.p.mu_s * (down + up), self.p.R)
        return np.array([v[0], v[1], up]), w

    def thrown(self, v, w, press):
        """A ball on the bed that another has pressed down with this impulse: the slate gives e_t of it back."""
        up = self.e_t * press
        if up < SETTLE:
            return np.array([v[0], v[1], 0.0]), w
        v, w = _rubbed(v, w, -UP, self.p.mu_s * up, self.p.R)
        return np.array([v[0], v[1], up]), w

    def lifted(self, v, w, press=0.0):
        """A ball on the bed after an impact: up with its v_z, or thrown up, or it stays."""
        if not self.flies:
            return v * (1.0, 1.0, 0.0), w
        return (v, w) if v[2] >= SETTLE else self.thrown(v, w, press)

    def meet(self, a, b):
        """Two balls."""
        p, R = self.p, self.p.R
        if a[MODE] == BED and b[MODE] == AIR:
            a, b = b, a
        v1, w1, v2, w2 = (ball[k] for ball in (a, b) for k in ([VX, VY, VZ], [WX, WY, WZ]))
        n = b[[X, Y, Z]] - a[[X, Y, Z]]
        n = n / math.sqrt(n @ n)
        closing = float((v1 - v2) @ n)
        if b[MODE] == AIR:
            v1, w1, v2, w2 = free(v1, w1, v2, w2, n, e=p.e_b, mu=self.mu_bb, R=R)
        elif a[MODE] == AIR:
            v1, w1, v2, w2, press = moreau_tilted(v1, w1, v2, w2, n, e=p.e_b, mu=self.mu_bb, mu_s=p.mu_s, R=R)
            v2, w2 = self.lifted(v2, w2, press)
        elif closing <= PART:
            parting, k = hop(closing, 0.2 * R * R * float(w1 @ w1 + w2 @ w2), 0.5)
            push = 0.5 * (closing + parting) * n
            v1, w1, v2, w2 = v1 - push, k * w1, v2 + push, k * w2
        else:
            e = max(p.e_b, PART / closing)
            least, extra, fade = self.mu_bb

            def mu(s):
                return least + extra * math.exp(-fade * s)

            out = ball_ball(v1, w1, v2, w2, n, R=R, M=1.0, e=e, mu_bb=mu, mu_s=p.mu_s)
            v1, w1 = self.lifted(out[0], out[1], out[2][2])
            v2, w2 = self.lifted(out[2], out[3], out[0][2])
        self.put(a, v1, w1)
        self.put(b, v2, w2)

    def rebound(self, ball, kind, k):
        """A nose or a jaw."""
        p, R, model = self.p, self.p.R, self.model
        v, w = ball[[VX, VY, VZ]], ball[[WX, WY, WZ]]
        if kind == JAW and ball[MODE] == AIR:
            hx, hy, off = _to_jaw(ball, self.jaws[k], model)
            h = np.array([hx, hy, 0.0])
        elif kind == JAW:
            h = np.array([self.jaws[k, JAW_X] - ball[X], self.jaws[k, JAW_Y] - ball[Y], 0.0])
            far = math.sqrt(h @ h)
            h, off = h / far, far - self.jaws[k, JAW_RADIUS] - R + model.ahead
        else:
            h, axis = np.zeros(3), int(self.noses[k, NOSE_AXIS])
            h[axis] = self.noses[k, NOSE_SIDE]
            off = _edge_line(self.noses[k], model) - h[axis] * ball[X + axis]
        closing = float(v @ h)
        if ball[MODE] == AIR:
            m = off * h + (model.height - ball[Z]) * UP
            m = m / math.sqrt(m @ m)
            v, w = fixed(v, w, m, e=self.restitution(kind == JAW, float(v @ m)), mu=p.mu_c, R=R)
        elif closing <= PART:
            parting, scale = hop(closing, 0.2 * R * R * float(w @ w), 1.0)
            v, w = v - (closing + parting) * h, scale * w
        else:
            e = max(self.restitution(kind == JAW, closing), PART / closing)
            out = ball_cushion(v, w, h, R=R, M=1.0, e=e, mu_w=p.mu_c, mu_s=p.mu_s, sin_theta=p.sin_theta)
            v, w = self.lifted(*out)
        self.put(ball, v, w)

    def resolve(self, balls, kind, i, k):
        """Change the balls; returns the kind and the index to log."""
        ball = balls[i]
        if kind == BALL:
            self.meet(ball, balls[k])
        elif kind in (CUSHION, JAW):
            self.rebound(ball, kind, k)
        elif kind == LAND and _over(ball, self.falls) < 0:
            ball[Z] = 0.0
            self.put(ball, *self.bounce(ball[[VX, VY, VZ]], ball[[WX, WY, WZ]]))
            return LAND, -1
        elif kind == RAIL_TOP and -self.e_t * ball[VZ] >= SETTLE:
            self.put(ball, *self.bounce(ball[[VX, VY, VZ]], ball[[WX, WY, WZ]]))
            return RAIL_TOP, -1
        elif kind in (RAIL_TOP, OFF) or (kind == POT and ball[Z] > self.model.height):
            ball[MODE] = OFF_TABLE
            return OFF, -1
        else:
            ball[MODE] = POTTED
            return POT, k if kind == POT else _over(ball, self.falls)
        return kind, k


def simulate(
    positions,
    velocities,
    spins,
    *,
    physics,
    table=None,
    dt: float,
    log: list | None = None,
) -> tuple[np.ndarray, list[str]]:
    """Final positions, (n, 3) [m], and fates of n balls, once all are at rest or gone.

    positions : (n, 2) or (n, 3) [m], z above the height on the bed. velocities [m/s], spins [rad/s] : (n, 3). A
    v_z below zero at z = 0 is a strike into the bed.
    physics : a ``Physics``. table : a ``Table``, or None.
    dt : step [s]. RuntimeError if the balls still move after ``MOST``, or after 10000 contacts.
    log : if a list is given, (time, kind, i, k) of each contact is appended. k: the other ball, or the nose, jaw or
    fall, or -1. Kinds: ``KINDS``.

    Fates: "table", "potted" or "off". A ball's position is then where it was lost.
    Contacts in one step are resolved in order of time; at equal times the ball with the lowest index goes first.
    """
    arrays = [np.zeros((0, columns)) for columns in (5, 6, 3)]
    if table is not None:
        arrays = [np.array(a, dtype=float) for a in (table.noses, table.jaws, table.falls)]
    shot = _Shot(physics, *arrays)
    places = np.asarray(positions, dtype=float)
    balls = np.zeros((len(places), 10))
    balls[:, [X, Y]] = places[:, :2]
    balls[:, Z] = places[:, 2] if places.shape[1] == 3 else 0.0
    for ball, v, w in zip(balls, np.asarray(velocities, float), np.asarray(spins, float), strict=True):
        shot.put(ball, v, w)
    time = into_step = 0.0
    for _ in range(10_000):
        time, into_step, kind, i, k = _run_to_contact(balls, time, into_step, dt, *arrays, shot.model)
        if kind == -2:
            raise RuntimeError(f"the balls still move after {MOST} s")
        if kind == -1:
            fates = ["table", "table", "potted", "off"]
            return balls[:, [X, Y, Z]].copy(), [fates[int(mode)] for mode in balls[:, MODE]]
        kind, k = shot.resolve(balls, kind, i, k)
        if log is not None:
            log.append((time, KINDS[kind], int(i), int(k)))
    raise RuntimeError("10000 contacts: the balls rattle")
