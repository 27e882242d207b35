"""What network reads a snooker table? Shared small networks for each ball and each pot, sums over them, and a head that scores every stroke of every pot.

The order of balls or pots must not matter, so each ball's row goes through one network and each pot's through another (deep sets [Zaheer et
al. 2017]); sums of the balls' codes and the game's state make the context. The policy's score of a stroke at a pot comes from that pot's
code and the context, by the same weights for every pot. ``fold`` uses the table's mirror symmetry: every table is turned so that the cue ball lies in
one quarter, and the choice of side is turned back.
"""

import torch
from sb3_contrib.common.maskable.policies import MaskableActorCriticPolicy
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
from torch import nn

from snooker_env.envs.choices import POTS, SIDES, STROKES, TOPS
from snooker_env.envs.observations import SIZE
from snooker_env.game.balls import N_BALLS

from .visits import POT_ENTRIES

BALL, CONTEXT, POT = 64, 128, 64
_STATE = SIZE - 5 * N_BALLS


def _mlp(*sizes):
    layers = []
    for a, b in zip(sizes, sizes[1:], strict=False):
        layers += [nn.Linear(a, b), nn.ReLU()]
    return nn.Sequential(*layers)


class TableReader(BaseFeaturesExtractor):
    """(n, view) -> (n, CONTEXT + POTS * POT): the context, then each pot's code."""

    def __init__(self, observation_space, width=64):
        super().__init__(observation_space, CONTEXT + POTS * POT)
        self.ball = _mlp(5 + 2, width, BALL)
        self.pot = _mlp(POT_ENTRIES, width, POT)
        self.context = _mlp(3 * BALL + POT + _STATE + 2, CONTEXT, CONTEXT)
        self.joint = _mlp(POT + CONTEXT, POT)

    def forward(self, seen):
        """One pass."""
        n = len(seen)
        balls = seen[:, : 5 * N_BALLS].reshape(n, N_BALLS, 5)
        state = seen[:, 5 * N_BALLS : SIZE]
        pots = seen[:, SIZE : SIZE + POTS * POT_ENTRIES].reshape(n, POTS, POT_ENTRIES)
        cue = balls[:, 0, :2]
        here = balls[:, 1:, 2:3]
        on, red = balls[:, 1:, 4:5] * here, torch.zeros_like(here)
        red[:, :15] = here[:, :15]
        codes = self.ball(torch.cat([balls[:, 1:], balls[:, 1:, :2] - cue[:, None]], 2))
        offered = pots[:, :, :1]
        each = self.pot(pots)
        sums = [(codes * w).sum(1) / 5.0 for w in (on, red, here - red)]
        context = self.context(torch.cat([*sums, (each * offered).sum(1), state, cue], 1))
        joint = self.joint(torch.cat([each, context[:, None].expand(-1, POTS, -1)], 2)) * offered
        return torch.cat([context, joint.reshape(n, -1)], 1)


class StrokeHead(nn.Module):
    """The context and the pots' codes -> a score for each of the POTS * STROKES choices."""

    def __init__(self):
        super().__init__()
        self.score = nn.Sequential(nn.Linear(POT + CONTEXT, 128), nn.ReLU(), nn.Linear(128, STROKES))
        with torch.no_grad():  # at first all strokes are nearly alike
            self.score[2].weight *= 0.1
            self.score[2].bias.zero_()

    def forward(self, read):
        """One pass."""
        context, pots = read[:, :CONTEXT], read[:, CONTEXT:].reshape(-1, POTS, POT)
        return self.score(torch.cat([pots, context[:, None].expand(-1, POTS, -1)], 2)).reshape(len(read), -1)


class TablePolicy(MaskableActorCriticPolicy):
    """A maskable policy that reads with ``TableReader`` and scores with ``StrokeHead``."""

    def __init__(self, *args, **kwargs):
        kwargs |= {"features_extractor_class": TableReader, "net_arch": []}
        super().__init__(*args, **kwargs)

    def _build(self, lr_schedule):
        super()._build(lr_schedule)
        self.action_net = StrokeHead()
        self.value_net = nn.Sequential(_Context(), nn.Linear(CONTEXT, 128), nn.ReLU(), nn.Linear(128, 1))
        self.optimizer = self.optimizer_class(self.parameters(), lr=lr_schedule(1), **self.optimizer_kwargs)


class _Context(nn.Module):
    def forward(self, read):
        """The context alone."""
        return read[:, :CONTEXT]


assert STROKES % (len(SIDES) * len(TOPS)) == 0
