"""How are the scores, values and gradients of ``TablePolicy`` computed quickly? In blocks of tables that stay in the processor's cache.

The plain networks (``networks.TableReader`` and its heads) spend most of their time on moving intermediate results through memory, and on
operations that PyTorch cannot join. Here the same functions are computed for ``BLOCK`` tables at a time, in arrays that are made once:
PyTorch multiplies matrices, the kernels of ``fused_kernels`` do all that lies between. The gradient is written out by hand, layer by
layer; tests/agents/learning/test_fused.py compares both with PyTorch's own.
"""

import numpy as np
import torch

from snooker_env.tasks import CHOICES, POTS, STROKES

from ..features.pot_features import POT_ENTRIES
from . import fused_kernels as kernels
from .fused_kernels import BALL_INPUTS, NEVER, STATE

BLOCK = 128
"""Tables of a block: their intermediate results take 2.5 MB."""
_BALLS = 21


class FusedTable:
    """Passes through the network of a ``TablePolicy``, with its present weights."""

    def __init__(self, policy):
        reader, value = policy.features_extractor, policy.value_net.value
        self._layers = {
            "ball_1": reader.ball[0], "ball_2": reader.ball[2], "pot_1": reader.pot[0], "pot_2": reader.pot[2],
            "context_1": reader.context[0], "context_2": reader.context[2], "joint_context": reader.joint[0], "joint_pot": reader.joint[1],
            "score": policy.action_net.score, "value_1": value[0], "value_2": value[2],
        }  # fmt: skip
        self.parameters = [p for layer in self._layers.values() for p in (layer.weight, layer.bias)]
        width = {name: layer.out_features for name, layer in self._layers.items()}
        self._ball, self._pot = width["ball_2"], width["pot_2"]
        self._at = 3 * self._ball + self._pot  # of the state in the input of the context
        rows = {"ball": BLOCK * _BALLS, "pot": BLOCK * POTS, "score": BLOCK * POTS, "joint_pot": BLOCK * POTS}
        self._a = {}  # results of the layers, and the gradients with respect to them
        self._d = {}
        for name, columns in width.items():
            n = rows.get(name, rows.get(name.partition("_")[0], BLOCK))
            self._a[name], self._d[name] = torch.zeros(n, columns), torch.zeros(n, columns)
        self._in = {
            "balls": torch.zeros(BLOCK * _BALLS, BALL_INPUTS), "pots": torch.zeros(BLOCK * POTS, POT_ENTRIES),
            "context": torch.zeros(BLOCK, self._at + STATE + 3), "d_context": torch.zeros(BLOCK, self._at),
            "likely": torch.zeros(BLOCK, CHOICES), "weighted": torch.zeros(BLOCK, CHOICES), "top": torch.zeros(BLOCK),
            "total": torch.zeros(BLOCK), "mean": torch.zeros(BLOCK), "scores": torch.zeros(BLOCK, CHOICES),
            "masks": torch.zeros(BLOCK, CHOICES, dtype=torch.bool),
        }  # fmt: skip
        self._group, self._first = np.zeros(BLOCK * _BALLS, np.int64), np.zeros(BLOCK + 1, np.int64)
        self._sides = np.zeros(BLOCK, np.float32)
        self._never = torch.tensor(NEVER)

    # forward -----------------------------------------------------------------------------------------------------------------------

    def _linear(self, name, x, n):
        layer, out = self._layers[name], self._a[name][:n]
        return torch.addmm(layer.bias, x, layer.weight.t(), out=out)

    def _read(self, rows, seen, masks):
        """One block: the results of all layers, and the likelihoods of the choices that are available."""
        n, a, i = len(rows), self._a, {name: part.numpy() for name, part in self._in.items()}
        first, sides = self._first[: n + 1], self._sides[:n]
        m = kernels.read_tables(rows, seen, i["balls"], self._group, first, i["pots"], i["context"], self._at, sides)
        context = self._in["context"][:n]
        self._linear("ball_1", self._in["balls"][:m], m).relu_()
        codes = self._linear("ball_2", a["ball_1"][:m], m)
        kernels.sum_balls(codes.numpy(), self._group, first, i["context"], self._ball)
        self._linear("pot_1", self._in["pots"][: n * POTS], n * POTS).relu_()
        codes = self._linear("pot_2", a["pot_1"][: n * POTS], n * POTS)
        kernels.sum_pots(codes.numpy(), i["pots"], i["context"][:n], 3 * self._ball)
        self._linear("context_1", context, n).relu_()
        read = self._linear("context_2", a["context_1"][:n], n).relu_()
        shared = self._linear("joint_context", read, n)
        layer = self._layers["joint_pot"]
        joint = torch.mm(codes, layer.weight.t(), out=a["joint_pot"][: n * POTS])
        kernels.join(joint.numpy(), shared.numpy(), layer.bias.detach().numpy(), i["pots"])
        self._linear("score", joint, n * POTS)
        self._linear("value_1", read, n).relu_()
        self._linear("value_2", a["value_1"][:n], n)
        kernels.turn_masks(rows, masks, sides, i["masks"])
        scores = torch.where(self._in["masks"][:n], a["score"][: n * POTS].view(n, POTS * STROKES), self._never, out=self._in["scores"][:n])
        top = torch.amax(scores, 1, out=self._in["top"][:n])
        likely = torch.sub(scores, top[:, None], out=self._in["likely"][:n]).exp_()
        torch.sum(likely, 1, out=self._in["total"][:n])
        return m

    def act(self, seen, masks, uniform):
        """Choices drawn for n tables (int64), the values and the logarithms of the choices' probabilities (float32), each (n,).

        seen (n, SHOWN), masks (n, CHOICES), uniform (n,) in [0, 1): the random numbers.
        """
        choices, values, chances = np.empty(len(seen), np.int64), np.empty(len(seen), np.float32), np.empty(len(seen), np.float32)
        with torch.no_grad():
            for start in range(0, len(seen), BLOCK):
                here = slice(start, min(start + BLOCK, len(seen)))
                rows = np.arange(here.start, here.stop)
                self._read(rows, seen, masks)
                n = len(rows)
                scores, likely, top, total = (self._in[name][:n].numpy() for name in ("scores", "likely", "top", "total"))
                kernels.draw(likely, total, uniform[here], self._sides, choices[here])
                kernels.log_probabilities(scores, top, total, self._sides, choices[here], chances[here])
                values[here] = self._a["value_2"][:n, 0].numpy()
        return choices, values, chances

    # backward ----------------------------------------------------------------------------------------------------------------------

    def _learn(self, name, d, x):
        """Add the gradients of a layer's weights, given that of its result and its input."""
        layer = self._layers[name]
        torch.addmm(layer.weight.grad, d.t(), x, out=layer.weight.grad)
        layer.bias.grad += d.sum(0)

    def _back(self, name, d, out):
        """The gradient with respect to a layer's input."""
        return torch.mm(d, self._layers[name].weight, out=out)

    def _propagate(self, n, m):
        """One block: add the gradients of all weights, given those of the scores and values in ``_d``."""
        a, d, i, k = self._a, self._d, self._in, n * POTS
        codes, joint, read, pots = a["pot_2"][:k], a["joint_pot"][:k], a["context_2"][:n], i["pots"].numpy()
        first, d_context = self._first[: n + 1], i["d_context"][:n]
        self._learn("score", d["score"][:k], joint)
        d_joint = self._back("score", d["score"][:k], d["joint_pot"][:k])
        d_shared = d["joint_context"][:n]
        kernels.part(d_joint.numpy(), joint.numpy(), d_shared.numpy())
        self._learn("joint_pot", d_joint, codes)
        self._learn("joint_context", d_shared, read)
        self._learn("value_2", d["value_2"][:n], a["value_1"][:n])
        d_value = self._back("value_2", d["value_2"][:n], d["value_1"][:n])
        kernels.cut_off(d_value.numpy(), a["value_1"].numpy())
        self._learn("value_1", d_value, read)
        d_read = self._back("value_1", d_value, d["context_2"][:n])
        torch.addmm(d_read, d_shared, self._layers["joint_context"].weight, out=d_read)
        kernels.cut_off(d_read.numpy(), read.numpy())
        self._learn("context_2", d_read, a["context_1"][:n])
        d_first = self._back("context_2", d_read, d["context_1"][:n])
        kernels.cut_off(d_first.numpy(), a["context_1"].numpy())
        self._learn("context_1", d_first, i["context"][:n])
        torch.mm(d_first, self._layers["context_1"].weight[:, : self._at], out=d_context)
        d_codes = self._back("joint_pot", d_joint, d["pot_2"][:k])
        kernels.spread_to_pots(d_codes.numpy(), codes.numpy(), d_context.numpy(), 3 * self._ball)
        self._learn("pot_2", d_codes, a["pot_1"][:k])
        d_hidden = self._back("pot_2", d_codes, d["pot_1"][:k])
        kernels.cut_off(d_hidden.numpy(), a["pot_1"].numpy())
        self._learn("pot_1", d_hidden, i["pots"][:k])
        kernels.spread_to_balls(d_context.numpy(), self._group, first, a["ball_2"].numpy(), self._ball, d["ball_2"].numpy())
        self._learn("ball_2", d["ball_2"][:m], a["ball_1"][:m])
        d_hidden = self._back("ball_2", d["ball_2"][:m], d["ball_1"][:m])
        kernels.cut_off(d_hidden.numpy(), a["ball_1"].numpy())
        self._learn("ball_1", d_hidden, i["balls"][:m])

    def ppo_gradient(self, rows, seen, masks, actions, before, advantages, returns, clip, entropy_weight, value_weight):
        """Add the gradient of PPO's loss on the minibatch ``rows`` of a rollout to the ``grad`` of all parameters.

        seen (n, SHOWN), masks (n, CHOICES), actions, before (logarithms of the old probabilities), advantages and returns (n,) are those
        of the whole rollout. Returns the means, over the minibatch, of the policy's loss, the squared error of the values, the entropy, the
        share of clipped ratios and the approximate KL divergence.
        """
        sums, batch = np.zeros(5), len(rows)
        with torch.no_grad():
            for start in range(0, batch, BLOCK):
                here = rows[start : start + BLOCK]
                n = len(here)
                m = self._read(here, seen, masks)
                i = {name: part[:n] for name, part in self._in.items()}
                torch.mul(i["likely"], i["scores"], out=i["weighted"])
                torch.sum(i["weighted"], 1, out=i["mean"])
                kernels.ppo_gradient(
                    here, *(i[name].numpy() for name in ("scores", "top", "likely", "total", "mean")), self._sides,
                    self._a["value_2"][:n, 0].numpy(), actions, before, advantages, returns, clip, entropy_weight, value_weight, batch,
                    self._d["score"][: n * POTS].view(n, CHOICES).numpy(), self._d["value_2"][:n, 0].numpy(), sums,
                )  # fmt: skip
                self._propagate(n, m)
        return sums / batch
