"""How do players search? By one ``StrokeSearch``; a name may end in simulated shots: ``search_2000``.

* ``search`` judges positions by the rule of thumb and looks at strokes spread evenly over the pots.
* ``planner`` judges by the learned value and looks at the strokes that the learned policy proposes. It takes
  the weights of the level of execution errors that it plays under.
* ``best_pot`` plays the likeliest pot without regard to what follows."""

from typing import Any

import numpy as np

from .._check import integer
from ..planning import Positions, StrokeSearch
from ..planning.learned.learned_value import LearnedValue
from ..planning.learned.policy_proposals import PolicyProposals
from ..tasks.options import Options
from .player import BoundPlayer, Ranked, Strokes, placed
from .weights import Learned, learned_at, level_for

BUDGET = 120  # simulated shots of a decision where the name does not say how many
KINDS = ("best_pot", "search", "planner", "planner_value", "planner_policy")  # the last two: half a planner
LEAST, MOST = 8, 10**7  # the fewest and the most simulated shots of a decision
RANKED = 40  # most strokes of a ranking


class SearchPlayer(BoundPlayer):
    """The best stroke of a ``StrokeSearch``; ``learned``: a planner's, by default the package's."""

    frames = False

    def __init__(self, kind: str, budget: int = BUDGET, learned: Learned | None = None):
        self.kind, self.name = kind, kind if budget == BUDGET else f"{kind}_{budget}"
        self.budget = integer("budget", budget, LEAST, MOST)
        self._learned, self.training_shots = learned, None if kind.startswith("planner") else 0
        self.search: Any = None  # the ``StrokeSearch`` where it is bound; None before

    def _bind(self, options: Options) -> None:
        self.search = search = StrokeSearch(options, self.budget, pots_only=self.kind == "best_pot")
        if self.kind.startswith("planner"):
            learned = self._learned or learned_at(level_for(search.noise))
            if self.kind != "planner_policy":
                search.value = LearnedValue(learned.value, search.spread, search.planner.threads)
            if self.kind != "planner_value":
                search.propose = PolicyProposals(learned.policy)

    def play(self, positions: Any, seeds: Any) -> Strokes:
        """See ``Player.play``."""
        ranked, places = self._ranked(positions, seeds)
        return Strokes(ranked.strokes[:, 0], places)

    def rank(self, positions: Any, seeds: Any) -> list[Ranked]:
        """The strokes that met noise samples, most first, best first, with their scores [points]."""
        ranked, places = self._ranked(positions, seeds)
        met = (ranked.samples > 0).sum(axis=1)
        most = np.minimum(np.where(met > 0, met, ranked.samples.shape[1]), RANKED)
        return [
            Ranked(Strokes(ranked.strokes[k, :m], np.repeat(places[k : k + 1], m, 0)), ranked.scores[k, :m])
            for k, m in enumerate(most.tolist())
        ]

    def _ranked(self, positions: Any, seeds: Any) -> tuple[Any, np.ndarray]:
        """The ranking of the search, and the places of cue balls in hand; NaN elsewhere."""
        _ = self.options  # it must be bound
        visits, places = placed(Positions.of(positions), seeds)
        return self.search.rank(visits, seeds), places
