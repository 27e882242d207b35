"""How do the two simple built-in players rank strokes? By the tolerance of the pot, at one speed; or at random."""

import numpy as np

from ..planning import Positions, action_masks, pots
from ..tasks.discrete_actions import SIDES, SPEEDS, TOPS, choice_of
from . import seeds
from .advisor import Advisor, Ranked
from .practice import Practice, starts, stroke_of_row

USUAL = 2.3
"""Cue speed of the ghost-ball player [m/s]."""


class GhostBallAdvisor(Advisor):
    """The built-in "ghost_ball": the widest direct pots with solved aims, no spin and one soft speed; else the first other line.

    Its scores are tolerances of the aim [mrad].
    """

    name = "ghost_ball"

    def rank(self, practice: Practice, at: Positions, n: int, seed: int) -> Ranked:
        """The widest pots in the one position, from the best place if the cue ball is in hand."""
        there = starts(practice, at, 1)
        found = pots(there)
        many = max(1, int((found.ball[0] >= 0).sum()))
        choices = np.array([choice_of(pot, SPEEDS.index(USUAL), SIDES.index(0.0), TOPS.index(0.0)) for pot in range(many)])
        strokes = practice.chosen(there, np.zeros(many, np.int64), choices)
        in_hand, wide = bool(at.in_hand[0]), (1e3 * found.tolerance[0]).tolist()
        return [(stroke_of_row(row, there, in_hand), wide[k]) for k, row in enumerate(strokes)]


class RandomAdvisor(Advisor):
    """The built-in "random": uniformly random choices of ``action="discrete"``, from a random place in the D if the cue ball is in hand."""

    name = "random"

    def rank(self, practice: Practice, at: Positions, n: int, seed: int) -> Ranked:
        """n random choices of those available, without scores."""
        rng = np.random.default_rng((seed, seeds.CHOOSING))
        there = starts(practice, at, 100)
        rows, choices = np.nonzero(action_masks(there))
        some = rng.permutation(len(rows))[: max(1, n)]
        strokes, in_hand = practice.chosen(there, rows[some], choices[some]), bool(at.in_hand[0])
        return [(stroke_of_row(row, there[k : k + 1], in_hand), None) for k, row in zip(rows[some].tolist(), strokes, strict=True)]
