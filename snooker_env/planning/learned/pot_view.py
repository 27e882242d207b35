"""What does a learned policy see of a table? The flat observation, then features of direct pots."""

from math import hypot, log10

import numpy as np
from gymnasium import spaces

from ..._lib.jit import entry
from ..._lib.types import Singles
from ...game.balls import N_BALLS, VALUES
from ...game.pots import COS_CUT, GHOST_X, GHOST_Y, POT_BALL, POT_COLUMNS, POT_POCKET, find_pots
from ...game.pots import TOLERANCE as POT_TOLERANCE
from ...geometry import AIM_X, AIM_Y, BALL_RADIUS, HALF_LENGTH, HALF_WIDTH, POCKET_AIMS
from ...tasks.discrete_actions import POTS
from ...tasks.observations import SIZE as OBSERVATION_SIZE

POT_ENTRIES = 13  # numbers shown of each of the ``tasks.POTS`` widest pots, see ``with_pots``
SHOWN = OBSERVATION_SIZE + POTS * POT_ENTRIES
# Entries that change sign when the table is mirrored, left and right exchanged.
BALL_X = 0
POT_X, CUT = (1, 9, 11), 3
TOLERANCE = 7  # the entry that shows the tolerance [rad], as 1 + log10(tolerance) / 2


@entry(what="the view of the pots", seconds=1)
def _add_pots(observations, shown):
    """Copy observations (n, OBSERVATION_SIZE) to ``shown``, and the pots read from them behind."""
    lines = np.empty((POTS, POT_COLUMNS))
    positions, on_table = np.empty((N_BALLS, 2)), np.empty(N_BALLS, np.bool_)
    for k in range(len(observations)):
        seen, row, on = observations[k], shown[k], 0
        for c in range(OBSERVATION_SIZE):
            row[c] = seen[c]
        for c in range(OBSERVATION_SIZE, row.shape[0]):
            row[c] = 0.0
        for i in range(N_BALLS):
            positions[i, 0], positions[i, 1] = seen[5 * i] * HALF_WIDTH, seen[5 * i + 1] * HALF_LENGTH
            on_table[i] = seen[5 * i + 2] > 0.0
            on |= (1 << i) if seen[5 * i + 4] > 0.0 else 0
        for p in range(find_pots(positions, on_table, on, BALL_RADIUS, lines) if on_table[0] else 0):
            ball, pocket = int(lines[p, POT_BALL]), int(lines[p, POT_POCKET])
            at = OBSERVATION_SIZE + POT_ENTRIES * p
            bx, by, gx, gy = positions[ball, 0], positions[ball, 1], lines[p, GHOST_X], lines[p, GHOST_Y]
            px, py, rx, ry = gx - positions[0, 0], gy - positions[0, 1], bx - gx, by - gy
            away, run = hypot(px, py), hypot(rx, ry)
            px, py, rx, ry = px / away, py / away, rx / run, ry / run
            to_pocket = hypot(POCKET_AIMS[pocket, AIM_X] - bx, POCKET_AIMS[pocket, AIM_Y] - by)
            row[at], row[at + 1], row[at + 2] = 1.0, px, py
            row[at + 3], row[at + 4] = px * ry - py * rx, lines[p, COS_CUT]
            row[at + 5], row[at + 6] = away / HALF_LENGTH - 1.0, to_pocket / HALF_LENGTH - 1.0
            row[at + TOLERANCE], row[at + 8] = 1.0 + log10(lines[p, POT_TOLERANCE]) / 2.0, VALUES[ball] / 7.0
            row[at + 9], row[at + 10] = bx / HALF_WIDTH, by / HALF_LENGTH
            row[at + 11] = POCKET_AIMS[pocket, AIM_X] / HALF_WIDTH
            row[at + 12] = POCKET_AIMS[pocket, AIM_Y] / HALF_LENGTH
            for c in range(at, at + POT_ENTRIES):
                row[c] = min(1.0, max(-1.0, row[c]))


def with_pots(observations: Singles) -> Singles:
    """Flat observations (n, OBSERVATION_SIZE), then of each of the four widest pots: 1, direction cue ball -> ghost ball (x, y),
    sine and cosine of the cut, both distances, tolerance, the ball's value and place, the pocket's place."""
    shown = np.empty((len(observations), SHOWN), np.float32)
    _add_pots(np.ascontiguousarray(observations), shown)
    return shown


VIEW_SPACE = spaces.Box(-1.0, 1.0, (SHOWN,), np.float32)  # the observation space of the agent
