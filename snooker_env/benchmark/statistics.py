"""How sure is a figure of many visits by several training runs? Bootstrap intervals of means, ratios and IQMs.

Scores are a matrix (runs, visits). Runs (training seeds) and visits (tables and luck) are both drawn with
replacement, the visits the same for every run: the bootstrap of crossed factors [Owen, The pigeonhole bootstrap,
2007]. Of R > 1 runs R - 1 are drawn, since R would make their variance (R - 1) / R of what it is [Rao & Wu 1988].
With one run only the visits are drawn: that says nothing about other seeds. Percentile intervals are too wide
where luck within a visit matters most (5 runs: up to 1.5 times), and the 95 % interval covers 85 % where only 5
seeds differ (``test_statistics`` measures both). How rare the never seen is, a bootstrap cannot say: ``bound_if_none``.
"""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from .._lib.types import Floats

RESAMPLES = 2000  # number of bootstrap samples
LEVEL = 0.95  # of all intervals and bounds
SHRINK = 10  # tables: the share of luck that so many show counts half


def iqm(values: ArrayLike) -> float:
    """The inter-quartile mean: the mean of the middle half."""
    unique, counts = np.unique(values, return_counts=True)
    return float(_middle_mean(unique, counts[None])[0])


def _middle_mean(values, weights):
    """Mean of the middle half of the sorted ``values`` (m,), for each row of their ``weights`` (n, m)."""
    upto = np.cumsum(weights, axis=1, dtype=np.float64)
    total = upto[:, -1:]
    inside = np.minimum(upto, 0.75 * total) - np.maximum(upto - weights, 0.25 * total)
    return (np.maximum(inside, 0.0) @ values) / (0.5 * total[:, 0])


@lru_cache(maxsize=16)
def _draw(size, draws, n, seed):
    """How often each of ``size`` things comes in ``draws`` with replacement, n times: (n, size)."""
    picks = np.random.default_rng(seed).integers(size, size=(n, draws)) + size * np.arange(n)[:, None]
    return np.bincount(picks.ravel(), minlength=n * size).reshape(n, size).astype(np.float64)


class Resamples:
    """n bootstrap samples of matrices (runs, visits): as many visits are the same ones; seeds draw runs."""

    def __init__(self, runs: int, visits: int, n: int = RESAMPLES, seed: int = 0):
        self._runs = _draw(runs, max(1, runs - 1), n, (1, seed))
        self._visits = _draw(visits, visits, n, (0, 0))

    def sums(self, scores: Floats) -> Floats:
        """The sum of a matrix, float (runs, visits), in each sample: float64 (n,)."""
        # one product a run: BLAS divides a larger one among its threads, whose number would decide last bits
        means = np.stack([self._visits @ one for one in scores], axis=1)
        return (means * self._runs).sum(axis=1)

    def iqms(self, scores: Floats) -> Floats:
        """The inter-quartile mean of a matrix, float (runs, visits), in each sample: float64 (n,)."""
        values, which = np.unique(scores, return_inverse=True)
        which, eye = which.reshape(scores.shape), np.eye(len(values))
        each = (self._runs[:, r, None] * (self._visits @ eye[one]) for r, one in enumerate(which))
        return _middle_mean(values, sum(each))


def bound_if_none(n: float) -> float:
    """Upper bound of a share of which ``n`` independent trials showed no case [Clopper & Pearson 1934]: exact, one-sided, about
    3 / n at 95 %. Runs on the same tables count once: it holds for other tables and errors, not for other training seeds."""
    return 1.0 - (1.0 - LEVEL) ** (1.0 / n)


def figure(value: float, samples: Floats | Sequence[float]) -> dict[str, float | None]:
    """A figure with its 95 % percentile interval: "value", "low" and "high", None where a number is not finite. An interval
    is None if a sample is NaN or all are equal: no century in 500 visits does not prove that there are none."""
    tails = np.quantile(samples, [(1 - LEVEL) / 2, (1 + LEVEL) / 2]) if np.ptp(samples) > 0 else [np.nan] * 2
    numbers = zip(("value", "low", "high"), (value, *tails), strict=True)
    return {name: float(x) if np.isfinite(x) else None for name, x in numbers}


def adjust(scores: Floats, luck: Floats) -> Floats:
    """Scores (runs, visits) less a share of their luck (runs, visits), whose expectation is 0.

    The share that varies least is fitted to the other half of the tables, every second one, and shrunk where they are few:
    it does not depend on the luck that it multiplies, so that the mean stays unbiased."""
    adjusted = scores.astype(np.float64)
    for half in (0, 1):
        other, its = scores[:, 1 - half :: 2], luck[:, 1 - half :: 2]
        square, visits = float((its * its).sum()), other.shape[1]
        if square > 0.0:
            share = float(((other - other.mean()) * its).sum()) / square * visits / (visits + SHRINK)
            adjusted[:, half::2] -= share * luck[:, half::2]
    return adjusted
