"""What is a position worth by learned networks? In a visit V = P x U: the chance that the next stroke scores, which starts
from the likeliest pot's, times what the visit then brings; in a frame that, and what another network adds for what follows."""

from collections.abc import Sequence

import numpy as np

from ..._lib.types import Singles
from ...tasks.noise import Spread
from ..positions import Positions
from ..pot_geometry import in_parts
from .dense_layers import Layers, Weights
from .frame_features import SIZE as FEATURES
from .frame_features import frame_features
from .value_features import LOGIT, value_features
from .value_features import SIZE as VISIT_SIZE

POINTS = 40.0  # unit of U, and of what the other network adds [points]
SIZE = FEATURES + 1  # what that network sees: the features, then the value of the visit


class LearnedValue:
    """The value [points] of visits: called with n ``Positions``, it returns float32 (n,). ``members``: of each network."""

    def __init__(self, members: Sequence[Weights], spread: Spread, threads: int = 1):
        self._members = [Layers(member, "relu") for member in members]
        self.spread: Spread = spread
        self.threads: int = threads

    def __call__(self, at: Positions) -> Singles:
        return self.of(value_features(at, self.spread, self.threads))

    def of(self, seen: Singles) -> Singles:
        """The values of features (n, SIZE)."""
        values = np.empty(len(seen), np.float32)
        in_parts(len(seen), self.threads, lambda rows: self._write(seen[rows], values[rows]))
        return values

    def _write(self, seen: Singles, values: Singles) -> None:
        values[:] = 0.0
        for member in self._members:
            p, u = member(seen).T
            values += POINTS * np.logaddexp(0.0, u) / (1.0 + np.exp(-(seen[:, LOGIT] + p)))
        values /= len(self._members)


class LearnedWorth:
    """A worth (``planning.worth``): float32 (n,) points; ``layers``: of the other network, None: the value alone."""

    def __init__(self, value: LearnedValue, layers: Weights | None):
        self.value: LearnedValue = value
        self._layers = None if layers is None else Layers(layers, "relu")

    def __call__(self, at: Positions) -> Singles:
        seen, worths = self.features_of(at), np.empty(len(at), np.float32)

        def fill(rows: slice) -> None:
            worths[rows] = worth_of(self._layers, seen[rows])

        in_parts(len(at), self.value.threads, fill)
        return worths

    def features_of(self, at: Positions) -> Singles:
        """What the network sees of n positions: float32 (n, SIZE)."""
        seen = np.empty((len(at), SIZE), np.float32)
        seen[:, :FEATURES] = frame_features(at, self.value.spread, self.value.threads)
        seen[:, -1] = self.value.of(np.ascontiguousarray(seen[:, :VISIT_SIZE])) / POINTS
        return seen


def worth_of(layers: Layers | None, seen: Singles) -> Singles:
    """The worths (n,) of what the network sees (n, SIZE)."""
    more = 0.0 if layers is None else layers(seen)[:, 0]
    return POINTS * (seen[:, -1] + more)
