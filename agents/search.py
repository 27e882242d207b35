"""What is the best of the choices, found by trying them out? Monte Carlo by simulation under execution noise, two shots deep.

From the true state of a table many copies are played, each with errors of its own (``envs.noise``). A shot is worth its points and, if the
visit goes on, the value of the position it leaves. Sequential halving [Karnin, Koren & Somekh 2013] spends the budget: all candidates are
tried a little, the better part a little more, and so on. The last few are judged by the second shot: from positions that they left, the
best next shot is sought without errors, worth the chance to make it times what it brings.

All candidates of a round meet the same errors (common random numbers): they differ by their own merits, not by luck.
"""

from dataclasses import replace
from math import erf, exp, sqrt
from typing import Any

import numpy as np

from snooker_env._jit import entry
from snooker_env.envs.choices import POTS, STROKES, TOPS
from snooker_env.envs.noise import N_AIM, N_TIP, Noise
from snooker_env.envs.shooting import Shooter
from snooker_env.envs.visit import OVER, Returned, Visits, Work
from snooker_env.game.balls import BALL_RADIUS, VALUES, balls_on_kernel, bits
from snooker_env.game.pots import POCKETS, POT_COLUMNS, find_pots
from snooker_env.physics.cue import squirt

from .players import DISCRETE, choice_of
from .view import with_pots

CHUNK = 128
"""Copies played in one go: their work space stays in the cache."""

FOLLOWS = 25.0
"""Points that a pot is worth beside its own: what the rest of the visit brings."""
SECOND, THIRD = 0.15, 0.05
"""What the second and the third best pot of a position add: they leave a choice of where to go next."""
FAR = 0.1
"""How much less likely a pot is for each metre that the balls have to run."""

KEEP = 3
"""Of a round's candidates one in so many goes on to the next."""
FINALISTS = 6
DEEP = 0.4
"""Share of the budget for the second shot."""
NEXT_SHOTS = 16
"""Shots tried from each position that a finalist left."""


@entry
def _prospects(positions, on_table, game, errors, end_mass_ratio, constants, values, chances):
    """For n tables: ``values`` (n,) of the positions, by hand, and ``chances`` (n, POTS) to make each of the widest pots.

    ``errors`` as ``Noise.pack`` gives them; an error of the tip's side turns the cue ball by squirt, most of what goes wrong.
    """
    turned = squirt(errors[N_TIP], end_mass_ratio)
    spread = max(1e-5, sqrt(errors[N_AIM] ** 2 + turned * turned))
    found = np.empty((16, POT_COLUMNS))
    follows, second, third, far = constants
    for k in range(len(values)):
        chances[k, :] = 0.0
        values[k] = 0.0
        p, on = positions[k], balls_on_kernel(game[k, 0], bits(on_table[k]))
        many = find_pots(p, on_table[k], on, BALL_RADIUS, found) if on_table[k, 0] else 0
        a = b = c = 0.0
        for j in range(many):
            ball, pocket, gx, gy = int(found[j, 0]), int(found[j, 1]), found[j, 2], found[j, 3]
            path = sqrt((gx - p[0, 0]) ** 2 + (gy - p[0, 1]) ** 2)
            run = sqrt((POCKETS[pocket, 0] - p[ball, 0]) ** 2 + (POCKETS[pocket, 1] - p[ball, 1]) ** 2)
            chance = erf(found[j, 5] / (spread * sqrt(2.0))) * exp(-far * (path + run))
            if j < chances.shape[1]:
                chances[k, j] = chance
            worth = chance * (VALUES[ball] + follows)
            if worth > a:
                a, b, c = worth, a, b
            elif worth > b:
                b, c = worth, b
            elif worth > c:
                c = worth
        values[k] = a + second * b + third * c


class Position:
    """Tables to copy shots from: positions (m, 22, 2), on_table (m, 22), game (m, 5)."""

    def __init__(self, positions, on_table, game):
        self.positions, self.on_table, self.game = positions, on_table, game

    def __len__(self):
        return len(self.game)

    def __getitem__(self, rows):
        return Position(self.positions[rows], self.on_table[rows], self.game[rows])


class Copies:
    """Plays shots on copies of positions: the rules of the tables, but the given noise."""

    def __init__(self, rules, noise):
        s = rules.shooter
        self._visits = Visits(replace(rules, shooter=Shooter(s.actions, noise, s.physics, s.table, s.fidelity)), CHUNK)
        self._work, self._out, self._none = Work(CHUNK), Returned(CHUNK), np.zeros(CHUNK, np.bool_)
        self.shots = 0

    def play(self, at, rows, picks, keys):
        """Choice ``picks[i]`` on a copy of ``at[rows[i]]`` with the errors of the stream with key ``keys[i]``.

        Returns the points (m,), whether the visit goes on (m,), the ``Position`` left and its flat observations.
        """
        m, v, out = len(rows), self._visits, self._out
        points, goes_on, left = np.empty(m), np.empty(m, np.bool_), at[rows]
        observations = np.empty((m, out.observations.shape[1]), np.float32)
        for start in range(0, m, CHUNK):
            part = slice(start, min(m, start + CHUNK))
            n = part.stop - start
            v.positions[:n], v.on_table[:n], v.game[:n] = left.positions[part], left.on_table[part], left.game[part]
            v.streams[:n, 0], v.streams[:n, 1] = keys[part], 0
            v.play(picks[part, None].astype(np.float64), self._none[:n], out, self._work)
            left.positions[part], left.on_table[part], left.game[part] = v.positions[:n], v.on_table[:n], v.game[:n]
            points[part], goes_on[part], observations[part] = out.reals[:n, 0], v.game[:n, OVER] == 0, out.observations[:n]
        self.shots += m
        return points, goes_on, left, observations


class Search:
    """Looks for the best choice with ``budget`` simulated shots a decision.

    ``noise``: the errors that it expects, a level or fields as the environment takes them, None for those of the tables; ``value``: worth
    [points] of flat observations with pots (``view.with_pots``), (m, n) -> (m,), in place of the value by hand.
    """

    options = DISCRETE

    def __init__(self, budget=2000, noise=None, seed=0, value=None, constants=(FOLLOWS, SECOND, THIRD, FAR)):
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
        self._errors, self._end_mass_ratio = noise.pack(BALL_RADIUS), rules.shooter.physics.end_mass_ratio

    def _values(self, left, observations):
        """What the positions left are worth [points], and the chances of their widest pots."""
        values, chances = np.empty(len(left)), np.empty((len(left), POTS))
        _prospects(
            left.positions, left.on_table, left.game, self._errors, self._end_mass_ratio, self._constants, values, chances
        )  # fmt: skip
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
