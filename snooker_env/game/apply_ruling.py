"""What does the table look like after the referee has done everything? Judge, spot, look for snookers, judge again: one kernel.

The verdict on a stroke can depend on the table after it (a free ball, a snooker laid behind the free ball), and that table on the verdict
(which colours return, what is on next). ``settle`` goes round once and is all that a simulator calls after its shot.
"""

import numpy as np

from .._check import array, refuse
from .._jit import entry, kernel
from .._types import Bools, Flags, Floats, Vectors
from ..geometry import BALL_RADIUS
from .balls import N_BALLS, balls_on_kernel, bits, check_table, mask_of
from .referee import Situation, Stroke, Verdict, check, numbers_of, verdict_of
from .ruling import AUTO, FLAG, OUTCOME, ruling
from .snookered import NO_JAWS, snookered
from .spotting import spot


@kernel
def _put_in_order(positions, on_table, result, gone, radius):
    """Balls in the mask ``gone`` leave, colours come back, the cue ball to hand, as the ``Ruling`` says; arrays in place."""
    for i in range(N_BALLS):
        if (gone >> i) & 1:
            on_table[i] = False
    if result.in_hand:
        on_table[0] = False
    spot(positions, on_table, result.respotted, radius)


@kernel
def settle_visit(positions, on_table, ball_on, lead, first, touching, moved, potted, radius):
    """``settle`` for a visit by itself: nobody plays on after a foul, so nobody looks for a snooker and there is no free ball.

    Arrays in place and numbers as in ``settle``; the simulation sees no ball off the table and no flag. Returns a ``Ruling``.
    """
    result = ruling(bits(on_table), ball_on, 0, lead, first, touching, moved, potted, 0, AUTO, 0)
    _put_in_order(positions, on_table, result, potted, radius)
    return result


@kernel
def settle(positions, on_table, ball_on, free_ball, lead, first, touching, moved, potted, off, nominated, flags, jaws, radius):
    """Judge a stroke and put the table in order. Returns a ``Ruling``, complete with free ball and snooker behind it.

    ``positions`` (22, 2) where the balls came to rest and ``on_table`` (22,) bool as it was *before* the stroke; both are changed in
    place: balls potted or off leave, colours are spotted, and on_table[0] is False if the cue ball is in hand. When the frame is over
    the object balls are left as they are, potted ones gone. The integers are those of ``ruling``; ``flags`` without the two that this
    function finds itself. ``jaws`` (m, 3): see ``snookered.NO_JAWS``.
    """
    flags = flags & ~(FLAG.SNOOKERED | FLAG.BEHIND_FREE_BALL)
    before = bits(on_table)
    result = ruling(before, ball_on, free_ball, lead, first, touching, moved, potted, off, nominated, flags)
    _put_in_order(positions, on_table, result, potted | off, radius)
    # A snooker matters after a foul (a free ball) and when a free ball was played without a pot (it must not be behind that ball).
    if result.outcome == OUTCOME.PLAYING and (result.fouls or (free_ball and result.nominated and not result.points)):
        hidden, effective = snookered(positions, on_table, balls_on_kernel(result.ball_on, result.on_table), jaws, radius)
        if hidden:
            flags |= FLAG.SNOOKERED
            if (effective >> result.nominated) & 1 and not result.fouls:
                flags |= FLAG.BEHIND_FREE_BALL
            result = ruling(before, ball_on, free_ball, lead, first, touching, moved, potted, off, nominated, flags)
    return result


@entry(what="the referee of frames", seconds=2)
def settle_one(positions, on_table, ball_on, free_ball, lead, first, touching, moved, potted, off, nominated, flags, jaws, radius):
    """``settle`` for Python."""
    return settle(positions, on_table, ball_on, free_ball, lead, first, touching, moved, potted, off, nominated, flags, jaws, radius)


def settle_table(
    positions: Vectors, on_table: Flags, situation: Situation, stroke: Stroke, *, jaws: Vectors = NO_JAWS, radius: float = BALL_RADIUS
) -> tuple[Verdict, Floats, Bools]:
    """Judge a ``Stroke`` and put the table in order: the ``Verdict`` and new ``positions`` (22, 2) and ``on_table`` (22,) bool.

    ``positions`` are those after the stroke, ``on_table`` that before it, and it must agree with ``situation.on_table``. The fields
    ``snookered`` and ``behind_free_ball`` of the stroke are found here, whatever they say. Raises ``ValueError`` on wrong input.
    """
    placed, present = check_table(positions, on_table)
    if (mask_of(np.flatnonzero(present)) ^ situation.on_table) & ~1:
        raise refuse("situation.on_table", situation.on_table, "must be the mask of the array on_table")
    check(situation, stroke)
    result = settle_one(placed, present, *numbers_of(situation, stroke)[1:], array("jaws", jaws, (-1, 3)), float(radius))
    return verdict_of(result), placed, present
