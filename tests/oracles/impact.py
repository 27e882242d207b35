"""What do the velocities become in one frictional impact? Two oracles for ball against ball, one for ball against cushion.

Sources: Mathavan, Jackson & Parkin (2014), *Sports Engineering* 17, 227-237 (ball against ball, "the paper" below), and Mathavan,
Jackson & Parkin (2010), *Proc. IMechE C* 224, 1863-1873 (cushion), both as corrected in ``shared/reference/physics.md``; Stronge (2000),
*Impact Mechanics* (energetic restitution).

Model. The impact is instantaneous; the accumulated normal impulse ``P`` takes the place of time. Every contact obeys Coulomb's law, and
at zero slip the law is decided by the forces: the contact sticks if the friction that holds it is within the limit, else it slips in the
direction the other forces drive it. Cloth and ball obey ``N >= 0``, ``v_z >= 0``, ``N v_z = 0``. Restitution is energetic: the normal
force gives back ``e^2`` of the work it took in.

Method of the first oracle (floats). Twelve (cushion: six) velocities as 3D vectors in the world frame, with cross products. The
independent variable is ``tau``, ``dP/M = dtau / (1 + 1/s + 1/b)`` with ``s``, ``b`` the slip speeds of the contacts that slip: an
approach of either to zero is then an exponential and not a singularity, so that an eighth-order Runge-Kutta method (scipy's DOP853,
rtol 3e-14) passes it in ordinary steps. Each switch of regime is a located event, solved for by integrating again up to the trial point
(no interpolation). One place needs a stiff method (Radau) instead: a sticking cushion contact that is released, see ``_march_until_event``.

Method of the second (``ball_ball(..., digits=n)``). The paper's scalar equations (3) and (4) in its contact frame, ``P`` itself as the
independent variable, mpmath arithmetic, extrapolated modified midpoint (Gragg-Bulirsch-Stoer, order 16) with steps graded
towards the singular points, stops found by Newton's method on the step length.

Units are SI. World frame: right-handed, z up; ``v`` [m/s] and ``w`` [rad/s] are arrays of shape (3,). R (radius) only scales ``w`` and
M (mass) only scales the impulse, which is not returned: both cancel but are asked for, as every model of the package asks for them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import mpmath
import numpy as np
from scipy.integrate import DOP853, Radau
from scipy.optimize import brentq, root

Friction = float | Callable[[float], float]
Vector = tuple[float, float, float]

# In units of the largest incoming speed: a slip that falls to ZERO_SLIP has reached zero, and what is within AT_ZERO when a regime is
# chosen is zero (twice as much: the state at the event is rounded). Rounding of the velocities is about 1e-16; a slip starts at
# 10 ZERO_SLIP.
ZERO_SLIP = 3e-15
AT_ZERO = 2.0 * ZERO_SLIP
# A sticking contact is released once the friction that would hold it exceeds the limit by this fraction, not at the very limit, where the
# slip it would start with has no rate yet. The impulse that passes meanwhile is of the same order, the error of its square.
RELEASE = 1e-9
SLOW = 0.05  # a slip that starts from zero with a lower rate per unit of P/M needs the stiff method
RTOL, ATOL = 3e-14, 1e-15
Z: Vector = (0.0, 0.0, 1.0)


# ---------------------------------------------------------------------------------------------------------------- vectors


def _cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _add(a: Vector, b: Vector) -> Vector:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def _scale(k: float, a: Vector) -> Vector:
    return (k * a[0], k * a[1], k * a[2])


def _norm(a: Vector) -> float:
    return math.sqrt(_dot(a, a))


def _direction(a: Vector) -> Vector:
    """``a`` over its length; zero for zero, which happens only inside a step that runs past the event at ZERO_SLIP."""
    length = _norm(a)
    return _scale(1.0 / length, a) if length > 0.0 else a


def _unit_horizontal(normal) -> Vector:
    n = tuple(float(c) for c in normal)
    if len(n) == 2:
        n = (*n, 0.0)
    if n[2] != 0.0 or abs(_norm(n) - 1.0) > 1e-9:
        raise ValueError(f"normal must be a horizontal unit vector, not {normal}")
    return _scale(1.0 / _norm(n), n)


def _on_the_cloth(*velocities) -> None:
    if any(v[2] != 0.0 for v in velocities):
        raise ValueError("the balls must be on the cloth: a vertical velocity before the impact is not modelled")


# ------------------------------------------------------------------------------------------------- the march through an impact
# A state is a list: per ball v (3) and R w (3), all in units of the largest incoming speed, then the work of the normal impulse.


@dataclass(frozen=True)
class _Regime:
    """What each contact does until the next event. ``main``: ball-ball or ball-cushion; ``cloth``: under the ball."""

    main: str  # "slip" or "stick"
    cloth: str  # "slip", "stick" or "off" (no reaction)
    main_start: Vector | None = None  # direction in which a slip starts from zero, None if it slips already (or sticks)
    cloth_start: Vector | None = None


def _march(state: list[float], problem, e: float) -> list[float]:
    """Carry ``state`` from first touch to parting. ``problem`` has ``closing``, ``slips``, ``regime``, ``rates`` and ``margins``."""
    state = [*state, 0.0]
    compressing, target = True, 0.0
    for _ in range(400):
        regime = problem.regime(state)
        starts = (regime.main_start, regime.cloth_start)
        slow_start = None
        if starts != (None, None):
            rate = problem.rates(state, regime)
            growth = [math.inf if d is None else _dot(r, d) for r, d in zip(problem.slips(rate), starts, strict=True)]
            if growth[0] < SLOW:
                slow_start = regime.main_start
                growth[0] = math.inf
            if min(growth) < math.inf:
                push = 10.0 * ZERO_SLIP / min(growth)
                state = [y + push * r for y, r in zip(state, rate, strict=True)]
            regime = _Regime(regime.main, regime.cloth)
        state, event = _march_until_event(state, problem, regime, compressing, target, slow_start)
        if event == "closing":
            if e == 0.0:
                return state
            compressing, target = False, -e * e * state[-1]
            state[-1] = 0.0
        elif event == "work":
            return state
    raise RuntimeError("the impact did not end: 400 changes of regime")


def _march_until_event(y0, problem, regime, compressing, target, slow_start=None):
    """Integrate in tau from ``y0`` to the first event; returns the state there and the name of the event.

    ``slow_start``: direction in which the slip at the main contact starts from zero with hardly any rate (a stick that is released: it
    grows like P^2). Its direction then follows the forces stiffly; the slip's size and angle join the state, P takes the place of tau for
    that contact, and Radau's method that of DOP853, until the slip is large.
    """
    slow = slow_start is not None
    size = len(y0)

    def regime_at(y) -> _Regime:
        return _Regime("slip", regime.cloth, problem.tangent(math.cos(y[size + 1]), math.sin(y[size + 1]))) if slow else regime

    def derivative(_tau, y):
        main, cloth = problem.slips(y)
        slowness = 1.0
        if regime.main == "slip" and not slow:
            slowness += 1.0 / max(_norm(main), 1e-300)
        if regime.cloth == "slip":
            slowness += 1.0 / max(_norm(cloth), 1e-300)
        rates = problem.rates(y, regime_at(y))
        if slow:
            growth = problem.slips(rates)[0]
            along, across = (problem.tangent(math.cos(a), math.sin(a)) for a in (y[size + 1], y[size + 1] + 0.5 * math.pi))
            rates = [*rates, _dot(growth, along), _dot(growth, across) / y[size]]
        return np.array(rates) / slowness

    def gauges(y) -> dict[str, float]:
        main, cloth = problem.slips(y)
        g = {"closing": problem.closing(y)} if compressing else {"work": y[size - 1] - target}
        if slow:
            g["slips well"] = SLOW / 10.0 - y[size]
        elif regime.main == "slip":
            g["main slip"] = math.log(max(_norm(main), 1e-300) / ZERO_SLIP)
        if regime.cloth == "slip":
            g["cloth slip"] = math.log(max(_norm(cloth), 1e-300) / ZERO_SLIP)
        g.update(problem.margins(y, regime_at(y)))
        return g

    method = partial(Radau, rtol=1e-12, atol=1e-14) if slow else partial(DOP853, rtol=RTOL, atol=ATOL)

    def reach(tau0, start, tau):
        inner = method(derivative, tau0, start, tau, first_step=tau - tau0)
        while inner.status == "running":
            inner.step()
        if inner.status == "failed":
            raise RuntimeError("the integration failed in the impact oracle")
        return inner.y

    y = list(y0)
    if slow:
        y += [ZERO_SLIP, math.atan2(_dot(slow_start, problem.t2), _dot(slow_start, problem.t1))]
    solver = method(derivative, 0.0, np.array(y), 1e9, max_step=2.0, first_step=1e-7 if slow else None)
    before, g_before = solver.y, gauges(solver.y)
    for event in ("closing", "work"):  # together with the event before: a ball that slips at neither contact has no closing speed left
        if g_before.get(event, 1.0) <= 0.0:
            return list(before[:size]), event
    for _ in range(100_000):
        solver.step()
        if solver.status == "failed":
            raise RuntimeError("the integration failed in the impact oracle")
        g_after = gauges(solver.y)
        crossed = [k for k in g_after if g_before[k] > 0.0 >= g_after[k]]
        if crossed:
            tau0, tau1 = solver.t_old, solver.t
            start, end = before, solver.y
            known = {tau0: g_before, tau1: g_after}

            def gauge(tau, k, start=start, tau0=tau0, known=known):
                return known[tau][k] if tau in known else gauges(reach(tau0, start, tau))[k]

            tau, event = min((brentq(gauge, tau0, tau1, args=(k,), xtol=1e-16, rtol=1e-15), k) for k in crossed)
            there = start if tau == tau0 else end if tau == tau1 else reach(tau0, start, tau)
            if slow and abs(_norm(problem.slips(there)[0]) - there[size]) > 1e-11:
                raise RuntimeError("the slow start of a slip was not resolved in the impact oracle")
            return list(there[:size]), event
        before, g_before = solver.y, g_after
    raise RuntimeError("the impact did not end: 100000 steps")


# ---------------------------------------------------------------------------------------------------------- ball against ball


class _BallBall:
    """Two balls in contact at ``+R n`` of ball 1; the ball that the friction between them presses into the cloth is found at the start."""

    def __init__(self, normal: Vector, mu_bb: Friction, mu_s: float, state: list[float]):
        self.n, self.mu_s = normal, mu_s
        self.mu = mu_bb
        slip_up = self.slip_between(state)[2]
        # Friction on ball 1 is against its slip relative to ball 2: if it slips upwards it is pressed down.
        self.pressed = 1 if slip_up > 0.0 else 2 if slip_up < 0.0 else 0

    def closing(self, y) -> float:
        return _dot((y[0] - y[6], y[1] - y[7], y[2] - y[8]), self.n)

    def slip_between(self, y) -> Vector:
        """Velocity of ball 1's surface at the contact relative to ball 2's, without its normal part."""
        n = self.n
        surface_1 = _add(y[0:3], _cross(y[3:6], n))  # v + w x (R n)
        surface_2 = _add(y[6:9], _cross(y[9:12], _scale(-1.0, n)))  # v + w x (-R n)
        u = _add(surface_1, _scale(-1.0, surface_2))
        return _add(u, _scale(-_dot(u, n), n))

    def slips(self, y) -> tuple[Vector, Vector]:
        if self.pressed == 0:
            return self.slip_between(y), (0.0, 0.0, 0.0)
        k = 0 if self.pressed == 1 else 6
        surface = _add(y[k : k + 3], _cross(y[k + 3 : k + 6], _scale(-1.0, Z)))  # v + w x (-R z)
        return self.slip_between(y), (surface[0], surface[1], 0.0)

    def friction(self, slip: Vector, speed: float) -> Vector:
        mu = self.mu(speed) if callable(self.mu) else self.mu
        return _scale(-mu, _direction(slip))

    def regime(self, y) -> _Regime:
        between, cloth = self.slips(y)
        speed = _norm(between)
        # Zero slip between the balls stays: the normal impulse does not drive it and the cloth acts only through the friction there.
        if speed <= AT_ZERO:
            return _Regime("stick", "off")
        f = self.friction(between, speed)
        if self.pressed == 0 or f[2] == 0.0:
            return _Regime("slip", "off")
        if _norm(cloth) > AT_ZERO:
            return _Regime("slip", "slip")
        # Coulomb's law at zero cloth slip: the rate at which the other forces drive it, against the friction there. The rate is at least
        # 1 + 5/2 |f_z|, so that 7/2 mu_s |f_z| cannot hold it while mu_s <= 5/7 (nor while mu_s mu_bb < 2/7).
        drive = self.slips(self.apply(f, 0.0, (0.0, 0.0, 0.0)))[1]
        if 3.5 * self.mu_s * abs(f[2]) >= _norm(drive):  # a friction impulse changes the cloth slip by 7/2 of itself per unit mass
            raise ValueError("the cloth contact would stick (mu_s > 5/7 and more): outside this oracle")
        return _Regime("slip", "slip", None, _direction(drive))

    def rates(self, y, regime: _Regime) -> list[float]:
        if regime.main == "stick":
            return [*self.apply((0.0, 0.0, 0.0), 0.0, (0.0, 0.0, 0.0)), self.closing(y)]
        between, cloth = self.slips(y)
        f = self.friction(between, _norm(between))
        reaction, cloth_friction = 0.0, (0.0, 0.0, 0.0)
        if regime.cloth == "slip":
            reaction = abs(f[2])
            direction = regime.cloth_start or _direction(cloth)
            cloth_friction = _scale(-self.mu_s * reaction, direction)
        return [*self.apply(f, reaction, cloth_friction), self.closing(y)]

    def apply(self, f: Vector, reaction: float, cloth_friction: Vector) -> list[float]:
        """Rates of the twelve velocities per unit of P/M. ``f``: friction on ball 1 from ball 2; the rest acts on the pressed ball."""
        n = self.n
        on_1 = _add(_scale(-1.0, n), f)
        on_2 = _scale(-1.0, on_1)
        # Moment of each impulse about the centre over I = 2/5 M R^2, times R: 5/2 of (arm / R) x impulse.
        spin_1, spin_2 = _scale(2.5, _cross(n, on_1)), _scale(2.5, _cross(_scale(-1.0, n), on_2))
        from_cloth = _add(cloth_friction, _scale(reaction, Z))
        cloth_spin = _scale(2.5, _cross(_scale(-1.0, Z), from_cloth))
        if self.pressed == 1:
            on_1, spin_1 = _add(on_1, from_cloth), _add(spin_1, cloth_spin)
        elif self.pressed == 2:
            on_2, spin_2 = _add(on_2, from_cloth), _add(spin_2, cloth_spin)
        return [*on_1, *spin_1, *on_2, *spin_2]

    def margins(self, _y, _regime: _Regime) -> dict[str, float]:
        return {}


def ball_ball(v1, w1, v2, w2, normal, *, R: float, M: float, e: float, mu_bb: Friction, mu_s: float, digits: int | None = None):
    """Velocities and spins after the frictional impact of two equal balls on a rough cloth.

    Source: Mathavan, Jackson & Parkin (2014), section 2, as corrected in physics.md 1.1. While ball 1's surface slips upwards past
    ball 2's, friction presses ball 1 into the cloth and lifts ball 2 (downwards: the reverse); the cloth answers with a reaction that
    holds the pressed ball's height and with friction against its slip on the cloth. Energetic restitution.

    v1, w1, v2, w2 : velocities [m/s] and spins [rad/s], shape (3,), world frame (z up); vertical velocities must be 0.
    normal : horizontal unit vector from the centre of ball 1 to that of ball 2.
    R, M : radius [m] and mass [kg]. ``e`` : restitution, 0..1. ``mu_s`` : ball-cloth friction.
    mu_bb : ball-ball friction, a number or a callable of the slip speed [m/s] (with ``digits`` it is called with an mpmath number, and
        its own precision limits the result).
    digits : None for the float oracle (within 1e-13 of the incoming speed); a number of decimal digits (20 or more) for the second,
        multi-precision one (steps and stops to 1e-16 of it, a second or so).

    Returns (v1, w1, v2, w2) as float64 arrays. The vertical velocity of the lifted ball is part of the result. If the balls do not
    approach (normal closing speed <= 0) the inputs come back unchanged.
    """
    v1, w1, v2, w2 = (np.array(a, dtype=float) for a in (v1, w1, v2, w2))
    _on_the_cloth(v1, v2)
    n = _unit_horizontal(normal)
    if (v1 - v2) @ np.array(n) <= 0.0:
        return v1, w1, v2, w2
    if digits is not None:
        return _ball_ball_multiprecision(v1, w1, v2, w2, n, R, e, mu_bb, mu_s, digits)
    unit = max(float(np.linalg.norm(a)) for a in (v1, R * w1, v2, R * w2))
    state = [float(c) / unit for a in (v1, R * w1, v2, R * w2) for c in a]
    law = (lambda s: mu_bb(s * unit)) if callable(mu_bb) else mu_bb
    out = np.array(_march(state, _BallBall(n, law, mu_s, state), e)) * unit
    return out[0:3], out[3:6] / R, out[6:9], out[9:12] / R


# ------------------------------------------------------------------------------- ball against ball, the second computation


def _ball_ball_multiprecision(v1, w1, v2, w2, n, R, e, mu_bb, mu_s, digits):
    """The paper's equations (3), (4) in its frame, X tangent, Y from ball C = 1 to ball O = 2, Z up; ``digits`` decimal digits."""
    with mpmath.workdps(digits):
        mpf = mpmath.mpf
        nx, ny = mpf(n[0]), mpf(n[1])
        length = mpmath.sqrt(nx * nx + ny * ny)
        nx, ny = nx / length, ny / length

        def to_frame(a):  # X = Y x Z = (ny, -nx)
            x, y, z = (mpf(float(c)) for c in a)
            return [x * ny - y * nx, x * nx + y * ny, z]

        def to_world(x, y, z):
            return np.array([float(x * ny + y * nx), float(y * ny - x * nx), float(z)])

        radius = mpf(R)
        vc, vo = to_frame(v1), to_frame(v2)
        wc, wo = ([radius * c for c in to_frame(w)] for w in (w1, w2))  # R w
        law = mu_bb if callable(mu_bb) else (lambda _s: mu_bb)
        y = _PaperImpact(vc + wc + vo + wo + [mpf(0)], law, mpf(mu_s), mpf(e)).run()
        return to_world(*y[0:3]), to_world(*y[3:6]) / R, to_world(*y[6:9]), to_world(*y[9:12]) / R


