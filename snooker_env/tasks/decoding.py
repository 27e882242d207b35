"""What does an action mean? The decoder of actions and choices: strokes, places, and what is said with them, for many positions."""

from typing import NamedTuple

import numpy as np

from .._jit import entry
from .._types import Bools, Floats, Ints
from ..game.balls import bits
from ..game.frame_columns import (
    ANYWHERE,
    CHOICE,
    IN_HAND,
    PHASE,
    PLACE_ANYWHERE,
    PLAY,
    PLAY_AGAIN,
    REPLACE,
    may_place_anywhere,
    may_replace,
)
from ..game.pots import POT_COLUMNS
from ..game.ruling import AUTO
from ..physics import cloth
from ..physics.cue import squirt
from ..physics.impact.polynomial import WORK
from . import discrete_actions
from .box_actions import place_anywhere_of, place_of, shot_of
from .declarations import (
    A_DECISION,
    A_DISCRETE,
    A_END_MASS,
    A_PLACEMENT,
    SAYS_NOTHING,
    declaration_of,
    nomination_of,
    playable,
)
from .lines import LINE_ROWS
from .options import Rules
from .stroke import place, place_anywhere


@entry(what="what actions say", seconds=1)
def _said(actions, options, game, rules, nominated, decisions, declared):
    """What the strikers of n frames say with their actions: nominations, decisions and declarations (n,)."""
    for k in range(len(game)):
        row, a = game[k], actions[k]
        declared[k] = declaration_of(a, options, row)
        wish = a[int(options[A_DECISION])] if options[A_DECISION] >= 0 and row[PHASE] == CHOICE else 0.0
        decisions[k] = PLAY_AGAIN if wish < -1.0 / 3.0 else PLAY
        if wish > 1.0 / 3.0 and may_replace(row, rules):
            decisions[k] = REPLACE
        elif wish > 1.0 / 3.0 and may_place_anywhere(row, rules):
            decisions[k] = PLACE_ANYWHERE
        nominated[k] = nomination_of(a, options, row)


@entry(what="the strokes that actions mean", seconds=3, uses=(discrete_actions.chosen, shot_of))
def _intended(actions, positions, on_table, game, nominated, options, phys, fidelity, n_steps, strokes):
    """The strokes (n, 5) of n actions, without errors; cue balls in hand are placed, in place. The aim: where the ball leaves."""
    lines = np.empty((LINE_ROWS, POT_COLUMNS))
    motion, phase, work = np.empty((2, cloth.COLUMNS)), np.empty(2, np.int64), np.empty(WORK)
    for k in range(len(game)):
        a, p, on, row = actions[k], positions[k], on_table[k], game[k]
        if row[IN_HAND] and options[A_PLACEMENT]:
            if row.shape[0] > ANYWHERE and row[ANYWHERE]:
                x, y = place_anywhere_of(a, options)
                place_anywhere(p, on, x, y)
            else:
                x, y = place_of(a, options)
                place(p, on, x, y)
        mask = playable(row, bits(on), nominated[k])
        if options[A_DISCRETE]:
            shot = discrete_actions.chosen(
                int(a[0]),
                p,
                on,
                mask,
                phys,
                options[A_END_MASS],
                fidelity,
                n_steps,
                lines,
                motion,
                phase,
                work,
            )
        else:
            shot = shot_of(a, p, on, mask, options, phys, lines, motion, phase, work)
        strokes[k, 0], strokes[k, 1], strokes[k, 2], strokes[k, 4] = shot[0], shot[1], shot[2], shot[4]
        strokes[k, 3] = shot[3] + squirt(shot[1], options[A_END_MASS])


class Meaning(NamedTuple):
    """What n actions mean, as ``decoded`` returns it."""

    strokes: Floats
    """(n, 5): cue speed [m/s], side, top, direction in which the cue ball leaves [rad], elevation [rad]."""
    place: Floats
    """(n, 2): where a cue ball in hand is placed [m]; NaN where the action holds no place."""
    nominate: Ints
    decision: Ints
    declare: Ints
    """(n,) each: as in ``Strokes``."""


def decoded(rules: Rules, actions: Floats, positions: Floats, on_table: Bools, game: Ints) -> Meaning:
    """What checked actions (n, k) mean in n positions of visits or frames, with the action space of ``rules``."""
    n, packed, (fidelity, n_steps) = len(game), rules.actions.pack(), rules.fidelity
    nominate, decision, declare = (
        np.full(n, AUTO, np.int64),
        np.full(n, PLAY, np.int64),
        np.full(n, SAYS_NOTHING, np.int64),
    )
    if game.shape[1] > ANYWHERE:
        _said(actions, packed, game, rules.rule_set.code, nominate, decision, declare)
    moved, strokes = positions.copy(), np.empty((n, 5))
    _intended(
        actions,
        moved,
        on_table.copy(),
        game,
        nominate,
        packed,
        rules.physics.pack(),
        fidelity,
        n_steps,
        strokes,
    )
    hand = (game[:, IN_HAND] != 0) & bool(rules.actions.placement)
    return Meaning(strokes, np.where(hand[:, None], moved[:, 0], np.nan), nominate, decision, declare)
