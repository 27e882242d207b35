"""How does a player play that predicts where balls come to rest, without a shot? The stroke that its networks say is worth
most, in visits a pot; where none is on, that of ``ghost_ball``. In frames it plays safeties, too, and decides by their worth."""

from typing import Any

import numpy as np

from .._lib.types import Floats, Integers
from ..planning import Positions
from ..planning.aims import Dynamics
from ..planning.learned.frame_strokes import FOULS, FrameStrokes
from ..planning.learned.learned_worth import LearnedValue, LearnedWorth
from ..planning.learned.stroke_value import LOOKS, Candidates, StrokeValue
from ..planning.positions import PositionsLike, seeds_of
from ..planning.proposals import over_cushions
from ..planning.stroke_columns import COLUMNS
from ..tasks.options import Options
from .choices import GhostBall
from .player import Ranked, Strokes, place_cue_balls
from .search_player import FramePlayer
from .seen import begun
from .weights import StrokeLayers, learned_at, learned_strokes, learned_worth, level_for

LIKELY = 0.75  # share of the predicted errors under which a stroke at a ball must be fair to be preferred


class StrokeValuePlayer(FramePlayer):
    """The best stroke of a ``StrokeValue``, in frames of a ``FrameStrokes``, with the layers ``learned``."""

    name = "stroke_value"
    search: FrameStrokes

    def __init__(self, learned: StrokeLayers | None = None):
        self._given, self.values = learned, None

    def _bind(self, options: Options) -> None:
        rules, level = options.rules, level_for(options.rules.noise)
        learned, self._plain = learned_at(level), GhostBall().at(options)
        layers = learned_strokes() if self._given is None else self._given
        spread = rules.noise.spread(rules.physics)
        # one of the value's networks says almost as much as all, in a quarter of the time
        value, worth = LearnedValue(learned.value[:1], spread), LearnedValue(learned.value, spread)
        self.values = StrokeValue(value, learned.policy, Dynamics.of(rules), rules.noise, layers.visits)
        own = LearnedWorth(worth, learned_worth()[0])
        self.search = self.judge = FrameStrokes(rules, self.values, own, layers.frames)

    def play(self, positions: PositionsLike, seeds: Integers) -> Strokes:
        at = Positions.of(positions)
        if at.of_frames:
            return self.decide_frames(at, seeds).strokes
        if self.options.rules.reward == "legal":
            return self._fairest(at, seeds)
        at, places, found, scores = self._score(at, seeds)
        values = np.zeros((len(at), COLUMNS))
        values[found.rows] = found.strokes[np.arange(len(scores)), scores.argmax(axis=1)]
        others = np.setdiff1d(np.arange(len(at)), found.rows)
        if len(others):
            plain = self._plain.play(at[others], np.asarray(seeds)[others])
            values[others], places[others] = plain.values, plain.place
        return Strokes(values, places)

    def rank(self, positions: PositionsLike, seeds: Integers) -> list[Ranked]:
        """Its strokes, best first, with what they are worth [points]; the one that need only be fair alone."""
        at = Positions.of(positions)
        if at.of_frames:
            return self._consider(at, seeds)
        if self.options.rules.reward == "legal":
            strokes = self._fairest(at, seeds)
            return [Ranked(strokes[k : k + 1], None) for k in range(len(at))]
        at, places, found, scores = self._score(at, seeds)
        made: list[Ranked] = self._plain.rank(at, seeds)
        for j, k in enumerate(found.rows.tolist()):
            order = np.argsort(-scores[j], kind="stable")
            where = np.repeat(places[k : k + 1], len(order), axis=0)
            made[k] = Ranked(Strokes(found.strokes[j, order], where), scores[j, order].astype(np.float64))
        return made

    def _fairest(self, positions: Positions, seeds: Integers) -> Strokes:
        """Strokes that need only be fair: at a ball that is likely to be struck, else over cushions, else as ``ghost_ball``."""
        at, keys = positions.known_to(self.options.rules), seeds_of(seeds, len(positions))
        plain, (visits, places) = self._plain.play(at, keys).values, place_cue_balls(at, keys)
        every, (strokes, there, seen) = np.arange(len(at)), self.search.look(begun(visits), keys)
        fair = np.where(there, 1.0 - seen[..., FOULS], 0.0)[:, LOOKS:]
        worth = self.search.scores(seen)[:, LOOKS:]
        best = (fair + 1e-3 * worth).argmax(axis=1)  # of those that are alike the worthiest
        fair, found = fair[every, best, None], strokes[every, LOOKS + best]
        over, some = over_cushions(self.search, visits, 1, keys)
        values = np.where(some > 0.0, over[:, 0], np.where(fair > 0.0, found, plain))
        return Strokes(np.where(fair >= LIKELY, found, values), places)

    def _score(self, at: Positions, seeds: Integers) -> tuple[Positions, Floats, Candidates, Any]:
        """Positions of visits, the places of cue balls in hand, the strokes that are looked at, and their values."""
        options, values = self.options, self.values  # it must be bound
        assert values is not None, options
        at = at.known_to(options.rules)
        keys = seeds_of(seeds, len(at))
        visits, places = place_cue_balls(at, keys)
        found = values.candidates(visits, LOOKS, keys)
        return at, places, found, values.scores(found.seen)
