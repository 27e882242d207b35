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
MEMBERS = 4
"""Number of networks whose mean is the value: each starts and learns apart, and errors that they do not share cancel."""
POINTS = 40.0
"""Unit of U [points]."""


class ValueNetwork(nn.Module):
    """Features (members, n, SIZE) or (n, SIZE) -> logits of P and U [points], each (members, n)."""

    def __init__(self, members=MEMBERS):
        super().__init__()
        self.members = members
        sizes = (SIZE, *WIDTHS, 2)
        self.weights, self.biases = nn.ParameterList(), nn.ParameterList()
        for a, b in pairwise(sizes):
            reach = a**-0.5  # as nn.Linear
            self.weights.append(nn.Parameter(torch.empty(members, a, b).uniform_(-reach, reach)))
            self.biases.append(nn.Parameter(torch.empty(members, 1, b).uniform_(-reach, reach)))
        with torch.no_grad():  # at first P is the chance by its width, and U hardly differs
            self.weights[-1].mul_(0.1)

    def forward(self, seen):
        """One pass."""
        x = seen
        for weight, bias in zip(self.weights[:-1], self.biases[:-1], strict=True):
            x = torch.relu(x @ weight + bias)
        p, u = (x @ self.weights[-1] + self.biases[-1]).unbind(-1)
        return seen[..., LOGIT] + p, POINTS * nn.functional.softplus(u)


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
        pairs = zip(network.weights, network.biases, strict=True)
        self._layers = [(weight.detach().numpy().copy(), bias.detach().numpy().copy()) for weight, bias in pairs]
        self.spread, self.threads, self._members = spread, threads, network.members

    def __call__(self, at):
        return self.of(value_features(at, self.spread, self.threads))

    def of(self, seen):
        """The values of features (n, SIZE)."""
        total = np.zeros(len(seen), np.float32)
        for k in range(self._members):
            x = seen
            for weight, bias in self._layers[:-1]:
                x = x @ weight[k]
                x += bias[k]
                np.maximum(x, 0.0, out=x)
            weight, bias = self._layers[-1]
            p, u = (x @ weight[k] + bias[k]).T
            total += POINTS * np.logaddexp(0.0, u) / (1.0 + np.exp(-(seen[:, LOGIT] + p)))
        return total / self._members
