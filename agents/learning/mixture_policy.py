"""How can a policy learn an angle of the full circle? By a mixture of strokes along lines of direct pots.

A plain Gaussian over ``action="box", aim="absolute"`` never learns: a random direction almost never pots. The
environment sees plain numbers; the density of an action (speed, side, top, aim) is::

    sum over pots k of  weight_k * N(speed, side, top; means_k, stds) * N(aim; line_k + turn_k(speed, side, top), std_k)

The weights are a softmax of the pots' scores. line_k is the direction to the pot's ghost ball, and turn_k
moves that round the object ball by the angle that ``Throw`` has learned for this cut, path and stroke. The aim
is explored in units of each pot's tolerance. Without a direct pot the line is a full hit on the nearest ball on.

    python train.py --agent ppo_absolute
"""

from math import log, pi
from typing import Any

import torch
from stable_baselines3.common.distributions import Distribution
from stable_baselines3.common.policies import ActorCriticPolicy
from torch import nn

from snooker_env.game import N_BALLS
from snooker_env.geometry import BALL_RADIUS, HALF_LENGTH, HALF_WIDTH
from snooker_env.planning.learned import pot_view
from snooker_env.planning.learned.pot_view import POT_ENTRIES, tolerance_of
from snooker_env.tasks import OBSERVATION_SIZE, POTS

from .networks import CONTEXT, POT, TableReader, ValueHead

LINE_ENTRIES = 6
"""Numbers that ``lines_of`` gives of each pot."""
(OFFERED, LINE, SIN_CUT, COS_CUT, PATH, TOLERANCE) = range(LINE_ENTRIES)

LEAST_TOLERANCE = 5e-4
"""Least scale of the exploration [rad]: about a professional's error of aim (0.03 degrees)."""
THROW_UNIT = 0.3
"""Unit of the learned turn of the line of centres [rad], a few times the largest throw: Adam's steps have one
size whatever the unit."""


def lines_of(seen):
    """(n, SHOWN) of ``pot_view.with_pots`` -> (n, POTS, LINE_ENTRIES), as seen and not in the mirror.

    1 if there is such a pot, direction of its line / pi, sine and cosine of the cut (left positive), path cue
    ball -> ghost ball [m], tolerance [rad]. Without any pot the first line leads to the nearest ball on.
    """
    balls = seen[:, : 5 * N_BALLS].reshape(-1, N_BALLS, 5)
    places = balls[:, :, :2] * seen.new_tensor([HALF_WIDTH, HALF_LENGTH])
    to_ball = places - places[:, :1]
    far = to_ball.square().sum(2).masked_fill((balls[:, :, 2] <= 0.0) | (balls[:, :, 4] <= 0.0), float("inf"))
    nearest = to_ball[torch.arange(len(seen), device=seen.device), far.argmin(1)]
    pots = seen[:, OBSERVATION_SIZE : pot_view.SHOWN].reshape(-1, POTS, POT_ENTRIES)
    offered = pots[:, :, 0]
    first = torch.where(offered[:, :1] > 0.0, pots[:, 0, 1:3], nearest)
    direction = torch.cat([first[:, None], pots[:, 1:, 1:3]], 1)
    line = torch.atan2(direction[:, :, 1], direction[:, :, 0]) / pi
    tolerance = tolerance_of(pots[:, :, pot_view.TOLERANCE]).clamp(min=LEAST_TOLERANCE)
    path = (pots[:, :, 5] + 1.0) * HALF_LENGTH
    return torch.stack([offered, line, pots[:, :, 3], pots[:, :, 4], path, tolerance], 2)


def nearest_image(turn):
    """An angle / pi within half a turn of 0."""
    return turn - 2.0 * torch.round(turn / 2.0)


class LineReader(TableReader):
    """The features of ``TableReader`` followed by ``lines_of``, flattened."""

    def __init__(self, observation_space, width=32):
        super().__init__(observation_space, width)
        self._features_dim += POTS * LINE_ENTRIES

    def forward(self, seen):
        return torch.cat([super().forward(seen), lines_of(seen).flatten(1)], 1)