class _PaperImpact:
    """State: C's velocity (0-2) and R w (3-5), O's velocity (6-8) and R w (9-11), work (12); variable P/M. The paper's frame."""

    COLUMNS = 8  # of the extrapolation table: order 16

    def __init__(self, state, law, mu_s, e):
        self.y, self.law, self.mu_s, self.e = state, law, mu_s, e
        self.unit = max(abs(c) for c in state)
        self.zero = self.unit * mpmath.mpf(10) ** -16
        self.tolerance = self.unit * mpmath.mpf(10) ** -17
        self.push = (state[1] - state[7]) * mpmath.mpf(10) ** -9  # of the closing speed
        self.sticks = False
        z_slip = self.slip_a(state)[1]
        self.o_pressed, self.c_pressed = z_slip < 0, z_slip > 0
        self.fraction = mpmath.mpf("0.5")
        self.cloth_direction = None

    @staticmethod
    def slip_a(y):
        """Eq. (5) with (11b): C's surface relative to O's at A, along X and Z."""
        return (y[0] - y[5]) - (y[6] + y[11]), (y[2] + y[3]) - (y[8] - y[9])

    def slip_cloth(self, y):
        """Eq. (9) with (11e), (11f), of the pressed ball."""
        return (y[6] - y[10], y[7] + y[9]) if self.o_pressed else (y[0] - y[4], y[1] + y[3])

    def impulses(self, y):
        """P1', P2' on C at A (eq. 6); the cloth's N' (eq. 7) and the direction of its slip."""
        if self.sticks:
            return 0, 0
        x, z = self.slip_a(y)
        s = mpmath.sqrt(x * x + z * z)
        mu = mpmath.mpf(self.law(s))
        return -mu * x / s, -mu * z / s

    def rates(self, y):
        p1, p2 = self.impulses(y)
        zero = mpmath.mpf(0)
        cx = cy = cn = ox = oy = on = zero
        if p2 != 0:
            bx, by = self.cloth_direction or self.slip_cloth(y)
            k = -self.mu_s * abs(p2) / mpmath.sqrt(bx * bx + by * by)
            if self.o_pressed:
                ox, oy, on = k * bx, k * by, p2  # eq. (7b), (8c), (8d)
            else:
                cx, cy, cn = k * bx, k * by, -p2  # eq. (7a), (8a), (8b)
        half5 = mpmath.mpf(5) / 2
        return [
            p1 + cx, cy - 1, p2 + cn,  # eq. (3a)-(3c)
            half5 * (p2 + cy), -half5 * cx, -half5 * p1,  # eq. (3d)-(3f), times R
            ox - p1, oy + 1, on - p2,  # eq. (4) and its five companions
            half5 * (p2 + oy), -half5 * ox, -half5 * p1,
            y[1] - y[7],  # eq. (10a)
        ]  # fmt: skip

    def extrapolate(self, y, h):
        """One Gragg-Bulirsch-Stoer step of length h; returns the new state and its error estimate."""
        table, first = [], self.rates(y)
        for column in range(1, self.COLUMNS + 1):
            n = 2 * column
            step = h / n
            previous, now = y, [a + step * f for a, f in zip(y, first, strict=True)]
            for _ in range(n - 1):
                previous, now = now, [a + 2 * step * f for a, f in zip(previous, self.rates(now), strict=True)]
            row = [[(a + b + step * f) / 2 for a, b, f in zip(previous, now, self.rates(now), strict=True)]]
            for j in range(1, column):
                weight = 1 / ((mpmath.mpf(n) / (n - 2 * j)) ** 2 - 1)
                row.append([a + (a - b) * weight for a, b in zip(row[j - 1], table[-1][j - 1], strict=True)])
            table.append(row)
        return table[-1][-1], max(abs(a - b) for a, b in zip(table[-1][-1], table[-1][-2], strict=True))

    def longest_step(self, y, remaining):
        """A fraction of the impulse to the nearest singular point (slip at A zero, cloth slip zero), or what remains."""
        h = remaining
        p1, p2 = self.impulses(y)
        if p1 != 0 or p2 != 0:
            h = min(h, self.fraction * mpmath.hypot(*self.slip_a(y)) / (7 * mpmath.hypot(p1, p2)))
        if p2 != 0:
            h = min(h, self.fraction * mpmath.hypot(*self.slip_cloth(y)) / mpmath.mpf("1.5"))
        return h

    def leave_zero_cloth_slip(self, y):
        """From zero cloth slip the friction is against the driving rate: a midpoint step so short that its error is nothing."""
        p1, p2 = self.impulses(y)
        half5 = mpmath.mpf(5) / 2
        self.cloth_direction = (-p1, 1 + half5 * p2) if self.o_pressed else (p1, -1 + half5 * p2)
        h = self.push
        middle = [a + h / 2 * f for a, f in zip(y, self.rates(y), strict=True)]
        self.cloth_direction = None
        return [a + h * f for a, f in zip(y, self.rates(middle), strict=True)]

    def advance(self, y, remaining):
        """The next accepted step of at most ``remaining`` (regime switches included)."""
        if not self.sticks and mpmath.hypot(*self.slip_a(y)) <= self.zero:
            self.sticks = True
        if self.impulses(y)[1] != 0 and mpmath.hypot(*self.slip_cloth(y)) <= self.zero:
            return self.leave_zero_cloth_slip(y)
        h = self.longest_step(y, remaining)
        while True:
            new, error = self.extrapolate(y, h)
            if error <= self.tolerance:
                return new
            h /= 2

    def solve_for(self, y, h, gauge, slope):
        """From the last state before a stop, Newton on the step length (first guess h) until ``gauge`` is zero."""
        for _ in range(12):
            new, _error = self.extrapolate(y, h)
            correction = gauge(new) / slope(new)
            if abs(correction) <= self.tolerance / 100:
                return new
            h -= correction
        raise RuntimeError("Newton's method did not find the end of the phase")

    def run(self):
        def closing(y):
            return y[1] - y[7]

        def closing_slope(y):
            rate = self.rates(y)
            return rate[1] - rate[7]

        # Both loops: guess the impulse to the stop as if the closing speed fell at 2 per unit (so it does but for the cloth), step
        # towards a little beyond it, and solve from the last state before it.
        y = self.y
        while True:
            guess = closing(y) / 2
            new = self.advance(y, guess * mpmath.mpf("1.2"))
            if closing(new) <= 0:
                break
            y = new
        y = self.solve_for(y, guess, closing, closing_slope)
        if self.e == 0:
            return y
        target = (1 - self.e**2) * y[12]
        while True:
            guess = (closing(y) + mpmath.sqrt(closing(y) ** 2 + 4 * (y[12] - target))) / 2
            new = self.advance(y, guess * mpmath.mpf("1.2"))
            if new[12] <= target:
                return self.solve_for(y, guess, lambda a: a[12] - target, closing)
            y = new


