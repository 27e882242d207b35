"""Which strokes does the geometry offer, and what is in the way? Direct pots, balls beside a path and clear
paths, along straight lines: no throw, no spin, no cushions. ``pot_aim`` corrects the aim for these."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._lib.check import array, integer
from .._lib.jit import entry
from .._lib.types import Integers, Vectors
from ..game.balls import N_BALLS, balls_on_kernel, bits
from ..game.frame_columns import BALL_ON
from ..game.paths import clear_path, full_ball_path
from ..game.pots import COS_CUT, GHOST_X, GHOST_Y, POT_BALL, POT_COLUMNS, POT_POCKET, TOLERANCE, find_pots
from ..game.snookered import segment_distance
from ..geometry import BALL_RADIUS
from ..physics.table import Table
from ..tasks.discrete_actions import POTS
from .positions import Positions, PositionsLike, rows_of


class Pots(NamedTuple):
    """The direct pots of m positions, widest tolerance first, as returned by ``pots``.

    Beyond a position's last pot ``ball`` and ``pocket`` hold -1, the other arrays 0.

    Attributes
    ----------
    ball, pocket : numpy.ndarray
        int64 (m, most). Id of the ball to pot, and index into ``snooker_env.POCKETS``.
    ghost : numpy.ndarray
        float64 (m, most, 2). Centre of the cue ball [m] when it touches the object ball.
    cut, tolerance : numpy.ndarray
        float64 (m, most). Angle between the paths of both balls [rad], 0 for a straight pot; approximate
        largest error of the aim [rad] with which the ball is still potted.

    Examples
    --------
    >>> from snooker_env.planning import Position, pots
    >>> direct = pots(Position(cue=(0.0, 0.0), black=(0.0, 1.4605)), most=1)
    >>> direct.ghost[0, 0].round(4).tolist(), direct.cut[0, 0].round(3).item()
    ([-0.0495, 1.443], 1.265)
    """

    ball: NDArray[np.int64]
    pocket: NDArray[np.int64]
    ghost: NDArray[np.float64]
    cut: NDArray[np.float64]
    tolerance: NDArray[np.float64]


class Paths(NamedTuple):
    """Whether the cue ball has a clear straight path in each of m positions, see ``clear_paths``."""

    any_part: NDArray[np.bool_]
    full_ball: NDArray[np.bool_]


@entry(what="the pots of positions", seconds=1)
def _pots(positions, on_table, game, ball, pocket, ghost, cut, tolerance):
    lines = np.empty((ball.shape[1], POT_COLUMNS))
    for k in range(len(ball)):
        on = balls_on_kernel(game[k, BALL_ON], bits(on_table[k]))
        for j in range(find_pots(positions[k], on_table[k], on, BALL_RADIUS, lines) if on_table[k, 0] else 0):
            ball[k, j], pocket[k, j] = int(lines[j, POT_BALL]), int(lines[j, POT_POCKET])
            ghost[k, j, 0], ghost[k, j, 1] = lines[j, GHOST_X], lines[j, GHOST_Y]
            cut[k, j], tolerance[k, j] = np.arccos(min(1.0, lines[j, COS_CUT])), lines[j, TOLERANCE]


def pots(positions: PositionsLike, most: int = POTS) -> Pots:
    """Find the direct pots of balls on: straight paths to a pocket with no other ball in the way.

    Parameters
    ----------
    positions : PositionsLike
        The m positions: anything that ``Positions.of`` accepts.
    most : int, optional
        Largest number of pots for each position, in [1, 126]; default 4, as ``action="discrete"`` has.

    Returns
    -------
    Pots
        Arrays with shape (m, most), widest tolerance first.

    Examples
    --------
    >>> from snooker_env.planning import Position, pots
    >>> direct = pots(Position(cue=(0.0, 0.0), black=(0.0, 1.4605)))
    >>> direct.ball[0].tolist(), direct.pocket[0].tolist(), direct.tolerance[0, 0].round(5).item()
    ([21, 21, -1, -1], [3, 4, -1, -1], 0.00023)
    """
    at, most = Positions.of(positions).as_visits(), integer("most", most, 1, 6 * (N_BALLS - 1))
    shape = len(at), most
    ids, reals = (np.full(shape, -1), np.full(shape, -1)), (np.zeros(shape), np.zeros(shape))
    out = Pots(*ids, np.zeros((*shape, 2)), *reals)
    _pots(at.positions, at.on_table, at.game, *out)
    return out


@entry
def _obstructions(positions, on_table, rows, starts, ends, reach, out):
    for j in range(len(rows)):
        p, here = positions[rows[j]], on_table[rows[j]]
        ax, ay, bx, by = starts[j, 0], starts[j, 1], ends[j, 0], ends[j, 1]
        for i in range(N_BALLS):
            out[j, i] = here[i] and segment_distance(p[i, 0], p[i, 1], ax, ay, bx, by) < reach


def obstructions(
    positions: PositionsLike, rows: Integers, starts: Vectors, ends: Vectors, *, ignore: Sequence[int] = ()
) -> NDArray[np.bool_]:
    """Find the balls in the way of a ball that runs straight: those with centres nearer than 2 R to its path.

    Parameters
    ----------
    positions : PositionsLike
        The m positions: anything that ``Positions.of`` accepts.
    rows, starts, ends : array_like
        int (n,), row of ``positions`` for each path, in [0, m); float (n, 2), first and last point of the
        running ball's centre [m].
    ignore : array_like, optional
        int (j,) or (n, j). Ids of balls that do not count, usually the running ball and its target.

    Returns
    -------
    numpy.ndarray
        bool (n, 22). Whether each ball is in the way.

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
def _clear_paths(positions, on_table, game, noses, jaws, any_part, full_ball):
    for k in range(len(any_part)):
        p, here = positions[k], on_table[k]
        on = balls_on_kernel(game[k, BALL_ON], bits(here))
        any_part[k] = here[0] and clear_path(p, here, on, noses, jaws, BALL_RADIUS)
        full_ball[k] = here[0] and full_ball_path(p, here, on, noses, jaws, BALL_RADIUS)


def clear_paths(positions: PositionsLike) -> Paths:
    """Determine whether the cue ball can roll straight to a ball on, touching no other ball or cushion first.

    Parameters
    ----------
    positions : PositionsLike
        The m positions: anything that ``Positions.of`` accepts.

    Returns
    -------
    Paths
        Two bool arrays (m,), ``any_part`` and ``full_ball``: whether a straight path leads to some part, and to the full
        face, of a ball on, by the foul-and-miss rule (``snooker_env.game.paths``) with the cushions of the match
        table; False without a cue ball.

    Examples
    --------
    >>> from snooker_env.planning import Position, clear_paths
    >>> hidden = Position(cue=(0.0, 0.0), reds=[(0.6, 0.0)], black=(0.3, 0.01), on="red")
    >>> bool(clear_paths(hidden).full_ball[0])
    False
    """
    at = Positions.of(positions).as_visits()
    out = Paths(np.zeros(len(at), np.bool_), np.zeros(len(at), np.bool_))
    table = Table.preset("match")
    _clear_paths(at.positions, at.on_table, at.game, table.noses, table.jaws, *out)
    return out
