"""How are networks learned from rounds of self-play? Each round plays with what the earlier rounds have learned.

A folder holds the data of each round and the weights learned after it, from which a run can continue.
"""

import json
from itertools import pairwise

import numpy as np
import torch
from torch import nn

from agents._lib.files import keep_arrays, kept_arrays, strict_json
from snooker_env.checks import refuse

from .loop import Part

RATE = 2e-3
"""The highest learning rate of ``descend``."""


class Rounds(Part):
    """``many`` rounds of ``tables`` tables in ``parts`` parts, kept in files that begin with ``name``.

    ``asked`` holds the inputs that the data depend on. A subclass has ``parts_of``, ``fit`` and ``take``."""

    unit, now = "tables", "these tables"

    def __init__(self, out, name, many, tables, parts, asked):
        self.out, self.name, self.many, self.tables, self.parts = out, name, many, tables, parts
        self.total, self.rounds, self.curve = many * tables, [], []
        self._asked, self._playing, self._played = [*map(str, asked)], None, []

    def parts_of(self, k):
        """Yield the data of each part of round k: a dict of arrays."""
        raise NotImplementedError

    def fit(self):
        """Learn from ``rounds``. Returns a dict of arrays, and figures."""
        raise NotImplementedError

    def take(self, arrays):
        """Use what was learned in the next rounds."""
        raise NotImplementedError

    @property
    def done(self):
        return len(self.rounds) * self.tables + len(self._played) * self.tables // self.parts

    def restore(self):
        """Read the rounds in the folder. Raises ValueError."""
        while len(self.rounds) < self.many and self._file().is_file():
            rows = kept_arrays(self._file())
            asked = rows.pop("asked").tolist()
            if asked != self._asked:
                raise refuse(
                    "out", str(self.out), "must hold rounds of this version and of the same settings"
                )
            self._learn(rows)

    def round(self):
        """Play a part, and learn after the last part of a round."""
        self._playing = self._playing or self.parts_of(len(self.rounds))
        self._played.append(next(self._playing))
        if len(self._played) == self.parts:
            rows = {key: np.concatenate([one[key] for one in self._played]) for key in self._played[0]}
            keep_arrays(self._file(), rows | {"asked": np.array(self._asked)})
            self._playing, self._played = None, []
            self._learn(rows)

    def _file(self, what=""):
        return self.out / f"{self.name}-{len(self.rounds)}{what}.npz"

    def _learn(self, rows):
        file = self._file("-weights")
        self.rounds.append(rows)
        if file.is_file():
            arrays = kept_arrays(file)
            figures = strict_json(str(arrays.pop("figures")))
        else:
            arrays, figures = self.fit()
            keep_arrays(file, arrays | {"figures": np.array(json.dumps(figures))})
        self.take(arrays)
        self.curve.append(figures)


def shares_of_parts(rng, parts):
    """The place of each part of a round in the range of errors, 0 to 1: evenly spread, at random within its interval."""
    return (np.arange(parts) + rng.random(parts)) / parts


def arrays_of(name, layers):
    """The arrays of a network for a file that ``snooker_env.players.weights`` reads."""
    made = {f"{name}/{k}/weight": weight.astype(np.float32) for k, (weight, _) in enumerate(layers)}
    return made | {f"{name}/{k}/bias": bias.astype(np.float32) for k, (_, bias) in enumerate(layers)}


class Perceptron(nn.Sequential):
    """Linear layers of these sizes with ReLUs between them."""

    def __init__(self, *sizes):
        parts = [nn.Linear(a, b) for a, b in pairwise(sizes)]
        super().__init__(*[part for one in parts for part in (one, nn.ReLU())][:-1])

    def arrays(self):
        """Weight (out, in) and bias (out,) of each layer."""
        linear = [one for one in self if isinstance(one, nn.Linear)]
        return [(one.weight.detach().numpy().copy(), one.bias.detach().numpy().copy()) for one in linear]


def descend(network, loss_of, rows, rng, passes, batch, decay, **schedule):
    """Fit a network with ``passes`` passes over ``rows`` in random batches; ``loss_of(rows)`` is the mean loss of some."""
    batch = min(batch, len(rows))
    steps = max(
        20, passes * (len(rows) // batch)
    )  # with 10 steps, OneCycleLR's warm-up of a tenth would end where it begins
    optimiser = torch.optim.AdamW(network.parameters(), lr=RATE, weight_decay=decay)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, RATE, total_steps=steps, **schedule)
    for _ in range(passes):
        order = torch.from_numpy(rng.permutation(rows))
        for k in range(0, batch * (len(rows) // batch), batch):
            loss = loss_of(order[k : k + batch])
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
            schedule.step()
