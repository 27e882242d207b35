"""How is the table after the referee has finished? Judge, spot, test for a snooker, judge again: one kernel,
as the verdict can depend on the table after the stroke, and that table on the verdict."""

import numpy as np

from .._lib.check import array, refuse
from .._lib.jit import entry, kernel
from .._lib.types import Bools, Flags, Floats, Vectors
from ..geometry import BALL_RADIUS
from .balls import N_BALLS, balls_on_kernel, bits, check_table, mask_of
from .fouls import AUTO, FLAG, OUTCOME, Before, Facts, ruling
from .referee import Situation, Stroke, Verdict, check, numbers_of, verdict_of
from .snookered import NO_JAWS, find_snooker
from .spotting import spot


@kernel
def _put_in_order(positions, on_table, result, gone, radius):
    """Apply a ``Ruling`` in place: balls in the mask ``gone`` leave, colours return, cue ball in hand."""
    for i in range(N_BALLS):
        if (gone >> i) & 1:
            on_table[i] = False
    if result.in_hand:
        on_table[0] = False
    spot(positions, on_table, result.respotted, radius)


@kernel
def settle_visit(positions, on_table, ball_on, lead, seen, flags, radius):
    """``settle`` for a visit, where no free ball follows a foul; seen: (first, touching, moved, potted, off)."""
    first, touching, moved, potted, off = seen
    facts = Facts(first, touching, moved, potted, off, AUTO)
    result = ruling(Before(bits(on_table), ball_on, 0, lead), facts, flags)
    _put_in_order(positions, on_table, result, potted | off, radius)
    return result


@kernel
def settle(positions, on_table, situation, facts, flags, jaws, radius):
    """Judge a stroke and set up the table for the next one: a ``Ruling`` with free ball and snooker behind
    it. ``positions`` after the stroke and ``on_table`` *before* it are changed in place; on_table[0] is False
    if the cue ball is in hand. SNOOKERED and BEHIND_FREE_BALL of ``flags`` are set here."""
    flags = flags & ~(FLAG.SNOOKERED | FLAG.BEHIND_FREE_BALL)
    ball_on, free_ball, lead = situation
    before = Before(bits(on_table), ball_on, free_ball, lead)
    result = ruling(before, facts, flags)
    _put_in_order(positions, on_table, result, facts.potted | facts.off, radius)
    # A snooker matters after a foul (free ball), and behind a free ball that was not potted (six-red snooker:
    # behind any nominated ball); in the Shoot Out never.
    nominating = free_ball or (flags & FLAG.SIX_RED and ball_on == 0)
    matters = (result.fouls and not flags & FLAG.SHOOT_OUT) or (
        nominating and result.nominated and not result.points
    )
    if result.outcome == OUTCOME.PLAYING and matters:
        on = balls_on_kernel(result.ball_on, result.on_table)
        hidden, effective = find_snooker(positions, on_table, on, jaws, radius)
        if hidden:
            flags |= FLAG.SNOOKERED
            if (effective >> result.nominated) & 1 and not result.fouls:
                flags |= FLAG.BEHIND_FREE_BALL
            result = ruling(before, facts, flags)
    return result


@entry(what="the referee of frames", seconds=2)
def settle_one(positions, on_table, before, facts, flags, jaws, radius):
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
    """Judge a ``Stroke`` and set up the table: ``Verdict``, new ``positions`` (22, 2) [m], ``on_table``
    (22,), of those after and before it. ValueError for wrong input."""
    placed, present = check_table(positions, on_table)
    if (mask_of(np.flatnonzero(present)) ^ situation.on_table) & ~1:
        raise refuse("situation.on_table", situation.on_table, "must be the mask of the array on_table")
    check(situation, stroke)
    arcs = array("jaws", jaws, (-1, 3))
    result = settle_one(placed, present, *numbers_of(situation, stroke), arcs, float(radius))
    return verdict_of(result), placed, present
