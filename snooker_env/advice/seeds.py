"""With which errors does advice try strokes? Keys drawn from a seed, separate for each purpose and from a state's own stream."""

import numpy as np
from numpy.typing import NDArray

CHOOSING, JUDGING, GOING_ON = range(3)
"""Purposes. Strokes are chosen with other samples than they are judged with, so that a lucky choice is not overestimated."""


def keys(seed: int, purpose: int, n: int, *more: int) -> NDArray[np.uint64]:
    """n keys of random streams, uint64 (n,). Equal arguments give equal keys, and a larger n begins with the same keys."""
    return np.random.default_rng((seed, purpose, *more)).integers(0, 2**64 - 1, n, dtype=np.uint64)
