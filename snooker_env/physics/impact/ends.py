"""When does an impact end? After the closing speed has fallen to zero and the work has then fallen to its
target, inside the last step.

The step is a polynomial (``polynomial.py``) of its own time, from 0 to ``span``. Compression ends at closing
speed 0, with work W_c; the impact ends at W = (1 - e^2) W_c: energetic restitution [Stronge 1990; MJP14 eq.
10].
"""

from math import sqrt
from typing import NamedTuple

from ..._jit import kernel
from . import dormand_prince
from .coulomb import held
from .inertia import slips_after
from .polynomial import CLOSING, ROW, WORK_DONE, state_at, time_of, value_at
from .taylor import turned

_CLOSE = 0.01
"""How exactly the ends are located, over tol and the step's length. Doubled or halved: no change above
rounding, because one more step of Halley's method is more exact than either."""
_TURN_HALVINGS, _LOOSE_HALVINGS = 50, 40
"""Bisections down to rounding; and to 1e-12 of a step, where a slip that begins is still zero. Doubled or
halved: no change above 1e-15 in impacts of play."""


class Target(NamedTuple):
    """The work at which the impact ends. ``top`` and ``work`` are known once compression has ended and
    ``compressing`` is False."""

    compressing: bool
    top: float
    """Work at the end of compression, the maximum."""
    work: float
    """Work at the end of the impact."""


@kernel
def _end_of_compression(series, degree, span, closing, near):
    """The time at which the closing speed falls to zero, in a step that ends with closing speed ``closing``
    <= 0."""
    first, slope = series[CLOSING], series[ROW + CLOSING]
    bend = (closing - first - slope * span) / (span * span)
    root = slope * slope - 4.0 * bend * first
    guess = 2.0 * first / (sqrt(root) - slope) if root > 0.0 and slope < 0.0 else 0.5 * span
    return time_of(series, degree, CLOSING, 0.0, 0.0, span, guess, near)


@kernel
def _end_of_restitution(series, degree, low, span, work, target, near):
    """The time at which the work falls to its target: at ``low`` it is above, at ``span``, where it is
    ``work``, it is not."""
    # the root of the work returned grows almost linearly
    now = sqrt(max(target.top - value_at(series, degree, WORK_DONE, low)[0], 0.0))
    guess = low + (span - low) * (sqrt(target.top - target.work) - now) / (sqrt(target.top - work) - now)
    return time_of(series, degree, WORK_DONE, target.work, low, span, guess, near)


@kernel
def ends_inside(end, closing, target):
    """Whether compression or the impact ends inside the step that ends at the state ``end`` with closing
    speed ``closing``."""
    return closing <= 0.0 if target.compressing else target.work >= end.W


@kernel
def locate_end(series, degree, span, end, closing, target, e, tol):
    """For such a step: whether the impact ends in it, the time of that (or of the end of compression), and
    the target from now on."""
    over, t, near = False, 0.0, _CLOSE * tol * span
    if target.compressing:
        # The work is stationary there: its error is that of the time squared, about _CLOSE tol. The speed
        # after the impact then errs by that over e.
        t = _end_of_compression(series, degree, span, closing, near if e < _CLOSE else sqrt(near * span))
        top = value_at(series, degree, WORK_DONE, t)[0]
        target = Target(False, top, (1.0 - e * e) * top)
    if target.work >= end.W:
        over = True
        if e > 0.0:
            t = _end_of_restitution(series, degree, t, span, end.W, target, near)
    return over, t, target


@kernel
def turns_at(series, degree, span, o1, o2, problem):
    """Time at which the cloth's slip, less (o1, o2), is at right angles to its first direction, in a step
    that ends with it reversed."""
    low, high = 0.0, span
    for _ in range(_TURN_HALVINGS):
        t = 0.5 * (low + high)
        slip = slips_after(state_at(series, degree, t), problem.start, problem.contact)
        low, high = (low, t) if turned(series, slip.b1 - o1, slip.b2 - o2) else (t, high)
    return high


@kernel
def breaks_loose_at(series, near, cloth, problem):
    """The fraction of a Runge-Kutta step after which friction no longer holds the slip at A at zero."""
    low, high = 0.0, 1.0
    for _ in range(_LOOSE_HALVINGS):
        t = 0.5 * (low + high)
        if held(state_at(series, dormand_prince.DEGREE, t), near, cloth, problem):
            low = t
        else:
            high = t
    return high
