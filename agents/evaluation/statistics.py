"""How sure is a figure of many visits by several training runs? Means, ratios and inter-quartile means with bootstrap intervals.

Scores come as a matrix (runs, visits): every run has played the same visits. Two things are a sample and both are drawn again, with
replacement: the runs (other training seeds) and the visits (other tables and other luck), the visits the same for every run, which is the
bootstrap of crossed factors [Owen, The pigeonhole bootstrap, 2007]. Of R > 1 runs R - 1 are drawn, since R would make their variance
(R - 1) / R of what it is [Rao & Wu 1988]. With one run only the visits are drawn: such an interval says nothing about other seeds.

Intervals are percentiles. Where luck within a visit matters most they are too wide (of 5 runs up to 1.5 times, never too narrow by it);
where nothing but the seeds differs, 5 of them are few and the 95 % interval covers 85 % (``test_statistics`` measures both).
A bootstrap cannot say how rare a thing is that was never seen, or always: that bound is ``unseen``.
"""

from functools import lru_cache

import numpy as np

RESAMPLES = 2000


def iqm(values):
    """The inter-quartile mean: that of the middle half. A value on the edge counts with the part that is inside."""
    unique, counts = np.unique(values, return_counts=True)
    return float(_middle_mean(unique, counts[None])[0])


def _middle_mean(values, weights):
    """Mean of the middle half of the sorted ``values`` (m,), for each row of their ``weights`` (n, m)."""
    upto = np.cumsum(weights, axis=1, dtype=np.float64)
    total = upto[:, -1:]
    inside = np.minimum(upto, 0.75 * total) - np.maximum(upto - weights, 0.25 * total)
    return (np.maximum(inside, 0.0) @ values) / (0.5 * total[:, 0])


@lru_cache(maxsize=16)
def _drawn(size, draws, n, seed):
    """How often each of ``size`` things comes when ``draws`` are drawn with replacement: (n, size), n times over."""
    picks = np.random.default_rng(seed).integers(size, size=(n, draws)) + size * np.arange(n)[:, None]
    return np.bincount(picks.ravel(), minlength=n * size).reshape(n, size).astype(np.float64)


class Resamples:
    """``n`` bootstrap samples of a matrix (runs, visits).

    Two agents with the same number of visits get the same visits in each sample (their figures can be paired), but runs of their own if
    their ``seed`` differs.
    """

    def __init__(self, runs, visits, n=RESAMPLES, seed=0):
        self._runs, self._visits = _drawn(runs, max(1, runs - 1), n, (1, seed)), _drawn(visits, visits, n, (0, 0))

    def sums(self, scores):
        """The sum of ``scores`` (runs, visits) in each sample: (n,)."""
        return ((self._visits @ scores.T) * self._runs).sum(axis=1)

    def ratios(self, above, below):
        """The ratio of two sums in each sample; NaN where the lower one is 0."""
        over = self.sums(below)
        return np.divide(self.sums(above), over, out=np.full(len(over), np.nan), where=over != 0)

    def iqms(self, scores):
        """The inter-quartile mean over all runs and visits in each sample."""
        values, which = np.unique(scores, return_inverse=True)
        which = which.reshape(scores.shape)
        weights = sum(
            self._runs[:, r, None] * (self._visits @ np.eye(len(values))[which[r]]) for r in range(len(scores))
        )  # fmt: skip
        return _middle_mean(values, weights)


def interval(samples, level=0.95):
    """(low, high): the percentile interval of bootstrap samples.

    NaN where the samples say nothing: one of them has no value, or all have the same (no century in 500 visits is not "none, for sure").
    """
    low, high = np.quantile(samples, [(1 - level) / 2, (1 + level) / 2])
    return (float(low), float(high)) if np.ptp(samples) > 0 else (float("nan"), float("nan"))


def unseen(n, level=0.95):
    """The largest share of a thing that ``n`` independent trials without one leave possible, nearly 3 / n: exact, one-sided
    [Clopper & Pearson 1934].

    Runs that have all met the same ``n`` tables and luck count once, not ``n`` times each: of tables and luck that is never too bold, of
    other training seeds it says nothing.
    """
    return 1.0 - (1.0 - level) ** (1.0 / n)
