"""How are choices, values and gradients of ``TablePolicy`` computed quickly? In blocks that fit into the cache.

PyTorch spends most of its time moving intermediate results through memory. Here, kernels do everything between the
layers, ``BLOCK`` tables at a time, in arrays that are made once; the gradient is written by hand. In play, the same
network is a ``StrokePolicy``, whose scores of a table do not depend on other tables.
tests/agents/learning/test_fused.py compares everything with PyTorch.
"""

from threading import Lock
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import torch

from snooker_env.game import N_BALLS
from snooker_env.planning.learned import stroke_policy
from snooker_env.planning.learned.dense_layers import relu
from snooker_env.planning.learned.stroke_policy import (
    BALL_INPUTS,
    BLOCK,
    POT_ENTRIES,
    SCORED,
    STATE,
    StrokePolicy,
)
from snooker_env.tasks import CHOICES, POTS

from . import fused_kernels as kernels


class Rollout(NamedTuple):
    """A rollout of n tables, with the actions played."""

    seen: np.ndarray
    """float32 (n, SHOWN), as in ``FusedTable.act``."""
    masks: np.ndarray
    """bool (n, CHOICES)."""
    actions: np.ndarray
    """int64 (n,)."""
    before: np.ndarray
    """Logarithms of the old probabilities; like the next two, float32 (n,)."""
    advantages: np.ndarray
    returns: np.ndarray


class Loss(NamedTuple):
    """The constants of PPO's loss."""

    clip: float
    entropy_weight: float
    value_weight: float


