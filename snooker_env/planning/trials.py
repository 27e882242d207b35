"""How are trial strokes played on copies of positions? As strokes in SI under given errors, or as actions
under drawn ones.

``decoded`` is the one way from actions and choices to strokes: the environment's own, without errors.
"""

from dataclasses import replace

import numpy as np

from .._jit import entry
from .._types import Floats, Ints
from ..physics.cue import squirt
from ..tasks import stroke
from ..tasks.arrays import StruckArrays, TableArrays
from ..tasks.box_actions import tip_on_disc
from ..tasks.declarations import A_END_MASS, A_MAX_OFFSET
from ..tasks.noise import Noise, with_errors
from ..tasks.options import Rules
from ..tasks.stroke import ShotBuffers
from ..tasks.visit import Visits
from .positions import Positions

(SPEED, SIDE, TOP, AIM, ELEVATION) = range(5)
"""Columns of a stroke: cue speed [m/s], tip offset over R to the right and up, direction in which the cue
ball leaves, elevation [rad]."""
COLUMNS = 5
NO_NOISE = Noise()


@entry(what="strokes under given errors", seconds=2)
def _strike(which, strokes, errors, tables, shots, options, noise, silent):
    """Carry strokes (n, 5) of the tables ``which`` out up to the strike, under standard normal errors (n, 5)."""
    tables, shots = TableArrays(*tables), StruckArrays(*shots)
    for j in range(which.shape[0]):
        k = which[j]
        speed, aim, elevation = strokes[k, SPEED], strokes[k, AIM], strokes[k, ELEVATION]
        side, top = tip_on_disc(strokes[k, SIDE], strokes[k, TOP], options[A_MAX_OFFSET])
        struck = with_errors(
            speed, side, top, aim - squirt(side, options[A_END_MASS]), elevation, errors[k], noise
        )
        stroke.strike(
            struck, tables.positions[k], tables.on_table[k], tables.streams[k], options, silent, j, shots
        )


class TrialVisits(Visits):
    """Visits of one stroke each, filled by ``lay``: of strokes (n, 5) with ``errors`` (n, 5), else of
    actions."""

    errors: Floats | None = None

    def lay(self, after: Positions, streams: np.ndarray, errors: Floats | None = None) -> None:
        """Put positions on the tables; they are played in place."""
        self.n, self.errors, self.streams = len(after), errors, streams
        self.positions, self.on_table, self.game = after.positions, after.on_table, after.game

    def address(self, which: Ints, actions: Floats, buffers: ShotBuffers) -> None:
        """As ``Tables.address``."""
        if self.errors is None:
            super().address(which, actions, buffers)
            return
        (options, noise, _), silent = self.packed, NO_NOISE.pack(1.0)
        _strike(which, actions, self.errors, self.arrays, buffers.struck, options, noise, silent)


def decoded(
    rules: Rules, at: Positions, which: Ints, actions: Floats, nominated: Ints | None = None
) -> tuple[Floats, Positions]:
    """Strokes (n, 5) that checked actions mean on ``at[which]``, and the positions with the cue ball placed as they say.

    ``nominated`` (n,): of frames, what is nominated with each stroke; a choice is a pot of that ball."""
    visits, after, n = TrialVisits(replace(rules, noise=NO_NOISE), 0), at[which], len(which)
    visits.lay(after, np.zeros((n, 2), np.uint64))
    if nominated is not None:
        visits.nominated = nominated
    buffers = ShotBuffers(n, 0)
    visits.address(np.arange(n), actions, buffers)
    strokes = buffers.shots[:, stroke.CUE_SPEED :].copy()
    strokes[:, AIM] = np.arctan2(buffers.shots[:, stroke.VY], buffers.shots[:, stroke.VX])
    return strokes, after
