"""What does an action mean? Read from the ball as it leaves the tip."""

import math

import numpy as np
import pytest

from snooker_env import SnookerEnv
from snooker_env.game.balls import BLACK, CUE, SPOTS, BallOn
from snooker_env.game.pots import pots
from snooker_env.geometry import BALL_RADIUS as R
from snooker_env.geometry import BAULK_Y, D_RADIUS, POCKET_AIMS
from snooker_env.tasks.box_actions import MAX_ELEVATION, TARGET_SPAN
from tests.shots import shot
from tests.tables import after_strike, begun, speed_of, table_state


def standing(**options):
    """A table with little on it."""
    env = SnookerEnv(**{"aim": "absolute", "render_mode": "ansi"} | options)
    table_state(env, {CUE: (0.1, -0.5), 1: (0.6, 1.2)}, BallOn.RED)
    return env


@pytest.mark.parametrize(("side", "aim"), [(0.0, -1.0), (1.0, -0.3), (-1.0, 0.1), (0.5, 0.99)])
def test_absolute_aim_is_the_direction_in_which_the_ball_leaves(side, aim):
    """Also with side spin: the squirt is compensated, so the cue itself points elsewhere."""
    env = standing()
    v, w = after_strike(env, [0.0, side, 0.0, aim])
    direction = math.pi * float(np.float32(aim))
    assert math.remainder(math.atan2(v[1], v[0]) - direction, 2 * math.pi) == pytest.approx(0.0, abs=1e-9)
    assert np.hypot(*v) == pytest.approx(speed_of(0.0), rel=1e-12)
    # right side turns the ball anticlockwise as seen from above: w = (5/2) v b / R^2 [TP A.30]
    assert w[2] == pytest.approx(2.5 * speed_of(0.0) * 0.5 * side / R, rel=1e-12)


def shot_of(env, *action_and_table):
    return shot(env.options.rules.actions, *action_and_table, env.physics)


@pytest.mark.parametrize(("a", "speed"), [(-1.0, 0.2), (1.0, 7.0), (0.0, 3.6), (-0.5, 1.9)])
def test_speed_is_linear_between_its_ends(a, speed):
    env = standing()
    assert np.hypot(*after_strike(env, [a, 0, 0, 0.3])[0]) == pytest.approx(speed, rel=1e-12)


@pytest.mark.parametrize(
    ("side", "top", "b", "t"),
    [
        (1, 0, 0.5, 0),
        (0, 1, 0, 0.5),
        (0, -1, 0, -0.5),
        (1, 1, math.sqrt(0.125), math.sqrt(0.125)),
        (-0.6, 0.8, -0.3, 0.4),
        (0.9, -1, 0.45 / math.sqrt(1.81), -0.5 / math.sqrt(1.81)),
        (0.5, 0.25, 0.25, 0.125),
    ],
)
def test_the_tip_stays_on_the_disc_within_the_miscue_limit(side, top, b, t):
    """A pair outside is drawn back along its own direction, one inside is as it is."""
    env = standing()
    _, w = after_strike(env, [0.0, side, top, 0.0])
    scale = 2.5 * speed_of(0.0) / R
    cue = -shot_of(env, [0, side, top, 0], env.positions, env.on_table, 2)[3]
    squirt = math.atan(2.5 * b * math.sqrt(1 - b * b) / (1 + 30 + 2.5 * (1 - b * b)))
    assert cue == pytest.approx(squirt, abs=1e-4)
    assert w[2] / scale == pytest.approx(b, abs=1e-4)
    assert w[1] / scale == pytest.approx(t, abs=1e-4)  # rolling along +x is a positive turn about +y
    assert np.hypot(*w[1:]) / scale <= 0.5 * (1 + 1e-12)


