"""What do actions of frames say beside the stroke? Nominations, decisions, declarations, for many frames."""

import numpy as np

from .._jit import entry
from .._types import Floats, Ints
from ..game import frame_columns as columns
from .declarations import A_DECISION, declaration_of, nomination_of
from .options import Rules


@entry(what="what actions say", seconds=1)
def _said(actions, options, game, rules, nominated, decisions, declared):
    """What the strikers of n frames say with their actions: nominations, decisions and declarations (n,)."""
    for k in range(len(game)):
        row, a = game[k], actions[k]
        declared[k] = declaration_of(a, options, row)
        asked = options[A_DECISION] >= 0 and row[columns.PHASE] == columns.CHOICE
        wish = a[int(options[A_DECISION])] if asked else 0.0
        decisions[k] = columns.PLAY_AGAIN if wish < -1.0 / 3.0 else columns.PLAY
        if wish > 1.0 / 3.0 and columns.may_replace(row, rules):
            decisions[k] = columns.REPLACE
        elif wish > 1.0 / 3.0 and columns.may_place_anywhere(row, rules):
            decisions[k] = columns.PLACE_ANYWHERE
        nominated[k] = nomination_of(a, options, row)


def sayings(rules: Rules, actions: Floats, game: Ints) -> tuple[Ints, Ints, Ints]:
    """Nominations, decisions and declarations (n,), as in ``players.Strokes``, of checked actions (n, k)."""
    nominated, decisions, declared = np.empty((3, len(game)), np.int64)
    _said(actions, rules.actions.pack(), game, rules.rule_set.code, nominated, decisions, declared)
    return nominated, decisions, declared
