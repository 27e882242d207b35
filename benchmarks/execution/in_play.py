"""How often does a player pot, in play, who always takes the likeliest pot that the simulator finds?"""

import numpy as np

from snooker_env.benchmark import play_visits
from snooker_env.planning import Planner, action_masks
from snooker_env.players import ChoicePlayer
from snooker_env.tasks import POTS, SIDES, SPEEDS, TOPS, choice_of

PICKS = np.array(
    [
        choice_of(pot, speed, SIDES.index(0.0), TOPS.index(0.0))
        for pot in range(POTS)
        for speed in range(len(SPEEDS))
        if 1 < SPEEDS[speed] < 4
    ]
)
"""What it chooses from: every direct pot, without spin, at speeds as played."""
FIRST, KEEP, MORE = 16, 4, 64
"""Tries of each choice; how many of the best are tried on; tries of those."""


class Likeliest(ChoicePlayer):
    """Plays every choice under its own errors on copies of the table, and takes the one that scores most
    often."""

    name = "likeliest"

    def __init__(self, threads=2):
        self._threads = threads
        self.chances: list[np.ndarray] = []
        """What it expected of each stroke, an array for each time that it was asked."""

    def _bind(self, options):
        super()._bind(options)
        self._tries = Planner(
            options.but(action="discrete", elevation=False, placement=False), threads=self._threads
        )

    def scores(self, at, seeds):
        """The share of tries in which each choice scored; below 0 for those that were tried least."""
        masks = action_masks(at)
        keys = np.random.default_rng(seeds.tolist())
        chances = np.where(masks[:, PICKS], 0.0, -1.0)
        rows, columns = np.nonzero(masks[:, PICKS])
        chances[rows, columns] = self._share(at, rows, columns, FIRST, keys)
        rows, columns = (
            np.repeat(np.arange(len(at)), KEEP),
            np.argsort(-chances, axis=1, kind="stable")[:, :KEEP].ravel(),
        )
        rows, columns = (a[chances[rows, columns] >= 0.0] for a in (rows, columns))
        judged = np.full(chances.shape, -1.0)
        judged[rows, columns] = self._share(at, rows, columns, MORE, keys)
        self.chances.append(judged.max(axis=1))
        scores = np.where(masks, -2.0, -np.inf)
        scores[:, PICKS] = np.where(masks[:, PICKS], judged, -np.inf)
        return scores

    def _share(self, at, rows, columns, n, rng):
        """How often each of these choices scores in n tries, all with the same errors."""
        keys = rng.integers(0, 2**64 - 1, n, dtype=np.uint64)
        rows, picks, keys = np.repeat(rows, n), np.repeat(PICKS[columns], n), np.tile(keys, len(rows))
        return (self._tries.play(at, rows, picks, keys).points > 0).reshape(-1, n).mean(axis=1)


class WidestPot(ChoicePlayer):
    """The widest pot, aim solved, at 2.3 m/s without spin."""

    name = "widest_pot"

    def scores(self, at, seeds):
        """1 for that choice."""
        masks = action_masks(at)
        scores = np.where(masks, 0.0, -np.inf)
        scores[:, choice_of(0, SPEEDS.index(2.3), SIDES.index(0.0), TOPS.index(0.0))] = 1.0
        return scores


def in_play(level, visits, seed, **options):
    """(made (m,), expected (m,)): of every stroke of so many visits from held-out tables whether it scored,
    and the chance it was given."""
    player = Likeliest()
    strokes = play_visits(player, visits, noise=level, seed=seed, **options)
    return strokes.points > 0, np.concatenate(player.chances)


def first_pots(level, layout, visits, **options):
    """Whether the first stroke of each of so many visits scored: at the widest pot, aim solved, 2.3 m/s."""
    strokes = play_visits(WidestPot(), visits, noise=level, layout=layout, **options)
    return strokes.points[strokes.number == 0] > 0