# ---------------------------------------------------------------------------------------------------------- ball against cushion


class _BallCushion:
    """One ball against a cushion whose nose is above the centre; ``m`` is the unit vector from the centre to the contact."""

    def __init__(self, normal: Vector, mu_w: float, mu_s: float, sin_theta: float):
        cos_theta = math.sqrt(1.0 - sin_theta**2)
        self.m = _add(_scale(cos_theta, normal), _scale(sin_theta, Z))
        self.t1 = _cross(normal, Z)  # along the cushion
        self.t2 = _cross(self.t1, self.m)  # completes the tangent plane, pointing up
        self.mu_w, self.mu_s = mu_w, mu_s

    def closing(self, y) -> float:
        return _dot(y[0:3], self.m)

    def slips(self, y) -> tuple[Vector, Vector]:
        at_nose = _add(y[0:3], _cross(y[3:6], self.m))  # v + w x (R m)
        at_nose = _add(at_nose, _scale(-_dot(at_nose, self.m), self.m))
        at_cloth = _add(y[0:3], _cross(y[3:6], _scale(-1.0, Z)))  # v + w x (-R z)
        return at_nose, (at_cloth[0], at_cloth[1], 0.0)

    def apply(self, f: Vector, reaction: float, cloth_friction: Vector) -> list[float]:
        """Rates of the six velocities per unit of P/M under the cushion's push -m and friction f, and the cloth's answer."""
        from_nose = _add(_scale(-1.0, self.m), f)
        from_cloth = _add(cloth_friction, _scale(reaction, Z))
        spin = _scale(2.5, _add(_cross(self.m, from_nose), _cross(_scale(-1.0, Z), from_cloth)))
        return [*_add(from_nose, from_cloth), *spin]

    def cloth_answer(self, f: Vector, law: str, direction: Vector | None = None) -> tuple[float, Vector]:
        """Reaction N' that holds the ball's height and the cloth's friction, for a nose friction ``f``; affine in ``f``."""
        if law == "off":
            return 0.0, (0.0, 0.0, 0.0)
        reaction = _dot(self.m, Z) - f[2]
        if law == "slip":
            return reaction, _scale(-self.mu_s * reaction, direction)
        drive = self.slips(self.apply(f, reaction, (0.0, 0.0, 0.0)))[1]
        return reaction, _scale(-2.0 / 7.0, drive)  # the friction that holds: it changes the cloth slip by 7/2 of itself

    def coulomb(self, f: Vector, airborne: bool, cloth_slip: Vector | None):
        """Law, reaction, friction and starting direction of the cloth contact for a given ``f``; ``cloth_slip`` None: it is zero."""
        if airborne or _dot(self.m, Z) - f[2] <= 0.0:
            return "off", 0.0, (0.0, 0.0, 0.0), None
        if cloth_slip is not None:
            return "slip", *self.cloth_answer(f, "slip", _direction(cloth_slip)), None
        reaction, hold = self.cloth_answer(f, "stick")
        if _norm(hold) <= self.mu_s * reaction:
            return "stick", reaction, hold, None
        start = _scale(-1.0, _direction(hold))
        return "slip", reaction, _scale(-self.mu_s * reaction, start), start

    def tangent(self, a: float, b: float) -> Vector:
        return _add(_scale(a, self.t1), _scale(b, self.t2))

    def holding(self, law: str, direction: Vector | None = None) -> Vector:
        """The nose friction that keeps the nose's slip constant under one affine law of the cloth."""

        def rate(a, b):
            f = self.tangent(a, b)
            r = self.slips(self.apply(f, *self.cloth_answer(f, law, direction)))[0]
            return np.array([_dot(r, self.t1), _dot(r, self.t2)])

        base = rate(0.0, 0.0)
        a, b = np.linalg.solve(np.column_stack([rate(1.0, 0.0) - base, rate(0.0, 1.0) - base]), -base)
        return self.tangent(float(a), float(b))

    def holding_any(self, airborne: bool, cloth_slip: Vector | None) -> Vector:
        """The nose friction that keeps the nose's slip constant when the cloth's law depends on it (Coulomb, N' >= 0)."""
        candidates = ["off"] if airborne else ["slip" if cloth_slip is not None else "stick", "off"]
        direction = None if cloth_slip is None else _direction(cloth_slip)
        for law in candidates:
            f = self.holding(law, direction)
            if self.coulomb(f, airborne, cloth_slip)[0] == law:
                return f

        def rate(p):
            f = self.tangent(*p)
            r = self.slips(self.apply(f, *self.coulomb(f, airborne, cloth_slip)[1:3]))[0]
            return [_dot(r, self.t1), _dot(r, self.t2)]

        f = self.holding(candidates[0], direction)
        solution = root(rate, [_dot(f, self.t1), _dot(f, self.t2)], tol=1e-15)
        if max(abs(c) for c in rate(solution.x)) > 1e-12:
            raise RuntimeError("no friction holds the nose's slip")
        return self.tangent(*(float(c) for c in solution.x))

    def start_direction(self, airborne: bool, cloth_slip: Vector | None) -> Vector:
        """Unit vector d of a slip that starts from zero: its rate under the friction -mu_w d is along d itself."""

        def rate(angle):
            d = self.tangent(math.cos(angle), math.sin(angle))
            f = _scale(-self.mu_w, d)
            r = self.slips(self.apply(f, *self.coulomb(f, airborne, cloth_slip)[1:3]))[0]
            return d, r

        def across(angle):
            d, r = rate(angle)
            return _dot(_cross(d, r), self.m)

        angles = np.linspace(0.1234, 0.1234 + 2.0 * math.pi, 361)
        values = [across(a) for a in angles]
        found = []
        for i in range(360):
            if values[i] * values[i + 1] <= 0.0 and values[i] != 0.0:
                d, r = rate(brentq(across, angles[i], angles[i + 1], xtol=1e-15))
                if _dot(d, r) > 0.0:
                    found.append(d)
        if len(found) != 1:
            raise RuntimeError(f"{len(found)} directions in which the slip may start, expected one")
        return found[0]

    def regime(self, y) -> _Regime:
        nose, cloth = self.slips(y)
        airborne = y[2] > AT_ZERO
        cloth_slip = cloth if _norm(cloth) > AT_ZERO else None
        nose_start = None
        if _norm(nose) > AT_ZERO:
            main, f = "slip", _scale(-self.mu_w, _direction(nose))
        else:
            main, f = "stick", self.holding_any(airborne, cloth_slip)
            if _norm(f) > self.mu_w:
                main, nose_start = "slip", self.start_direction(airborne, cloth_slip)
                f = _scale(-self.mu_w, nose_start)
        law, _reaction, _friction, cloth_start = self.coulomb(f, airborne, cloth_slip)
        if main == law == "stick":  # no slip at either contact leaves v_y = 0 and nothing that would end the impact
            raise ValueError("the ball is wedged between cushion and cloth (mu_w, mu_s too high): outside this oracle")
        return _Regime(main, law, nose_start, cloth_start)

    def nose_friction(self, y, regime: _Regime, cloth_direction: Vector | None) -> Vector:
        if regime.main == "slip":
            direction = regime.main_start
            if direction is None:
                nose = self.slips(y)[0]
                direction = _direction(nose)
            return _scale(-self.mu_w, direction)
        return self.holding(regime.cloth, cloth_direction)

    def answer(self, y, regime: _Regime) -> tuple[Vector, float, Vector]:
        cloth_direction = None
        if regime.cloth == "slip":
            cloth = self.slips(y)[1]
            cloth_direction = regime.cloth_start or _direction(cloth)
        f = self.nose_friction(y, regime, cloth_direction)
        return f, *self.cloth_answer(f, regime.cloth, cloth_direction)

    def rates(self, y, regime: _Regime) -> list[float]:
        return [*self.apply(*self.answer(y, regime)), self.closing(y)]

    def margins(self, y, regime: _Regime) -> dict[str, float]:
        f, reaction, cloth_friction = self.answer(y, regime)
        g = {}
        if regime.main == "stick":
            g["nose holds"] = (1.0 + RELEASE) * self.mu_w - _norm(f)
        if regime.cloth == "stick":
            g["cloth holds"] = (1.0 + RELEASE) * self.mu_s * reaction - _norm(cloth_friction)
        if regime.cloth == "off":
            # On the cloth again: it has come down (v_z is back at zero) and nothing lifts it any more.
            g["in the air"] = max(y[2] - ZERO_SLIP, f[2] - _dot(self.m, Z))
        else:
            g["pressed"] = reaction + RELEASE
        return g


