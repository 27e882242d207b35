"""Are the points those of Sobol's sequence, scrambled as Owen proposed: evenly spread, each uniform?"""

import numpy as np
import pytest
from scipy.stats import norm, qmc

from snooker_env.planning.sobol import DIMENSIONS, normal_points, sobol_points


def whole(points):
    """Coordinates as the integers of 32 bits that they are made of."""
    bits = points * 2.0**32 - 0.5
    assert np.array_equal(bits, np.round(bits))
    return bits.astype(np.uint64)


def shared_bits(x):
    """Number of leading bits that each two of n numbers of 32 bits share: (n, n)."""
    apart = (x[:, None] ^ x[None, :]).astype(np.float64)
    return 32 - np.where(apart > 0, np.floor(np.log2(np.maximum(apart, 1))) + 1, 0).astype(int)


def test_unscrambled_they_are_the_sequence_of_joe_and_kuo():
    """A nested scramble keeps the leading bits that points share; SciPy takes them in Gray code's order."""
    n = 512
    reference = np.empty((n, DIMENSIONS))
    steps = np.arange(n)
    reference[steps ^ (steps >> 1)] = qmc.Sobol(DIMENSIONS, scramble=False, bits=32).random(n)
    # van der Corput's sequence: the bits of i in opposite order
    by_hand = [int(f"{i:032b}"[::-1], 2) for i in range(n)]
    assert np.array_equal((reference[:, 0] * 2**32).astype(np.uint64), np.array(by_hand, np.uint64))
    for seed in (0, 1, 0xFFFFFFFF):
        direct = whole(sobol_points(n, DIMENSIONS, seed))
        for d in range(DIMENSIONS):
            expected = shared_bits((reference[:, d] * 2**32).astype(np.uint64))
            assert np.array_equal(shared_bits(direct[:, d]), expected), (seed, d)


def test_scrambles_and_dimensions_differ():
    """The first point of each scramble differs in each dimension; only the low 32 bits of a seed count."""
    first = np.array([sobol_points(1, DIMENSIONS, seed)[0] for seed in range(2000)])
    assert len(np.unique(first)) == first.size
    assert np.abs(np.corrcoef(first.T) - np.eye(DIMENSIONS)).max() < 0.1  # 4.5 standard deviations
    assert np.array_equal(sobol_points(9, 3, 5), sobol_points(9, 3, 5 + 2**32))


def test_each_point_is_uniform_over_the_scrambles():
    """Whatever its index: mean, variance and the shares of ten parts."""
    many = 4000
    points = np.array([sobol_points(7, DIMENSIONS, 104729 * seed + 11) for seed in range(many)])
    assert np.abs(points.mean(0) - 0.5).max() < 4.5 * np.sqrt(1 / 12 / many)
    assert np.abs(points.var(0) - 1 / 12).max() < 4.5 * np.sqrt(1 / 180 / many)
    for i in range(7):
        for d in range(DIMENSIONS):
            shares = np.bincount((10 * points[:, i, d]).astype(int), minlength=10)
            assert ((shares - many / 10) ** 2 / (many / 10)).sum() < 40.0  # chi-square of 9: p = 1e-5


def test_normal_points_are_standard_normal_and_independent():
    points = np.concatenate([normal_points(64, seed) for seed in range(200)])
    assert points.shape == (12_800, DIMENSIONS) and np.isfinite(points).all()
    assert np.abs(points.mean(0)).max() < 0.01 and points.std(0) == pytest.approx(np.ones(6), abs=0.01)
    assert (points**3).mean(0) == pytest.approx(np.zeros(6), abs=0.05)
    assert (points**4).mean(0) == pytest.approx(3 * np.ones(6), abs=0.2)
    assert np.abs(np.corrcoef(points.T) - np.eye(6)).max() < 0.02


def test_the_aim_gets_the_most_even_coordinate():
    """Aim (column 3) and speed (column 0) together are a net without a gap."""
    even = norm.cdf(normal_points(64, 12))
    for i in range(7):
        cells = (even[:, 3] * 2**i).astype(int) * 2 ** (6 - i) + (even[:, 0] * 2 ** (6 - i)).astype(int)
        assert np.array_equal(np.sort(cells), np.arange(64))
    assert np.array_equal(normal_points(64, 12)[:10], normal_points(10, 12))
    assert not np.array_equal(normal_points(10, 12), normal_points(10, 13))
