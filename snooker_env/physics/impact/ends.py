"""When does an impact end? In the last step, after closing speed zero, where the work falls to its target.

A step is a polynomial (``polynomial.py``) in its time, 0 to ``span``. Compression ends at closing speed 0
with work W_c, the impact at W = (1 - e^2) W_c: energetic restitution [Stronge 1990; MJP14 eq. 10].
"""

from math import sqrt
from typing import NamedTuple

from ..._lib.jit import inline, kernel
from . import dormand_prince
from .coulomb import can_hold
from .inertia import slips_after
from .polynomial import CLOSING, ROW, WORK_DONE, state_at, time_of, value_at
from .taylor import turns_back

_CLOSE = 0.01
"""Exactness of the ends over tol and the step. Doubled or halved: no change above rounding, as Halley's next
step is more exact than either."""
_NEAR_AN_END = 0.02
"""So near the ends of a step, as part of it, its polynomial errs by a hundredth of what it does in the middle."""
_DIP_HALVINGS = 20
"""A minimum is flat: a millionth of a step beside it the speed errs by a millionth squared."""
NEVER = -1.0
"""No time."""
WHOLE = 1.0
"""The step is not split."""
_TURN_HALVINGS, _LOOSE_HALVINGS = 50, 40
"""Bisections to rounding; and to 1e-12 of a step, where a beginning slip is still zero. Doubled or halved: no
change above 1e-15 in impacts of play."""


class Target(NamedTuple):
    """The work at which the impact ends; ``top`` and ``work`` are known once ``compressing`` is False."""

    compressing: bool
    top: float
    """Work at the end of compression, the maximum."""
    work: float
    """Work at the end of the impact."""


@kernel
def _end_of_compression(series, degree, span, closing, near):
    """The time at which the closing speed falls to zero, in a step that ends with ``closing`` <= 0."""
    first, slope = series[CLOSING], series[ROW + CLOSING]
    bend = (closing - first - slope * span) / (span * span)
    root = slope * slope - 4.0 * bend * first
    guess = 2.0 * first / (sqrt(root) - slope) if root > 0.0 and slope < 0.0 else 0.5 * span
    return time_of(series, degree, CLOSING, 0.0, 0.0, span, guess, near)


@kernel
def _end_of_restitution(series, degree, low, span, work, target, near):
    """The time at which the work falls to its target: above at ``low``, not at ``span``, with ``work``."""
    # the root of the work returned grows almost linearly
    now = sqrt(max(target.top - value_at(series, degree, WORK_DONE, low)[0], 0.0))
    guess = low + (span - low) * (sqrt(target.top - target.work) - now) / (sqrt(target.top - work) - now)
    return time_of(series, degree, WORK_DONE, target.work, low, span, guess, near)


@kernel
def ends_inside(end, closing, target):
    """Whether compression or the impact ends in the step that ends at ``end`` with speed ``closing``."""
    return closing <= 0.0 if target.compressing else target.work >= end.W


@inline
def may_dip(before, rate, span, after):
    """Whether the closing speed, from ``before`` at this rate to ``after``, may have a minimum inside the step:
    a parabola's, or one as flat."""
    return rate < 0.0 and after > 0.0 and after > before + 0.5 * rate * span


@kernel
def dips_at(series, degree, span):
    """When the closing speed is at its minimum below zero inside a step whose ends are above; ``NEVER``: it is not.

    Friction can speed a ball up across the nose and then into it, so that an impact all but ends and goes on.
    """
    low, high = 0.0, span
    for _ in range(_DIP_HALVINGS):
        t = 0.5 * (low + high)
        low, high = (t, high) if value_at(series, degree, CLOSING, t)[1] < 0.0 else (low, t)
    # at the step's end it is none of its inside: rounding, where the closing speed all but vanishes
    return high if high < span and value_at(series, degree, CLOSING, high)[0] < 0.0 else NEVER


@kernel
def locate_end(series, degree, span, end, closing, target, e, tol):
    """For such a step: whether the impact ends, when compression or (if that is over) the impact ends, when the
    last of the two does, and the new target."""
    over, t, near = False, 0.0, _CLOSE * tol * span
    if target.compressing:
        # the work is stationary there: it errs by the time's error squared, _CLOSE tol; the speed by that / e
        t = _end_of_compression(series, degree, span, closing, near if e < _CLOSE else sqrt(near * span))
        top = value_at(series, degree, WORK_DONE, t)[0]
        target = Target(False, top, (1.0 - e * e) * top)
    first = t
    if target.work >= end.W:
        over = True
        if e > 0.0:
            t = _end_of_restitution(series, degree, t, span, end.W, target, near)
        first = first if first > 0.0 else t
    return over, first, t, target


@kernel
def split_at(first, last):
    """The fraction of a Runge-Kutta step up to which it is taken again, so that it ends where compression or the
    impact does: its polynomial, of a lower order, is exact at its ends only. ``WHOLE``: it is near enough."""
    if _NEAR_AN_END < first < 1.0 - _NEAR_AN_END:
        return first
    if _NEAR_AN_END < last < 1.0 - _NEAR_AN_END:
        return last
    return WHOLE


@kernel
def turns_at(series, degree, span, o1, o2, problem):
    """When the cloth's slip, less (o1, o2), is normal to its first direction, in a step that reverses it."""
    low, high = 0.0, span
    for _ in range(_TURN_HALVINGS):
        t = 0.5 * (low + high)
        slip = slips_after(state_at(series, degree, t), problem.start, problem.contact)
        low, high = (low, t) if turns_back(series, slip.b1 - o1, slip.b2 - o2) else (t, high)
    return high


@kernel
def breaks_loose_at(series, near, cloth, problem):
    """The fraction of a Runge-Kutta step after which friction no longer holds A's slip at zero."""
    low, high = 0.0, 1.0
    for _ in range(_LOOSE_HALVINGS):
        t = 0.5 * (low + high)
        if can_hold(state_at(series, dormand_prince.DEGREE, t), near, cloth, problem):
            low = t
        else:
            high = t
    return high
