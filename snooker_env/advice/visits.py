"""How does a visit go on? From many positions at once a quick player plays on under noise, stroke after stroke, to the end of the visit.

The player looks at plain strokes at the two widest pots once each, without errors, and takes the one with the highest product of the pot's
chance, by the rule of thumb, and what it leads to: its points and what the position left promises. Where there is no direct pot it strikes
the nearest ball on full. It is the built-in lookahead with as little looking as possible: a hundred visits on open
tables take about half a second.
"""

import numpy as np
from numpy.typing import NDArray

from ..planning import Positions, action_masks
from ..tasks.discrete_actions import SIDES, STROKES, choice_of
from . import seeds
from .candidates import rows_of_choices
from .practice import Practice

PICKS = np.array([choice_of(p, s, SIDES.index(0.0), t) for p in range(2) for s in (1, 3, 5) for t in (1, 3)])
"""The choices that are looked at: 1.3, 2.3 and 3.6 m/s, tip 0.2 R above and below the middle. Looked at once each, without errors,
these few lead to longer visits than twice as many with wilder strokes, which look good only while they come out as intended."""


def played_on(practice: Practice, left: Positions, visits: NDArray[np.int64], seed: int) -> NDArray[np.float64]:
    """Points of the rest of n visits, played on from the positions ``left``: (n,).

    ``visits`` (n,): the number of each; visits with the same number meet the same errors in their second stroke, their third, and so on.
    """
    total, going, number = np.zeros(len(left)), np.arange(len(left)), 0
    most = int(visits.max()) + 1 if len(visits) else 0
    while len(going):
        rows, strokes = _choose(practice, left)
        samples = seeds.keys(seed, seeds.GOING_ON, most, number)[visits[going]]
        stops = practice.play(left, rows, strokes, samples)
        total[going] += stops.points
        left, going, number = stops.afterstates[stops.goes_on], going[stops.goes_on], number + 1
    return total


def _choose(practice: Practice, at: Positions) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """The stroke of the quick player at each of n positions: rows (n,) and strokes (n, 5)."""
    n = len(at)
    rows, places = np.nonzero(action_masks(at)[:, PICKS])
    choices = PICKS[places]
    strokes = rows_of_choices(practice, at, rows, choices)
    look = practice.play(at, rows, strokes)
    _, chances = practice.prospects(at)
    worth = np.full((n, len(PICKS)), -1.0)
    worth[rows, places] = chances[rows, choices // STROKES] * (look.points + look.goes_on * practice.prospects(look.afterstates)[0])
    where = np.full((n, len(PICKS)), -1)
    where[rows, places] = np.arange(len(rows))
    return np.arange(n), strokes[where[np.arange(n), worth.argmax(axis=1)]]
