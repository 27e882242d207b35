"""How does a player play on tables? Its strokes as actions of an environment that reads strokes, with a seed for each decision."""

from typing import Any

import numpy as np

from .._types import Bools, Floats, Ints
from ..planning import Positions
from .player import Player

VISITS: dict[str, Any] = {"aim": "absolute", "elevation": True, "placement": True}
"""The options with which an environment of visits reads all that a player does."""
FRAMES: dict[str, Any] = VISITS | {"decision": True}
"""Those of frames and matches, where nobody concedes and the colour first struck is the one nominated."""
_ODD = np.uint64(0x9E3779B97F4A7C15)


def decision_seeds(seed: int, tables: Ints, decision: int | Ints) -> Ints:
    """A seed in [0, 2**32) for each table and decision: int64 (n,), the same whichever tables are asked beside it."""
    state = np.uint64(seed & 0xFFFFFFFFFFFFFFFF) + np.zeros(len(tables), np.uint64)
    for part in (np.asarray(tables), np.broadcast_to(np.asarray(decision), len(tables))):
        state = _mixed(state + _ODD * (part.astype(np.uint64) + np.uint64(1)))
    return (state >> np.uint64(32)).astype(np.int64)


def _mixed(x: Any) -> Any:
    """splitmix64 of uint64 numbers (Steele, Lea & Flood 2014)."""
    x = (x ^ (x >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    x = (x ^ (x >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return x ^ (x >> np.uint64(31))


def decided(player: Player, tables: Any, going: Bools, seeds: Ints) -> Floats:
    """The actions of a bound player on the tables ``going`` (n,) of a ``SnookerVectorEnv``; 0 on the others: float64 (n, k).

    ``seeds`` (n,): of the decision on each table.
    """
    rows = np.flatnonzero(going)
    actions = np.zeros((len(going), tables.options.rules.actions.size))
    if len(rows):
        at = Positions.of(tables)[rows]
        actions[rows] = player.play(at, seeds[rows]).actions(tables.options, at)
    return actions
