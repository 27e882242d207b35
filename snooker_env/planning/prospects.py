"""How good is a position? The chances of its pots, and the points to expect of them and of what follows."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from math import exp

import numpy as np
from numpy.typing import NDArray

from .._lib.jit import entry
from .._lib.types import Floats
from ..game.balls import N_BALLS, VALUES, BallOn, balls_on_kernel, bits
from ..game.pots import POT_BALL, POT_COLUMNS, find_pots
from ..geometry import BALL_RADIUS
from ..physics.cue_room import NO_RAILS
from ..physics.parameters import PhysicsLike
from ..tasks.discrete_actions import POTS
from ..tasks.noise import Noise, Spread
from ..tasks.pot_chance import FAR, length_of, plain_chance
from .positions import Positions

_ANY_COLOUR = int(BallOn.ANY_COLOUR)
WORTH_A_THREAD = 128  # smallest number of positions for which another thread is worth its cost
FOLLOWS = 25.0
"""Points to expect after a made pot from the rest of the visit; fewer if fewer are left on the table."""
SECOND, THIRD = 0.15, 0.05
"""Shares of the second and third best pot that count: they leave a choice of where to play next."""
DISTANT = 0.09
"""Decay of what a pot is worth per metre of both balls' paths [1/m], beside its chance: from far the cue ball is hard to place."""
RULE_OF_THUMB = (FOLLOWS, SECOND, THIRD, DISTANT)
"""Constants of ``prospects_of`` for a player with execution errors: the four numbers above."""
SURE = (1e4, 1e-3, 0.0, -FAR)
"""Constants of ``prospects_of`` for a player without execution errors, who takes all points that are left: the
last one undoes the loss that the chance has by the paths."""


@entry(what="the value of positions", seconds=1)
def _prospects(positions, on_table, ball_on, spread, constants, rails, values, chances):
    """Fill ``values`` (n,) and ``chances`` (n, most) of ``prospects_of``."""
    lines = np.empty((16, POT_COLUMNS))
    follows, second, third, distant = constants
    for k in range(len(values)):
        chances[k, :] = 0.0
        values[k] = 0.0
        p, on = positions[k], balls_on_kernel(ball_on[k], bits(on_table[k]))
        many = find_pots(p, on_table[k], on, BALL_RADIUS, lines) if on_table[k, 0] else 0
        # points: a black with each red, and one after a red just potted
        left = 7.0 if ball_on[k] == _ANY_COLOUR else 0.0
        for i in range(1, N_BALLS):
            if on_table[k, i]:
                left += 8.0 if VALUES[i] == 1 else VALUES[i]
        a = b = c = 0.0
        for j in range(many):
            ball = int(lines[j, POT_BALL])
            chance = plain_chance(p, on_table[k], lines[j], spread, rails)
            if j < chances.shape[1]:
                chances[k, j] = chance
            rest = max(0.0, left - VALUES[ball])
            worth = chance * (VALUES[ball] + follows * (1.0 - exp(-rest / follows)))
            worth *= exp(-distant * length_of(p, lines[j]))
            if worth > a:
                a, b, c = worth, a, b
            elif worth > b:
                b, c = worth, b
            elif worth > c:
                c = worth
        values[k] = a + second * b + third * c


def in_parts(n: int, threads: int, fill: Callable[[slice], None]) -> None:
    """Call ``fill`` with slices of n positions, on as many threads as are worth it, at most ``threads``."""
    threads = min(threads, n // WORTH_A_THREAD)
    if threads <= 1:
        fill(slice(0, n))
        return
    ends = np.linspace(0, n, threads + 1).astype(int).tolist()
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(fill, map(slice, ends[:-1], ends[1:])))


def spread_of(noise: Noise, physics: PhysicsLike = None) -> Spread:
    """Return the law of the cue ball's direction in a stroke at 1.5 m/s, tip errors included.

    Parameters
    ----------
    noise : Noise
        The execution noise.
    physics : str, dict, Physics or None, optional
        Physical constants, for the squirt of a tip error. Default None: the preset "paper".

    Returns
    -------
    Spread
        The standard deviation ``core`` [rad], at least 1e-5; the probability ``lapse`` of a lapse, and its ``factor``.

    Examples
    --------
    >>> from snooker_env.planning import spread_of
    >>> from snooker_env.tasks import LEVELS
    >>> round(spread_of(LEVELS["olympiad"]).core * 1e3, 2)
    2.6
    """
    return noise.spread(physics)


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
        The law of the cue ball's direction, see ``spread_of``.
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
    >>> from snooker_env.planning import Position, Positions, prospects_of, spread_of
    >>> from snooker_env.tasks import LEVELS
    >>> spread = spread_of(LEVELS["professional"])
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
