"""What do the contacts do after a step? Their next states; or, as the change lies inside it, the factor by
which it is shortened and taken again (else ``STANDS``)."""

from typing import NamedTuple

from ..._lib.jit import inline
from . import dormand_prince
from .coulomb import CREEP, GRIPS, SLIDES, SLIP, STARTS, STICK, can_hold, grip_holds, rates, settles
from .ends import breaks_loose_at
from .inertia import Impulses, Slips

STANDS = 0.0
"""The step is accepted."""
_HALF = 0.5
"""Factor on a step inside which a contact changed state. Doubled: 3 % of the cushion impacts of play fail
(measured as in ``impulse.py``, here and below). Halved: no effect."""
_INTO_CREEP, _OUT_OF_CREEP = 0.5, 2.0
"""Over ``creep``: the slip below which A may begin to creep, and the largest at the end of a step that ends
creeping. The second halved: 30 % more steps in cushion impacts of play. Otherwise no effect."""


class Tolerances(NamedTuple):
    """The tolerances of one impact, in units of the closing speed before it."""

    tol: float
    """The largest error of a step."""
    delta: float
    """A slip at A below this is zero."""
    near: float
    """A cloth slip below this is zero."""
    creep: float
    """Up to this size a slip that begins has the direction of the driving force."""


class Moment(NamedTuple):
    """A moment of an impact: the impulses so far, the slips, and the rates."""

    x: Impulses
    slip: Slips
    per: Impulses


class Step(NamedTuple):
    """A step of length h."""

    start: Moment
    h: float
    end: Moment


@inline
def cloth_after(step, mode, cloth, may_grip, limits, problem):
    """The next state of the cloth contact, and the factor on the step."""
    end, slip, per = step.end
    shrink = STANDS
    after = SLIDES if slip.b1 * slip.b1 + slip.b2 * slip.b2 > limits.near * limits.near else STARTS
    if cloth == GRIPS:
        after = GRIPS
        if not grip_holds(per, end, problem):
            after = STARTS
            if end.p - step.start.x.p > limits.delta:  # it began to slip inside the step: find where
                shrink = _HALF
    elif (
        may_grip
        and after == STARTS
        and grip_holds(rates(end, mode, limits.near, GRIPS, problem), end, problem)
    ):
        after = GRIPS
    return after, shrink


@inline
def mode_after(series, step, s, mode, cloth, located, limits, problem):
    """A's next state, with slip s; the step's factor; and whether it leads to where A begins to slip."""
    after, shrink = mode, STANDS
    start, (end, slip, per_end) = step.start, step.end
    if mode == SLIP:
        if s <= limits.delta:
            after = STICK if can_hold(end, limits.near, cloth, problem) else CREEP
        elif s < _INTO_CREEP * limits.creep and settles(end, slip, s, limits.near, cloth, problem):
            after = CREEP
    elif mode == STICK:
        if not can_hold(end, limits.near, cloth, problem):
            after = CREEP
            # it began to slip inside the step: take the step up to that place
            if step.h > limits.delta and not located:
                dormand_prince.leave_polynomial(series, start.x, end, step.h, problem.contact)
                shrink = breaks_loose_at(series, limits.near, cloth, problem)
                located = True
    elif s > limits.creep:
        after = SLIP
        if s > _OUT_OF_CREEP * limits.creep and step.h > limits.delta:
            shrink = _HALF
    # friction does not oppose the slip
    elif per_end.F1 * slip.a1 + per_end.F2 * slip.a2 > 0.0 and s > limits.delta:
        if step.h > limits.delta and start.per.F1 * start.slip.a1 + start.per.F2 * start.slip.a2 <= 0.0:
            shrink = _HALF  # it did before: the slip ended inside the step
        else:
            after = STICK if can_hold(end, limits.near, cloth, problem) else CREEP
    elif s <= limits.delta and can_hold(end, limits.near, cloth, problem):
        after = STICK
    return after, shrink, located