def ball_cushion(v, w, normal, *, R: float, M: float, e: float, mu_w: float, mu_s: float, sin_theta: float):
    """Velocity and spin after the frictional impact of a ball on a cushion, the cloth's reaction and friction included.

    Source: Mathavan, Jackson & Parkin (2010), with Coulomb's law at zero slip as in physics.md 1.4: the contact sticks only if the friction
    that holds it is within ``mu_w``; if not, it slips in the direction in which the other forces drive it. The cushion pushes the ball
    into the cloth (N' >= 0); where its friction would lift the ball instead, N' = 0 and the ball rises.

    v, w : velocity [m/s] (horizontal) and spin [rad/s], shape (3,), world frame (z up).
    normal : horizontal unit vector INTO the cushion.
    R, M : radius [m] and mass [kg]. ``e`` : energetic restitution. ``mu_w``, ``mu_s`` : friction of ball on cushion and on cloth.
    sin_theta : height of the cushion's nose above the ball's centre over R.

    Returns (v, w) as float64 arrays, the vertical velocity of a ball that was lifted included. A ball that does not approach comes back
    unchanged.
    """
    v, w = np.array(v, dtype=float), np.array(w, dtype=float)
    _on_the_cloth(v)
    n = _unit_horizontal(normal)
    if v @ np.array(n) <= 0.0:
        return v, w
    unit = max(float(np.linalg.norm(v)), float(np.linalg.norm(R * w)))
    state = [float(c) / unit for a in (v, R * w) for c in a]
    out = np.array(_march(state, _BallCushion(n, mu_w, mu_s, sin_theta), e)) * unit
    return out[0:3], out[3:6] / R


