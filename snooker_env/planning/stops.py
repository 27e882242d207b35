"""Where did every ball stop? ``Stops``: the balls at rest before colours are respotted, and what the referee
says of the stroke."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._types import Floats, Ints
from ..game.balls import N_BALLS
from ..tasks.stroke import ShotBuffers
from ..tasks.tables import StepOutput
from .positions import Positions
from .trials import TrialVisits


class Stops(NamedTuple):
    """Where n strokes left each ball, as returned by ``Planner.stops``.

    Attributes
    ----------
    places : numpy.ndarray
        float64 (n, 22, 2). Centres at rest [m] before colours are respotted; of a potted ball where it fell.
    potted : numpy.ndarray
        int64 (n, 22). Pocket of each ball, an index into ``snooker_env.POCKETS``; -1 if not potted.
    first : numpy.ndarray
        int64 (n,). Id of the ball struck first (the lowest of several at once); -1 if none was.
    points : numpy.ndarray
        float64 (n,). Points scored; 0 for a miss or a foul.
    penalty : numpy.ndarray
        int64 (n,). Penalty points of a foul; 0 for a fair stroke.
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

    def output(self, *, last: bool = False, given: Mapping[str, Any] | None = None) -> StepOutput:
        """As ``Tables.output``; also allocates ``places`` and ``potted``."""
        self.places, self.potted = np.zeros((self.n, N_BALLS, 2)), np.zeros((self.n, N_BALLS), np.int64)
        return super().output(last=last, given=given)

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
