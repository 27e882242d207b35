"""How does a test ask what shot an action means, and where its target line leads?"""

import numba
import numpy as np

from snooker_env.game.pots import POT_COLUMNS
from snooker_env.physics.parameters import Physics
from snooker_env.tasks.box_actions import shot_of
from snooker_env.tasks.kernel_arrays import CueLaw
from snooker_env.tasks.lines import LINE_ROWS, line_of, new_work

PAPER = Physics()


@numba.njit(error_model="numpy")
def _line(positions, on_table, on):
    return line_of(positions, on_table, on, np.empty((LINE_ROWS, POT_COLUMNS)))


@numba.njit(error_model="numpy")
def _shot(a, positions, on_table, on, options, phys, cue):
    law = CueLaw(phys, cue[0], 0, 0, cue[1], cue[2:])
    return shot_of(a, positions, on_table, on, options, law, new_work())


def shot(actions, a, positions, on_table, on, physics=PAPER):
    """(speed, side, top, aim of the cue, elevation) of the action ``a`` of ``Actions``, with a free cue."""
    table = np.array(positions, np.float64), np.array(on_table, np.bool_), int(on)
    cue = np.array([physics.end_mass_ratio, physics.max_offset])
    return _shot(np.array(a, np.float64), *table, actions.pack(), physics.pack(), cue)


def line(positions, on_table, on):
    """Direction [rad] of the target line: to the widest direct pot's ghost ball, else the best line."""
    return _line(np.array(positions, np.float64), np.array(on_table, np.bool_), int(on))