# ---------------------------------------------------------------------------------------------------------- the paper's tables


@dataclass(frozen=True)
class PaperRow:
    """One shot of the paper's Tables 1 and 2; ``_c`` the cue ball, ``_o`` the object ball, predicted unless ``measured_``.

    Speeds [m/s] and angles [deg, from the cue ball's incoming direction] after the slip; ``w_t`` topspin [rad/s]; ``cut`` angle [deg].
    """

    v0: float
    w_t: float
    cut: float
    v_c: float
    v_o: float
    angle_c: float
    angle_o: float
    measured_v_c: float
    measured_v_o: float
    measured_angle_c: float
    measured_angle_o: float


PAPER_PARAMETERS = {"R": 0.02625, "M": 0.1406, "e": 0.89, "mu_bb": 0.05, "mu_s": 0.21}

# Row 4's speed of the cue ball is printed as 0.128; 1.277 follows from the printed error (physics.md 1.2).
PAPER_ROWS = (
    PaperRow(1.539, 58.63, 33.83, 0.914, 0.831, 31.93, 32.20, 0.816, 0.836, 35.96, 33.83),
    PaperRow(1.032, 39.31, 26.36, 0.520, 0.599, 32.45, 25.07, 0.520, 0.629, 33.20, 26.36),
    PaperRow(1.364, 51.96, 40.52, 0.917, 0.676, 29.91, 38.62, 0.925, 0.700, 30.50, 40.51),
    PaperRow(1.731, 65.94, 46.50, 1.277, 0.780, 27.32, 44.38, 1.275, 0.787, 27.97, 46.50),
    PaperRow(0.942, 35.89, 18.05, 0.383, 0.579, 29.47, 17.15, 0.365, 0.581, 29.86, 18.05),
)