class Throw(nn.Module):
    """Lines (n, POTS, LINE_ENTRIES) and strokes (n, POTS, 3) -> the angle / pi by which to turn each line.

    Friction throws the object ball off the line of centres, by an angle of cut, path and stroke alone.
    """

    def __init__(self, width=32):
        super().__init__()
        self.last = nn.Linear(width, 1)
        hidden = nn.Linear(6, width), nn.Tanh(), nn.Linear(width, width), nn.Tanh()
        self.net = nn.Sequential(*hidden, self.last)
        self.mirror: torch.Tensor
        self.register_buffer("mirror", torch.tensor([-1.0, 1.0, 1.0, 1.0, -1.0, 1.0]), persistent=False)

    def start(self):
        """Begin on the straight line."""
        nn.init.zeros_(self.last.weight)

    def forward(self, lines, strokes):
        # as the environment reads them: within the box, the tip on the disc of the miscue limit
        played = strokes.clamp(-1.0, 1.0)
        tip = played[:, :, 1:]
        tip = tip / torch.linalg.vector_norm(tip, dim=2, keepdim=True).clamp(min=1.0)
        sine, cosine, path = lines[:, :, SIN_CUT], lines[:, :, COS_CUT], lines[:, :, PATH]
        line = torch.stack([sine, cosine, path / HALF_LENGTH - 1.0], 2)
        known = torch.cat([line, played[:, :, :1], tip], 2)
        angle = THROW_UNIT * (self.net(known) - self.net(known * self.mirror)).squeeze(2)
        # the ghost ball, seen along the line, when the line of centres is turned by this angle
        turned_sine = sine * torch.cos(angle) + cosine * torch.sin(angle)
        turned_cosine = cosine * torch.cos(angle) - sine * torch.sin(angle)
        ahead = path - 2.0 * BALL_RADIUS * (turned_cosine - cosine)
        aside = -2.0 * BALL_RADIUS * (turned_sine - sine)
        turn = torch.atan2(aside, ahead.clamp(min=BALL_RADIUS)) / pi
        return turn * lines[:, :, OFFERED]


class MixtureHead(nn.Module):
    """The features of ``LineReader`` -> the parameters of a ``StrokeMixture``, but for the deviations."""

    def __init__(self):
        super().__init__()
        self.pot = nn.Linear(POT, 4)
        self.no_pot = nn.Linear(CONTEXT, 3)
        self.throw = Throw()
        with torch.no_grad():  # at first all strokes are nearly alike, at medium speed without spin
            for layer in (self.pot, self.no_pot):
                layer.weight.mul_(0.1)
                layer.bias.zero_()
        self.throw.start()

    def forward(self, read):
        """Logarithms of the weights (n, POTS), means (n, POTS, 3), lines, and a function for aims."""
        n = len(read)
        end = CONTEXT + POTS * POT
        codes, side = read[:, CONTEXT:end].reshape(n, POTS, POT), read[:, end, None]
        lines = read[:, end + 1 :].reshape(n, POTS, LINE_ENTRIES)
        offered, first = lines[:, :, OFFERED] > 0.0, torch.arange(POTS, device=read.device) == 0
        alone = ~offered.any(1, keepdim=True) & first  # the one line of a table without a pot
        out = self.pot(codes)
        # before training: in proportion to the pot's width
        scores = out[:, :, 0] + torch.log(lines[:, :, TOLERANCE])
        log_weights = torch.log_softmax(scores.masked_fill(~offered & ~alone, -1e8), 1)
        means = torch.where(alone[:, :, None], self.no_pot(read[:, :CONTEXT])[:, None], out[:, :, 1:])
        means = torch.stack([means[:, :, 0], means[:, :, 1] * side, means[:, :, 2]], 2)
        return log_weights, means, lines, lambda strokes: lines[:, :, LINE] + self.throw(lines, strokes)


