"""Which stroke is best by simulation? A Monte Carlo search under execution noise, two shots deep.

Strokes are simulated many times from the state of the table, each time with new execution errors. A stroke's score is its points plus, if
the visit goes on, the value of its afterstate. Sequential halving [Karnin, Koren & Somekh 2013] spends the budget: all candidates are
simulated a few times, the better ones more often, and so on. The finalists are compared two shots deep: from their afterstates the best
next shot is searched without errors, and its score is weighted by the chance to pot it.

All candidates of a round use the same noise samples (common random numbers): they are compared under equal luck.
"""

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from snooker_env.geometry import BALL_RADIUS
from snooker_env.planning import RULE_OF_THUMB, SURE, Planner, Positions, action_masks, pots, processors, prospects_of, spread_of
from snooker_env.tasks import STROKES, TOPS, choice_of

from ..features.pot_features import with_pots

KEEP = 3
"""One in ``KEEP`` candidates of a round goes on to the next round."""
FINALISTS = 6
DEEP = 0.4
"""Share of the budget for the second shot."""
NEXT_SHOTS = 16
"""Shots simulated from each afterstate of a finalist."""


class Search:
    """The player that searches for the best shot by simulation: see this module's docstring.

    Parameters
    ----------
    budget : int
        Simulated shots a decision, at least 2.
    seed : int
        Of the noise samples and candidates.
    value : callable, optional
        Values [points] of observations with pots (``pot_features.with_pots``), (m, n) -> (m,), in place of the rule of thumb.
    threads : int, optional
        Tables searched in parallel; all processors by default. The shots found do not depend on it.

    Examples
    --------
    >>> from agents.players.search import Search
    >>> Search(budget=500).options
    {'aim': 'absolute'}
    """

    options = {"aim": "absolute"}  # noqa: RUF012 - a player's options are read, never changed

    def __init__(self, budget=2000, seed=0, value=None, threads=None):
        self.budget, self.value = budget, value
        self._seed, self._decisions, self._threads = seed, 0, threads or processors()
        self._tables: Any = None
        self._workers: list[_Worker] = []

    @property
    def shots(self):
        """Shots simulated so far."""
        return sum(worker.noisy.shots + worker.exact.shots for worker in self._workers)

    def act(self, tables, observations, going):
        """The best shot of each running table: float32 (n, 4)."""
        actions = np.zeros((tables.num_envs, 4), np.float32)
        for k, (found, _) in zip(np.flatnonzero(going).tolist(), self.rank(tables, observations, going), strict=True):
            actions[k] = found[0]
        return actions

    def rank(self, tables, observations, going):
        """The finalists of each running table, best first, with their scores [points]."""
        if self._tables is not tables:
            self._tables, self._workers = tables, [_Worker(self, tables) for _ in range(self._threads)]
        ranked, positions = {}, Positions.of(tables)

        def search(worker, own):
            for k in own:
                ranked[k] = worker.ranked(positions[k : k + 1], np.random.default_rng((self._seed, self._decisions, k)))

        wanted = np.flatnonzero(going).tolist()
        with ThreadPoolExecutor(self._threads) as pool:
            list(pool.map(search, self._workers, (wanted[i :: self._threads] for i in range(self._threads))))
        self._decisions += 1
        return [ranked[k] for k in wanted]


