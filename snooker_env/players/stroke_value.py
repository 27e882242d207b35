"""How does a player play that predicts where pots leave the cue ball, without a shot? The stroke that its network says is
worth most; where no pot is on, that of ``ghost_ball``."""

from typing import Any

import numpy as np

from .._types import Floats
from ..planning import Positions, spread_of
from ..planning.learned.learned_value import LearnedValue
from ..planning.learned.stroke_value import LOOKS, Candidates, StrokeValue
from ..planning.positions import seeds_of
from ..planning.strokes import COLUMNS, Dynamics
from ..tasks.options import Options
from .choices import GhostBall
from .player import BoundPlayer, Ranked, Strokes, placed
from .weights import learned_at, learned_strokes, level_for


class StrokeValuePlayer(BoundPlayer):
    """The best of the strokes of a ``StrokeValue``; ``layers``: of its network, by default the package's."""

    name = "stroke_value"

    def __init__(self, layers: Any = None):
        self._given, self.values = layers, None

    def _bind(self, options: Options) -> None:
        rules, level = options.rules, level_for(options.rules.noise)
        learned, self._plain = learned_at(level), GhostBall().at(options)
        # one of the value's networks says almost as much as all, in a quarter of the time
        value = LearnedValue(learned.value[:1], spread_of(rules.noise, rules.physics))
        layers = learned_strokes() if self._given is None else self._given
        self.values = StrokeValue(value, learned.policy, Dynamics.of(rules), rules.noise, layers)

    def play(self, positions: Any, seeds: Any) -> Strokes:
        """See ``Player.play``."""
        at, places, found, scores = self._scored(positions, seeds)
        values = np.zeros((len(at), COLUMNS))
        values[found.rows] = found.strokes[np.arange(len(scores)), scores.argmax(axis=1)]
        others = np.setdiff1d(np.arange(len(at)), found.rows)
        if not len(others):
            return Strokes(values, places)
        plain = self._plain.play(at[others], np.asarray(seeds)[others])
        values[others] = plain.values
        chosen = Strokes(values, places)
        for part, its in zip(chosen.parts[1:], plain.parts[1:], strict=True):
            part[others] = its
        return chosen

    def rank(self, positions: Any, seeds: Any) -> list[Ranked]:
        """Its strokes, best first, with what they are worth [points]."""
        at, places, found, scores = self._scored(positions, seeds)
        ranked: list[Ranked] = self._plain.rank(at, seeds)
        for j, k in enumerate(found.rows.tolist()):
            order = np.argsort(-scores[j], kind="stable")
            where = np.repeat(places[k : k + 1], len(order), axis=0)
            ranked[k] = Ranked(Strokes(found.strokes[j, order], where), scores[j, order].astype(np.float64))
        return ranked

    def _scored(self, positions: Any, seeds: Any) -> tuple[Positions, Floats, Candidates, Any]:
        """The positions, the places of cue balls in hand, the strokes that are looked at, and their values."""
        options, values = self.options, self.values  # it must be bound
        assert values is not None, options
        at = Positions.of(positions).known_to(options.rules)
        keys = seeds_of(seeds, len(at))
        visits, places = placed(at, keys)
        found = values.candidates(visits, LOOKS, keys)
        return at, places, found, values.scores(found.seen)
