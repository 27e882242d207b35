"""Is a mirrored shot the mirror image to the last bit? On a preset table and on unbounded cloth, in both axes."""

import numpy as np
import pytest

from benchmarks import fuzz
from benchmarks.stability.symmetry import images

AXES = (0, 1)


def assert_mirrored(drawn, axis, rows=slice(None)):
    here, there = images(drawn, axis, rows)
    assert all(np.array_equal(a, b) for a, b in zip(here, there, strict=True))


@pytest.mark.parametrize(("number", "index", "axis"), [(73, 34, 1), (133, 35, 0), (524, 4, 1)])
def test_shots_that_once_differed(number, index, axis):
    """A jaw found with the time of another jaw as its limit, or a fall; a polynomial with -0.0 where its image has 0.0: by 3e-13 m."""
    assert_mirrored(fuzz.batch(5, number), axis, slice(index, index + 1))


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("number", [1, 7, 8, 15, 16])
def test_random_shots_are_mirrored_to_the_last_bit(number, axis):
    drawn = fuzz.batch(5, number)
    assert_mirrored(drawn, axis)
