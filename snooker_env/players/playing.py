"""How does a player play on tables? Its strokes as actions, with a seed for each decision."""

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
    """Return a seed for each table and decision, the same whichever tables are asked beside it.

    Parameters
    ----------
    seed, tables, decision
        The player's, an int; a number for each table, int (n,), such as the seed that it was dealt from; the
        number of the decision, of all tables or of each.

    Returns
    -------
    numpy.ndarray
        int64 (n,), in [0, 2**32).

    Examples
    --------
    >>> from snooker_env.players import decision_seeds
    >>> bool(decision_seeds(0, [5, 6], 3)[1] == decision_seeds(0, [6], 3)[0])
    True
    """
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
    """Ask a bound player on tables.

    Parameters
    ----------
    player, tables
        The player, bound, and n tables, made with ``VISITS`` or ``FRAMES``.
    going, seeds : numpy.ndarray
        The tables on which it is asked, bool (n,), and the seeds of these decisions, int64 (n,).

    Returns
    -------
    numpy.ndarray
        float64 (n, k). Actions; 0 on the other tables.

    Examples
    --------
    >>> import numpy as np
    >>> import snooker_env as sn
    >>> from snooker_env.players import VISITS, decided
    >>> tables = sn.SnookerVectorEnv(2, **VISITS)
    >>> _ = tables.reset(seed=0)
    >>> decided(sn.player("ghost_ball").at(tables), tables, np.array([True, False]), np.array([1, 2])).shape
    (2, 7)
    """
    rows = np.flatnonzero(going)
    actions = np.zeros((len(going), tables.options.rules.actions.size))
    if len(rows):
        at = Positions.of(tables)[rows]
        actions[rows] = player.play(at, seeds[rows]).actions(tables.options, at)
    return actions
