"""Does the closed form of a cue's room agree with spheres along the cue, and does it move tips as it says?"""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.geometry import BALL_RADIUS as R
from snooker_env.physics import cue_room
from snooker_env.physics.cue import MAX_ELEVATION
from snooker_env.physics.cue_room import FREE, MOVED, OVER_NOTHING, OVER_RAIL, RAISED, STEEPEST, UNPLAYABLE
from tests.kernels import from_python
from tests.oracles import cue_clearance

_LEAST, _IN_ROOM = from_python(cue_room.least_elevation), from_python(cue_room.in_room)
TABLE = sn.Table.preset("match")
RAILS = cue_room.rails_of(TABLE.noses, TABLE.falls)
ALONE = np.ones(1, bool)
NONE = np.empty(0)


def least(tip, aim, positions, rails=RAILS, elevation=0.0):
    positions = np.array(positions, float)
    stroke, here = (*map(float, tip), float(aim), float(elevation)), np.ones(len(positions), bool)
    return _LEAST(stroke, positions, here, rails, R)


def in_room(stroke, positions, rails=RAILS):
    positions = np.array(positions, float)
    return _IN_ROOM(tuple(map(float, stroke)), positions, np.ones(len(positions), bool), rails, R, 0.5)


def tip_of(rng):
    far, turn = rng.uniform(0.0, 0.5), rng.uniform(-np.pi, np.pi)
    return far * np.cos(turn), far * np.sin(turn)


@pytest.mark.slow
def test_over_a_rail_as_spheres():
    rng, worst, steep = np.random.default_rng(0), 0.0, 0
    for _ in range(100):
        tip, away = tip_of(rng), R + 10 ** rng.uniform(-6, -0.3)
        axis, side, level = int(rng.integers(2)), rng.choice([-1.0, 1.0]), 0.889
        lie = np.array([0.1, 0.2])
        lie[axis] = side * (level - away)
        aim = (0.0 if axis == 0 else np.pi / 2) + (np.pi if side > 0 else 0.0) + rng.uniform(-1.5, 1.5)
        got = least(tip, aim, [lie], np.array([axis, side, level, -50.0, 50.0, 0.1]))
        wanted = cue_clearance.least_elevation(lie, aim, *tip, R, rails=[(axis, side, level)])
        worst, steep = max(worst, abs(got - wanted)), steep + (wanted > 0.3)
    assert worst < 1e-5 and steep > 30


def test_over_a_ball_as_spheres():
    rng, worst, steep, seen = np.random.default_rng(1), 0.0, 0, 0
    while seen < 100:
        tip, aim = tip_of(rng), rng.uniform(-np.pi, np.pi)
        back, right = np.exp(rng.uniform(np.log(0.03), 0.0)), rng.uniform(-0.05, 0.05)
        if np.hypot(back, right) < 2.0 * R:
            continue
        lie, a = np.array([0.1, 0.2]), np.array([np.cos(aim), np.sin(aim)])
        ball = lie - back * a + right * np.array([a[1], -a[0]])
        got = least(tip, aim, [lie, ball], NONE)
        wanted = cue_clearance.least_elevation(lie, aim, *tip, R, balls=[ball])
        worst, steep, seen = max(worst, abs(got - wanted)), steep + (wanted > 0.3), seen + 1
    assert worst < 1e-5 and steep > 5


def test_a_frozen_ball_needs_what_players_say_and_one_in_the_open_nothing():
    x = 0.889 - R
    centre, screw, follow = (np.degrees(least((0.0, top), np.pi, [(x, 0.9)])) for top in (0.0, -0.4, 0.5))
    assert 30.0 < centre < 36.0 and screw > 50.0 and follow < 17.0
    assert least((0.0, 0.0), np.pi, [(x - 1.48, 0.9)]) == 0.0  # all of the cue lies over the bed
    assert least((0.0, 0.0), 0.0, [(x, 0.9)]) < 0.05  # away from the table: the other rail is 1.7 m behind
    assert least((0.0, 0.0), 0.0, [(x, 0.9)], elevation=0.4) == 0.4


def test_what_is_done_to_a_stroke_is_what_is_said():
    rng, seen, fits = np.random.default_rng(5), dict.fromkeys(range(8), 0), []
    for _ in range(4000):
        x = 0.889 - R - 10 ** rng.uniform(-6, 0)
        positions = [(x, 0.9), *rng.uniform((-0.86, -1.75), (0.86, 1.75), (3, 2))]
        stroke = (2.0, *tip_of(rng), np.pi + rng.uniform(-1.0, 1.0), rng.choice([0.0, 0.2]))
        played, done = in_room(stroke, positions)
        speed, side, top, aim, elevation = played
        assert (speed, aim) == (stroke[0], stroke[3]) and elevation >= stroke[4]
        assert np.hypot(side, top) < 0.5 + 1e-9
        assert bool(done & RAISED) == (elevation > stroke[4])
        assert bool(done & MOVED) == ((side, top) != stroke[1:3])
        assert done != FREE or played == stroke
        needed = min(least((side, top), aim, positions, elevation=stroke[4]), MAX_ELEVATION)
        assert elevation == pytest.approx(needed, abs=1e-9)
        if done & UNPLAYABLE:
            assert elevation > STEEPEST
        elif done & MOVED:  # to the place that just fits
            # beside a ball behind it, a cue that moves up may have no more of it in its way at once
            fits.append(abs(elevation - STEEPEST) < 1e-6)
            assert elevation <= STEEPEST + 1e-9 and top > stroke[2]
        seen[done] += 1
    assert np.mean(fits) > 0.95 and seen[FREE] > 100 and seen[RAISED] > 100 and seen[RAISED | MOVED] > 100


def test_what_the_cue_passes_over_is_what_lets_it_down_when_it_is_gone():
    rng, seen = np.random.default_rng(11), {OVER_NOTHING: 0, OVER_RAIL: 0, 1: 0, MOVED: 0}
    for _ in range(1500):
        positions = rng.uniform((-0.86, -1.75), (0.86, 1.75), (8, 2))
        positions[1:5] = positions[0] + rng.uniform(0.06, 0.4, (4, 1)) * rng.normal(size=(4, 2))
        on = np.ones(8, bool)
        (side, top), aim, elevation = tip_of(rng), rng.uniform(-np.pi, np.pi), rng.choice([0.0, 0.2])
        meant = (2.0, side, top, aim, elevation)
        played, done, over, behind = cue_room.in_room_over(meant, positions, on, RAILS, R, 0.5, 0.0)
        straight = aim - float(np.arctan(2.5 * side * np.sqrt(1 - side**2) / (1 + 2.5 * (1 - side**2))))
        tip = (side, top, straight, elevation)
        wanted, flags = in_room((2.0, side, top, straight, elevation), positions)
        assert (played, done) == (pytest.approx(wanted, abs=1e-12), flags)
        where = tip, positions

        def lie(on, rails=RAILS, where=where):
            return _LEAST(*where, on, rails, R)

        assert (over == OVER_NOTHING) == (lie(on) == elevation)
        if over == OVER_RAIL:
            assert lie(on, NONE) < lie(on) and 0.0 < behind < cue_room.LENGTH + 2.0 * R
        elif over > 0:
            without = on.copy()
            without[over] = False
            assert lie(without) < lie(on)
            along = [np.cos(straight), np.sin(straight)]
            assert behind == pytest.approx(-(positions[over] - positions[0]) @ along)
        seen[min(over, 1)] += 1
        seen[MOVED] += bool(done & MOVED)
    assert min(seen.values()) > 50, seen
