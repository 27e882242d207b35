"""How does a visit go on? A fast player continues many at once, with execution errors, to their end.

1. It tries twelve strokes at the two widest pots, once each and without errors. The value of a stroke is the
   chance of its pot, by the rule of thumb, times its points plus the value of the position left.
2. The best three meet five noise samples, and the best of them is played.
3. Where there is no direct pot, so it chooses among strokes at what it sees of the balls on, or escapes.

This is a shallow search, made to be fast: a stronger player makes more of the same visits."""

import numpy as np

from .._types import Floats, Ints, Words
from ..planning import Positions, action_masks
from ..tasks.discrete_actions import SIDES, STROKES, choice_of
from .practice import GOING_ON, Practice, keys

PICKS = np.array([choice_of(p, s, SIDES.index(0.0), t) for p in range(2) for s in (1, 3, 5) for t in (1, 3)])
"""Choices tried: 1.3, 2.3 and 3.6 m/s, tip 0.2 R up or down. Without errors, extremes are overestimated."""
BEST = 3  # number of strokes that meet noise samples
EVEN_SAMPLES = (354, 1840, 979, 2326, 3875)  # keys of five noise samples in which errors are evenly spread


def played_on(practice: Practice, left: Positions, visits: Ints, seed: int) -> Floats:
    """Points (n,) of the rest of n visits from ``left``; equal numbers ``visits`` (n,) meet equal errors."""
    total, going, number = np.zeros(len(left)), np.arange(len(left)), 0
    most = int(visits.max()) + 1 if len(visits) else 0
    while len(going):
        strokes = _choose(practice, left)
        samples = keys(seed, GOING_ON, most, number)[visits[going]]
        stops = practice.play(left, np.arange(len(left)), strokes, samples)
        total[going] += stops.points
        left, going, number = stops.afterstates[stops.goes_on], going[stops.goes_on], number + 1
    return total


def _choose(practice: Practice, at: Positions) -> Floats:
    """The strokes that the fast player plays in n positions: (n, 5)."""
    n = len(at)
    rows, places = np.nonzero(action_masks(at, cue=practice.options.cue)[:, PICKS])
    choices = PICKS[places]
    strokes, worth = np.zeros((n, len(PICKS), 5)), np.full((n, len(PICKS)), -1.0)
    strokes[rows, places] = practice.chosen(at, rows, choices)
    _, chances = practice.prospects(at)
    led_to = _led_to(practice, at, rows, strokes[rows, places], None)
    worth[rows, places] = chances[rows, choices // STROKES] * led_to
    # each position has at least six
    best = np.argsort(-worth, axis=1, kind="stable")[:, : 1 if practice.sure else BEST]
    finalists = np.take_along_axis(strokes, best[:, :, None], 1)
    if practice.sure:
        return finalists[:, 0]
    k = len(EVEN_SAMPLES)
    tries = np.repeat(finalists.reshape(-1, 5), k, 0)
    brought = _led_to(practice, at, np.repeat(np.arange(n), BEST * k), tries, np.tile(EVEN_SAMPLES, n * BEST))
    return finalists[np.arange(n), brought.reshape(n, BEST, k).mean(axis=2).argmax(axis=1)]


def _led_to(practice: Practice, at: Positions, rows: Ints, strokes: Floats, samples: Words | None) -> Floats:
    """Points of strokes plus the values of the positions left: (n,)."""
    stops = practice.play(at, rows, strokes, samples)
    return stops.points + stops.goes_on * practice.prospects(stops.afterstates)[0]
