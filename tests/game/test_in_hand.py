"""Is the place found in the D legal, and the nearest?"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from snooker_env.game import in_hand
from snooker_env.game.balls import CLEARANCE
from snooker_env.game.in_hand import place_cue
from snooker_env.geometry import BALL_RADIUS, BAULK_Y, D_RADIUS, HALF_LENGTH, HALF_WIDTH
from snooker_env.physics.table import Table
from tests.game.geometry_cases import lie
from tests.kernels import from_python

in_d, on_bed = from_python(in_hand.in_d), from_python(in_hand.on_bed)
REACH = 2 * BALL_RADIUS + CLEARANCE


def table(*places):
    return lie(dict(enumerate(places, start=1)))


def test_a_full_d_and_wrong_input_are_refused(monkeypatch):
    rows = [(x, BAULK_Y - y) for y in (0.02, 0.11, 0.2, 0.28) for x in np.linspace(-0.26, 0.26, 6)]
    with pytest.raises(ValueError, match="x = nan"):
        place_cue(*table(), np.nan, 0.0)
    monkeypatch.setattr(in_hand, "BALL_RADIUS", 0.08)
    with pytest.raises(ValueError, match="free place"):
        place_cue(*table(*rows[:17], *rows[18:22]), 0.0, -1.1)


def strewn(rng, number, low, high):
    """At most so many balls without overlap within a rectangle."""
    balls = []
    for place in rng.uniform(low, high, (400, 2)):
        if len(balls) < number and all(np.hypot(*(place - ball)) > 2 * BALL_RADIUS for ball in balls):
            balls.append(place)
    return balls


@pytest.mark.parametrize("anywhere", [False, True])
@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), number=st.integers(0, 21))
def test_no_place_drawn_at_random_is_nearer(anywhere, seed, number):
    rng = np.random.default_rng(seed)
    if anywhere:  # next to a corner pocket or a middle one, so that balls are close
        corner = rng.choice([-1, 1], 2) * [0.6, 1.5]
        balls = strewn(rng, number, *(corner + np.array([[-0.35, -0.3], [0.35, 0.3]])))
        wish = corner + rng.uniform([-0.4, -0.4], [0.4, 0.4])
        edge = np.array([HALF_WIDTH, HALF_LENGTH]) - BALL_RADIUS - CLEARANCE
        nearest = np.clip(wish, -edge, edge)
        tries = nearest + rng.normal(0, 1, (8000, 2)) * rng.choice([0.01, 0.1, 0.3], (8000, 1))
        tries = np.vstack([tries, np.clip(tries, -edge, edge)])
    else:
        balls = strewn(rng, number, [-0.33, BAULK_Y - 0.33], [0.33, BAULK_Y + 0.05])
        wish = nearest = np.array(place_cue(*table(), *rng.uniform([-0.3, BAULK_Y - 0.3], [0.3, BAULK_Y])))
        tries = rng.uniform([-D_RADIUS, BAULK_Y - D_RADIUS], [D_RADIUS, BAULK_Y], (4000, 2))
        tries = np.vstack([tries, wish + rng.normal(0, 0.05, (4000, 2))])
    legal = (lambda x, y: on_bed(x, y, BALL_RADIUS)) if anywhere else in_d
    tries = tries[[legal(x, y) for x, y in tries]]
    for ball in balls:
        tries = tries[np.hypot(*(tries - ball).T) > REACH]
    try:
        place = place_cue(*table(*balls), *wish, anywhere=anywhere)
    except ValueError:
        assert not len(tries)
        return
    assert legal(*place)
    assert all(np.hypot(*(ball - place)) > 2 * BALL_RADIUS + CLEARANCE / 2 for ball in balls)
    assert not len(tries) or np.hypot(*(tries - nearest).T).min() > np.hypot(*(place - nearest)) - 1e-9


def test_anywhere_is_on_the_bed_and_off_the_pockets():
    assert place_cue(*table(), 0.3, 1.2, anywhere=True) == (0.3, 1.2)
    for x, y in [(5.0, 0.3), (0.3, -9.0), (HALF_WIDTH, HALF_LENGTH), (-HALF_WIDTH, 0.0)]:
        place = place_cue(*table(), x, y, anywhere=True)
        assert on_bed(*place, BALL_RADIUS)
        Table.preset("match").check([place], BALL_RADIUS)
    assert in_d(*place_cue(*table(), 0.3, 1.2)) and not on_bed(0.0, HALF_LENGTH, BALL_RADIUS)
