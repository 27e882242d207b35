"""What does a position promise? The chances of its pots, and the points that they and what follows bring, by a rule of thumb."""

from concurrent.futures import ThreadPoolExecutor
from math import erf, exp, radians, sqrt

import numpy as np

from snooker_env.game import N_BALLS, VALUES, BallOn
from snooker_env.geometry import AIM_X, AIM_Y, BALL_RADIUS, POCKET_AIMS
from snooker_env.kernels import GHOST_X, GHOST_Y, POT_BALL, POT_COLUMNS, POT_POCKET, TOLERANCE, balls_on, bits, entry, find_pots
from snooker_env.tasks import POTS

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


@entry
def _prospects(positions, on_table, ball_on, spread, constants, values, chances):
    """For n tables: ``values`` (n,) of the positions, by the rule of thumb, and ``chances`` (n, most) to make each of the widest pots.

    ``spread`` [rad] as ``spread_of`` gives it, ``constants`` as ``RULE_OF_THUMB``.
    """
    found = np.empty((16, POT_COLUMNS))
    follows, second, third, far = constants
    for k in range(len(values)):
        chances[k, :] = 0.0
        values[k] = 0.0
        p, on = positions[k], balls_on(ball_on[k], bits(on_table[k]))
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


def spread_of(noise, physics):
    """Standard deviation [rad] of the cue ball's direction under a ``Noise``, tip errors included; at least 1e-5."""
    return max(1e-5, radians(noise.direction_deg(physics)))


def prospects_of(at, spread, constants=RULE_OF_THUMB, most=POTS, threads=1):
    """What ``Positions`` promise to a player whose aim errs by ``spread`` [rad] (``spread_of``), by the rule of thumb ``constants``.

    Returns their values (n,) [points] and the chances (n, most) to make each of the widest pots. Any number of threads gives the same.
    """
    n = len(at)
    values, chances, ball_on = np.empty(n), np.empty((n, most)), at.ball_on.copy()
    threads = min(threads, n // WORTH_A_THREAD)

    def fill(first, last):
        here = slice(first, last)
        _prospects(at.positions[here], at.on_table[here], ball_on[here], spread, constants, values[here], chances[here])

    if threads <= 1:
        fill(0, n)
    else:
        ends = np.linspace(0, n, threads + 1).astype(int)
        with ThreadPoolExecutor(threads) as pool:
            list(pool.map(fill, ends[:-1], ends[1:]))
    return values, chances
