"""How is a frictional impact carried from first touch to parting, through every change of slip and stick? For
both float oracles.

Method. Twelve (cushion: six) velocities as 3D vectors in the table frame, with cross products. The
independent variable is ``tau``, ``dP/M = dtau / (1 + 1/s + 1/b)`` with ``P`` the normal impulse and ``s``,
``b`` the slip speeds of the contacts that slip: an approach of either to zero is then an exponential and not
a singularity, so that an eighth-order Runge-Kutta method (scipy's DOP853, rtol 3e-14) passes it in ordinary
steps. Each switch of regime is a located event, solved for by integrating again up to the trial point (no
interpolation). One place needs a stiff method (Radau) instead: a sticking cushion contact that is released,
see ``_march_until_event``.

A state is a list: per ball v (3) and R w (3), all in units of the largest incoming speed, then the work of
the normal impulse.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.integrate import DOP853, Radau
from scipy.optimize import brentq

Vector = tuple[float, float, float]
Z: Vector = (0.0, 0.0, 1.0)


def cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def add(a: Vector, b: Vector) -> Vector:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def scale(k: float, a: Vector) -> Vector:
    return (k * a[0], k * a[1], k * a[2])


def norm(a: Vector) -> float:
    return math.sqrt(dot(a, a))


def normalized(a) -> Vector:
    """``a`` over its length; zero for zero, which happens only inside a step that runs past the event at ZERO_SLIP."""
    length = norm(a)
    return scale(1.0 / length, a) if length > 0.0 else a


# In units of the largest incoming speed: a slip that falls to ZERO_SLIP has reached zero, and what is within
# AT_ZERO when a regime is chosen is zero (twice as much: the state at the event is rounded). Rounding of the
# velocities is about 1e-16; a slip starts at 10 ZERO_SLIP.
ZERO_SLIP = 3e-15
AT_ZERO = 2.0 * ZERO_SLIP
SLOW = 0.05  # a slip that starts from zero with a lower rate per unit of P/M needs the stiff method
RTOL, ATOL = 3e-14, 1e-15


@dataclass(frozen=True)
class Regime:
    """What each contact does until the next event. ``main``: ball-ball or ball-cushion; ``cloth``: under the ball."""

    main: str  # "slip" or "stick"
    cloth: str  # "slip", "stick" or "off" (no reaction)
    # direction in which a slip starts from zero, None if it slips already (or sticks)
    main_start: Vector | None = None
    cloth_start: Vector | None = None


def march(state: list[float], problem, e: float) -> list[float]:
    """Carry ``state`` from first touch to parting. ``problem`` has ``closing``, ``slips``, ``regime``,
    ``rates`` and ``margins``."""
    state = [*state, 0.0]
    compressing, target = True, 0.0
    for _ in range(400):
        regime = problem.regime(state)
        starts = (regime.main_start, regime.cloth_start)
        slow_start = None
        if starts != (None, None):
            rate = problem.rates(state, regime)
            growth = [
                math.inf if d is None else dot(r, d) for r, d in zip(problem.slips(rate), starts, strict=True)
            ]
            if growth[0] < SLOW:
                slow_start = regime.main_start
                growth[0] = math.inf
            if min(growth) < math.inf:
                push = 10.0 * ZERO_SLIP / min(growth)
                state = [y + push * r for y, r in zip(state, rate, strict=True)]
            regime = Regime(regime.main, regime.cloth)
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

    ``slow_start``: direction in which the slip at the main contact starts from zero with hardly any rate (a
    stick that is released: it grows like P^2). Its direction then follows the forces stiffly; the slip's size
    and angle join the state, P takes the place of tau for that contact, and Radau's method that of DOP853,
    until the slip is large.
    """
    slow = slow_start is not None
    size = len(y0)

    def regime_at(y) -> Regime:
        return (
            Regime("slip", regime.cloth, problem.tangent(math.cos(y[size + 1]), math.sin(y[size + 1])))
            if slow
            else regime
        )

    def derivative(_tau, y):
        main, cloth = problem.slips(y)
        slowness = 1.0
        if regime.main == "slip" and not slow:
            slowness += 1.0 / max(norm(main), 1e-300)
        if regime.cloth == "slip":
            slowness += 1.0 / max(norm(cloth), 1e-300)
        rates = problem.rates(y, regime_at(y))
        if slow:
            growth = problem.slips(rates)[0]
            along, across = (
                problem.tangent(math.cos(a), math.sin(a)) for a in (y[size + 1], y[size + 1] + 0.5 * math.pi)
            )
            rates = [*rates, dot(growth, along), dot(growth, across) / y[size]]
        return np.array(rates) / slowness

    def gauges(y) -> dict[str, float]:
        main, cloth = problem.slips(y)
        g = {"closing": problem.closing(y)} if compressing else {"work": y[size - 1] - target}
        if slow:
            g["slips well"] = SLOW / 10.0 - y[size]
        elif regime.main == "slip":
            g["main slip"] = math.log(max(norm(main), 1e-300) / ZERO_SLIP)
        if regime.cloth == "slip":
            g["cloth slip"] = math.log(max(norm(cloth), 1e-300) / ZERO_SLIP)
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
        y += [ZERO_SLIP, math.atan2(dot(slow_start, problem.t2), dot(slow_start, problem.t1))]
    solver = method(derivative, 0.0, np.array(y), 1e9, max_step=2.0, first_step=1e-7 if slow else None)
    before, g_before = solver.y, gauges(solver.y)
    # together with the event before: a ball that slips at neither contact has no closing speed left
    for event in ("closing", "work"):
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

            tau, event = min(
                (brentq(gauge, tau0, tau1, args=(k,), xtol=1e-16, rtol=1e-15), k) for k in crossed
            )
            there = start if tau == tau0 else end if tau == tau1 else reach(tau0, start, tau)
            if slow and abs(norm(problem.slips(there)[0]) - there[size]) > 1e-11:
                raise RuntimeError("the slow start of a slip was not resolved in the impact oracle")
            return list(there[:size]), event
        before, g_before = solver.y, g_after
    raise RuntimeError("the impact did not end: 100000 steps")
