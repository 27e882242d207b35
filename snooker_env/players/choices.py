"""How does a player play that scores the discrete choices? The one with the highest score; its aim is solved."""

from typing import Any

import numpy as np

from .._types import Floats, Ints
from ..planning import Planner, Positions, action_masks
from ..tasks.options import Options
from .player import Ranked, Strokes, seeds_of
from .simple import BoundPlayer, placed

MOST = 100
"""Most strokes of a ranking."""


class ChoicePlayer(BoundPlayer):
    """Base class of players that score the choices of ``action="discrete"``. Subclasses implement ``scores``."""

    _planner: Any = None

    def _bind(self, options: Options) -> None:
        same: Any = {name: getattr(options, name) for name in ("physics", "table", "fidelity")}
        self._planner = Planner(Options(action="discrete", **same), threads=1)

    def scores(self, at: Positions, seeds: Ints) -> Floats:
        """Scores of all choices in n positions of visits: (n, CHOICES), -inf for those that are not available."""
        raise NotImplementedError

    def figures(self, scores: Floats) -> Floats | None:
        """What a ranking shows of the sorted scores (m,) of one position; None for nothing."""
        return scores.astype(np.float64)

    def play(self, positions: Any, seeds: Any) -> Strokes:
        """See ``Player.play``."""
        visits, places, scores = self._scored(positions, seeds)
        return Strokes(self._planner.strokes_of(visits, np.arange(len(visits)), scores.argmax(axis=1))[0], places)

    def rank(self, positions: Any, seeds: Any) -> list[Ranked]:
        """The choices of each position, highest score first, at most ``MOST``."""
        visits, places, scores = self._scored(positions, seeds)
        ranked = []
        for k, row in enumerate(scores):
            choices = np.argsort(-row, kind="stable")[: max(1, min(MOST, int(np.isfinite(row).sum())))]
            values = self._planner.strokes_of(visits, np.full(len(choices), k), choices)[0]
            ranked.append(Ranked(Strokes(values, np.repeat(places[k : k + 1], len(choices), 0)), self.figures(row[choices])))
        return ranked

    def _scored(self, positions: Any, seeds: Any) -> tuple[Positions, Floats, Floats]:
        """The visits with placed cue balls, their places, and the scores."""
        _ = self.options  # it must be bound
        at = Positions.of(positions)
        keys = seeds_of(seeds, len(at))
        visits, places = placed(at, keys)
        return visits, places, self.scores(visits, keys)


def shares(scores: Floats) -> Floats:
    """The probabilities (m,) of choices with these scores: a softmax."""
    parts = np.exp(scores.astype(np.float64) - scores.max())
    return parts / parts.sum()


class Random(ChoicePlayer):
    """Uniformly random choices of ``action="discrete"``, of those available."""

    name, training_shots = "random", 0

    def scores(self, at: Positions, seeds: Ints) -> Floats:
        """A random number for each choice."""
        masks = action_masks(at)
        order = np.empty(masks.shape)
        for row, seed in zip(order, seeds.tolist(), strict=True):
            row[:] = np.random.default_rng(seed).random(len(row))
        return np.where(masks, order, -np.inf)

    def figures(self, scores: Floats) -> None:
        """None: its scores mean nothing."""
