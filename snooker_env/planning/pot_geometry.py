"""Which pots does a position offer, what is in the way, and how good is it? By straight lines: no throw, spin or cushions."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np

from .._lib.check import integer
from .._lib.jit import entry
from .._lib.types import Bools, Floats, Ints
from ..game.balls import N_BALLS, balls_on_kernel, bits
from ..game.frame_columns import BALL_ON
from ..game.paths import clear_path
from ..game.pots import COS_CUT, GHOST_X, GHOST_Y, POT_BALL, POT_COLUMNS, POT_POCKET, TOLERANCE, find_pots
from ..game.snookered import segment_distance
from ..geometry import BALL_RADIUS
from ..physics.cue_room import NO_RAILS
from ..physics.table import Table
from ..tasks.discrete_actions import POTS
from ..tasks.noise import Spread
from ..tasks.pot_chance import RULE_OF_THUMB, points_left, worth_of_pots
from .positions import Positions, PositionsLike, check_rails

WORTH_A_THREAD = 128  # smallest number of positions for which another thread is worth its cost


class Pots(NamedTuple):
    """The direct pots of m positions, as returned by ``pots``."""

    ball: Ints
    pocket: Ints
    ghost: Floats
    cut: Floats
    tolerance: Floats


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
    positions, most
        The m positions, see ``Positions.of``; the largest number of pots for each, in [1, 126].

    Returns
    -------
    Pots
        Arrays, widest tolerance first: ``ball``, ``pocket``, int64 (m, most), id of the ball and index into
        ``snooker_env.POCKETS``, -1 beyond the last pot; ``ghost``, (m, most, 2), centre of the cue ball [m] when it touches
        the ball; ``cut``, (m, most), angle between the paths of both balls [rad]; ``tolerance``, (m, most), approximate
        largest error of the aim [rad] with which the ball is still potted.

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


def obstructions(at: Positions, rows: Ints, starts: Floats, ends: Floats, ignore: Ints) -> Bools:
    """Which balls are nearer than 2 R to the straight paths (n, 2) of a ball's centre in ``at[rows]``, but for the ids
    ``ignore`` (n, j): (n, 22)."""
    out = np.empty((len(rows), N_BALLS), np.bool_)
    _obstructions(at.positions, at.on_table, rows, starts, ends, 2.0 * BALL_RADIUS * (1.0 - 1e-9), out)
    out[np.arange(len(rows))[:, None], ignore] = False
    return out


@entry(what="the clear paths of positions", seconds=2)
def _clear_paths(positions, on_table, game, noses, jaws, clear):
    for k in range(len(clear)):
        p, here = positions[k], on_table[k]
        on = balls_on_kernel(game[k, BALL_ON], bits(here))
        clear[k] = here[0] and clear_path(p, here, on, noses, jaws, BALL_RADIUS)


def clear_paths(positions: PositionsLike) -> Bools:
    """Determine whether the cue ball can roll straight to some part of a ball on, touching no other ball or cushion first.

    Parameters
    ----------
    positions : PositionsLike
        The m positions, see ``Positions.of``.

    Returns
    -------
    numpy.ndarray
        bool (m,), by the foul-and-miss rule (``snooker_env.game.paths``) on the match table; False without a cue ball.

    Examples
    --------
    >>> from snooker_env.planning import Position, clear_paths
    >>> clear_paths(Position(cue=(0.0, 0.0), reds=[(0.6, 0.0)], black=(0.3, 0.0), on="red")).tolist()
    [False]
    """
    at, table = Positions.of(positions).as_visits(), Table.preset("match")
    clear = np.zeros(len(at), np.bool_)
    _clear_paths(at.positions, at.on_table, at.game, table.noses, table.jaws, clear)
    return clear


@entry(what="the value of positions", seconds=1)
def _prospects(positions, on_table, ball_on, spread, constants, rails, values, chances):
    """Fill ``values`` (n,) and ``chances`` (n, most) of ``prospects_of``."""
    lines = np.empty((16, POT_COLUMNS))
    for k in range(len(values)):
        chances[k, :] = 0.0
        p, here, own = positions[k], on_table[k], chances[k]
        on = balls_on_kernel(ball_on[k], bits(here))
        many = find_pots(p, here, on, BALL_RADIUS, lines) if here[0] else 0
        left = points_left(here, ball_on[k])
        values[k], _, _ = worth_of_pots(lines, many, p, here, left, spread, constants, rails, own)


def in_parts(n: int, threads: int, fill: Callable[[slice], None]) -> None:
    """Call ``fill`` with slices of n positions, on as many threads as are worth it, at most ``threads``."""
    threads = min(threads, n // WORTH_A_THREAD)
    if threads <= 1:
        fill(slice(0, n))
        return
    ends = np.linspace(0, n, threads + 1).astype(int).tolist()
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(fill, map(slice, ends[:-1], ends[1:])))


def prospects_of(
    at: Positions,
    spread: Spread,
    constants: tuple[float, float, float, float] = RULE_OF_THUMB,
    most: int = POTS,
    threads: int = 1,
    rails: Floats = NO_RAILS,
) -> tuple[Floats, Floats]:
    """Estimate the value of positions and the chances of their pots by a rule of thumb.

    The chance of a pot is that of an error within its tolerance; its value that times its points plus what may follow, less
    from far. Small shares of the second and third best pot count too.

    Parameters
    ----------
    at, spread, constants
        The n positions; the law of the cue ball's direction, ``Noise.spread``; ``RULE_OF_THUMB``, or ``SURE`` for a player
        without execution errors.
    most, threads, rails
        Number of chances for each position; largest number of threads; those that a real cue passes over,
        ``Planner.rules.rails``: the errors grow with the elevation that a plain stroke at the pot needs.

    Returns
    -------
    values, chances : numpy.ndarray
        float64 (n,), values of the positions [points]; float64 (n, most), chance of each of the widest pots,
        in the order of ``pots``; 0 where there is none.

    Examples
    --------
    >>> from snooker_env.planning import Position, Positions, prospects_of
    >>> from snooker_env.tasks import LEVELS
    >>> spread = LEVELS["professional"].spread()
    >>> values, chances = prospects_of(Positions.of(Position(cue=(0.0, 0.0), black=(0.0, 1.4605))), spread)
    >>> bool(values[0] > 0), chances.shape
    (True, (1, 4))
    """
    at, n = at.as_visits(), len(at)
    values, chances, balls = np.empty(n), np.empty((n, most)), (at.positions, at.on_table, at.ball_on.copy())
    over = check_rails(rails)

    def fill(rows: slice) -> None:
        _prospects(*(part[rows] for part in balls), spread, constants, over, values[rows], chances[rows])

    in_parts(n, threads, fill)
    return values, chances
