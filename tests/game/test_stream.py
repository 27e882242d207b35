"""Are the kernels' random numbers the generator's, uniform, normal, and independent between streams?"""

import numba
import numpy as np
import pytest
from scipy import stats

from snooker_env.game import philox


@numba.njit
def block(words):
    return philox.philox(words[0], words[1], words[2], words[3], words[4], words[5])


@numba.njit
def pairs(state, out):
    for k in range(len(out)):
        out[k, 0], out[k, 1] = philox.pair(state)


@numba.njit
def gaussians(state, out):
    for k in range(len(out)):
        out[k, 0], out[k, 1] = philox.normals(state)


def drawn(fill, key, n, counter=0):
    out = np.empty((n, 2))
    fill(np.array([key, counter], np.uint64), out)
    return out


@pytest.mark.parametrize(
    ("counter", "key", "expected"),
    [
        ("00000000 00000000 00000000 00000000", "00000000 00000000", "6627e8d5 e169c58d bc57ac4c 9b00dbd8"),
        ("ffffffff ffffffff ffffffff ffffffff", "ffffffff ffffffff", "408f276d 41c83b0e a20bc7c6 6d5451fd"),
        ("243f6a88 85a308d3 13198a2e 03707344", "a4093822 299f31d0", "d16cfe09 94fdcceb 5001e420 24126ea1"),
    ],
)
def test_blocks_are_those_of_the_authors(counter, key, expected):
    """Known answers of Random123, the authors' own library (kat_vectors, philox4x32 10)."""
    words = np.array([int(word, 16) for word in f"{counter} {key}".split()], np.uint64)
    assert [f"{int(word):08x}" for word in block(words)] == expected.split()


def test_a_draw_takes_one_block_and_keys_come_from_the_generator():
    state = np.array([7, 2**40], np.uint64)
    out = np.empty((3, 2))
    pairs(state, out)
    assert state.tolist() == [7, 2**40 + 3]
    assert np.array_equal(drawn(pairs, 7, 1, 2**40 + 2)[0], out[2])
    # counter 2^40 = 2^8 in the upper word
    words = [int(w) for w in block(np.array([0, 2**8, 0, 0, 7, 0], np.uint64))]
    assert out[0].tolist() == [(low + (high << 32) >> 11) * 2.0**-53 for low, high in (words[:2], words[2:])]
    one, two = philox.stream_of(np.random.default_rng(1)), philox.stream_of(np.random.default_rng(1))
    assert np.array_equal(one, two) and one.dtype == np.uint64 and one[1] == 0
    rng = np.random.default_rng(1)
    assert philox.stream_of(rng)[0] != philox.stream_of(rng)[0]
    with pytest.raises(ValueError, match="Generator"):
        philox.stream_of(np.random.RandomState(0))


def test_normal_numbers_are_normal():
    z = drawn(gaussians, 2**63 + 5, 100_000)
    for column in z.T:
        assert stats.kstest(column, "norm").pvalue > 1e-3
    n = z.size
    moments = [(z**k).mean() for k in (1, 2, 3, 4)]
    # the fourth power has variance 96, the others less
    assert moments == pytest.approx([0, 1, 0, 3], abs=4 * np.sqrt(96 / n))
    assert abs(np.corrcoef(z.T)[0, 1]) < 4 / np.sqrt(len(z))
