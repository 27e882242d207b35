"""What is a position of a frame worth by learned networks? The points that its striker is expected to score from
there on, less the other's: the learned value of the visit, and what a small network adds for all that comes after it.

The value was learned from a hundred times as many shots, and tells apart what a stroke within a break leaves; the
other network is about whose turn follows, and what safety is. ``agents.learn_worth`` trains it, for all levels of
errors at once: the error of the cue ball's direction is one of its inputs."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..positions import Positions
from ..prospects import in_parts
from .dense_layers import Layers
from .frame_features import SIZE as FEATURES
from .frame_features import frame_features
from .learned_value import LearnedValue
from .value_features import SIZE as VISIT_SIZE

POINTS = 40.0  # unit of the networks' results [points]
SIZE = FEATURES + 1  # what the network sees: the features, then the value of the visit


class LearnedWorth:
    """A worth (``planning.worth``): float32 (n,) points for n ``Positions`` of frames as their strikers see them.
    ``value``: of the visit; ``layers``: weight (out, in) and bias (out,) of each, or None: the value alone."""

    def __init__(self, value: LearnedValue, layers: Sequence[tuple[NDArray, NDArray]] | None):
        self.value: LearnedValue = value
        self._layers = None if layers is None else Layers(layers, "relu")

    def __call__(self, at: Positions) -> NDArray[np.float32]:
        seen = self.features_of(at)
        worths = np.empty(len(at), np.float32)

        def fill(rows: slice) -> None:
            worths[rows] = worth_of(self._layers, seen[rows])

        in_parts(len(at), self.value.threads, fill)
        return worths

    def features_of(self, at: Positions) -> NDArray[np.float32]:
        """What the network sees of n positions: float32 (n, SIZE)."""
        seen = np.empty((len(at), SIZE), np.float32)
        seen[:, :FEATURES] = frame_features(at, self.value.spread, self.value.threads)
        seen[:, -1] = self.value.of(np.ascontiguousarray(seen[:, :VISIT_SIZE])) / POINTS
        return seen


def worth_of(layers: Layers | None, seen: NDArray[np.float32]) -> NDArray[np.float32]:
    """The worths (n,) of what the network sees (n, SIZE)."""
    more = 0.0 if layers is None else layers(seen)[:, 0]
    return POINTS * (seen[:, -1] + more)