class FusedTable:
    """Passes through a ``TablePolicy`` with its current weights. Only one thread at a time may compute."""

    def __init__(self, policy):
        reader, value = policy.features_extractor, policy.value_net.value
        layers = {}
        for name, net in {"ball": reader.ball, "pot": reader.pot, "context": reader.context}.items():
            layers |= {f"{name}_1": net[0], f"{name}_2": net[2]}
        layers |= {"shared": reader.joint[0], "joint": reader.joint[1], "scores": policy.action_net.score}
        layers |= {"value_1": value[0], "value_2": value[2]}
        self.parameters = [p for layer in layers.values() for p in (layer.weight, layer.bias)]
        ends = np.cumsum([p.numel() for p in self.parameters]).tolist()
        self.gradient = torch.zeros(ends[-1])
        """The gradient of all parameters in one array; ``zero_grad`` makes their ``grad`` views of it."""
        pairs = zip(self.parameters, ends, strict=True)
        self._views = [self.gradient[end - p.numel() : end].view_as(p) for p, end in pairs]
        self._layers = {}
        for k, (name, layer) in enumerate(layers.items()):
            d_weight, d_bias = self._views[2 * k : 2 * k + 2]
            wider = SCORED if name == "scores" else None
            self._layers[name] = _Layer(layer, d_weight, d_bias, wider)
        self._blocks, self._lock = {}, Lock()

    def zero_grad(self):
        """Set the gradient to 0."""
        self.gradient.zero_()
        for p, view in zip(self.parameters, self._views, strict=True):
            p.grad = view

    @property
    def policy(self):
        """The ``StrokePolicy`` with the current weights, which plays for this network."""
        parameters = [p.detach().numpy() for p in self.parameters]
        pairs = zip(parameters[::2], parameters[1::2], strict=True)
        return StrokePolicy(dict(zip(self._layers, pairs, strict=True)))

    def scores(self, seen, masks):
        """The scores of all choices (n, CHOICES), ``NEVER`` if unavailable. Arguments as in ``act``."""
        return self.policy.scores(seen, masks)

    def act(self, seen, masks, uniform):
        """Draw for n tables. Returns choices int64, values and logarithms of their probabilities float32, each (n,).

        seen float32 (n, SHOWN), masks bool (n, CHOICES), uniform (n,) in [0, 1): the random numbers.
        """
        n = len(seen)
        choices, values, logs = np.empty(n, np.int64), np.empty(n, np.float32), np.empty(n, np.float32)
        with self._lock, torch.no_grad():
            for b, rows in self._blocks_of(np.arange(n)):
                here = slice(rows[0], rows[-1] + 1)
                self._forward(b, rows, seen, masks)
                kernels.draw(b.likely_, uniform[here], b.sides, choices[here])
                kernels.log_probabilities(b.by_table_, b.likely_, b.sides, choices[here], logs[here])
                values[here] = b.value_2_[:, 0]
        return choices, values, logs

    def ppo_gradient(self, rows, rollout, loss):
        """Add the gradient of PPO's loss on the rows (int64) of a rollout to the parameters' ``grad``.

        Returns means over these rows: the policy's loss, the squared error of the values, the entropy, the share
        of clipped ratios and the approximate KL divergence.
        """
        seen, masks, *played = rollout
        sums, size = np.zeros(5), len(rows)
        with self._lock, torch.no_grad():
            for b, here in self._blocks_of(rows):
                m = self._forward(b, here, seen, masks)
                torch.sum(torch.mul(b.likely, b.by_table, out=b.d_by_table), 1, out=b.mean)
                passed = b.by_table_, b.likely_, b.mean_, b.sides, b.value_2_
                wanted = b.d_by_table_, b.d_value_2_
                kernels.ppo_gradient(here, passed, tuple(played), tuple(loss), size, wanted, sums)
                self._backward(b, m)
        return sums / size

    def _blocks_of(self, rows):
        """Yield the arrays for each ``BLOCK`` of the rows, and these rows, after taking the current weights."""
        for layer in self._layers.values():
            layer.refresh()
        for start in range(0, len(rows), BLOCK):
            here = rows[start : start + BLOCK]
            yield self._block(len(here)), here

    def _block(self, n):
        if n not in self._blocks:
            whole = {k: b for k, b in self._blocks.items() if k == BLOCK}
            self._blocks = whole | {n: _Block(n, self._layers)}
        return self._blocks[n]

    def _forward(self, b, rows, seen, masks):
        """Compute the results of all layers for the tables seen[rows]. Returns their numbers of object balls."""
        layers = self._layers
        read = b.balls_, b.group, b.first, b.pots_, b.context_, b.sides
        m = stroke_policy.read_tables(rows, seen, read, b.at)
        layers["ball_2"](_relu(layers["ball_1"](b.balls_[:m], b.ball_1_[:m])), b.ball_2_[:m])
        stroke_policy.sum_balls(b.ball_2_, b.group, b.first, b.context_, b.width)
        layers["pot_2"](_relu(layers["pot_1"](b.pots_, b.pot_1_)), b.pot_2_)
        stroke_policy.sum_pots(b.pot_2_, b.pots_, b.context_, 3 * b.width)
        _relu(layers["context_2"](_relu(layers["context_1"](b.context_, b.context_1_)), b.context_2_))
        layers["shared"](b.context_2_, b.shared_)
        layers["joint"](b.pot_2_, b.joint_)
        stroke_policy.join(b.joint_, b.shared_, b.pots_)
        layers["scores"](b.joint_, b.scores_)
        stroke_policy.mask_scores(rows, masks, b.sides, b.scores_, b.by_table_)
        layers["value_2"](_relu(layers["value_1"](b.context_2_, b.value_1_)), b.value_2_)
        torch.softmax(b.by_table, 1, out=b.likely)
        return m

    def _learn(self, name, d, x):
        """Add the gradients of a layer's weights, from its input and the gradient of its result."""
        layer = self._layers[name]
        layer.d_weight.addmm_(d.t(), x)
        layer.d_bias.add_(d.sum(0))

    def _learn_first(self, name, d, x):
        """The same for a layer with few inputs, where this order is five times as fast."""
        layer = self._layers[name]
        layer.d_turned.addmm_(x.t(), d)
        layer.d_bias.add_(d.sum(0))

    def _back(self, name, d, out):
        """The gradient with respect to a layer's input."""
        return torch.mm(d, self._layers[name].weight, out=out)

    def _backward(self, b, m):
        """Add the gradients of all weights, from those of the scores and values."""
        n = len(b.first) - 1
        self._learn("scores", b.d_scores, b.joint)
        self._back("scores", b.d_scores, b.d_joint)
        kernels.part(b.d_joint_, b.joint_, b.d_shared_)
        self._learn("joint", b.d_joint, b.pot_2)
        self._learn("shared", b.d_shared, b.context_2)
        self._learn("value_2", b.d_value_2, b.value_1)
        self._back("value_2", b.d_value_2, b.d_value_1)
        kernels.cut_off(b.d_value_1_, b.value_1_, n)
        self._learn("value_1", b.d_value_1, b.context_2)
        self._back("value_1", b.d_value_1, b.d_context_2).addmm_(b.d_shared, self._layers["shared"].weight)
        kernels.cut_off(b.d_context_2_, b.context_2_, n)
        self._learn("context_2", b.d_context_2, b.context_1)
        self._back("context_2", b.d_context_2, b.d_context_1)
        kernels.cut_off(b.d_context_1_, b.context_1_, n)
        self._learn("context_1", b.d_context_1, b.context)
        torch.mm(b.d_context_1, self._layers["context_1"].weight[:, : b.at], out=b.d_context)
        self._back("joint", b.d_joint, b.d_pot_2)
        kernels.spread_to_pots(b.d_pot_2_, b.pot_2_, b.d_context_, 3 * b.width)
        self._learn("pot_2", b.d_pot_2, b.pot_1)
        self._back("pot_2", b.d_pot_2, b.d_pot_1)
        kernels.cut_off(b.d_pot_1_, b.pot_1_, n * POTS)
        self._learn_first("pot_1", b.d_pot_1, b.pots)
        kernels.spread_to_balls(b.d_context_, b.group, b.first, b.ball_2_, b.width, b.d_ball_2_)
        self._learn("ball_2", b.d_ball_2[:m], b.ball_1[:m])
        self._back("ball_2", b.d_ball_2[:m], b.d_ball_1[:m])
        kernels.cut_off(b.d_ball_1_, b.ball_1_, m)
        self._learn_first("ball_1", b.d_ball_1[:m], b.balls[:m])


