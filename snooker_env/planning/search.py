"""Which stroke is best? One search over continuous strokes, one shot deep, for visits and for frames.

A judge proposes strokes for each position, plays each once without error, and says what it brings and what the position that
it leaves is worth. The best meet noise samples, the better ones more of them (sequential halving, Karnin, Koren & Somekh
2013): scrambled Sobol points, common to all strokes of a position. A stroke's figure is the mean over the samples, with the
first look as ``PRIOR`` of them."""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from .._lib.check import integer, refuse_what
from .._lib.types import Floats, Integers, Ints
from .judges import BUDGET, Judge, Plan, Proposed
from .positions import Positions, PositionsLike, check_has_stroke, seeds_of
from .proposals import Propose, at_pots
from .sobol import DIMENSIONS, normal_points
from .strokes import Strokes

PRIOR = 1.0  # number of samples that the look without error counts as
MOST = 10**7  # simulated shots of a decision


class Ranked(NamedTuple):
    """The strokes that were considered in one position: most samples first, then best first.

    A stroke that was left behind in an earlier round may keep a higher score: fewer samples flatter it.

    Attributes
    ----------
    strokes, scores : Strokes, numpy.ndarray or None
        The m strokes; float64 (m,), by which they are ranked: in visits expected points of the stroke and of what follows,
        in frames the chance to win, or the points if there is no law for it. None of a player that has no scores.
    points, samples, kinds : numpy.ndarray
        Of a search, else empty: float64 (m,), expected points, in frames less the opponent's; int64 (m,), noise samples that
        each met, 0 if it had only the look without error; int64 (m,), the generator that proposed each, in frames 0 a pot,
        1 a safety, 2 a contact, 3 an escape.

    Examples
    --------
    >>> from snooker_env.planning import Position, Search, VisitJudge
    >>> position = Position(cue=(0.0, 0.9), black=(0.4, 1.3))
    >>> (one,) = Search(VisitJudge({"noise": "club"}), budget=30).rank(position, seeds=[7])
    >>> one.samples[:5].tolist(), len(one.strokes)
    ([5, 5, 2, 2, 0], 16)
    """

    strokes: Strokes
    scores: Floats | None
    points: Floats = np.empty(0)
    samples: Ints = np.empty(0, np.int64)
    kinds: Ints = np.empty(0, np.int64)


