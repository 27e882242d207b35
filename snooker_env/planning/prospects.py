"""How good is a position? The chances of its pots, and the points to expect of them and of what follows."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from .._lib.jit import entry
from .._lib.types import Floats
from ..game.balls import balls_on_kernel, bits
from ..game.pots import POT_COLUMNS, find_pots
from ..geometry import BALL_RADIUS
from ..physics.cue_room import NO_RAILS
from ..tasks.discrete_actions import POTS
from ..tasks.noise import Spread
from ..tasks.pot_chance import RULE_OF_THUMB, points_left, worth_of_pots
from .positions import Positions

WORTH_A_THREAD = 128  # smallest number of positions for which another thread is worth its cost


@entry(what="the value of positions", seconds=1)
def _prospects(positions, on_table, ball_on, spread, constants, rails, values, chances):
    """Fill ``values`` (n,) and ``chances`` (n, most) of ``prospects_of``."""
    lines = np.empty((16, POT_COLUMNS))
    for k in range(len(values)):
        chances[k, :] = 0.0
        p, on = positions[k], balls_on_kernel(ball_on[k], bits(on_table[k]))
        many = find_pots(p, on_table[k], on, BALL_RADIUS, lines) if on_table[k, 0] else 0
        left = points_left(on_table[k], ball_on[k])
        values[k], _, _ = worth_of_pots(
            lines, many, p, on_table[k], left, spread, constants, rails, chances[k]
        )


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
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Estimate the value of positions and the chances of their pots by a rule of thumb.

    The chance of a pot is that of an error within its tolerance (``pot_chance``); its
    value that times its points plus what may follow, less from far. Small shares of the second and third best pot count too.

    Parameters
    ----------
    at : Positions
        The n positions.
    spread : Spread
        The law of the cue ball's direction, ``Noise.spread``.
    constants : tuple of float, optional
        ``RULE_OF_THUMB`` (default), or ``SURE`` for a player without execution errors.
    most, threads : int, optional
        Number of chances for each position; default 4. Largest number of threads; default 1.
    rails : numpy.ndarray, optional
        Those that a real cue passes over, ``Planner.rules.rails``: the errors of a plain stroke at the pot then grow
        with the elevation that it needs. Default: a free cue.

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
    over = np.array(rails)  # kernels are compiled for arrays that can be written

    def fill(rows: slice) -> None:
        _prospects(*(part[rows] for part in balls), spread, constants, over, values[rows], chances[rows])

    in_parts(n, threads, fill)
    return values, chances
