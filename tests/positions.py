"""How does a test of an agent get tables, and the chances of their pots in plain Python?"""

from math import erf, exp, hypot, sqrt

import numpy as np

from snooker_env import SnookerVectorEnv
from snooker_env.geometry import POCKET_AIMS
from snooker_env.planning import pots
from tests.tables import begun


def tables(n, seed=0, **options):
    return begun(SnookerVectorEnv(n, **options), seed)


def chances_by_width(at, spread, decay=0.01):
    """Chances of the pots, in their order, for a ``Spread`` and this loss a metre, in plain Python: (n, 16)."""
    direct, chances = pots(at, most=16), np.zeros((len(at), 16))
    for k, j in np.argwhere(direct.ball >= 0):
        (gx, gy), (cx, cy) = direct.ghost[k, j], at.positions[k, 0]
        (px, py), (x, y) = POCKET_AIMS[direct.pocket[k, j], :2], at.positions[k, direct.ball[k, j]]
        run = hypot(gx - cx, gy - cy) + hypot(px - x, py - y)
        core = erf(direct.tolerance[k, j] / (spread.core * sqrt(2.0)))
        lapse = erf(direct.tolerance[k, j] / (spread.factor * spread.core * sqrt(2.0)))
        chances[k, j] = ((1.0 - spread.lapse) * core + spread.lapse * lapse) * exp(-decay * run)
    return chances
