"""Which networks read a snooker table? Small networks shared by all balls and by all pots, sums, and a head for strokes.

The order of balls or pots must not matter, so all balls pass through one network and all pots through another
(deep sets, Zaheer et al. 2017). Masked sums of their codes and the game's state form the context. The score of a
stroke at a pot follows from that pot's code and the context, with the same weights for every pot. The table is
mirrored so that the cue ball is on the right, and the choice of side spin is mirrored back. (Yellow and green break
the symmetry, so an input gives the half with the cue ball.)
"""

from itertools import pairwise

import numpy as np
import torch
from sb3_contrib.common.maskable.policies import MaskableActorCriticPolicy
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
from torch import nn

from snooker_env.game import N_BALLS
from snooker_env.planning.learned.stroke_policy import BALL_X, CUT, LAYERS, POT_ENTRIES, POT_X, SHOWN
from snooker_env.tasks import OBSERVATION_SIZE, POTS, SIDES, SPEEDS, STROKES, TOPS

from .fused import FusedTable
from .value_network import ValueNetwork

BALL, CONTEXT, POT = 64, 128, 128
"""Widths of the codes."""
_STATE = OBSERVATION_SIZE - 5 * N_BALLS
_N_REDS = 15


def mlp(*sizes):
    """Linear layers of these sizes, each followed by a ReLU."""
    return nn.Sequential(*(layer for a, b in pairwise(sizes) for layer in (nn.Linear(a, b), nn.ReLU())))


class TableReader(BaseFeaturesExtractor):
    """(n, SHOWN) -> (n, CONTEXT + POTS * POT + 1): the context, each pot's code, and -1 if mirrored, otherwise 1."""

    def __init__(self, observation_space, width=32):
        super().__init__(observation_space, CONTEXT + POTS * POT + 1)
        self.ball = mlp(5 + 2, width, BALL)
        self.pot = mlp(POT_ENTRIES, 2 * width, POT)
        self.context = mlp(3 * BALL + POT + _STATE + 3, CONTEXT, CONTEXT)
        # one layer from both; the part of the context is shared
        self.joint = nn.ModuleList([nn.Linear(CONTEXT, POT), nn.Linear(POT, POT)])
        flips = torch.zeros(SHOWN, dtype=torch.bool)
        flips[torch.arange(N_BALLS) * 5 + BALL_X] = True
        for entry in (*POT_X, CUT):
            flips[OBSERVATION_SIZE + torch.arange(POTS) * POT_ENTRIES + entry] = True
        self.flips: torch.Tensor
        self.register_buffer("flips", flips, persistent=False)

    def forward(self, seen):
        n = len(seen)
        side = torch.where(seen[:, BALL_X : BALL_X + 1] < 0.0, -1.0, 1.0)
        seen = torch.where(self.flips, seen * side, seen)
        balls = seen[:, : 5 * N_BALLS].reshape(n, N_BALLS, 5)
        state = seen[:, 5 * N_BALLS : OBSERVATION_SIZE]
        pots = seen[:, OBSERVATION_SIZE:].reshape(n, POTS, POT_ENTRIES)
        cue = balls[:, 0, :2]
        here = (balls[:, 1:, 2:3] > 0.0).float()
        on = (balls[:, 1:, 4:5] > 0.0).float() * here
        codes = self.ball(torch.cat([balls[:, 1:], balls[:, 1:, :2] - cue[:, None]], 2)) * here
        offered = pots[:, :, :1]
        each = self.pot(pots) * offered
        sums = [(codes * on).sum(1) / 5.0, codes[:, :_N_REDS].sum(1) / 5.0, codes[:, _N_REDS:].sum(1) / 5.0]
        context = self.context(torch.cat([*sums, each.sum(1), state, cue, side], 1))
        joint = torch.relu(self.joint[0](context)[:, None] + self.joint[1](each)) * offered
        return torch.cat([context, joint.reshape(n, -1), side], 1)


class StrokeHead(nn.Module):
    """The features of ``TableReader`` -> a score for each of the POTS * STROKES choices."""

    def __init__(self):
        super().__init__()
        self.score = nn.Linear(POT, STROKES)
        with torch.no_grad():  # at first all strokes are nearly equal
            self.score.weight.mul_(0.1)
            self.score.bias.zero_()

    def forward(self, read):
        n = len(read)
        scores, side = self.score(read[:, CONTEXT:-1].reshape(n, POTS, POT)), read[:, -1:]
        turned = scores.reshape(n, POTS * len(SPEEDS), len(SIDES), len(TOPS)).flip(2).reshape(n, -1)
        return torch.where(side < 0.0, turned, scores.reshape(n, -1))


