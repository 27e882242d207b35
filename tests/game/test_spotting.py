"""Does every colour come back, to the place that the rule says, touching nothing?"""

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from snooker_env.game.balls import BLACK, CLEARANCE, GREEN, NAMES, REFEREE_TOUCH, SPOTS, YELLOW, mask_of
from snooker_env.geometry import BALL_RADIUS, HALF_LENGTH, HALF_WIDTH
from snooker_env.tasks.stroke import touching_balls
from tests.game.geometry_cases import lie, misplaced, spot_colours
from tests.kernels import from_python

SIX = range(YELLOW, BLACK + 1)
touching = from_python(touching_balls)


def table(*places):
    """A table with a red at each place."""
    return lie(dict(enumerate(places, start=1)))


@settings(max_examples=60, deadline=None)
@given(st.data(), st.sampled_from(SIX), st.booleans())
def test_no_spotted_colour_touches_in_the_eyes_of_the_referee(data, ball, crowded):
    """The cue ball lies at the edge of where the colour goes."""
    gap = data.draw(st.sampled_from([0.0, 2e-6, 1e-5, 4.9e-5, 5.1e-5, 9e-5, 2e-4]))
    turn = data.draw(st.floats(0, 2 * np.pi))
    positions, on_table = table(*(SPOTS[k] for k in SIX if k != ball and crowded))
    positions[0] = SPOTS[ball] + (2 * BALL_RADIUS + gap) * np.array([np.cos(turn), np.sin(turn)])
    on_table[0] = True
    for _ in range(2):  # the second time the first place is taken, too
        positions, on_table = spot_colours(positions, on_table, 1 << ball)
        assert not touching(positions, on_table)
        apart = np.hypot(*(positions[on_table] - positions[ball]).T)
        assert np.sort(apart)[1] - 2 * BALL_RADIUS >= REFEREE_TOUCH
        red = int(np.argmin(on_table[1:16])) + 1
        positions[red], on_table[red] = positions[ball], True


def test_the_cue_ball_occupies_a_spot_unless_it_is_in_hand():
    positions, on_table = table()
    positions[0] = SPOTS[GREEN]
    assert np.array_equal(spot_colours(positions, on_table, 1 << GREEN)[0][GREEN], SPOTS[GREEN])
    on_table[0] = True
    assert np.array_equal(spot_colours(positions, on_table, 1 << GREEN)[0][GREEN], SPOTS[BLACK])


@st.composite
def crowded(draw):
    """A legal table, dense about the spots and the lines above them, and a set of colours to return."""
    waiting = draw(st.sets(st.integers(YELLOW, BLACK), min_size=1))
    columns = st.sampled_from([0.0, 0.0, 0.0, SPOTS[YELLOW, 0], SPOTS[GREEN, 0]])
    beside, up = st.floats(-0.05, 0.05), st.floats(-1.1, HALF_LENGTH - BALL_RADIUS)
    near = st.builds(lambda x, dx, y: (x + dx, y), columns, beside, up)
    on_spot = st.sampled_from([tuple(SPOTS[i]) for i in SIX])
    places = []
    for place in draw(st.lists(st.one_of(near, on_spot), max_size=60)):
        if all(np.hypot(place[0] - x, place[1] - y) >= 2 * BALL_RADIUS for x, y in places):
            places.append(place)
    balls = [0, *range(1, 16), *(i for i in SIX if i not in waiting)]
    return *lie(dict(zip(balls, places, strict=False))), waiting


@settings(max_examples=150, deadline=None)
@given(crowded())
def test_every_colour_returns_and_none_overlaps(case):
    positions, on_table, waiting = case
    placed, present = spot_colours(positions, on_table, mask_of(waiting))
    assert all(present[list(waiting)])
    assert np.array_equal(placed[on_table], positions[on_table]) and np.all(present[on_table])
    assert present.sum() == on_table.sum() + len(waiting)
    for ball in waiting:
        others = present.copy()
        others[ball] = False
        assert np.all(np.hypot(*(placed[others] - placed[ball]).T) > 2 * BALL_RADIUS)
        assert abs(placed[ball, 0]) + BALL_RADIUS < HALF_WIDTH
        assert abs(placed[ball, 1]) + BALL_RADIUS < HALF_LENGTH


@settings(max_examples=100, deadline=None)
@given(crowded())
def test_one_colour_is_where_a_search_in_small_steps_finds_it(case):
    positions, on_table, waiting = case
    ball = max(waiting)
    assume(not any(on_table[i] for i in waiting))
    placed, _ = spot_colours(positions, on_table, 1 << ball)
    others = list(positions[on_table])
    reach = 2 * BALL_RADIUS

    def free(place):
        return not others or np.hypot(*(np.array(others) - place).T).min() >= reach + CLEARANCE

    spots = [ball, *range(BLACK, YELLOW - 1, -1)]
    # where a ball is within rounding of touching a spot, the search and the rule may read it differently
    apart = [np.hypot(*(np.array(others) - SPOTS[i]).T).min() for i in spots if others]
    assume(all(abs(gap - reach) > 2 * CLEARANCE for gap in apart))
    target = next((i for i in spots if free(SPOTS[i])), None)
    if target is not None:
        assert np.array_equal(placed[ball], SPOTS[target])
    else:
        side = "toward_top" if placed[ball, 1] > SPOTS[ball, 1] else "toward_baulk_on_centre_line"
        assert misplaced(placed[ball], others, f"near:{NAMES[ball]}:{side}") is None
