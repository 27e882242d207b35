"""How do players search? By one ``StrokeSearch``; a name may end in simulated shots: ``search_2000``.

* ``search`` judges positions by the rule of thumb and looks at strokes spread evenly over the pots.
* ``planner`` judges by the learned value and looks at the strokes that the learned policy proposes. It takes
  the weights of the level of execution errors that it plays under.
* ``best_pot`` plays the likeliest pot without regard to what follows.

After a foul in a frame a planner decides by the learned worth, the others by the likeliest pot (``BoundPlayer.worth``)."""

from typing import Any

import numpy as np

from .._check import integer
from .._types import Floats, Ints
from ..planning import Positions, StrokeSearch
from ..planning.learned.learned_value import LearnedValue
from ..planning.learned.learned_worth import LearnedWorth
from ..planning.learned.policy_proposals import PolicyProposals
from ..tasks.options import Options
from .player import BoundPlayer, Ranked, Strokes
from .weights import Learned, learned_at, learned_worth, level_for

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
        self._worth: LearnedWorth | None = None

    def _bind(self, options: Options) -> None:
        self.search = search = StrokeSearch(options, self.budget, pots_only=self.kind == "best_pot")
        if self.kind.startswith("planner"):
            learned = self._learned or learned_at(level_for(search.noise))
            value = LearnedValue(learned.value, search.spread, search.planner.threads)
            self._worth = LearnedWorth(value, learned_worth()[0])
            if self.kind != "planner_policy":
                search.value = value
            if self.kind != "planner_value":
                search.propose = PolicyProposals(learned.policy)

    def worth(self, at: Positions) -> Floats:
        """See ``BoundPlayer.worth``."""
        return super().worth(at) if self._worth is None else self._worth(at).astype(np.float64)

    def play(self, positions: Any, seeds: Any) -> Strokes:
        """See ``Player.play``."""
        ranked, places, decisions = self._ranked(positions, seeds)
        return Strokes(ranked.strokes[:, 0], places, decision=decisions)

    def rank(self, positions: Any, seeds: Any) -> list[Ranked]:
        """The strokes that met noise samples, most first, best first, with their scores [points]."""
        ranked, places, decisions = self._ranked(positions, seeds)
        met = (ranked.samples > 0).sum(axis=1)
        most = np.minimum(np.where(met > 0, met, ranked.samples.shape[1]), RANKED)
        made = []
        for k, m in enumerate(most.tolist()):
            where, what = np.repeat(places[k : k + 1], m, 0), np.full(m, decisions[k])
            made.append(Ranked(Strokes(ranked.strokes[k, :m], where, decision=what), ranked.scores[k, :m]))
        return made

    def _ranked(self, positions: Any, seeds: Any) -> tuple[Any, Floats, Ints]:
        """The ranking of the search, the places of cue balls in hand, NaN elsewhere, and the decisions after fouls."""
        visits, places, decisions = self.started(positions, seeds)
        return self.search.rank(visits, seeds), places, decisions
