"""How is the value of a position computed? V = P x U: the chance to score, times the points of the visit if it does.

One small network with two outputs (``ValueNetwork``). P starts from the chance of the likeliest pot by its width;
U is positive. It is trained with torch; ``snooker_env.planning.learned.learned_worth`` plays the same weights.
"""

from itertools import pairwise

import torch
from torch import nn

from snooker_env.planning.learned.learned_worth import POINTS, LearnedValue
from snooker_env.planning.learned.value_features import LOGIT, SIZE

WIDTHS = (160, 96)
MEMBERS = 4
"""Networks whose mean is the value. Each learns separately, so that independent errors cancel."""


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
        with torch.no_grad():  # at first P is the chance by its width, and U is nearly constant
            self.weights[-1].mul_(0.1)

    def forward(self, seen):
        x = seen
        for weight, bias in zip(self.weights[:-1], self.biases[:-1], strict=True):
            x = torch.relu(x @ weight + bias)
        p, u = (x @ self.weights[-1] + self.biases[-1]).unbind(-1)
        return seen[..., LOGIT] + p, POINTS * nn.functional.softplus(u)


def value_of(network, spread, threads=1):
    """The ``LearnedValue`` with the current weights of a ``ValueNetwork``."""
    pairs = zip(network.weights, network.biases, strict=True)
    layers = [(weight.detach().numpy(), bias.detach().numpy()) for weight, bias in pairs]
    members = [[(weight[k].T, bias[k, 0]) for weight, bias in layers] for k in range(network.members)]
    return LearnedValue(members, spread, threads)