@pytest.mark.parametrize(("a", "degrees"), [(-1.0, 0.0), (0.0, 15.0), (1.0, 30.0)])
@pytest.mark.parametrize("mu_s", [0.21, 0.1])
def test_elevation_lengthens_the_action_and_takes_speed(a, degrees, mu_s):
    env = standing(elevation=True, physics={"mu_s": mu_s})
    assert env.action_space.shape == (5,) and SnookerEnv(aim="absolute").action_space.shape == (4,)
    v, w = after_strike(env, [0.0, 1.0, 0.0, 0.0, a])
    angle = math.radians(degrees)
    assert math.radians(30) == MAX_ELEVATION
    on, down = speed_of(0.0) * math.cos(angle), speed_of(0.0) * math.sin(angle)
    assert w[2] == pytest.approx(2.5 * 0.5 * on / R, rel=1e-12)
    # the slip along the path is all of the speed, across it the masse part; the cloth rubs against both
    slip = np.array([on, 2.5 * 0.5 * down])
    push = -mu_s * down * slip / np.hypot(*slip)
    assert v == pytest.approx([on + push[0], push[1]], rel=1e-6, abs=1e-6)
    assert R * w[:2] == pytest.approx([slip[1] + 2.5 * push[1], -2.5 * push[0]], rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("elevation", [False, True])
@pytest.mark.parametrize(
    ("a", "b"), [(0.0, -1.0), (0.0, 1.0), (-0.5, 0.0), (0.25, 0.5), (1.0, 0.0), (-0.99, 1.0)]
)
def test_placement_puts_the_ball_in_hand_where_it_says(a, b, elevation):
    """The yellow and the green stand on the D's corners, the brown between them: no place overlaps a ball."""
    env = SnookerEnv(
        observation="flat", layout="break_off", placement=True, elevation=elevation, render_mode="ansi"
    )
    assert env.action_space.shape == (6 + elevation,)
    obs, _ = env.reset(seed=1)
    assert obs[-2] == 1.0  # in hand
    before = env.positions[CUE].copy()
    env.step(np.array([-1.0, 0, 0, 0.5, *[-1.0] * elevation, a, b]))
    placed = env.last_shot.at(0.0)[0][CUE]
    depth = D_RADIUS * math.sqrt(1 - a * a) * (b + 1) / 2
    want = (D_RADIUS * a, BAULK_Y - depth)
    if np.hypot(*(SPOTS[16:19] - want).T).min() > 2 * R + 2e-4:
        assert placed == pytest.approx(want, abs=1e-12)
    elif a == 0.0:  # the brown's spot is taken: the nearest place where it is clear of it
        assert 2 * R < np.hypot(*(placed - SPOTS[18])) < 2 * R + 2e-4
    assert np.hypot(*(env.last_shot.at(0.0)[0][1:] - placed).T).min() >= 2 * R - 1e-6
    assert np.hypot(placed[0], placed[1] - BAULK_Y) <= D_RADIUS + 1e-12 and placed[1] <= BAULK_Y
    assert not np.array_equal(placed, before)


def test_placement_is_for_a_ball_in_hand_only():
    env = SnookerEnv(aim="absolute", layout="random:4", placement=True, render_mode="ansi")
    ends = set()
    for place in ((0.0, 0.0), (0.7, -0.3), (-1.0, 1.0)):
        env.reset(seed=3)
        here = env.positions[CUE].copy()
        ends.add(env.step([0, 0, 0, 0.2, *place])[0].tobytes())
        assert np.array_equal(env.last_shot.at(0.0)[0][CUE], here)
    assert len(ends) == 1
    # without placement the ball lies where the layout put it
    plain = begun(SnookerEnv(aim="absolute", layout="break_off", render_mode="ansi"), 3)
    here = plain.positions[CUE].copy()
    plain.step([0, 0, 0, 0.5])
    assert np.array_equal(plain.last_shot.at(0.0)[0][CUE], here)


def straight(rng):
    """A straight pot: object ball, cue ball, direction, all clear of the cushions."""
    while True:
        pocket = POCKET_AIMS[rng.integers(6)]
        turn = rng.uniform(-0.35, 0.35)
        c, s = math.cos(turn), math.sin(turn)
        d = np.array([pocket[2] * c - pocket[3] * s, pocket[2] * s + pocket[3] * c])
        ball = pocket[:2] - rng.uniform(0.25, 0.6) * d
        cue = ball - rng.uniform(0.2, 0.5) * d
        if (np.abs([ball, cue]) < (0.8, 1.65)).all():
            return ball, cue, math.atan2(d[1], d[0])


def astray_of(env, direction):
    """The angle between the cue ball's way off the tip and a direction."""
    v = env.last_shot.at(0.0)[1][CUE]
    return math.remainder(math.atan2(v[1], v[0]) - direction, 2 * math.pi)


def test_target_aim_of_nothing_pots_a_straight_ball():
    """a = 0 is the line of the best pot: any straight pot goes in, 3 degrees off it does not."""
    env = SnookerEnv(aim="target", render_mode="ansi")
    rng = np.random.default_rng(3)
    tried = astray = 0
    for _ in range(40):
        ball, cue, direction = straight(rng)
        black = (0.0, 0.3) if ball[1] * cue[1] > 0.05 else (-0.6, 1.4)
        if np.hypot(*(np.array([cue, ball]) - black).T).min() < 0.3:
            continue
        table_state(env, {CUE: cue, 1: ball, BLACK: black}, BallOn.RED)
        before = env.get_state()
        info = env.step([-0.4, 0.0, -0.3, 0.0])[4]
        assert astray_of(env, direction) == pytest.approx(0.0, abs=1e-6)
        assert info["pots"] == 1 and info["first_ball"] == 1
        assert env.last_shot.potted[1] >= 0
        for a in (-1.0, 1.0):
            env.set_state(before)
            tried, astray = tried + 1, astray + (env.step([-0.4, 0.0, -0.3, a])[4]["pots"] == 0)
            assert astray_of(env, direction + a * TARGET_SPAN) == pytest.approx(0.0, abs=1e-6)
    assert tried > 50 and astray > 0.8 * tried


def test_target_aim_without_a_pot_is_at_the_middle_of_what_is_seen():
    env = SnookerEnv(aim="target")
    # the black hides half of the red: no pot there
    table_state(env, {CUE: (0.0, 1.0), 1: (0.0, 1.7), BLACK: (0.05, 1.3)}, BallOn.RED)
    assert len(pots(env.positions, env.on_table, env.tables.on(0))) == 0
    left = math.pi / 2 + math.asin(2 * R / 0.7)
    edge = math.atan2(0.3, 0.05) + math.asin(2 * R / math.hypot(0.05, 0.3))
    for a in (0.0, -0.5):
        aim = shot_of(env, [0, 0, 0, a], env.positions, env.on_table, env.tables.on(0))[3]
        assert aim == pytest.approx(0.5 * (left + edge) + a * TARGET_SPAN, abs=1e-12)
