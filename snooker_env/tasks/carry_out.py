"""How are players' strokes carried out in frames? What is said with each, its place, the strike."""

from typing import TYPE_CHECKING

import numpy as np

from .._lib.jit import entry
from .._lib.types import Floats, Ints
from ..game import frame_columns as columns
from ..game.balls import YELLOW
from ..game.fouls import AUTO
from ..physics.cue import squirt
from . import declarations
from .box_actions import tip_on_disc
from .declarations import decision_of, declaration_of, nomination_of
from .frame_kernels import say
from .kernel_arrays import C_END_MASS, C_MAX_OFFSET, StruckArrays, TableArrays
from .options import Rules
from .rewards import MATCH_REWARDS
from .stroke import ShotBuffers, place, row_of, strike

if TYPE_CHECKING:
    from .frames import Asked, Frames


@entry(what="the strokes of players in frames", seconds=3)
def _carry_out(which, asked, tables, saved, packed, codes, shots, playing):
    """Strokes ``asked`` (``frames.Asked``) of the tables ``which``: shots 0 to m - 1, on the tables ``playing[:m]``; returns m.
    ``codes``: rule set, reward."""
    values, places, nominate, decisions, declared = asked
    tables, saved, shots = TableArrays(*tables), columns.Layouts(*saved), StruckArrays(*shots)
    (cues, noise), (rules, reward), m = packed, codes, 0
    for k in which:
        row, p, on = tables.game[k], tables.positions[k], tables.on_table[k]
        cue_row = cues[row_of(k, cues)]
        says = declared[k] if declarations.may_declare(declared[k], row) else declarations.SAYS_NOTHING
        if not say(k, says, columns.allowed_choice(row, decisions[k], rules), reward, tables, saved):
            continue
        colour = max(0, nominate[k] - YELLOW + 1)
        tables.nominated[k] = AUTO if nominate[k] < 0 else declarations.nominated_ball(colour, row)
        if row[columns.IN_HAND] and not np.isnan(places[k, 0]):
            place(p, on, places[k, 0], places[k, 1], row[columns.ANYWHERE] != 0)
        speed, aim, elevation = values[k, 0], values[k, 3], values[k, 4]
        side, top = tip_on_disc(values[k, 1], values[k, 2], cue_row[C_MAX_OFFSET])
        intended = (speed, side, top, aim - squirt(side, cue_row[C_END_MASS]), elevation)
        strike(intended, p, on, tables.streams[k], cue_row, noise, m, shots)
        playing[m] = k
        m += 1
    return m


def carry_out(frames: "Frames", which: Ints, asked: "Asked", buffers: ShotBuffers, side: int) -> Ints:
    """Carry the strokes ``asked`` out up to the strike, with the errors of the seat ``side``; returns the tables with a stroke."""
    codes = frames.rules.rule_set.code, MATCH_REWARDS.index(frames.rules.reward)
    playing, tables = np.empty(len(which), np.int64), (frames.arrays, frames.saved_arrays)
    m = _carry_out(which, asked, *tables, frames.pack(side)[1:3], codes, buffers.struck, playing)
    frames.hold_late(playing[:m], buffers)
    return playing[:m]


@entry(what="what actions say", seconds=1)
def _read_sayings(actions, options, game, rules, nominated, decisions, declared):
    """What the strikers of n frames say with their actions: nominations, decisions and declarations (n,)."""
    for k in range(len(game)):
        row, a = game[k], actions[k]
        declared[k] = declaration_of(a, options, row)
        decisions[k] = decision_of(a, options, row, rules)
        nominated[k] = nomination_of(a, options, row)


def sayings(rules: Rules, actions: Floats, game: Ints) -> tuple[Ints, Ints, Ints]:
    """Nominations, decisions and declarations (n,), as in ``players.Strokes``, of checked actions (n, k)."""
    nominated, decisions, declared = np.empty((3, len(game)), np.int64)
    _read_sayings(actions, rules.actions.pack(), game, rules.rule_set.code, nominated, decisions, declared)
    return nominated, decisions, declared
