"""How is an impact with friction solved? Coulomb's law at two contacts, integrated over the normal impulse.

Ball on ball [MJP14] and ball on cushion [MJP10] differ in constants only. At A, where the bodies touch: slip
a = (a1, a2), friction impulse F = (F1, F2). Under the ball pressed into the cloth: slip b, friction impulse
G. p is the normal impulse per unit mass, W its work, Z the vertical velocity of a ball that has left the
cloth::

    a1      = a1_0              + k1 F1 + c1 G1                 All slips are linear in F, G, p and Z (``inertia.py``, where
    a2      = a2_0      + d_a p + k2 F2 + c2 G2 + l_a Z         the constants are derived), so F, G, p, W and Z are the
    b1      = b1_0              + c1 F1 + 7/2 G1                whole state: ``Impulses``.
    b2      = b2_0      + d_b p + c2 F2 + 7/2 G2
    closing = closing_0 + d_n p - d_a F2 - d_b G2 + l_n Z       W' = closing
    N'      = n_p + n_f F2'  while that is positive and the ball is down (Z = 0); else N' = 0 and Z' = -(n_p + n_f F2'): it lifts

Coulomb: F' = -mu(|a|) a/|a| and G' = -mu_s N' b/|b|, prime: d/dp. Friction holds a zero slip if it can; if
not, the slip starts in the direction of the driving forces (``coulomb.py``). Ends: ``ends.py``.

While A slips, the variable is t with dp = |a| dt: F' = -mu a is regular, and the end of a slip, where its
direction turns like a power of |a|, is approached exponentially. While both contacts slip, the solution is
analytic in t and a Taylor series covers most of an impact or all (``taylor.py``). The rest is rare in play (a
contact that sticks or creeps, a lifted ball, a cloth that may hold): Runge-Kutta steps
(``dormand_prince.py``). Both write a polynomial, in which ends are located; ``transitions.py`` has the
contacts' next states. Speeds are over the closing speed before.
"""

from math import hypot, sqrt
from typing import NamedTuple

from ..._lib.jit import inline, kernel
from . import dormand_prince, taylor
from .coulomb import (
    CREEP,
    GRIPS,
    SLIDES,
    SLIP,
    STARTS,
    STICK,
    can_hold,
    friction_coefficient,
    grip_holds,
    is_wedge,
    rates,
    stop_wedge,
)
from .ends import NEVER, WHOLE, Target, dips_at, ends_inside, locate_end, may_dip, split_at, turns_at
from .inertia import K_CLOTH, Impulses, slips_after
from .polynomial import CLOSING, ROW, WORK_DONE, state_at
from .transitions import STANDS, Moment, Step, Tolerances, cloth_after, mode_after

OK, TOO_MANY_STEPS = 0, 1

# "Doubled", "halved", "either" (one or the other): the effect of this number alone on 6,000 impacts, two
# balls and cushion, half of play, half harsh (friction, restitution and nose height anywhere in their
# ranges): on the steps (play 2 to 11, harsh 20 to 350), the largest deviation from ``reference``, and
# failures. What is not named has no effect: below 2 % of the steps, no error. A few harsh ones at
# ``reference`` change by up to 1e-5 in any case.

