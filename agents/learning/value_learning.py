"""How is the value of a position learned? By backups over noise samples, corrected by the actual continuation.

The target of a position is the mean of points plus the value of the afterstate, over fresh noise samples of the best
stroke; reusing the samples that chose the stroke would bias the target upwards. The actual continuation corrects it with
weight ``LAMBDA``, but not beyond an exploratory stroke (Watkins' Q(lambda)), because a visit's returns alone are too
noisy. Features of afterstates are kept, so that targets follow the network.
"""

from collections import deque
from typing import Any

import numpy as np
import torch

from snooker_env.planning.learned.value_features import SIZE

from .value_network import value_of

LAMBDA = 0.7
KEPT = 81_920
"""Positions that gradient steps are drawn from."""
REFRESH = 8
"""Rounds between two computations of the targets."""
BATCH, EACH, RATE = 1024, 32, 2e-3
"""Positions per batch, new positions per gradient step, and the first learning rate."""
FIRST_STEPS, FIRST_GUESS = 25, 25.0
"""Factor of gradient steps the first time; points after a kept position in the first targets."""


class ValueLearning:
    """Fits a ``ValueNetwork`` to rounds of n positions."""

    def __init__(self, network, spread, n, rng):
        self._network, self._spread, self._n, self._rng = network, spread, n, rng
        self._optimizer = torch.optim.Adam(network.parameters(), RATE)
        self._rounds, self._age = [], 0
        self._fitted: tuple[Any, ...] = ()
        """Features, targets and shares of samples that scored, for the rounds at the last refresh."""
        self.losses = deque(maxlen=100)

    def add(self, seen, after, points, goes_on, follows):
        """Keep a round: features (n, SIZE) of positions and (n, s, SIZE) of the afterstates of s samples, points and
        whether visits continued (n, s), and whether the first sample was actually played (n,)."""
        self._rounds.append((seen.astype(np.float16), after, points.astype(np.float32), goes_on, follows))
        del self._rounds[: -max(1, KEPT // self._n)]

    def value(self):
        """The current value."""
        return value_of(self._network, self._spread)

    def fit(self, remaining):
        """Take the gradient steps for one round; ``remaining``: share of the training left."""
        first = not self._fitted
        if first or self._age % REFRESH == 0:
            targets = self._returns() if first else self._targets()
            made = np.concatenate([(points > 0).mean(axis=1) for _, _, points, _, _ in self._rounds])
            self._fitted = np.concatenate([one[0] for one in self._rounds]), targets, made.astype(np.float32)
        self._age += 1
        for group in self._optimizer.param_groups:
            group["lr"] = RATE * max(0.02, remaining)
        members = self._network.members
        for _ in range(max(1, self._n // EACH) * (FIRST_STEPS if first else 1)):
            # one batch for each member
            rows = self._rng.integers(len(self._fitted[0]), size=(members, BATCH))
            seen, target, made = (torch.from_numpy(one[rows].astype(np.float32)) for one in self._fitted)
            logit, follows = self._network(seen)
            error = (torch.sigmoid(logit) * follows - target) / 20.0  # typical error of a target in points
            chance = torch.nn.functional.binary_cross_entropy_with_logits(logit, made)
            loss = error.square().mean() + 0.3 * chance
            self._optimizer.zero_grad()
            # the sum over the members, so that each gets the gradient of its own mean
            (members * loss).backward()
            torch.nn.utils.clip_grad_norm_(self._network.parameters(), members**0.5)
            self._optimizer.step()
            self.losses.append(loss.item())
        self._optimizer.zero_grad()  # leave no gradients behind, because PPO clips by the norm of all

    @property
    def mean_target(self):
        """Mean target of the last fitted round [points]; None before the first."""
        return float(self._fitted[1][-self._n :].mean()) if self._fitted else None

    def _returns(self):
        """First targets: points of the samples, and the actual continuation as far as it is known."""
        later, targets = np.full(self._n, FIRST_GUESS, np.float32), []
        for _, _, points, goes_on, follows in reversed(self._rounds):
            targets.append(points.mean(axis=1) + goes_on.mean(axis=1) * np.where(follows, later, FIRST_GUESS))
            later = targets[-1]
        return np.concatenate(targets[::-1]).astype(np.float32)

    def _targets(self):
        """Targets of all kept rounds, by the current network."""
        value, correction, targets = self.value(), np.zeros(self._n, np.float32), []
        for seen, after, points, goes_on, follows in reversed(self._rounds):
            left = value.of(after.reshape(-1, SIZE).astype(np.float32)).reshape(goes_on.shape)
            targets.append((points + goes_on * left).mean(axis=1) + LAMBDA * follows * correction)
            correction = targets[-1] - value.of(seen.astype(np.float32))
        return np.concatenate(targets[::-1]).astype(np.float32)

    def get_state(self):
        """Everything but the network."""
        state = {"rounds": self._rounds, "age": self._age, "fitted": self._fitted}
        return state | {"losses": list(self.losses), "optimizer": self._optimizer.state_dict()}

    def set_state(self, state):
        """Continue from a state of ``get_state``."""
        self._rounds, self._age, self._fitted = list(state["rounds"]), state["age"], state["fitted"]
        self.losses.extend(state["losses"])
        self._optimizer.load_state_dict(state["optimizer"])
