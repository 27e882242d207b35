"""How does the lookahead player choose? By ``planning.StrokeSearch`` with many simulated shots."""

import numpy as np

from ..planning import Positions, StrokeSearch
from .advisor import Advisor, Ranked
from .practice import Practice, starts, stroke_of_row

BUDGET = 2600
"""Simulated shots of a decision, from each place that is tried."""
DOUBTFUL = 0.25
"""Largest chance of a pot at which strokes that pot nothing are tried as well."""


class LookaheadAdvisor(Advisor):
    """The built-in "lookahead": the best strokes of a search by a rule of thumb. Its scores are points."""

    name = "lookahead"

    def rank(self, practice: Practice, at: Positions, n: int, seed: int) -> Ranked:
        """The best strokes in one position, best first, each with its score [points]."""
        there = starts(practice, at)
        search = StrokeSearch(practice.options, BUDGET, doubtful=DOUBTFUL, threads=practice.exact.threads)
        ranked = search.rank(there, np.full(len(there), seed & 0xFFFFFFFF) ^ (seed >> 32))
        order = np.lexsort((-ranked.scores.ravel(), -ranked.samples.ravel()))[: max(n, 1)]
        rows, strokes, in_hand = order // ranked.scores.shape[1], ranked.strokes.reshape(-1, 5), bool(at.in_hand[0])
        scores = ranked.scores.ravel()
        return [(stroke_of_row(strokes[i], there[k : k + 1], in_hand), float(scores[i])) for i, k in zip(order, rows.tolist(), strict=True)]
