"""Are the figures of ``agents.evaluate`` as sure as they say?"""

import os
import subprocess
import sys

import numpy as np
import pytest
from scipy import stats

from agents.evaluation.entrants import Entrant
from agents.evaluation.metrics import EntrantMetrics, draw_ratios
from snooker_env.benchmark.statistics import Resamples, iqm


def test_iqm_is_scipys_trimmed_mean():
    rng = np.random.default_rng(0)
    for n in (4, 8, 400):
        for values in (rng.normal(size=n), rng.integers(0, 6, n).astype(float)):
            assert iqm(values) == pytest.approx(stats.trim_mean(values, 0.25))
    # edges count with the part that is inside
    assert iqm([1, 2, 10]) == pytest.approx((0.25 * 1 + 2 + 0.25 * 10) / 1.5)
    assert iqm([3.0]) == 3.0


def test_samples_are_those_of_a_plain_bootstrap():
    """Sums, ratios and inter-quartile means against the matrix drawn row by row."""
    rng = np.random.default_rng(1)
    x, y = rng.integers(0, 9, (3, 40)).astype(float), rng.integers(1, 5, (3, 40)).astype(float)
    samples = Resamples(3, 40, 50, seed=2)
    sums, shares, iqms = samples.sums(x), draw_ratios(samples, x, y), samples.iqms(x)
    for k in range(50):
        runs = np.repeat(np.arange(3), samples._runs[k].astype(int))
        tables = np.repeat(np.arange(40), samples._visits[k].astype(int))
        assert len(runs) == 2 and len(tables) == 40
        drawn = x[np.ix_(runs, tables)]
        assert sums[k] == pytest.approx(drawn.sum())
        assert shares[k] == pytest.approx(drawn.sum() / y[np.ix_(runs, tables)].sum())
        assert iqms[k] == pytest.approx(stats.trim_mean(drawn.ravel(), 0.25))


def played(label, points):
    """A ``EntrantMetrics`` with these points (runs, visits) and nothing else."""
    return EntrantMetrics(Entrant(label, ("x",) * len(points)), {"points": points, "pots": points}, [], 1000)


def test_paired_ratio():
    rng = np.random.default_rng(5)
    base = rng.exponential(10.0, (1, 400))
    exact = played("twice", 2 * base).ratios(played("base", base))["points_a_visit"]
    assert exact["value"] == pytest.approx(2)
    assert (exact["low"], exact["high"]) in ((None, None), pytest.approx((2, 2)))
    near, apart = (
        played("other", points).ratios(played("base", base))["points_a_visit"]
        for points in (2 * base + rng.normal(0, 1, base.shape), 2 * rng.permuted(base, axis=1))
    )
    assert near["low"] < 2 < near["high"]
    assert near["high"] - near["low"] < 0.1 * (apart["high"] - apart["low"])
    # the delta method for independent ones: the relative variances add
    spread = base.std() / base.mean() / np.sqrt(400)
    assert apart["high"] - apart["low"] == pytest.approx(2 * 3.92 * np.sqrt(2) * spread, rel=0.2)


def test_the_number_of_blas_threads_decides_no_bit():
    code = """if True:
        import numpy as np
        from snooker_env.benchmark.statistics import Resamples
        scores = np.random.default_rng(3).normal(size=(5, 500))
        print(Resamples(5, 500).sums(scores).tobytes().hex())
    """
    found = {
        subprocess.run(
            [sys.executable, "-c", code],
            env=os.environ | {"OMP_NUM_THREADS": n},
            capture_output=True,
            check=True,
        ).stdout
        for n in "12"
    }
    assert len(found) == 1
