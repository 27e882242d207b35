"""How is the table after the referee has finished? Judge, spot, test for a snooker, judge again: one kernel.

The verdict on a stroke can depend on the table after it (a free ball, a snooker laid behind the free ball),
and that table on the verdict (which colours return, what is on next). ``settle`` does both steps; a simulator
calls nothing else after its shot.
"""

import numpy as np

from .._check import array, refuse
from .._jit import entry, kernel
from .._types import Bools, Flags, Floats, Vectors
from ..geometry import BALL_RADIUS
from .balls import N_BALLS, balls_on_kernel, bits, check_table, mask_of
from .referee import Situation, Stroke, Verdict, check, numbers_of, verdict_of
from .ruling import AUTO, FLAG, OUTCOME, Before, Facts, ruling
from .snookered import NO_JAWS, snookered
from .spotting import spot


@kernel
def _put_in_order(positions, on_table, result, gone, radius):
    """Apply a ``Ruling`` in place: balls in the mask ``gone`` leave, colours return, the cue ball comes in
    hand."""
    for i in range(N_BALLS):
        if (gone >> i) & 1:
            on_table[i] = False
    if result.in_hand:
        on_table[0] = False
    spot(positions, on_table, result.respotted, radius)


@kernel
def settle_visit(positions, on_table, ball_on, lead, seen, radius):
    """``settle`` for a single visit: nobody plays on after a foul, so there is no test for a snooker and no
    free ball.

    ``seen``: (first, touching, moved, potted) of ``Facts``; no ball is off the table, nothing is nominated.
    """
    first, touching, moved, potted = seen
    facts = Facts(first, touching, moved, potted, 0, AUTO)
    result = ruling(Before(bits(on_table), ball_on, 0, lead), facts, 0)
    _put_in_order(positions, on_table, result, potted, radius)
    return result


@kernel
def settle(positions, on_table, situation, facts, flags, jaws, radius):
    """Judge a stroke and set up the table for the next one. Returns a ``Ruling``, complete with free ball and
    snooker behind it.

    ``positions`` (22, 2) [m]: where the balls came to rest. ``on_table`` (22,) bool: *before* the stroke.
    Both are changed in place: balls potted or off leave, colours are spotted, and on_table[0] is False if the
    cue ball is in hand. When the frame is over, the potted balls leave and the others stay. ``situation``:
    (ball_on, free_ball, lead) of ``Before``; ``facts``: ``Facts``. Of ``flags``, this function sets SNOOKERED
    and BEHIND_FREE_BALL itself. ``jaws`` (m, 3): see ``snookered.NO_JAWS``.
    """
    flags = flags & ~(FLAG.SNOOKERED | FLAG.BEHIND_FREE_BALL)
    ball_on, free_ball, lead = situation
    before = Before(bits(on_table), ball_on, free_ball, lead)
    result = ruling(before, facts, flags)
    _put_in_order(positions, on_table, result, facts.potted | facts.off, radius)
    # A snooker matters after a foul (free ball), and after a free ball that was not potted (no snooker may be
    # behind that ball); in six-red snooker after any nominated ball that was not potted; in the Shoot Out
    # never.
    nominating = free_ball or (flags & FLAG.SIX_RED and ball_on == 0)
    matters = (result.fouls and not flags & FLAG.SHOOT_OUT) or (
        nominating and result.nominated and not result.points
    )
    if result.outcome == OUTCOME.PLAYING and matters:
        hidden, effective = snookered(
            positions, on_table, balls_on_kernel(result.ball_on, result.on_table), jaws, radius
        )
        if hidden:
            flags |= FLAG.SNOOKERED
            if (effective >> result.nominated) & 1 and not result.fouls:
                flags |= FLAG.BEHIND_FREE_BALL
            result = ruling(before, facts, flags)
    return result


@entry(what="the referee of frames", seconds=2)
def settle_one(positions, on_table, before, facts, flags, jaws, radius):
    """``settle`` for Python."""
    situation = before.ball_on, before.free_ball, before.lead
    return settle(positions, on_table, situation, facts, flags, jaws, radius)


def settle_table(
    positions: Vectors,
    on_table: Flags,
    situation: Situation,
    stroke: Stroke,
    *,
    jaws: Vectors = NO_JAWS,
    radius: float = BALL_RADIUS,
) -> tuple[Verdict, Floats, Bools]:
    """Judge a ``Stroke`` and set up the table: the ``Verdict`` and new ``positions`` (22, 2) [m] and
    ``on_table`` (22,) bool.

    ``positions`` are those after the stroke. ``on_table`` is that before it, and must agree with
    ``situation.on_table``. The fields ``snookered`` and ``behind_free_ball`` of the stroke are ignored and
    computed here. Raises ``ValueError`` for wrong input.
    """
    placed, present = check_table(positions, on_table)
    if (mask_of(np.flatnonzero(present)) ^ situation.on_table) & ~1:
        raise refuse("situation.on_table", situation.on_table, "must be the mask of the array on_table")
    check(situation, stroke)
    arcs = array("jaws", jaws, (-1, 3))
    result = settle_one(placed, present, *numbers_of(situation, stroke), arcs, float(radius))
    return verdict_of(result), placed, present
