"""Where did every ball stop? ``Stops``: what strokes led to before colours were respotted, and what the referee saw of them."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._types import Floats, Ints
from ..game.balls import N_BALLS
from ..tasks.stroke import ShotBuffers
from ..tasks.tables import StepOutput
from ..tasks.visit import Visits
from .positions import Positions


class Stops(NamedTuple):
    """What n strokes led to, ball by ball.

    Attributes
    ----------
    places : float64 (n, 22, 2)
        Centres at rest [m], before colours were respotted; of a potted ball where it fell.
    potted : int64 (n, 22)
        The pocket of each ball, an index of ``snooker_env.POCKETS``; -1 if it was not potted by this stroke.
    first : int64 (n,)
        The ball struck first, by id (the lowest of several at once); -1 if none was.
    points : float64 (n,)
        Points scored; 0 for a miss or a foul.
    penalty : int64 (n,)
        Points that a foul costs, 0 for a fair stroke.
    goes_on : bool (n,)
        Whether the visit goes on.
    afterstates : Positions
        n rows: colours respotted, and what is on next.
    """

    places: NDArray[np.float64]
    potted: NDArray[np.int64]
    first: NDArray[np.int64]
    points: NDArray[np.float64]
    penalty: NDArray[np.int64]
    goes_on: NDArray[np.bool_]
    afterstates: Positions


class WatchedVisits(Visits):
    """Visits that keep where the balls of each table's last stroke stopped: ``places`` (n, 22, 2) and ``potted`` (n, 22)."""

    places: Floats
    potted: Ints

    def output(self, *, last: bool = False, given: Mapping[str, Any] | None = None) -> StepOutput:
        """As ``Tables.output``, and room for what is kept."""
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
