"""What does a position promise? The chances of its pots, and the points that they and what follows bring, by a rule of thumb."""

from concurrent.futures import ThreadPoolExecutor
from math import erf, exp, radians, sqrt

import numpy as np
from numpy.typing import NDArray

from .._jit import entry
from ..game.balls import N_BALLS, VALUES, BallOn, balls_on_kernel, bits
from ..game.pots import GHOST_X, GHOST_Y, POT_BALL, POT_COLUMNS, POT_POCKET, TOLERANCE, find_pots
from ..geometry import AIM_X, AIM_Y, BALL_RADIUS, POCKET_AIMS
from ..physics.parameters import PhysicsLike
from ..tasks.discrete_actions import POTS
from ..tasks.noise import Noise
from .positions import Positions

_ANY_COLOUR = int(BallOn.ANY_COLOUR)

WORTH_A_THREAD = 128
"""Fewest positions that are worth a thread of their own."""

FOLLOWS = 25.0
"""Points that a pot is worth beside its own: what the rest of the visit brings, or less where less is left on the table."""
SECOND, THIRD = 0.15, 0.05
"""What the second and the third best pot of a position add: they leave a choice of where to go next."""
FAR = 0.1
"""How much less likely a pot is for each metre that the balls have to run."""
RULE_OF_THUMB = (FOLLOWS, SECOND, THIRD, FAR)
SURE = (1e4, 1e-3, 0.0, 0.0)
"""The same for a player without execution errors: all that is left follows."""


@entry(what="the value of positions", seconds=1)
def _prospects(positions, on_table, ball_on, spread, constants, values, chances):
    """For n tables: ``values`` (n,) of the positions, by the rule of thumb, and ``chances`` (n, most) to make each of the widest pots.

    ``spread`` [rad] as ``spread_of`` gives it, ``constants`` as ``RULE_OF_THUMB``.
    """
    found = np.empty((16, POT_COLUMNS))
    follows, second, third, far = constants
    for k in range(len(values)):
        chances[k, :] = 0.0
        values[k] = 0.0
        p, on = positions[k], balls_on_kernel(ball_on[k], bits(on_table[k]))
        many = find_pots(p, on_table[k], on, BALL_RADIUS, found) if on_table[k, 0] else 0
        left = 7.0 if ball_on[k] == _ANY_COLOUR else 0.0  # points: a black for each red, and after a red that was potted
        for i in range(1, N_BALLS):
            if on_table[k, i]:
                left += 8.0 if VALUES[i] == 1 else VALUES[i]
        a = b = c = 0.0
        for j in range(many):
            ball, pocket, gx, gy = int(found[j, POT_BALL]), int(found[j, POT_POCKET]), found[j, GHOST_X], found[j, GHOST_Y]
            path = sqrt((gx - p[0, 0]) ** 2 + (gy - p[0, 1]) ** 2)
            run = sqrt((POCKET_AIMS[pocket, AIM_X] - p[ball, 0]) ** 2 + (POCKET_AIMS[pocket, AIM_Y] - p[ball, 1]) ** 2)
            chance = erf(found[j, TOLERANCE] / (spread * sqrt(2.0))) * exp(-far * (path + run))
            if j < chances.shape[1]:
                chances[k, j] = chance
            rest = max(0.0, left - VALUES[ball])
            worth = chance * (VALUES[ball] + follows * (1.0 - exp(-rest / follows)))
            if worth > a:
                a, b, c = worth, a, b
            elif worth > b:
                b, c = worth, b
            elif worth > c:
                c = worth
        values[k] = a + second * b + third * c


def spread_of(noise: Noise, physics: PhysicsLike = None) -> float:
    """Standard deviation of the cue ball's direction, tip errors included; at least 1e-5.

    Parameters
    ----------
    noise : Noise
    physics : None, str, dict or Physics

    Returns
    -------
    float
        [rad]

    Examples
    --------
    >>> from snooker_env.planning import spread_of
    >>> from snooker_env.tasks import LEVELS
    >>> round(spread_of(LEVELS["club"]) * 1e3, 2)
    1.99
    """
    return max(1e-5, radians(noise.direction_deg(physics)))


def prospects_of(
    at: Positions, spread: float, constants: tuple[float, float, float, float] = RULE_OF_THUMB, most: int = POTS, threads: int = 1
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """What positions promise to a player whose aim errs by ``spread``, by a rule of thumb.

    A pot's chance is that of an error of the direction within its tolerance, less for long runs of the balls; its worth that chance times
    its points and what may follow. A position is worth its best pot and a little of the second and the third.

    Parameters
    ----------
    at : Positions
    spread : float
        As ``spread_of`` gives it [rad].
    constants : (float, float, float, float)
        ``RULE_OF_THUMB``, or ``SURE`` for a player without errors.
    most : int
        How many chances.
    threads : int
        Any number of them gives the same.

    Returns
    -------
    values : float64 (n,)
        Worth of the positions [points].
    chances : float64 (n, most)
        To make each of the widest pots, in the order of ``pots``.

    Examples
    --------
    >>> from snooker_env.planning import Position, Positions, prospects_of
    >>> values, chances = prospects_of(Positions.of(Position(cue=(0.0, 0.0), black=(0.0, 1.4605))), 1e-3)
    >>> bool(values[0] > 0), chances.shape
    (True, (1, 4))
    """
    n = len(at)
    values, chances, ball_on = np.empty(n), np.empty((n, most)), at.ball_on.copy()
    threads = min(threads, n // WORTH_A_THREAD)

    def fill(first: int, last: int) -> None:
        here = slice(first, last)
        _prospects(at.positions[here], at.on_table[here], ball_on[here], spread, constants, values[here], chances[here])

    if threads <= 1:
        fill(0, n)
    else:
        ends = np.linspace(0, n, threads + 1).astype(int)
        with ThreadPoolExecutor(threads) as pool:
            list(pool.map(fill, ends[:-1], ends[1:]))
    return values, chances
