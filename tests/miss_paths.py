"""How does a test ask for the straight paths of the miss rule? On one table, as arrays."""

import numpy as np

from snooker_env.game.balls import check_table
from snooker_env.game.paths import best_paths
from snooker_env.geometry import BALL_RADIUS


def paths(positions, on_table, on, *, anywhere=False, noses=(), jaws=()):
    """(any part, full ball): whether such paths lead to a ball of the mask ``on``; with the cue ball off the table from
    anywhere in the D, or on the bed. ``noses``, ``jaws``: of a ``Table``."""
    placed, present = check_table(positions, on_table)
    cushions = np.reshape(noses, (-1, 5)).astype(float), np.reshape(jaws, (-1, 6)).astype(float)
    for part in cushions:
        part.setflags(write=False)  # as those of a Table: numba compiles for each kind
    in_hand = 0 if present[0] else 1 + anywhere
    any_part, full = best_paths(placed, present, on, in_hand, *cushions, BALL_RADIUS)
    return bool(any_part), bool(full)
