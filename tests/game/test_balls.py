"""Are the balls where the rules put them, and do the masks say what they mean?"""

import numpy as np
import pytest

from snooker_env.game import balls
from snooker_env.game.balls import SPOTS, BallOn
from snooker_env.geometry import BALL_RADIUS, HALF_LENGTH
from tests.kernels import from_python

bits, count = from_python(balls.bits), from_python(balls.count)


def test_balls_are_where_the_rules_put_them_and_worth_what_they_say():
    rack = SPOTS[1:16]
    gaps = np.hypot(*(rack[:, None] - rack[None]).T)[np.triu_indices(15, 1)] - 2 * BALL_RADIUS
    assert gaps.min() > -1e-12
    assert np.sum(np.abs(gaps) < 1e-12) == 30  # a triangle of side 5 has 30 neighbouring pairs
    assert SPOTS[1, 1] - SPOTS[balls.PINK, 1] - 2 * BALL_RADIUS == pytest.approx(0.0005, abs=1e-12)
    assert np.all(SPOTS[1:16, 1] < SPOTS[balls.BLACK, 1] - 0.3)
    # The rules: black 324 from the top cushion, pink and blue on the centre line's quarter and middle, the D
    # of 292 about the brown.
    spots = [(292, -1047.5), (-292, -1047.5), (0, -1047.5), (0, 0), (0, 892.25), (0, 1460.5)]
    for name, place in zip(balls.COLOUR_NAMES, spots, strict=True):
        assert SPOTS[balls.colour(name)] * 1000 == pytest.approx(place, abs=1e-9)
    assert HALF_LENGTH - SPOTS[balls.BLACK, 1] == pytest.approx(0.324)
    assert SPOTS[balls.BROWN, 1] + HALF_LENGTH == pytest.approx(0.737)
    assert balls.VALUES.sum() == 15 + 27
    assert [balls.NAMES[i] for i in np.argsort(balls.VALUES)[-6:]] == list(balls.COLOUR_NAMES)
    for name in balls.COLOUR_NAMES:
        assert balls.VALUES[balls.colour(name)] == BallOn[name.upper()]
    assert not balls.VALUES.flags.writeable and not SPOTS.flags.writeable


def test_masks_and_what_is_none():
    assert balls.ids_of(balls.mask_of([0, 3, 21])) == (0, 3, 21)
    assert balls.mask_of(range(22)) == balls.ALL_MASK == balls.CUE_BIT | balls.REDS_MASK | balls.COLOURS_MASK
    present = np.zeros(22, dtype=bool)
    present[[0, 5, 20]] = True
    assert bits(present) == balls.mask_of([0, 5, 20])
    assert count(balls.mask_of([1, 7, 21])) == 3
    wrong_masks = [(balls.mask_of, wrong) for wrong in ([22], [-1], [1.0])]
    for function, value in (*wrong_masks, (balls.colour, "red"), (balls.ids_of, 1 << 22)):
        with pytest.raises(ValueError, match="must be"):
            function(value)
