"""What is a position of a frame worth by a learned network? The points that its striker is expected to score from
there on, less the other's. ``agents.learning.frame_worth`` trains it, for all levels of errors at once: the error
of the cue ball's direction is one of its inputs."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..positions import Positions
from ..prospects import in_parts
from .dense_layers import Layers
from .frame_features import frame_features

POINTS = 40.0  # unit of the network's result [points]


class LearnedWorth:
    """A worth (``planning.worth``): float32 (n,) points for n ``Positions`` of frames as their strikers see them.
    ``layers``: weight (out, in) and bias (out,) of each; ``spread`` [rad]: see ``spread_of``."""

    def __init__(self, layers: Sequence[tuple[NDArray, NDArray]], spread: float, threads: int = 1):
        self._layers, self.spread, self.threads = Layers(layers, "relu"), spread, threads

    def __call__(self, at: Positions) -> NDArray[np.float32]:
        return self.of(frame_features(at, self.spread, self.threads))

    def of(self, seen: NDArray[np.float32]) -> NDArray[np.float32]:
        """The worths of features (n, SIZE)."""
        worths = np.empty(len(seen), np.float32)

        def fill(rows: slice) -> None:
            worths[rows] = POINTS * self._layers(seen[rows])[:, 0]

        in_parts(len(seen), self.threads, fill)
        return worths
