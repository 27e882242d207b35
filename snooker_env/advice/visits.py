"""How does a visit go on? A fast player continues many at once, with execution errors, to their end: a search with the rule
of thumb as its value and few simulated shots. A stronger player makes more of the same visits."""

import numpy as np

from .._lib.types import Floats, Ints
from ..planning import Positions
from .practice import GOING_ON, Practice, keys


def played_on(practice: Practice, left: Positions, visits: Ints, seed: int) -> Floats:
    """Points (n,) of the rest of n visits from ``left``; equal numbers ``visits`` (n,) meet equal errors."""
    total, going, number = np.zeros(len(left)), np.arange(len(left)), 0
    most = int(visits.max()) + 1 if len(visits) else 0
    while len(going):
        ranked = practice.quick.rank(left, visits[going])
        strokes = np.array([one.strokes.values[0] for one in ranked])
        samples = keys(seed, GOING_ON, most, number)[visits[going]]
        stops = practice.play(left, np.arange(len(left)), strokes, samples)
        total[going] += stops.points
        left, going, number = stops.afterstates[stops.goes_on], going[stops.goes_on], number + 1
    return total
