"""How is the value of a position computed? V = P x U: the chance that the next stroke scores, times what the visit then brings.

One small network with two outputs (``ValueNetwork``). P starts from the likeliest pot's chance by its width; U is positive. It is trained
with torch; ``Value`` plays the same weights by ``dense_layers``.
"""

from itertools import pairwise

import numpy as np
import torch
from torch import nn

from ..features.value_features import LOGIT, SIZE, in_parts, value_features
from .dense_layers import Layers

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
    """The value [points] of positions by the present weights of a ``ValueNetwork``: called with n ``Positions``, it returns float32 (n,).

    ``spread``: standard deviation of the cue ball's direction [rad], of ``planning.spread_of``. Results do not depend on ``threads``.
    """

    def __init__(self, network, spread, threads=1):
        layers = [(weight.detach().numpy(), bias.detach().numpy()) for weight, bias in zip(network.weights, network.biases, strict=True)]
        self._members = [Layers([(weight[k].T, bias[k, 0]) for weight, bias in layers], "relu") for k in range(network.members)]
        self.spread, self.threads = spread, threads

    def __call__(self, at):
        return self.of(value_features(at, self.spread, self.threads))

    def of(self, seen):
        """The values of features (n, SIZE)."""
        values = np.empty(len(seen), np.float32)
        in_parts(len(seen), self.threads, lambda rows: self._write(seen[rows], values[rows]))
        return values

    def _write(self, seen, values):
        values[:] = 0.0
        for member in self._members:
            p, u = member(seen).T
            values += POINTS * np.logaddexp(0.0, u) / (1.0 + np.exp(-(seen[:, LOGIT] + p)))
        values /= len(self._members)
