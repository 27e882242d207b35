"""Which strokes does a policy propose? Strokes near the choices that it likes, drawn from its probabilities.

The policy scores the 540 discrete choices. A softmax with ``TEMPERATURE`` makes them probabilities, which are
sampled systematically: a choice with a share of 10 % gets 10 % of the strokes. Each stroke is moved within
the choice's cell of speed, side and top by a Sobol point, so that the grid does not limit the search."""

from typing import Any

import numpy as np

from ..._lib.types import Bools, Floats, Ints, Singles
from ...physics.cue_room import NO_RAILS
from ...tasks.discrete_actions import SIDES, SPEEDS, STROKES, TOPS
from ...tasks.discrete_actions import SIZE as CHOICES
from ..positions import Positions
from ..proposals import Asking, Proposals, strokes_at
from ..sobol import sobol_points
from ..strokes import available
from .pot_view import with_pots
from .stroke_policy import StrokePolicy

TEMPERATURE = 4.0
"""Of the scores: above 1, so that less likely ones are tried too."""
_SPEEDS, _SIDES, _TOPS = np.array(SPEEDS), np.array(SIDES), np.array(TOPS)
_STEP = np.gradient(np.log(_SPEEDS))  # width of a cell in the logarithm of the speed
_SIDE_STEP, _TOP_STEP = _SIDES[1] - _SIDES[0], _TOPS[1] - _TOPS[0]


class PolicyProposals:
    """The proposals of a ``Search`` by a ``StrokePolicy`` on tables as ``with_pots`` shows them."""

    def __init__(self, policy: StrokePolicy):
        self.policy = policy

    def scores(self, at: Positions, rails: Floats = NO_RAILS) -> Any:
        """Scores of all choices in n ``Positions``: float32 (n, CHOICES), and which are available to a cue that
        passes over these ``rails``."""
        masks = available(at, rails)
        return self.policy.scores(with_pots(at.observations()), masks), masks

    def __call__(self, search: Asking, at: Positions, m: int, seeds: Ints) -> Proposals:
        """m strokes for each position, see ``Propose``."""
        scores, masks = self.scores(at, search.dynamics.rails)
        picks, tips = draw_choices(scores, masks, m, seeds)
        return strokes_at(at, picks // STROKES, tips, search.spread, search.dynamics)


def draw_choices(scores: Floats | Singles, masks: Bools, m: int, seeds: Ints) -> tuple[Ints, Floats]:
    """m choices of each position, drawn by their scores (n, CHOICES), and speeds and tips near them: (n, m), (n, m, 3)."""
    likely = np.where(masks, np.exp((scores - scores.max(axis=1, keepdims=True)) / TEMPERATURE), 0.0)
    sums = np.cumsum(likely, axis=1)
    points = np.stack([sobol_points(m, 4, seed ^ 0xBEEF) for seed in seeds.tolist()])
    levels = (np.arange(m) + points[:, :1, 3]) / m  # systematic sampling: one random start a position
    each = zip(sums, levels, strict=True)
    picks = np.stack([np.searchsorted(row, level * row[-1], side="right") for row, level in each])
    picks = np.minimum(picks, CHOICES - 1)
    stroke = picks % STROKES
    speed, side = stroke // (len(SIDES) * len(TOPS)), stroke // len(TOPS) % len(SIDES)
    top = stroke % len(TOPS)
    tips = np.empty((*picks.shape, 3))
    tips[..., 0] = _SPEEDS[speed] * np.exp(_STEP[speed] * (points[..., 0] - 0.5))
    plain = (side == SIDES.index(0.0)) & (points[..., 3] < 0.5)
    tips[..., 1] = np.where(plain, 0.0, _SIDES[side] + _SIDE_STEP * (points[..., 1] - 0.5))
    tips[..., 2] = _TOPS[top] + _TOP_STEP * (points[..., 2] - 0.5)
    return picks, tips
