"""Are snookers and clear paths seen as the rules define them?"""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from snooker_env.game.balls import BLACK, mask_of
from snooker_env.game.snookered import is_snookered
from snooker_env.geometry import BALL_RADIUS
from tests.game.geometry_cases import lie
from tests.miss_paths import paths

R = BALL_RADIUS


def table(cue, reds, others=()):
    """Arrays and the mask on: reds are on, the others (from black down) are not. ``cue`` None is in hand."""
    places = {1 + k: place for k, place in enumerate(reds)} | {
        BLACK - k: place for k, place in enumerate(others)
    }
    return *lie(places | ({} if cue is None else {0: cue})), mask_of(range(1, 1 + len(reds)))


def snookered(*args, **options):
    return is_snookered(*table(*args), **options)


CUE = (0.0, -0.8)
FAR = (0.0, 0.8)


def test_a_cushion_does_not_snooker():
    jaw, elsewhere = np.array([[0.08, -0.6, 0.06]]), np.array([[0.58, -0.6, 0.06]])
    behind, before = (0.06, 0.0), (0.05, -0.7)
    assert snookered(CUE, [FAR], [behind])[0]
    assert not snookered(CUE, [FAR], [behind], jaws=jaw)[0]  # the jaw bars the edge and is nearer
    assert snookered(CUE, [FAR], [before], jaws=jaw)[0]  # the ball is nearer
    assert snookered(CUE, [FAR], [behind], jaws=elsewhere)[0]  # the jaw bars nothing


# In hand: the whole D


def test_in_hand_sees_from_any_place_that_is_free():
    assert not snookered(None, [FAR])[0]
    assert not snookered(None, [FAR], [(0.0, 0.0)])[0]  # round the blocker from the ends of the D
    cage = [(2.1 * R * np.sin(a), 0.8 - 2.1 * R * np.cos(a)) for a in np.radians([-60.0, 0.0, 60.0])]
    assert snookered(None, [FAR], cage)[0]
    assert not snookered(None, [FAR, (0.5, 0.0)], cage)[0]
    red = np.array([0.0, -1.19])
    ring = [red + 2.001 * R * np.array([np.cos(a), np.sin(a)]) for a in np.radians(range(0, 360, 60))]
    assert snookered(None, [red], ring)[0]
    assert not snookered(None, [red], ring[:3])[0]


# Small steps as the judge


def rolls_into(cue, angle, reach, balls):
    """The ball that a cue ball rolling along ``angle`` meets first within ``reach``, in steps of 0.2 mm."""
    path = np.array(cue) + np.arange(0.0, reach, 2e-4)[:, None] * [np.cos(angle), np.sin(angle)]
    distance = np.hypot(*(path[:, None] - np.array(balls)).T).T
    meets = np.argwhere(distance < 2 * R - 1e-7)
    return int(meets[0][1]) if len(meets) else None


@st.composite
def scenes(draw):
    """A cue ball at the origin, one or two reds, up to four other balls between and around."""
    number = st.floats(-0.6, 0.6).map(lambda x: round(x, 4))
    places = [(0.0, 0.0)]
    for place in draw(st.lists(st.tuples(number, number), min_size=2, max_size=6)):
        if all(np.hypot(place[0] - x, place[1] - y) > 2 * R + 1e-3 for x, y in places):
            places.append(place)
    assume(len(places) >= 3)
    reds = draw(st.integers(1, min(2, len(places) - 2)))
    return places[1 : 1 + reds], places[1 + reds :]


@settings(max_examples=60, deadline=None)
@given(scenes())
def test_paths_agree_with_rolling(scene):
    reds, others = scene
    positions, on_table, on = table((0.0, 0.0), reds, others)
    any_part, full = paths(positions, on_table, on)
    # A narrow opening may fall between the directions of the coarse sweep; then the fine one must find it.
    assert any_part == (swept(reds, others, 81) or (any_part and swept(reds, others, 4001)))
    fulls = [rolls_into((0.0, 0.0), np.arctan2(red[1], red[0]), 1.0, [red, *others]) == 0 for red in reds]
    margins = [abs(abs(b[0] * r[1] - b[1] * r[0]) / np.hypot(*r) - 2 * R) for r in reds for b in others]
    assume(min(margins) > 1e-4)
    assert full == any(fulls)


def swept(reds, others, directions):
    """Does a direction of a sweep over each red, with the other reds taken away, lead into it?"""
    spread = np.linspace(-0.999, 0.999, directions)
    for red in reds:
        ways = np.arctan2(red[1], red[0]) + spread * np.arcsin(min(1.0, 2 * R / np.hypot(*red)))
        if any(rolls_into((0.0, 0.0), way, 1.0, [red, *others]) == 0 for way in ways):
            return True
    return False


@settings(max_examples=80, deadline=None)
@given(scenes())
def test_snookers_agree_with_rolling(scene):
    reds, others = scene
    open_reds = []
    for red in reds:
        d = np.hypot(*red)
        edges = np.arctan2(red[1], red[0]) + np.array([-1, 1]) * np.arcsin(2 * R / d)
        run = np.sqrt(d * d - 4 * R * R)
        steps = np.linspace(0.0, run, 4000)[:, None]
        nearest = [
            np.hypot(*(steps * [np.cos(a), np.sin(a)] - b).T).min() for a in edges for b in np.array(others)
        ]
        assume(abs(np.array(nearest) - 2 * R).min() > 1e-5)
        open_reds.append(min(nearest) >= 2 * R)
    assert snookered((0.0, 0.0), reds, others)[0] != any(open_reds)


# Paths by name


def test_wrong_input_is_refused():
    positions, on_table, on = table(CUE, [FAR])
    with pytest.raises(ValueError, match="on = 1"):
        is_snookered(positions, on_table, 1)
    with pytest.raises(ValueError, match="jaws"):
        is_snookered(positions, on_table, on, jaws=[[1.0, 2.0]])