_MAX_STEPS = 20_000
"""The most steps; then the impact is unsolved."""
_KNIFE_EDGE = 4_000
"""After so many steps friction and drive almost balance: the small, stiff slip takes its limiting direction. With a quarter
impacts at ``reference`` that need 1,100 to 1,500 steps (frictions near 1) err by up to 7e-5 (tests/oracles/test_moreau.py)."""
_STIFF, _STIFF_CREEP = 1e-4, 10.0
"""The cloth slip that then is zero, creep's limit over it. Either: harsh cushion impacts change 4e-5."""
_JAMMED, _STOPPED = 15_000, 1e-2
"""After so many steps an impact slower than this has ended: friction balances the elastic force, and the slow
motion across the nose has no end. With a third of the steps a harsh cushion impact ends 7e-2 off."""
_NEAR = 10.0
"""A cloth slip below this many delta is zero: more than the shortest step covers, so that a stop is detected.
Halved: 5 % more steps at ``fast`` in harsh cushion impacts."""
_ROUNDING = 1e-15
"""What impulses and slips err by at the least, over the slips at first."""
_SERIES = 40.0
"""Limit of a series' last terms, over tol; their sum is far above the step's error. Doubled: 3 % fewer steps,
twice the error (8e-7 for two balls at ``standard``). Halved: the reverse."""
_BENT = 10.0
"""A step's polynomial with last terms above this, over tol, may err by more than tol between its ends."""
_OVERSHOOT = 1.05
"""The estimated normal impulse over one without friction. Halved: 2 to 5 times the steps to the end."""
_LEAST_LEFT = 0.1
"""The remaining impulse is taken to be at least this part of that estimate, or of what exceeds it: spin can drive
a ball into a cushion a thousand times as hard as it came."""
_FIRST = 0.4
"""The first Runge-Kutta step of a slip over the longest stable one; the error control corrects it."""
_NO_FRICTION = 1e-9
"""Keeps the longest step finite without friction at A."""
_SAFETY, _ERROR_POWER = 0.9, 0.2
"""The next step over that with error tol, and the power 1/5 of order 5. Doubled: every step is rejected,
impacts fail. Halved: up to 1.9 times the steps."""
_LEAST_FACTOR, _MOST_FACTOR = 0.2, 3.0
"""Limits on the change of a step. Most, doubled: 5e-5 error instead of 3e-7 at cushions in play at
``standard``, as a step passes over a change of state; halved: up to 4 % more steps."""
_EXACT = 1e-3
"""With an error below this part of tol the step grows by the largest factor."""
_SHORTEST = 1e-13
"""A step as short as this is not shortened further."""
_LEAPT, _LEAPT_FACTOR = 2.0, 0.5
"""The largest impulse of a step over the remaining one (a slip may grow fast); factor on a longer step."""
_TURNED_FACTOR = 0.25
"""Factor on a step that reversed the cloth slip. Either: up to 3 % more steps in harsh cushion impacts."""
_BELOW, _LANDED_FACTOR = 10.0, 0.5
"""How far below the cloth a lifted ball may end a step, over tol; the factor if lower. Factor doubled: never
shortened, 6 % of harsh cushion impacts fail."""
_PAST_END = 1.01
"""How far a step may pass the estimated end. Halved: never there, 8 % of harsh two-ball impacts fail."""
_SMALL, _REACH, _STABLE = 1000.0, 0.4, 0.2
"""A cloth slip that may end and be held, below the first (over the larger of tol and delta): the next step
cuts it by at most the second and is within the stability limit, the third. At ``fast`` in harsh cushion
impacts: ``_REACH`` doubled 2.1 times the steps, halved 12 % more; ``_STABLE`` halved 1.6 times, doubled 3 %
more."""
_TINY = 1e-300
"""Keeps a quotient of zeros finite."""
NO_IMPULSE = Impulses(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class Accuracy(NamedTuple):
    """How accurately an impact is solved; the first three in units of the closing speed before it."""

    tol: float
    """The largest local error of a step."""
    delta: float
    """Slips below this count as zero."""
    creep: float
    """A slip that begins keeps its limiting direction until it exceeds this."""
    order: int
    """The highest order of the Taylor series."""


REFERENCE = Accuracy(tol=1e-13, delta=1e-13, creep=1e-5, order=20)
"""Of the fidelity "reference": errors below 1e-9 of the larger incoming speed."""


class Outlook(NamedTuple):
    """What is known of an impact before its first step."""

    p_full: float
    """Estimate of its normal impulse, slightly too large."""
    h_slip: float
    """The longest Runge-Kutta step while A slips; beyond three times this the method is unstable on a' = -k1
    mu a, and a slip that should decay stays at the size of the tolerance."""
    mu: float
    """The largest coefficient of friction at A."""
    may_grip: bool
    """Whether the cloth's friction can hold the ball in some state."""
    may_rise: bool
    """Whether friction can ever let the closing speed grow: never between balls."""
    analytic: bool
    """Whether the Taylor series is valid while A slips: the cloth never holds, its load is positive."""


@inline
def outlook_of(problem):
    """The ``Outlook`` of an impact, from its constants."""
    contact = problem.contact
    mu = friction_coefficient(0.0, problem.friction)
    p_full = -_OVERSHOOT * (1.0 + problem.e) / contact.d_n
    h_slip = 1.0 / (contact.k1 * mu + _NO_FRICTION)
    may_grip = (
        K_CLOTH * problem.mu_s * (contact.n_p + abs(contact.n_f) * mu)
        >= abs(contact.d_b) - abs(contact.c2) * mu
    )
    # the load stays positive if p exceeds the friction at A, or only that presses and a2 keeps its sign
    pressed = contact.n_p >= abs(contact.n_f) * mu or (
        contact.n_p == 0.0 and contact.n_f * problem.start.a2 <= 0.0
    )
    cloth = abs(contact.d_b) * problem.mu_s * (contact.n_p + abs(contact.n_f) * mu)
    may_rise = abs(contact.d_a) * mu + cloth + abs(contact.l_n) > -contact.d_n
    return Outlook(p_full, h_slip, mu, may_grip, may_rise, pressed and not may_grip)


@kernel
def _stick_or_creep(x, near, cloth, problem):
    """The state of contact A where its slip is zero."""
    return STICK if can_hold(x, near, cloth, problem) else CREEP


@inline
def _first_state(s, outlook, limits, problem):
    """At first, slip s at A: states of A and cloth, the rates if needed, and the step's length."""
    start, near = problem.start, limits.near
    calm = start.b1 * start.b1 + start.b2 * start.b2 <= near * near
    cloth = GRIPS if outlook.may_grip and calm else STARTS if calm else SLIDES
    if s > limits.delta:
        mode, h = SLIP, min(outlook.p_full / s, _FIRST * outlook.h_slip)
    else:
        mode, h = _stick_or_creep(NO_IMPULSE, near, cloth, problem), outlook.p_full
    per = NO_IMPULSE
    if not (outlook.analytic and mode == SLIP):
        per = rates(NO_IMPULSE, mode, near, cloth, problem)
        if cloth == GRIPS and not grip_holds(per, NO_IMPULSE, problem):
            cloth = STARTS
            if s <= limits.delta:
                mode = _stick_or_creep(NO_IMPULSE, near, cloth, problem)
            per = rates(NO_IMPULSE, mode, near, cloth, problem)
    return mode, cloth, per, h


@inline
def _estimate_rest(x, outlook):
    """Estimate of the remaining normal impulse."""
    return max(outlook.p_full - x.p, _LEAST_LEFT * max(outlook.p_full, x.p - outlook.p_full))


@inline
def _series_step(series, x, slip, starts, outlook, problem, tol, order):
    """A Taylor step, up to its accuracy or a reversal of the cloth's slip: end, slips, degree and length."""
    degree, span = taylor.expand(
        series, x, slip, starts, _estimate_rest(x, outlook), problem, _SERIES * tol, order
    )
    # a slip that counts as zero has no definite direction
    o1, o2 = (slip.b1, slip.b2) if starts else (0.0, 0.0)
    end = state_at(series, degree, span)
    slip_end = slips_after(end, problem.start, problem.contact)
    if outlook.may_rise and may_dip(slip.closing, series[ROW + CLOSING], span, slip_end.closing):
        t = dips_at(series, degree, span)
        if t != NEVER:
            span = t
            end = state_at(series, degree, span)
            slip_end = slips_after(end, problem.start, problem.contact)
    if taylor.turns_back(series, slip_end.b1 - o1, slip_end.b2 - o2):
        span = turns_at(series, degree, span, o1, o2, problem)
        end = state_at(series, degree, span)
        slip_end = slips_after(end, problem.start, problem.contact)
    return end, slip_end, degree, span


@inline
def _closing_rate(per, contact):
    """The rate of the closing speed while the impulses grow at the rates ``per``."""
    return contact.d_n * per.p - contact.d_a * per.F2 - contact.d_b * per.G2 + contact.l_n * per.Z


@inline
def _runge_kutta_step(series, start, h, mode, cloth, outlook, limits, problem):
    """A Runge-Kutta step: its end, a ``Moment``, its error, the factor to shorten it or ``STANDS``."""
    x, slip, per = start
    contact, shrink, slip_end = problem.contact, STANDS, slip
    end, per_end, error = dormand_prince.step(series, x, h, per, mode, limits.near, cloth, problem)
    if error > limits.tol and h > _SHORTEST:
        shrink = max(_LEAST_FACTOR, _SAFETY * (limits.tol / error) ** _ERROR_POWER)
    elif mode == SLIP and end.p - x.p > _LEAPT * _estimate_rest(x, outlook):
        # the slip grew; the step's polynomial is inaccurate over the impulse of several impacts
        shrink = _LEAPT_FACTOR
    else:
        slip_end = slips_after(end, problem.start, contact)
        push = problem.mu_s * (contact.n_p + abs(contact.n_f) * outlook.mu) * (end.p - x.p)
        if slip_end.b1 * slip.b1 + slip_end.b2 * slip.b2 < 0.0 and push > limits.delta and h > _SHORTEST:
            shrink = _TURNED_FACTOR  # the cloth's slip reversed inside the step, perhaps between two stages
        elif -_BELOW * limits.tol > end.Z and x.Z > 0.0 and h > _SHORTEST:
            shrink = _LANDED_FACTOR  # the ball came down inside the step: find where
        elif (
            outlook.may_rise
            and h > _SHORTEST
            and may_dip(slip.closing, _closing_rate(per, contact), h, slip_end.closing)
        ):
            dormand_prince.leave_polynomial(series, x, end, h, contact)
            t = dips_at(series, dormand_prince.DEGREE, 1.0)
            shrink = t if t != NEVER else STANDS
    return Moment(end, slip_end, per_end), error, shrink


@inline
def _bound_step(h, start, s, mode, cloth, outlook, limits, contact):
    """The next Runge-Kutta step, with slip s at A, within stability and the rest of the impact."""
    x, slip, per = start
    if mode == SLIP:
        h = min(h, outlook.h_slip, _estimate_rest(x, outlook) / s)
    elif x.p < outlook.p_full:
        h = min(h, _PAST_END * (outlook.p_full - x.p))
    if outlook.may_grip and cloth == SLIDES:
        size = hypot(slip.b1, slip.b2)
        db1, db2 = (
            contact.c1 * per.F1 + K_CLOTH * per.G1,
            contact.d_b * per.p + contact.c2 * per.F2 + K_CLOTH * per.G2,
        )
        along = (slip.b1 * db1 + slip.b2 * db2) / (size + _TINY)
        if along < 0.0 and size < _SMALL * max(limits.tol, limits.delta):
            # a longer step is unstable or passes over the slip's end, an error too small to be noticed
            h = min(h, _REACH * size / max(_STABLE * K_CLOTH * hypot(per.G1, per.G2), -along))
    return h


@kernel
def solve(problem, accuracy, series):
    """Integrate one impact, its closing speed 1: the impulses at its end, and OK or TOO_MANY_STEPS."""
    order = accuracy.order
    outlook = outlook_of(problem)
    slip = problem.start
    s = sqrt(slip.a1 * slip.a1 + slip.a2 * slip.a2)
    least = _ROUNDING * (s + abs(slip.b1) + abs(slip.b2))
    tol, delta = max(accuracy.tol, least), max(accuracy.delta, least)
    limits = Tolerances(tol, delta, _NEAR * delta, accuracy.creep)
    mode, cloth, per, h = _first_state(s, outlook, limits, problem)
    now, target, located = Moment(NO_IMPULSE, slip, per), Target(True, 0.0, 0.0), False
    for n in range(_MAX_STEPS):
        # Advance: one step from now, unless it must be shorter.
        by_series = outlook.analytic and mode == SLIP
        if by_series:
            starts = cloth == STARTS
            x, slip, degree, span = _series_step(
                series, now.x, now.slip, starts, outlook, problem, limits.tol, order
            )
            end, error = Moment(x, slip, now.per), limits.tol
        else:
            degree, span = dormand_prince.DEGREE, 1.0
            end, error, shrink = _runge_kutta_step(series, now, h, mode, cloth, outlook, limits, problem)
            x, slip = end.x, end.slip
            if shrink != STANDS:
                h *= shrink
                continue

        # Classify: what do the contacts do from here on?
        step = Step(now, h, end)
        next_cloth, shrink = cloth_after(step, mode, cloth, outlook.may_grip, limits, problem)
        if shrink != STANDS:
            h *= shrink
            continue
        s = sqrt(slip.a1 * slip.a1 + slip.a2 * slip.a2)
        next_mode, shrink, located = mode_after(series, step, s, mode, cloth, located, limits, problem)
        if shrink != STANDS:
            h *= shrink
            continue
        # friction almost balances the driving force of a slip, which stays small and stiff: use its limit
        if n >= _KNIFE_EDGE:
            near, creep = max(limits.near, _STIFF), max(limits.creep, _STIFF_CREEP * _STIFF)
            limits = Tolerances(limits.tol, limits.delta, near, creep)
        if n >= _JAMMED and abs(slip.closing) < _STOPPED:
            # friction balances the elastic force almost exactly: the slow motion across the nose has no end
            return x, OK

        # Locate: does compression or the impact end inside this step?
        if ends_inside(x, slip.closing, target):
            if not by_series:
                dormand_prince.leave_polynomial(series, now.x, x, h, problem.contact)
            over, first, t, ends_at = locate_end(
                series, degree, span, x, slip.closing, target, problem.e, limits.tol
            )
            last = 4 * ROW  # the polynomial's last terms: in a smooth step they are far smaller
            bent = abs(series[last + WORK_DONE]) + abs(series[last + CLOSING])
            if not by_series and bent > _BENT * limits.tol and h > _SHORTEST:
                part = split_at(first, t)
                if part != WHOLE:
                    h *= part
                    continue
            target = ends_at
            if over:
                return state_at(series, degree, t), OK

        # Go on: the next states, rates and step.
        if not by_series:
            h *= (
                _MOST_FACTOR
                if error < _EXACT * tol
                else min(_MOST_FACTOR, _SAFETY * (tol / error) ** _ERROR_POWER)
            )
        now, located = end, False
        if next_mode != mode or (next_cloth != cloth and (next_cloth == GRIPS or cloth == GRIPS)):
            mode, cloth = next_mode, next_cloth
            if mode == STICK and cloth == GRIPS and problem.contact.k1 == K_CLOTH:  # one ball, at a nose
                if is_wedge(problem):
                    return stop_wedge(x, slip, problem.contact), OK
                cloth = STARTS
                mode = _stick_or_creep(x, limits.near, cloth, problem)
            now = Moment(x, slip, rates(x, mode, limits.near, cloth, problem))
            h = (
                outlook.p_full
                if mode == STICK
                else limits.creep
                if mode == CREEP
                else _FIRST * outlook.h_slip
            )
        else:
            cloth = next_cloth
        h = _bound_step(h, now, s, mode, cloth, outlook, limits, problem.contact)
    return now.x, TOO_MANY_STEPS
