"""What is the best of the choices, found by trying them out? Monte Carlo by simulation under execution noise, two shots deep.

From the true state of a table many copies are played, each with errors of its own (``envs.noise``). A shot is worth its points and, if the
visit goes on, the value of the position it leaves. Sequential halving [Karnin, Koren & Somekh 2013] spends the budget: all candidates are
tried a little, the better part a little more, and so on. The last few are judged by the second shot: from positions that they left, the
best next shot is sought without errors, worth the chance to make it times what it brings.

All candidates of a round meet the same errors (common random numbers): they differ by their own merits, not by luck.
"""

from typing import Any

import numpy as np

from snooker_env.envs.choices import POTS, STROKES, TOPS
from snooker_env.envs.noise import Noise

from .lookahead import BY_HAND, Copies, Position, prospects, spread_of
from .players import DISCRETE, choice_of
from .view import with_pots

KEEP = 3
"""Of a round's candidates one in so many goes on to the next."""
FINALISTS = 6
DEEP = 0.4
"""Share of the budget for the second shot."""
NEXT_SHOTS = 16
"""Shots tried from each position that a finalist left."""


class Search:
    """Looks for the best choice with ``budget`` simulated shots a decision.

    ``noise``: the errors that it expects, a level or fields as the environment takes them, None for those of the tables; ``value``: worth
    [points] of flat observations with pots (``view.with_pots``), (m, n) -> (m,), in place of the value by hand.
    """

    options = DISCRETE

    def __init__(self, budget=2000, noise=None, seed=0, value=None, constants=BY_HAND):
        self.budget, self._noise, self._value, self._constants = budget, noise, value, constants
        self._rng = np.random.default_rng(seed)
        self._rules: Any = None
        self._noisy: Any = None
        self._exact: Any = None
        self.shots = 0
        """Shots simulated so far."""

    def act(self, tables, observations, going):
        """The choice found for each table that is going."""
        self._prepare(tables.visits.rules)
        masks, chosen = tables.action_masks(), np.zeros(tables.num_envs, np.int64)
        v = tables.visits
        for k in np.flatnonzero(going).tolist():
            here = slice(k, k + 1)
            at = Position(v.positions[here].copy(), v.on_table[here].copy(), v.game[here].copy())
            chosen[k] = self._best(at, np.flatnonzero(masks[k]))
        return chosen

    def _prepare(self, rules):
        if self._rules is rules:
            return
        noise = rules.shooter.noise if self._noise is None else Noise.of(self._noise)
        self._rules, self._noisy, self._exact = rules, Copies(rules, noise), Copies(rules, Noise())
        self._spread = spread_of(noise, rules.shooter.physics)

    def _values(self, left, observations):
        """What the positions left are worth [points], and the chances of their widest pots."""
        values, chances = np.empty(len(left)), np.empty((len(left), POTS))
        prospects(left.positions, left.on_table, left.game, self._spread, self._constants, values, chances)
        if self._value is not None:
            values = np.asarray(self._value(with_pots(observations)), np.float64)
        return values, chances

    def _best(self, at, candidates):
        if len(candidates) == 0:
            return 0
        rng, spent = self._rng, 0
        shallow, deep = self.budget, 0
        if self.budget >= 200:
            deep = int(DEEP * self.budget)
            shallow -= deep
        candidates = self._first(candidates, max(1, shallow // 2))
        rounds = 1 + max(0, int(np.ceil(np.log(len(candidates) / FINALISTS) / np.log(KEEP))))
        sums, tries = np.zeros(len(candidates)), 0
        scores, records = sums, None
        for r in range(rounds):
            n = len(candidates)
            each = max(1, (shallow - spent) // (rounds - r) // n)
            if n * each > shallow - spent:
                break
            keys = rng.integers(0, 2**64 - 1, each, dtype=np.uint64)
            picks = np.repeat(candidates, each)
            points, goes_on, left, seen = self._noisy.play(at, np.zeros(len(picks), np.int64), picks, np.tile(keys, n))
            spent += len(picks)
            values, chances = self._values(left, seen)
            worth = points + goes_on * values
            sums, tries = sums + worth.reshape(n, each).sum(axis=1), tries + each
            scores = sums / tries
            keep = np.argsort(-scores, kind="stable")[: FINALISTS if r >= rounds - 2 else max(FINALISTS, -(-n // KEEP))]
            if r == rounds - 1:
                records = (points.reshape(n, each), goes_on.reshape(n, each), left, chances)
                break
            candidates, sums = candidates[keep], sums[keep]
        self.shots += spent
        if deep and records is not None:
            scores = self._second(candidates, scores, records, self.budget - spent)
        return candidates[np.argmax(scores)]

    def _first(self, candidates, most):
        """At most so many of the candidates, evenly from all pots."""
        if len(candidates) <= most:
            return candidates
        picked = self._rng.permutation(candidates)
        order = np.argsort(_rank(picked // STROKES), kind="stable")
        return np.sort(picked[order[:most]])

    def _second(self, candidates, scores, records, budget):
        """Scores of the finalists two shots deep."""
        points, goes_on, left, chances = records
        n, each = goes_on.shape
        samples = min(each, max(1, budget // (n * NEXT_SHOTS)))
        if n * NEXT_SHOTS > budget:
            return scores
        rows = [f * each + j for f in range(n) for j in np.flatnonzero(goes_on[f])[:samples].tolist()]
        if not rows:
            return scores
        rows = np.array(rows)
        who, came = np.repeat(np.arange(len(rows)), NEXT_SHOTS), chances[rows]
        picks = self._next_shots(came).reshape(-1)
        from_there = left[rows]
        made, further, then, seen = self._exact.play(from_there, who, picks, np.zeros(len(picks), np.uint64))
        self.shots += len(picks)
        values, _ = self._values(then, seen)
        chance = came[who, picks // STROKES]
        best = (chance * (made + further * values)).reshape(len(rows), NEXT_SHOTS).max(axis=1)
        owner = rows // each
        total, count = np.bincount(owner, best, n), np.bincount(owner, minlength=n)
        mean = np.divide(total, count, out=np.zeros(n), where=count > 0)
        return points.mean(axis=1) + goes_on.mean(axis=1) * mean

    def _next_shots(self, chances):
        """Choices (m, NEXT_SHOTS) to try next where the widest pots have these chances: the strokes that are played most."""
        order = np.argsort(-chances, axis=1, kind="stable")
        half = NEXT_SHOTS // 2
        pots = np.concatenate([np.repeat(order[:, :1], half, 1), np.repeat(order[:, 1:2], NEXT_SHOTS - half, 1)], axis=1)
        pots = np.where(np.take_along_axis(chances, pots, 1) > 0.0, pots, order[:, :1])
        strokes = self._rng.permuted(np.tile(_USUAL, (len(chances), 1)), axis=1)[:, :NEXT_SHOTS]
        return pots * STROKES + strokes


def _rank(groups):
    """How many earlier entries are equal to each."""
    order = np.argsort(groups, kind="stable")
    ranks = np.empty(len(groups), np.int64)
    sorted_groups = groups[order]
    starts = np.searchsorted(sorted_groups, sorted_groups)
    ranks[order] = np.arange(len(groups)) - starts
    return ranks


_USUAL = np.array([choice_of(0, speed, 1, top) for speed in range(1, 7) for top in range(len(TOPS))])
"""Strokes for the second shot: without side, neither the softest nor the hardest."""
