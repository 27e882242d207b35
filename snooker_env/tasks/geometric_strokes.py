"""What does the geometric player do in many positions? The strokes of ``ghost_ball``, and its places for a cue ball in hand."""

import numpy as np

from .._jit import entry
from ..game.balls import bits
from ..game.frame_columns import (
    ANYWHERE,
    CHOICE,
    IN_HAND,
    PHASE,
    PLACE_ANYWHERE,
    PLAY,
    SAVED,
    may_place_anywhere,
    strikeable,
)
from ..game.philox import pair
from ..game.pots import POT_COLUMNS
from ..game.rule_sets import SHOOT_OUT
from ..game.ruling import AUTO
from .ghost_ball import DRIVE, named, put, stroke_at
from .lines import LINE_ROWS, racked


@entry(what="the places of a cue ball in hand", seconds=2)
def put_in_hand(positions, on_table, game, streams, within_d):
    """Place the cue balls in hand of n positions, in place; without ``within_d``, only those that may stand anywhere."""
    lines = np.empty((LINE_ROWS, POT_COLUMNS))
    for k in range(len(game)):
        row = game[k]
        anywhere = row.shape[0] > ANYWHERE and row[ANYWHERE] != 0
        if row[IN_HAND] and (within_d or anywhere):
            put(
                positions[k],
                on_table[k],
                strikeable(row, bits(on_table[k]) & ~1),
                anywhere,
                lines,
                streams[k],
            )


@entry(what="the geometric player", seconds=3)
def geometric_strokes(positions, on_table, game, rules, streams, strokes, nominated, decisions):
    """The strokes (n, 5) of the geometric player, what it nominates and decides (n,); cue balls in hand are placed.

    ``rules``: the code of the rule set. ``game``: of visits or of frames; the copies given are changed.
    """
    lines, drive = np.empty((LINE_ROWS, POT_COLUMNS)), DRIVE if rules == SHOOT_OUT else 0.0
    for k in range(len(game)):
        p, on, row, stream = positions[k], on_table[k], game[k], streams[k]
        nominated[k], decisions[k] = AUTO, PLAY
        frame = row.shape[0] > ANYWHERE
        if frame and row[PHASE] == CHOICE and may_place_anywhere(row, rules):
            decisions[k], row[IN_HAND], row[ANYWHERE] = PLACE_ANYWHERE, 1, 1
        mask = strikeable(row, bits(on) & ~1)
        if row[IN_HAND]:
            put(p, on, mask, frame and row[ANYWHERE] != 0, lines, stream)
        jitter, _ = pair(stream)
        failed = frame and row[SAVED] != 0  # it plays from a position that has been restored
        speed, side, top, aim = stroke_at(p, on, mask, row[IN_HAND], failed, drive, lines, stream)
        if frame:
            nominated[k] = named(p, on, row, aim)
        speed *= 1.0 + (0.04 if row[IN_HAND] and racked(p, on) else 0.2) * (jitter - 0.5)
        strokes[k, 0], strokes[k, 1], strokes[k, 2], strokes[k, 3], strokes[k, 4] = speed, side, top, aim, 0.0