def incoming(row: PaperRow):
    """(v1, w1, v2, w2, normal) of a row: cue ball along +x with topspin, the object ball at rest at the cut angle to its left."""
    cut = math.radians(row.cut)
    still = np.zeros(3)
    return np.array([row.v0, 0.0, 0.0]), np.array([0.0, row.w_t, 0.0]), still, still.copy(), np.array([math.cos(cut), math.sin(cut), 0.0])


def velocity_after_slip(v, w, *, R: float) -> np.ndarray:
    """Horizontal velocity (2,) [m/s] once the slip on the cloth has ended: v - 2/7 u, u = v + w x (-R z) (physics.md 1.3)."""
    v, w = np.asarray(v, dtype=float), np.asarray(w, dtype=float)
    slip = v[:2] + R * np.array([-w[1], w[0]])
    return v[:2] - 2.0 / 7.0 * slip


def after_slip(v1, w1, v2, w2, direction, *, R: float) -> tuple[float, float, float, float]:
    """The tables' columns: speeds [m/s] of balls 1 and 2 after slip, their angles [deg, >= 0] from ``direction`` (the incoming one)."""
    speeds, angles = [], []
    dx, dy = float(direction[0]), float(direction[1])
    for v, w in ((v1, w1), (v2, w2)):
        x, y = velocity_after_slip(v, w, R=R)
        speeds.append(math.hypot(x, y))
        angles.append(abs(math.degrees(math.atan2(dx * y - dy * x, dx * x + dy * y))))
    return speeds[0], speeds[1], angles[0], angles[1]