class ValueHead(nn.Module):
    """The context -> the expected return."""

    def __init__(self, width=128):
        super().__init__()
        self.value = nn.Sequential(nn.Linear(CONTEXT, width), nn.ReLU(), nn.Linear(width, 1))

    def forward(self, read):
        return self.value(read[:, :CONTEXT])


class TablePolicy(MaskableActorCriticPolicy):
    """Observes the table and its pots and scores all strokes; the value follows from the reader's context."""

    reader = TableReader
    _fused = None

    def __init__(self, *args, **kwargs):
        super().__init__(*args, **(kwargs | {"features_extractor_class": self.reader, "net_arch": []}))

    def _build(self, lr_schedule):
        super()._build(lr_schedule)
        self.action_net, self.value_net = StrokeHead(), ValueHead()
        self.optimizer = self._new_optimizer(self.parameters(), lr_schedule)

    def _new_optimizer(self, parameters, lr_schedule):
        """Adam in one call for all parameters, because 22 calls for the small arrays take ten times as long."""
        settings = {"fused": True, **self.optimizer_kwargs, "lr": lr_schedule(1)}
        return self.optimizer_class(parameters, **settings)

    @property
    def has_fused(self):
        """Whether there are fused passes; a subclass with another reader has none."""
        return self.reader is TableReader

    @property
    def fused(self):
        """The fused passes through this network."""
        at = [part.data_ptr() for part in self.parameters()]
        if self._fused is None or self._fused[0] != at:  # the passes share the memory of the weights
            self._fused = at, FusedTable(self)
        return self._fused[1]

    def __getstate__(self):
        """The state for copies and pickles, without the passes, which share the memory of these weights."""
        return {name: part for name, part in self.__dict__.items() if name != "_fused"}

    def forward(self, obs, deterministic=False, action_masks=None):
        """As in the base class, but quick with masks: it draws one PyTorch random number per table."""
        if deterministic or not self._plays(obs, action_masks):
            return super().forward(obs, deterministic, action_masks)
        choices, values, logs = self.fused.act(*_arrays(obs, action_masks), torch.rand(len(obs)).numpy())
        return torch.as_tensor(choices), torch.as_tensor(values)[:, None], torch.as_tensor(logs)

    def get_distribution(self, obs, action_masks=None):
        """As in the base class; with masks and without gradients it uses the fused passes."""
        if not self._plays(obs, action_masks):
            return super().get_distribution(obs, action_masks)
        seen, masks = _arrays(obs, action_masks)
        logits = torch.from_numpy(self.fused.scores(seen, masks))
        distribution = self.action_dist.proba_distribution(action_logits=logits)
        distribution.apply_masking(masks)
        return distribution

    def _plays(self, obs, action_masks):
        """Whether the fused passes can read these observations."""
        quick = self.has_fused and not torch.is_grad_enabled()
        return quick and action_masks is not None and obs.device.type == "cpu"


def _arrays(obs, action_masks):
    """Convert observations and masks for ``FusedTable``."""
    masks = np.ascontiguousarray(action_masks, np.bool_).reshape(len(obs), -1)
    return np.ascontiguousarray(obs.float().numpy()), masks


class JudgedPolicy(TablePolicy):
    """``TablePolicy`` with the value of positions that judges it; saved together, learned separately."""

    def _build(self, lr_schedule):
        super()._build(lr_schedule)
        by_ppo = list(self.parameters())
        self.position_value = ValueNetwork()
        self.optimizer = self._new_optimizer(by_ppo, lr_schedule)


def arrays_of(policy):
    """The arrays of a ``JudgedPolicy`` by name: {name: float32 array}."""
    parameters = [p.detach().numpy() for p in policy.fused.parameters]
    arrays = {}
    # the critic's own come last
    for name, weight, bias in zip(LAYERS, parameters[::2], parameters[1::2], strict=False):
        arrays |= {f"policy/{name}/weight": weight, f"policy/{name}/bias": bias}
    value = policy.position_value
    for k, (weight, bias) in enumerate(zip(value.weights, value.biases, strict=True)):
        arrays[f"value/{k}/weight"] = weight.detach().numpy().transpose(0, 2, 1)
        arrays[f"value/{k}/bias"] = bias.detach().numpy()[:, 0]
    return {name: np.ascontiguousarray(array, np.float32) for name, array in arrays.items()}
