"""Which strokes does the geometry offer, and what is in the way? Direct pots, balls beside a path, clear paths, of many positions at once.

Straight lines only: no throw, no spin, no cushion. ``pot_aim`` corrects a line for what a ball does.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._check import array, integer
from .._jit import entry, kernel
from ..game.balls import N_BALLS, balls_on_kernel, bits
from ..game.frame_columns import BALL_ON
from ..game.paths import clear_path, full_ball_path
from ..game.pots import COS_CUT, GHOST_X, GHOST_Y, POT_BALL, POT_COLUMNS, POT_POCKET, TOLERANCE, find_pots
from ..game.snookered import segment_distance
from ..geometry import BALL_RADIUS
from ..tasks.discrete_actions import POTS
from .positions import Positions, rows_of


class Pots(NamedTuple):
    """The widest direct pots of m positions, widest first; rows without so many end with -1 and 0.

    Attributes
    ----------
    ball : int64 (m, most)
        The ball to pot, -1 where there is none.
    pocket : int64 (m, most)
        Index of ``snooker_env.POCKETS``, -1 where there is none.
    ghost : float64 (m, most, 2)
        Where the cue ball's centre must meet the ball [m].
    cut : float64 (m, most)
        Angle between the cue ball's path and the object ball's [rad].
    tolerance : float64 (m, most)
        How far the aim may err, about [rad] (``snooker_env.game.pots``).
    """

    ball: NDArray[np.int64]
    pocket: NDArray[np.int64]
    ghost: NDArray[np.float64]
    cut: NDArray[np.float64]
    tolerance: NDArray[np.float64]


class Paths(NamedTuple):
    """Whether the cue ball has a clear straight path in each of m positions.

    Attributes
    ----------
    any_part : bool (m,)
        To some part of a ball on.
    full_ball : bool (m,)
        To the full face of a ball on.
    """

    any_part: NDArray[np.bool_]
    full_ball: NDArray[np.bool_]


@entry(what="the pots of positions", seconds=1)
def _pots(positions, on_table, game, ball, pocket, ghost, cut, tolerance):
    found = np.empty((ball.shape[1], POT_COLUMNS))
    for k in range(len(ball)):
        on = balls_on_kernel(game[k, BALL_ON], bits(on_table[k]))
        for j in range(find_pots(positions[k], on_table[k], on, BALL_RADIUS, found) if on_table[k, 0] else 0):
            ball[k, j], pocket[k, j] = int(found[j, POT_BALL]), int(found[j, POT_POCKET])
            ghost[k, j, 0], ghost[k, j, 1] = found[j, GHOST_X], found[j, GHOST_Y]
            cut[k, j], tolerance[k, j] = np.arccos(min(1.0, found[j, COS_CUT])), found[j, TOLERANCE]


def pots(positions: Any, most: int = POTS) -> Pots:
    """The direct pots of balls on that straight lines offer, no other ball in the way.

    Parameters
    ----------
    positions : whatever ``Positions.of`` takes
    most : int
        How many of each position at most; the default is what ``action="discrete"`` chooses from.

    Returns
    -------
    Pots

    Examples
    --------
    >>> from snooker_env.planning import Position, pots
    >>> found = pots(Position(cue=(0.0, 0.0), black=(0.0, 1.4605)))
    >>> found.ball[0].tolist(), found.pocket[0].tolist(), found.tolerance[0, 0].round(5).item()
    ([21, 21, -1, -1], [3, 4, -1, -1], 0.00023)
    """
    at, most = Positions.of(positions), integer("most", most, 1, 6 * (N_BALLS - 1))
    m = len(at)
    out = Pots(np.full((m, most), -1), np.full((m, most), -1), np.zeros((m, most, 2)), np.zeros((m, most)), np.zeros((m, most)))
    _pots(at.positions, at.on_table, at.game, *out)
    return out


@kernel
def _beside(positions, on_table, ax, ay, bx, by, reach, out):
    for i in range(N_BALLS):
        out[i] = on_table[i] and segment_distance(positions[i, 0], positions[i, 1], ax, ay, bx, by) < reach


@entry
def _obstructions(positions, on_table, rows, starts, ends, reach, out):
    for i in range(len(rows)):
        k = rows[i]
        _beside(positions[k], on_table[k], starts[i, 0], starts[i, 1], ends[i, 0], ends[i, 1], reach, out[i])


def obstructions(positions: Any, rows: ArrayLike, starts: ArrayLike, ends: ArrayLike, *, ignore: ArrayLike = ()) -> NDArray[np.bool_]:
    """Which balls are in the way of a ball that runs straight from one place to another: their centres are nearer than 2 R to its path.

    Parameters
    ----------
    positions : whatever ``Positions.of`` takes
    rows : array_like, int (n,)
        On which position each path lies.
    starts, ends : array_like, float (n, 2)
        The path of the ball's centre [m].
    ignore : array_like, int, (j,) or (n, j)
        Balls that do not count: the one that runs, and the one it is sent at.

    Returns
    -------
    bool (n, 22)
        No True in a row: the path is clear.

    Raises
    ------
    ValueError
        If a row is out of range or an array has another shape.

    Examples
    --------
    >>> from snooker_env.planning import Position, obstructions
    >>> position = Position(cue=(0.0, 0.0), reds=[(0.3, 0.01), (0.6, 0.0)])
    >>> obstructions(position, [0], [(0.0, 0.0)], [(0.6, 0.0)], ignore=[0, 2]).nonzero()[1].tolist()
    [1]
    """
    at = Positions.of(positions)
    which = rows_of(at, rows)
    n = len(which)
    a, b = array("starts", starts, (n, 2)), array("ends", ends, (n, 2))
    left_out = np.asarray(ignore, np.int64)
    out = np.empty((n, N_BALLS), np.bool_)
    _obstructions(at.positions, at.on_table, which, a, b, 2.0 * BALL_RADIUS * (1.0 - 1e-9), out)
    if left_out.size:
        each = np.broadcast_to(left_out, (n, left_out.shape[-1]))
        for ball in (each.min(), each.max()):
            integer("ignore", int(ball), 0, N_BALLS - 1)
        out[np.arange(n)[:, None], each] = False
    return out


@entry(what="the clear paths of positions", seconds=2, uses=())
def _clear_paths(positions, on_table, game, any_part, full_ball):
    for k in range(len(any_part)):
        on = balls_on_kernel(game[k, BALL_ON], bits(on_table[k]))
        any_part[k] = on_table[k, 0] and clear_path(positions[k], on_table[k], on, BALL_RADIUS)
        full_ball[k] = on_table[k, 0] and full_ball_path(positions[k], on_table[k], on, BALL_RADIUS)


def clear_paths(positions: Any) -> Paths:
    """Whether the cue ball, rolling straight from where it lies, can reach a ball on before any other.

    Parameters
    ----------
    positions : whatever ``Positions.of`` takes

    Returns
    -------
    Paths
        By the two tests of the miss rule (``snooker_env.game.paths``).

    Examples
    --------
    >>> from snooker_env.planning import Position, clear_paths
    >>> hidden = Position(cue=(0.0, 0.0), reds=[(0.6, 0.0)], black=(0.3, 0.01), on="red")
    >>> bool(clear_paths(hidden).full_ball[0])
    False
    """
    at = Positions.of(positions)
    out = Paths(np.zeros(len(at), np.bool_), np.zeros(len(at), np.bool_))
    _clear_paths(at.positions, at.on_table, at.game, *out)
    return out
