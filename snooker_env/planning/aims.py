"""In which direction must the cue ball leave to send a ball to a point, by the engine's own models?"""

from typing import NamedTuple

import numpy as np

from .._lib.check import number
from .._lib.jit import entry
from .._lib.types import Floats
from ..physics.conditions import END_MASS_RATIO
from ..physics.cue_room import NO_RAILS
from ..physics.parameters import Physics, pack_into
from ..tasks.kernel_arrays import CueLaw
from ..tasks.lines import new_work
from ..tasks.options import Rules
from ..tasks.pot_aim import solved_aim
from ..tasks.stroke import row_of
from .positions import Positions
from .stroke_columns import ELEVATION, NAMES, SIDE, SPEED, TOP

ROUNDING = 1e-9  # how far beyond its bounds a number may be


class Dynamics(NamedTuple):
    """What strokes are played by: constants, a parsed fidelity, the rails of a real cue, the errors' growth [s/m]."""

    physics: Physics
    fidelity: tuple[int, int]
    rails: Floats = NO_RAILS
    growth: float = 0.0

    @classmethod
    def of(cls, rules: Rules) -> "Dynamics":
        return cls(rules.physics, rules.fidelity, rules.rails, rules.noise.growth)


def law_of(dynamics: Dynamics, at: Positions) -> tuple[Floats, Floats, int, int, float, Floats]:
    """The fields of a ``CueLaw``: the first two with one row for all or, with constants of their own, for each position."""
    physics, fidelity, rails, _ = dynamics
    if at.conditions is None:
        phys, ratios = physics.packed_for(fidelity)[None], np.array([physics.end_mass_ratio])
    else:
        phys, ratios = rows_under(at.conditions, physics), at.conditions[:, END_MASS_RATIO].copy()
    over = np.array(rails)  # kernels take arrays that can be written
    return phys, ratios, *fidelity, physics.max_offset, over


def rows_under(conditions: Floats, physics: Physics) -> Floats:
    """The packed constants (n, 22) of tables with these conditions (n, 8)."""
    rows = np.tile(physics.pack(), (len(conditions), 1))
    pack_into(rows, np.arange(len(conditions)), conditions, physics)
    return rows


@entry(what="the solving of aims", seconds=15)
def solve_aims(table, rows, balls, targets, ghosts, strokes, law, aims):
    """Fill the aims (n,), see ``Planner.pot_aim``, of strokes (n, 5) in the positions ``rows`` (n,)."""
    (positions, on_table), (phys, ratios, fidelity, n_steps, most, rails), work = table, law, new_work()
    for i in range(len(rows)):
        own = row_of(rows[i], phys)
        its = CueLaw(phys[own], ratios[own], fidelity, n_steps, most, rails)
        stroke = strokes[i, SPEED], strokes[i, SIDE], strokes[i, TOP], strokes[i, ELEVATION]
        target, ghost = (targets[i, 0], targets[i, 1]), (ghosts[i, 0], ghosts[i, 1])
        p, on = positions[rows[i]], on_table[rows[i]]
        aims[i] = solved_aim(p, on, balls[i], target, ghost, stroke, its, work)


def check_columns(strokes: Floats, least: tuple[float, ...], most: tuple[float, ...]) -> None:
    """ValueError names the first number of strokes (n, 5) that is not finite or out of range."""
    low, high = np.array(least) - ROUNDING, np.array(most) + ROUNDING
    fair = np.isfinite(strokes) & (strokes >= low) & (strokes <= high)
    for k, c in np.argwhere(~fair)[:1].tolist():
        number(f"strokes[{k}], {NAMES[c]}", float(strokes[k, c]), least[c], most[c])
