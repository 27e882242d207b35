"""Which errors does advice try? Keys of noise samples made from a seed, apart for each purpose, so that no state's own errors are met."""

import numpy as np
from numpy.typing import NDArray

CHOOSING, JUDGING, GOING_ON = range(3)
"""Purposes: strokes are chosen with other samples than they are judged by, so that a lucky choice does not look better than it is."""


def keys(seed: int, purpose: int, n: int, *more: int) -> NDArray[np.uint64]:
    """n keys of random streams, uint64 (n,): the same for the same numbers, the first of them also for another n."""
    return np.random.default_rng((seed, purpose, *more)).integers(0, 2**64 - 1, n, dtype=np.uint64)
