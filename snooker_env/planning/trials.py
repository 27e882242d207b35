"""How are trial strokes played on copies of positions? As strokes in SI under given errors, or as actions
under drawn ones. ``decoded`` is the one way from actions and choices to strokes: the environment's own."""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._jit import entry
from .._types import Floats, Ints
from ..game.balls import N_BALLS
from ..physics.cue import squirt
from ..tasks import stroke
from ..tasks.arrays import StruckArrays, TableArrays
from ..tasks.box_actions import tip_on_disc
from ..tasks.declarations import A_END_MASS, A_MAX_OFFSET
from ..tasks.noise import Noise, with_errors
from ..tasks.options import Rules
from ..tasks.stroke import ShotBuffers
from ..tasks.tables import StepOutput
from ..tasks.visit import Visits
from .positions import Positions

(SPEED, SIDE, TOP, AIM, ELEVATION) = range(5)
"""Columns of a stroke: cue speed [m/s], tip offset over R to the right and up, direction in which the cue ball
leaves (the cue itself points aside by the squirt of the side), elevation of the cue [rad]."""
COLUMNS = 5
NO_NOISE = Noise()


@entry(what="strokes under given errors", seconds=2)
def _strike(which, strokes, errors, tables, shots, options, noise, silent):
    """Strike the strokes (n, 5) of the tables ``which`` under standard normal errors (n, 5)."""
    tables, shots = TableArrays(*tables), StruckArrays(*shots)
    for j in range(which.shape[0]):
        k = which[j]
        speed, aim, elevation = strokes[k, SPEED], strokes[k, AIM], strokes[k, ELEVATION]
        side, top = tip_on_disc(strokes[k, SIDE], strokes[k, TOP], options[A_MAX_OFFSET])
        p, on, aim = tables.positions[k], tables.on_table[k], aim - squirt(side, options[A_END_MASS])
        struck = with_errors(speed, side, top, aim, elevation, errors[k], noise)
        stroke.strike(struck, p, on, tables.streams[k], options, silent, j, shots)


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
    """Strokes (n, 5) that checked actions mean on ``at[which]``, and n positions with the cue ball so placed.

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


class Stops(NamedTuple):
    """Where n strokes left each ball, as returned by ``Planner.stops``.

    Attributes
    ----------
    places, potted : numpy.ndarray
        float64 (n, 22, 2), centres at rest [m] before colours are respotted, of a potted ball where it fell;
        int64 (n, 22), pocket of each ball, an index into ``snooker_env.POCKETS``, or -1.
    first : numpy.ndarray
        int64 (n,). Id of the ball struck first (the lowest of several at once); -1 if none was.
    points, penalty : numpy.ndarray
        float64 (n,), points scored, 0 for a miss or a foul; int64 (n,), penalty points of a foul, or 0.
    goes_on : numpy.ndarray
        bool (n,). Whether the visit continues after the stroke.
    afterstates : Positions
        n rows: colours respotted, and the ball on for the next stroke.

    Examples
    --------
    >>> from snooker_env.planning import Planner, Position
    >>> stops = Planner({"action": "discrete"}).stops(Position(cue=(0.0, 0.9), black=(0.4, 1.3)), [0], [67])
    >>> int(stops.first[0]), int(stops.potted[0, 21]), stops.points.tolist()
    (21, 3, [7.0])
    """

    places: NDArray[np.float64]
    potted: NDArray[np.int64]
    first: NDArray[np.int64]
    points: NDArray[np.float64]
    penalty: NDArray[np.int64]
    goes_on: NDArray[np.bool_]
    afterstates: Positions


class WatchedVisits(TrialVisits):
    """Trial visits that record where each table's last stroke left the balls."""

    places: Floats
    potted: Ints

    def output(self, **kwargs: Any) -> StepOutput:
        """As ``Tables.output``; also allocates ``places`` and ``potted``."""
        self.places, self.potted = np.zeros((self.n, N_BALLS, 2)), np.zeros((self.n, N_BALLS), np.int64)
        return super().output(**kwargs)

    def run(self, which: Ints, buffers: ShotBuffers) -> list[int]:
        """As ``Tables.run``."""
        unfinished = super().run(which, buffers)
        m = len(which)
        self.places[which], self.potted[which] = buffers.r[:m], buffers.potted[:m]
        return unfinished

    def again(self, which: Ints, j: int, buffers: ShotBuffers) -> ShotBuffers:
        """As ``Tables.again``."""
        one = super().again(which, j, buffers)
        self.places[which[j]], self.potted[which[j]] = one.r[0], one.potted[0]
        return one
