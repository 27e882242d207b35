"""What is a position worth by a learned value? V = P x U: the chance that the next stroke scores, times what
the visit then brings: the mean of several small networks. P starts from the likeliest pot's chance by its
width; U is positive. ``agents.learning.value_network`` trains them."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...tasks.noise import Spread
from ..positions import Positions
from ..prospects import in_parts
from .dense_layers import Layers
from .value_features import LOGIT, value_features

POINTS = 40.0  # unit of U [points]


class LearnedValue:
    """The value [points] of n ``Positions``: called with them, it returns float32 (n,). ``members``: the
    layers (weight (out, in), bias (out,)) of each network. ``spread``: see ``Noise.spread``."""

    def __init__(
        self, members: Sequence[Sequence[tuple[NDArray, NDArray]]], spread: Spread, threads: int = 1
    ):
        self._members = [Layers(member, "relu") for member in members]
        self.spread: Spread = spread
        self.threads: int = threads

    def __call__(self, at: Positions) -> NDArray[np.float32]:
        return self.of(value_features(at, self.spread, self.threads))

    def of(self, seen: NDArray[np.float32]) -> NDArray[np.float32]:
        """The values of features (n, SIZE)."""
        values = np.empty(len(seen), np.float32)
        in_parts(len(seen), self.threads, lambda rows: self._write(seen[rows], values[rows]))
        return values

    def _write(self, seen: NDArray[np.float32], values: NDArray[np.float32]) -> None:
        values[:] = 0.0
        for member in self._members:
            p, u = member(seen).T
            values += POINTS * np.logaddexp(0.0, u) / (1.0 + np.exp(-(seen[:, LOGIT] + p)))
        values /= len(self._members)
