"""How do players search? By one ``Search``; a name may end in simulated shots: ``search_2000``. ``search`` judges by the rule of
thumb and looks at strokes spread over the pots, ``planner`` by the learned value at those that the learned policy proposes, of
the level of errors that it plays under. ``best_pot`` plays the likeliest pot. After a foul a planner decides by learned worth."""

import numpy as np

from .._lib.check import integer
from .._lib.types import Floats, Integers
from ..planning import Positions, Search, VisitJudge
from ..planning.learned.learned_worth import LearnedValue, LearnedWorth
from ..planning.learned.stroke_policy import PolicyProposals
from ..planning.positions import PositionsLike
from ..planning.proposals import Propose, at_pots
from ..planning.search import BUDGET, MOST
from ..planning.stroke_columns import COLUMNS
from ..tasks.options import Options
from .player import BoundPlayer, Ranked, Strokes
from .weights import Learned, learned_at, learned_worth, level_for

KINDS = ("best_pot", "search", "planner")
RANKED = 40  # most strokes of a ranking


class SearchPlayer(BoundPlayer):
    """The best stroke of a ``Search`` with a ``VisitJudge``; ``learned``: a planner's, by default the package's."""

    frames = False

    def __init__(self, kind: str, budget: int = BUDGET, learned: Learned | None = None):
        self.kind, self.name = kind, kind if budget == BUDGET else f"{kind}_{budget}"
        self.budget = integer("budget", budget, VisitJudge.least, MOST)
        self._learned, self.training_shots = learned, None if kind == "planner" else 0
        self._worth: LearnedWorth | None = None

    def _bind(self, options: Options) -> None:
        self.judge = judge = VisitJudge(options, pots_only=self.kind == "best_pot")
        propose: Propose = at_pots
        if self.kind == "planner":
            learned = self._learned or learned_at(level_for(judge.noise))
            value = LearnedValue(learned.value, judge.spread, judge.planner.threads)
            self._worth = LearnedWorth(value, learned_worth()[0])
            judge.value, propose = value, PolicyProposals(learned.policy)
        self.search = Search(judge, self.budget, propose)

    def worth(self, at: Positions) -> Floats:
        return super().worth(at) if self._worth is None else self._worth(at).astype(np.float64)

    def play(self, positions: PositionsLike, seeds: Integers) -> Strokes:
        return self._play(positions, seeds)[0]

    def rank(self, positions: PositionsLike, seeds: Integers) -> list[Ranked]:
        """The strokes that met noise samples, most first, best first, with their scores [points]."""
        strokes, ranked = self._play(positions, seeds)
        return [show_strokes(one, strokes[k : k + 1]) for k, one in enumerate(ranked)]

    def _play(self, positions: PositionsLike, seeds: Integers) -> tuple[Strokes, list[Ranked]]:
        visits, places, decisions = self.start_playing(positions, seeds)
        ranked = self.search.rank(visits, seeds)
        best = np.array([one.strokes.values[0] for one in ranked]).reshape(-1, COLUMNS)
        return Strokes(best, places, decision=decisions), ranked


def show_strokes(one: Ranked, said: Strokes) -> Ranked:
    """What a player shows of a ranking: the strokes that met noise samples, else all, at most ``RANKED``; it says ``said``."""
    m = min(RANKED, int((one.samples > 0).sum()) or len(one.samples))
    same = [np.repeat(part, m, 0) for part in said.parts[1:]]
    scores = None if one.scores is None else one.scores[:m]
    strokes = Strokes(one.strokes.values[:m], *same)
    return Ranked(strokes, scores, one.points[:m], one.samples[:m], one.kinds[:m])
