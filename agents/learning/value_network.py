"""How is the value of a position computed? V = P x U: the chance that the next stroke scores, times what the visit then brings.

One small network with two outputs (``ValueNetwork``). P starts from the likeliest pot's chance by its width; U is positive. It is trained
with torch; ``Value`` plays the same weights in NumPy, where a call costs less.
"""

from itertools import pairwise

import numpy as np
import torch
from torch import nn

from ..features.value_features import LOGIT, SIZE, value_features

WIDTHS = (160, 96)
POINTS = 40.0
"""Unit of U [points]."""


class ValueNetwork(nn.Module):
    """Features (n, SIZE) -> logits of P (n,) and U (n,) [points]."""

    def __init__(self):
        super().__init__()
        sizes = (SIZE, *WIDTHS, 2)
        self.layers = nn.ModuleList([nn.Linear(a, b) for a, b in pairwise(sizes)])
        with torch.no_grad():  # at first P is the chance by its width, and U hardly differs
            last: nn.Module = self.layers[-1]
            assert isinstance(last, nn.Linear)
            last.weight.mul_(0.1)

    def forward(self, seen):
        """One pass."""
        x = seen
        for layer in self.layers[:-1]:
            x = torch.relu(layer(x))
        p, u = self.layers[-1](x).unbind(1)
        return seen[:, LOGIT] + p, POINTS * nn.functional.softplus(u)


class Value:
    """The value [points] of positions by a ``ValueNetwork``: called with n ``Positions``, it returns float32 (n,).

    Parameters
    ----------
    network : ValueNetwork
        Its present weights are copied.
    spread : float
        Standard deviation of the cue ball's direction [rad], of ``planning.spread_of``.
    threads : int
        Number of threads for the features.
    """

    def __init__(self, network, spread, threads=1):
        self._layers = [(layer.weight.detach().numpy().T.copy(), layer.bias.detach().numpy().copy()) for layer in network.layers]
        self.spread, self.threads = spread, threads

    def __call__(self, at):
        return self.of(value_features(at, self.spread, self.threads))

    def of(self, seen):
        """The values of features (n, SIZE)."""
        x = seen
        for weight, bias in self._layers[:-1]:
            x = x @ weight
            x += bias
            np.maximum(x, 0.0, out=x)
        weight, bias = self._layers[-1]
        p, u = (x @ weight + bias).T
        return POINTS * np.logaddexp(0.0, u) / (1.0 + np.exp(-(seen[:, LOGIT] + p)))