class Search:
    """Searches for the best stroke with a number of simulated shots.

    Parameters
    ----------
    judge, budget : VisitJudge or FrameJudge, int
        What is played where, and what a stroke is worth; simulated shots of a decision: at most in visits, at least 8; on
        average in frames, at least 30.
    propose : callable or sequence of callable, optional
        Generators of strokes at pots, which return what ``at_pots(judge, at, m, seeds)`` does, the default; in frames one.

    Examples
    --------
    >>> from snooker_env.planning import Position, Search, VisitJudge
    >>> search = Search(VisitJudge({"noise": "club"}), budget=30)
    >>> (best,) = search.rank(Position(cue=(0.0, 0.9), black=(0.4, 1.3)), seeds=[7])
    >>> best.strokes.values.shape
    (16, 5)
    """

    def __init__(self, judge: Judge, budget: int = BUDGET, propose: Propose | Sequence[Propose] = at_pots):
        if not isinstance(judge, Judge):
            raise refuse_what("judge", f"a {type(judge).__name__}", "must be a VisitJudge or a FrameJudge")
        self.judge: Judge = judge
        self.budget: int = integer("budget", budget, judge.least, MOST)
        self.propose: tuple[Propose, ...] = (propose,) if callable(propose) else tuple(propose)

    def rank(self, positions: PositionsLike, seeds: Integers) -> list[Ranked]:
        """Try strokes in n positions and return them ``Ranked``: the first one of each is to be played.

        ``seeds``, int (n,): equal seeds give equal decisions. A cue ball in hand is played from where it lies, decisions
        after a foul have been made. ValueError if a position is invalid or has no stroke to play."""
        rules, at = self.judge.rules, Positions.of(positions)
        at, keys = at.known_to(rules), seeds_of(seeds, len(at))
        check_has_stroke(at.as_visits(), np.arange(len(at)), rules.table, rules.physics.R)
        ranked: dict[int, Ranked] = {}
        for plan, rows in self.judge.plans(self.budget, self.propose, at, keys):
            if len(rows):
                ranked |= zip(rows.tolist(), self._rank(at[rows], keys[rows], plan), strict=True)
        return [ranked[k] for k in range(len(at))]

    def _rank(self, at: Positions, seeds: Ints, plan: Plan) -> list[Ranked]:
        """The rankings of positions in which the budget is spent alike."""
        judge, every = self.judge, np.arange(len(at))[:, None]
        proposed = judge.propose(self.propose, at, seeds, plan)
        strokes, chances, kinds, safe = proposed
        rows, picks = np.nonzero(chances > 0.0)
        values, keep = judge.look(at, proposed, rows, picks)
        rows, picks = rows[keep], picks[keep]
        looks = np.zeros((*chances.shape, values.shape[1]))
        looks[..., :2] = -np.inf
        looks[rows, picks] = values[keep]
        order = np.argsort(-judge.score(looks), axis=1, kind="stable")
        if safe.any():  # a look without error flatters: the best of each kind are sampled
            order[safe] = in_turn(order[safe], judge.groups(kinds[safe], looks[safe]))
            there = np.isfinite(looks[every, order, 0])
            order = np.take_along_axis(order, np.argsort(~there, axis=1, kind="stable"), 1)
        order, means, samples = self._halve(at, proposed, looks, order, plan, seeds)
        scores, points = judge.figures(means)
        counts = np.bincount(rows, minlength=len(at))
        tried = np.arange(chances.shape[1]) < counts[:, None]  # what was not tried is last
        flat = np.repeat(np.arange(len(at)), counts), order[tried]
        told = Strokes(strokes[flat])
        ranked = []
        for start, end in pairwise([0, *np.cumsum(counts).tolist()]):
            which = flat[0][start:end], flat[1][start:end]
            figures = scores[which], points[which], samples[which], kinds[which]
            ranked.append(Ranked(told[start:end], *figures))
        return ranked

    def _halve(
        self, at: Positions, proposed: Proposed, looks: Floats, order: Ints, plan: Plan, seeds: Ints
    ) -> tuple[Ints, Floats, Ints]:
        """Sequential halving of strokes with these ``looks`` (n, m, v), -inf where there is none, best first in ``order``: the
        order then, means and samples."""
        judge, (n, m) = self.judge, looks.shape[:2]
        every, sums = np.arange(n)[:, None], PRIOR * looks
        values, tries = looks.copy(), np.zeros((n, m), np.int64)
        samples = np.stack([normal_points(sum(each for _, each in plan.rounds), k) for k in seeds.tolist()])
        done = 0
        for many, each in plan.rounds:
            best = order[:, :many]
            j, c = np.nonzero(np.isfinite(looks[every, best, 0]))
            c = best[j, c]
            errors = judge.noise.errors_from(samples[:, done : done + each][j].reshape(-1, DIMENSIONS))
            got = judge.sample(at, proposed, np.repeat(j, each), np.repeat(c, each), errors)
            got = got.reshape(len(j), each, -1)
            sums[j, c] += np.ascontiguousarray(got.transpose(0, 2, 1)).sum(axis=2)  # rounded in a fixed order
            tries[j, c] += each
            done += each
            values[j, c] = sums[j, c] / (PRIOR + tries[j, c])[:, None]
            again = np.argsort(-judge.score(values[every, best]), axis=1, kind="stable")
            order = np.concatenate([np.take_along_axis(best, again, 1), order[:, many:]], 1)
        return order, values, tries


def in_turn(order: Ints, kinds: Ints) -> Ints:
    """Rows (n, m) of indices, best first, as the best of each of ``kinds`` (n, m), the second best, ..."""
    sorted_kinds = np.take_along_axis(kinds, order, 1)
    place = np.zeros_like(order)
    for kind in np.unique(kinds):
        same = sorted_kinds == kind
        place[same] = (np.cumsum(same, axis=1) - 1)[same]
    return np.take_along_axis(order, np.argsort(place, axis=1, kind="stable"), 1)