class _Layer:
    """A linear layer, its weights and their gradients, without autograd."""

    def __init__(self, layer, d_weight, d_bias, columns=None):
        self.weight, self._bias = layer.weight.detach(), layer.bias.detach()
        self.outputs = int(layer.out_features)
        columns = columns or self.outputs
        self._copies = np.zeros((layer.in_features, columns), np.float32), np.zeros(columns, np.float32)
        self._turned, self._bias_turned = map(torch.from_numpy, self._copies)
        self.d_weight, self.d_bias, self.d_turned = d_weight, d_bias, d_weight.t()

    def refresh(self):
        """Take the current weights."""
        weight, bias = self._copies
        weight[:, : self.outputs], bias[: self.outputs] = self.weight.numpy().T, self._bias.numpy()

    def __call__(self, rows, out):
        """Write and return the results for each row. The last bits depend on the number of rows."""
        torch.addmm(self._bias_turned, torch.from_numpy(rows), self._turned, out=torch.from_numpy(out))
        return out


def _relu(x):
    relu(x)
    return x


class _Block(SimpleNamespace):
    """Make arrays for n tables: each layer's result by name, gradients with prefix ``d_``, NumPy views with ``_``."""

    def __init__(self, n: int, layers: dict[str, _Layer]):
        most = n * (N_BALLS - 1)
        of_pots = {name: n * POTS for name in ("pot_1", "pot_2", "joint", "scores")}
        rows = {"ball_1": most, "ball_2": most} | of_pots  # other layers have n rows
        made = {name: torch.zeros(rows.get(name, n), layer.outputs) for name, layer in layers.items()}
        made |= {f"d_{name}": torch.zeros_like(array) for name, array in made.items()}
        width = layers["ball_2"].outputs
        at = 3 * width + layers["pot_2"].outputs  # start of the game's state in the input of the context
        made["balls"], made["pots"] = torch.zeros(most, BALL_INPUTS), torch.zeros(n * POTS, POT_ENTRIES)
        made["context"], made["d_context"] = torch.zeros(n, at + STATE + 3), torch.zeros(n, at)
        made["scores"] = torch.zeros(n * POTS, SCORED)  # wider than its gradient
        made["by_table"], made["d_by_table"] = torch.zeros(n, CHOICES), made["d_scores"].view(n, CHOICES)
        made["likely"], made["mean"] = torch.zeros(n, CHOICES), torch.zeros(n)
        super().__init__(**made, **{f"{name}_": array.numpy() for name, array in made.items()})
        self.width, self.at = width, at
        self.group, self.first = np.zeros(most, np.int64), np.zeros(n + 1, np.int64)
        self.sides = np.zeros(n, np.float32)
