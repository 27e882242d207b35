"""How often does a player pot, in play, who always takes the likeliest pot that the simulator finds?"""

import numpy as np

from agents.players.built_in import GhostBall
from snooker_env.benchmark import play_visits
from snooker_env.planning import Planner, Positions
from snooker_env.tasks import POTS, SIDES, SPEEDS, TOPS, choice_of

PICKS = np.array([
    choice_of(pot, speed, SIDES.index(0.0), TOPS.index(0.0)) for pot in range(POTS) for speed in range(len(SPEEDS)) if 1 < SPEEDS[speed] < 4
])  # fmt: skip
"""What it chooses from: every direct pot, without spin, at speeds as played."""
FIRST, KEEP, MORE = 16, 4, 64
"""Tries of each choice; how many of the best are tried on; tries of those."""


class Likeliest:
    """Plays every choice under its own errors on copies of the table, and takes the one that scores most often."""

    options = {"action": "discrete"}  # noqa: RUF012 - a player's options are read, never changed

    def __init__(self, seed=0, threads=2):
        self._rng, self._threads, self._tables, self._planner = np.random.default_rng(seed), threads, None, None
        self.chances: list[np.ndarray] = []
        """What it expected of each stroke, an array for each time that it was asked."""

    def act(self, tables, observations, going):
        """The likeliest pot of each table going."""
        if self._tables is not tables:
            self._tables, self._planner = tables, Planner(tables, threads=self._threads)
        at = Positions.of(tables)[going]
        there = tables.action_masks()[going][:, PICKS]
        chances = np.where(there, 0.0, -1.0)
        rows, columns = np.nonzero(there)
        chances[rows, columns] = self._share(at, rows, columns, FIRST)
        rows, columns = np.repeat(np.arange(len(at)), KEEP), np.argsort(-chances, axis=1, kind="stable")[:, :KEEP].ravel()
        rows, columns = (a[chances[rows, columns] >= 0.0] for a in (rows, columns))
        judged = np.full(chances.shape, -1.0)
        judged[rows, columns] = self._share(at, rows, columns, MORE)
        self.chances.append(judged.max(axis=1))
        picks = np.zeros(len(going), np.int64)
        picks[going] = PICKS[judged.argmax(axis=1)]
        return picks

    def _share(self, at, rows, columns, n):
        """How often each of these choices scores in n tries, all with the same errors."""
        assert self._planner is not None
        keys = self._rng.integers(0, 2**64 - 1, n, dtype=np.uint64)
        points = self._planner.play(at, np.repeat(rows, n), np.repeat(PICKS[columns], n), np.tile(keys, len(rows)))[0]
        return (points > 0).reshape(-1, n).mean(axis=1)


def in_play(level, visits, seed, **options):
    """(made (m,), expected (m,)): of every stroke of so many visits from held-out tables whether it scored, and the chance it was given."""
    player = Likeliest(seed)
    strokes = play_visits(player, visits, noise=level, **options)
    return strokes.made, np.concatenate(player.chances)


def first_pots(level, layout, visits, **options):
    """Whether the first stroke of each of so many visits scored: at the widest pot, aim solved, 2.3 m/s."""
    strokes = play_visits(GhostBall(), visits, noise=level, layout=layout, **options)
    return strokes.made[strokes.number == 0]