class _Worker:
    """The search, one table after the other, in one thread."""

    def __init__(self, search, tables):
        self.budget, self._value = search.budget, search.value
        self.noisy, self.exact = Planner(tables, threads=1), Planner(tables, noise="none", threads=1)
        noise = self.noisy.noise
        self._sure, self._spread = noise.silent, spread_of(noise, self.noisy.physics)

    def _values(self, left, observations):
        """Values of the afterstates [points], and the chances of their widest pots."""
        values, chances = prospects_of(left, self._spread, SURE if self._sure else RULE_OF_THUMB)
        return values if self._value is None else np.asarray(self._value(with_pots(observations)), np.float64), chances

    def ranked(self, at, rng):
        """The finalists at the one position ``at``, best first: actions and scores."""
        candidates, scores = self._finalists(at, rng)
        order = np.argsort(-scores, kind="stable")
        return candidates[order], scores[order]

    def _finalists(self, at, rng):
        """The actions of the last round, and their scores."""
        if self._sure:
            return self._exactly(at, rng)
        deep = int(DEEP * self.budget) if self.budget >= 200 else 0
        shallow, spent = self.budget - deep, 0
        candidates = self._candidates(at, max(1, shallow // 2), max(1, shallow // 2), rng)
        rounds = 1 + max(0, int(np.ceil(np.log(len(candidates) / FINALISTS) / np.log(KEEP))))
        sums, tries = np.zeros(len(candidates)), 0
        scores, records = sums, None
        for r in range(rounds):
            n = len(candidates)
            each = max(1, (shallow - spent) // (rounds - r) // n)  # one each always fits: all rounds hold less than twice the first
            keys = rng.integers(0, 2**64 - 1, each, dtype=np.uint64)
            points, goes_on, left, seen = self.noisy.play(
                at, np.zeros(n * each, np.int64), np.repeat(candidates, each, 0), np.tile(keys, n)
            )
            spent += n * each
            values, chances = self._values(left, seen)
            sums, tries = sums + (points + goes_on * values).reshape(n, each).sum(axis=1), tries + each
            scores = sums / tries
            if r == rounds - 1:
                records = (points.reshape(n, each), goes_on.reshape(n, each), left, chances)
                break
            keep = np.argsort(-scores, kind="stable")[: FINALISTS if r == rounds - 2 else max(FINALISTS, -(-n // KEEP))]
            candidates, sums = candidates[keep], sums[keep]
        if deep and records is not None:
            scores = self._second(scores, records, self.budget - spent, rng)
        return candidates, scores

    def _exactly(self, at, rng):
        """The finalists without execution noise: one simulation each is enough, so that more candidates are searched two shots deep."""
        candidates = self._candidates(at, max(1, self.budget // 2), self.budget, rng)
        n = len(candidates)
        points, goes_on, left, seen = self.exact.play(at, np.zeros(n, np.int64), candidates)
        values, chances = self._values(left, seen)
        scores = points + goes_on * values
        keep = np.argsort(-scores, kind="stable")[: (self.budget - n) // NEXT_SHOTS]
        if len(keep):
            records = (points[keep, None], goes_on[keep, None], left[keep], chances[keep])
            better = self._second(scores[keep], records, self.budget - n, rng)
            return candidates[keep], better
        return candidates, scores

    def _candidates(self, at, most, without_pots, rng):
        """At most ``most`` strokes at the direct pots, evenly from all; without one ``without_pots`` random shots at the balls on."""
        if pots(at, most=1).ball[0, 0] < 0:
            return _at_balls(at.positions[0], np.flatnonzero(at.balls_on[0]), without_pots, rng)
        picks = np.flatnonzero(action_masks(at)[0])
        if len(picks) > most:
            picks = rng.permutation(picks)
            picks = np.sort(picks[np.argsort(_rank(picks // STROKES), kind="stable")[:most]])
        return self.exact.as_actions(at, np.zeros(len(picks), np.int64), picks)

    def _second(self, scores, records, budget, rng):
        """Scores of the finalists two shots deep."""
        points, goes_on, left, chances = records
        n, each = goes_on.shape
        samples = min(each, max(1, budget // (n * NEXT_SHOTS)))
        rows = np.array([f * each + j for f in range(n) for j in np.flatnonzero(goes_on[f])[:samples].tolist()], np.int64)
        if n * NEXT_SHOTS > budget or not len(rows):
            return scores
        who, came, from_there = np.repeat(np.arange(len(rows)), NEXT_SHOTS), chances[rows], left[rows]
        picks = self._next_shots(came, rng).reshape(-1)
        actions = self.exact.as_actions(from_there, who, picks)
        made, further, then, seen = self.exact.play(from_there, who, actions)
        values, _ = self._values(then, seen)
        chance = came[who, picks // STROKES]
        best = (chance * (made + further * values)).reshape(len(rows), NEXT_SHOTS).max(axis=1)
        owner = rows // each
        total, count = np.bincount(owner, best, n), np.bincount(owner, minlength=n)
        mean = np.divide(total, count, out=np.zeros(n), where=count > 0)
        return points.mean(axis=1) + goes_on.mean(axis=1) * mean

    def _next_shots(self, chances, rng):
        """Choices (m, NEXT_SHOTS) for the second shot, from the chances of the pots: common strokes at the two likeliest pots."""
        order = np.argsort(-chances, axis=1, kind="stable")
        half = NEXT_SHOTS // 2
        widest = np.concatenate([np.repeat(order[:, :1], half, 1), np.repeat(order[:, 1:2], NEXT_SHOTS - half, 1)], axis=1)
        widest = np.where(np.take_along_axis(chances, widest, 1) > 0.0, widest, order[:, :1])
        return widest * STROKES + rng.permuted(np.tile(_USUAL, (len(chances), 1)), axis=1)[:, :NEXT_SHOTS]


def _at_balls(positions, balls, n, rng):
    """n random actions that send the cue ball at one of the ``balls``, with any speed and spin: for break-offs, plants and flukes."""
    to = positions[rng.choice(balls, n)] - positions[0]
    reach = np.arcsin(np.minimum(1.0, 2.0 * BALL_RADIUS / np.hypot(*to.T)))
    turned = (np.arctan2(to[:, 1], to[:, 0]) + rng.uniform(-1.0, 1.0, n) * reach) / np.pi
    tips = rng.uniform(-0.6, 0.6, (n, 2))  # of the action's unit: within the disc
    return np.column_stack([rng.uniform(-0.7, 1.0, n), tips, turned - 2.0 * np.round(0.5 * turned)]).astype(np.float32)


def _rank(groups):
    """The number of earlier equal entries, for each entry."""
    order = np.argsort(groups, kind="stable")
    ranks = np.empty(len(groups), np.int64)
    sorted_groups = groups[order]
    starts = np.searchsorted(sorted_groups, sorted_groups)
    ranks[order] = np.arange(len(groups)) - starts
    return ranks


_USUAL = np.array([choice_of(0, speed, 1, top) for speed in range(1, 7) for top in range(len(TOPS))])
"""Strokes for the second shot: without side, neither the softest nor the hardest."""
