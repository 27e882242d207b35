"""Are four numbers side by side four numbers? To the last bit. (Without numba: ``test_work.py`` plays shots
so.)"""

import numba
import numpy as np
import pytest

from snooker_env._lib.lanes import lane, lanes, lanes_at, lesser, no_more, put_lanes


@numba.njit(error_model="numpy")
def sums(array, out):
    x, y = lanes_at(array, 1), lanes_at(array, 6)
    z = x * y + x
    put_lanes(out, 2, z)
    z = lanes(array[0], lane(z, 1), lane(z, 2), lane(z, 3)) * y
    return lane(z, 0) + lane(z, 3)


@pytest.mark.parametrize("seed", range(5))
def test_each_lane_is_computed_as_a_number_of_its_own(seed):
    array = np.random.default_rng(seed).normal(size=12) * 10.0 ** np.random.default_rng(seed + 9).integers(
        -60, 60, 12
    )
    out = np.zeros(8)
    total = sums(array, out)
    one_by_one = [array[1 + k] * array[6 + k] + array[1 + k] for k in range(4)]
    assert out.tolist() == [0.0, 0.0, *one_by_one, 0.0, 0.0]
    assert total == array[0] * array[6] + one_by_one[3] * array[9]


def test_infinite_and_missing_numbers_stay_in_their_lane():
    array = np.array([1.0, np.inf, np.nan, -0.0, 2.0, 0.0, 0.0, 1.0, 1.0, 1.0])
    out = np.zeros(8)
    sums(array, out)
    # inf * 0 + inf, nan, -0.0 + -0.0, 2 + 2
    assert np.isnan(out[2]) and np.isnan(out[3]) and out[4] == 0.0 and out[5] == 4.0


@numba.njit(error_model="numpy")
def compared(rows, out):
    """``rows`` (2, 4), read by one index; the flags of row 0 <= row 1, and the lesser of each lane."""
    x, y = lanes_at(rows, 0), lanes_at(rows, 4)
    put_lanes(out, 0, lesser(x, y))
    return no_more(x, y)


def test_lanes_are_compared_one_by_one():
    rows, out = np.array([[1.0, np.inf, 2.0, np.nan], [1.0, 3.0, np.inf, 0.0]]), np.zeros(4)
    assert compared(rows, out) == 0b0101
    assert out[:3].tolist() == [1.0, 3.0, 2.0]
    assert compared(rows[::-1].copy(), out) == 0b0011