class StrokeMixture(Distribution):
    """The density of actions (n, 4). ``log_std`` (4,): of speed, side, top, and of aim in tolerances."""

    def proba_distribution_net(self, log_std_init=0.0):
        """The head and the deviations."""
        return MixtureHead(), nn.Parameter(torch.full((4,), float(log_std_init)))

    def proba_distribution(self, log_weights, means, lines, aims_of, log_std):
        """Set the parameters: the output of ``MixtureHead``, and the deviations."""
        self.log_weights, self.means, self.aims_of = log_weights, means, aims_of
        self.stds, self.aim_stds = log_std[:3].exp(), lines[:, :, TOLERANCE] / pi * log_std[3].exp()
        return self

    def log_prob(self, actions):
        """Logarithm of the density; an aim counts at its image nearest to the mean alone."""
        strokes = actions[:, None, :3].expand_as(self.means)
        aside = nearest_image(actions[:, None, 3] - self.aims_of(strokes)) / self.aim_stds
        off = ((strokes - self.means) / self.stds).square().sum(2) + aside.square()
        scale = self.stds.log().sum() + self.aim_stds.log() + 2.0 * log(2.0 * pi)
        return torch.logsumexp(self.log_weights - 0.5 * off - scale, 1)

    def entropy(self):
        """The joint entropy of weight and component; if components overlap, more than the mixture's."""
        of_each = self.stds.log().sum() + self.aim_stds.log() + 2.0 * log(2.0 * pi) + 2.0
        return (self.log_weights.exp() * (of_each - self.log_weights)).sum(1)

    def sample(self):
        """A pot by its weight, a stroke at it, then the aim for this stroke, in [-1, 1]."""
        chosen = torch.multinomial(self.log_weights.exp(), 1)
        strokes = self.means + self.stds * torch.randn_like(self.means)
        aims = self.aims_of(strokes) + self.aim_stds * torch.randn_like(self.aim_stds)
        return self._chosen(chosen, strokes, aims)

    def mode(self):
        """The mean stroke at the pot of the largest weight, and the aim for it."""
        return self._chosen(self.log_weights.argmax(1, keepdim=True), self.means, self.aims_of(self.means))

    @staticmethod
    def _chosen(chosen, strokes, aims):
        actions = torch.cat([strokes, nearest_image(aims)[:, :, None]], 2)
        return actions[torch.arange(len(actions), device=actions.device), chosen[:, 0]]

    def actions_from_params(self, log_weights, means, lines, aims_of, log_std, deterministic=False):
        """Actions of the mixture with these parameters."""
        return self.proba_distribution(log_weights, means, lines, aims_of, log_std).get_actions(deterministic)

    def log_prob_from_params(self, log_weights, means, lines, aims_of, log_std):
        """Actions of the mixture with these parameters, and their logarithmic densities."""
        actions = self.actions_from_params(log_weights, means, lines, aims_of, log_std)
        return actions, self.log_prob(actions)


class AbsolutePolicy(ActorCriticPolicy):
    """A policy for PPO on ``action="box", aim="absolute"``, shown ``pot_view.with_pots``."""

    def __init__(self, *args, **kwargs):
        super().__init__(*args, **(kwargs | {"features_extractor_class": LineReader, "net_arch": []}))

    def _build(self, lr_schedule):
        super()._build(lr_schedule)
        self.action_dist = self.mixture = StrokeMixture()
        self.action_net, self.log_std = self.mixture.proba_distribution_net(self.log_std_init)
        self.value_net = ValueHead()
        settings: dict[str, Any] = {"lr": lr_schedule(1), **self.optimizer_kwargs}
        self.optimizer = self.optimizer_class(self.parameters(), **settings)

    def _get_action_dist_from_latent(self, latent_pi):
        log_weights, means, lines, aims_of = self.action_net(latent_pi)
        return self.mixture.proba_distribution(log_weights, means, lines, aims_of, self.log_std)
