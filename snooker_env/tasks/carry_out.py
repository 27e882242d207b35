"""How are players' strokes carried out in frames? What is said with each, its place, the strike."""

from typing import Any

import numpy as np

from .._jit import entry
from .._types import Ints
from ..game.balls import YELLOW
from ..game.frame_columns import (
    ANYWHERE,
    CHOICE,
    IN_HAND,
    LOT,
    PHASE,
    PLAY,
    PLAY_AGAIN,
    STRIKER,
    Layouts,
    claim,
    concede,
    draw,
)
from ..game.ruling import AUTO
from ..physics.cue import squirt
from .arrays import StruckArrays, TableArrays
from .box_actions import tip_on_disc
from .declarations import (
    A_END_MASS,
    A_MAX_OFFSET,
    CLAIMS,
    CONCEDES,
    OTHER_BEGINS,
    SAYS_NOTHING,
    may_declare,
    nominated_ball,
)
from .frame import Frames
from .frame_kernels import choose_as, give_up
from .rewards import MATCH_REWARDS
from .stroke import ShotBuffers, place, place_anywhere, strike


@entry(what="the strokes of players in frames", seconds=3)
def _carry_out(which, asked, tables, saved, packed, codes, shots, playing):
    """Strokes of the tables ``which``: shots 0 to m - 1, on the tables ``playing[:m]``; returns m. ``asked``:
    values, place, nominate, decision, declare of ``players.Strokes``; ``codes``: rule set, reward."""
    values, places, nominate, decisions, declared = asked
    tables, saved, shots = TableArrays(*tables), Layouts(*saved), StruckArrays(*shots)
    (options, noise), (rules, reward), m = packed, codes, 0
    for k in which:
        row, p, on = tables.game[k], tables.positions[k], tables.on_table[k]
        says = declared[k] if may_declare(declared[k], row) else SAYS_NOTHING
        if says == CONCEDES:
            concede(row)
            give_up(row, reward)
            continue
        if says == CLAIMS:
            claim(row)
            continue
        if row[PHASE] == LOT:
            draw(row, 1 - row[STRIKER] if says == OTHER_BEGINS else row[STRIKER])
            if says == OTHER_BEGINS:
                continue
        elif row[PHASE] == CHOICE:
            wish = 0.0 if decisions[k] == PLAY else -1.0 if decisions[k] == PLAY_AGAIN else 1.0
            if not choose_as(k, wish, rules, tables, saved):
                continue
        tables.nominated[k] = (
            AUTO if nominate[k] < 0 else nominated_ball(max(0, nominate[k] - YELLOW + 1), row)
        )
        if row[IN_HAND] and not np.isnan(places[k, 0]):
            if row[ANYWHERE]:
                place_anywhere(p, on, places[k, 0], places[k, 1])
            else:
                place(p, on, places[k, 0], places[k, 1])
        speed, aim, elevation = values[k, 0], values[k, 3], values[k, 4]
        side, top = tip_on_disc(values[k, 1], values[k, 2], options[A_MAX_OFFSET])
        intended = (speed, side, top, aim - squirt(side, options[A_END_MASS]), elevation)
        strike(intended, p, on, tables.streams[k], options, noise, m, shots)
        playing[m] = k
        m += 1
    return m


def carry_out(frames: Frames, which: Ints, asked: tuple[Any, ...], buffers: ShotBuffers, side: int) -> Ints:
    """Carry out the strokes ``asked``, arrays of ``players.Strokes``, up to the strike, with the errors of the
    seat ``side``; returns the tables with a stroke."""
    playing = np.empty(len(which), np.int64)
    codes = (frames.rules.rule_set.code, MATCH_REWARDS.index(frames.rules.reward))
    m = _carry_out(
        which,
        asked,
        frames.arrays,
        frames.saved_arrays,
        frames.packs[side][:2],
        codes,
        buffers.struck,
        playing,
    )
    frames.hold_late(playing[:m], buffers)
    return playing[:m]
