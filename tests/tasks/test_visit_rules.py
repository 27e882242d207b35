"""Is the game of a visit snooker? Each rule by shots really played."""

import gymnasium
import numpy as np
import pytest

from snooker_env import SnookerEnv
from snooker_env.game.balls import BLACK, BLUE, CUE, N_BALLS, PINK, REFEREE_TOUCH, SPOTS, YELLOW, BallOn
from snooker_env.game.ruling import Foul
from snooker_env.geometry import BALL_RADIUS as R
from snooker_env.geometry import HALF_WIDTH
from snooker_env.tasks.rewards import REWARDS
from tests.tables import table_state

BESIDE = (0.55, 0.0)
"""A place straight before the middle right pocket; the cue ball of ``pot`` comes from the left."""
STUN = np.array([-0.55, 0.0, -0.35, 0.0])


def pot(env, *balls, action=STUN):
    """Move one ball to where it is potted dead straight with ``STUN`` (the others stay), and play that."""
    state = env.get_state()
    for ball in balls:
        state["positions"][ball] = list(BESIDE)
    state["positions"][CUE] = [0.3, 0.0]
    env.set_state(state)
    return env.step(action)


def racked(**arguments):
    """A whole table with the reds in their triangle."""
    env = SnookerEnv(**arguments)
    places = {ball: SPOTS[ball] for ball in range(1, N_BALLS)} | {CUE: (0.3, 0.0)}
    table_state(env, places, BallOn.RED)
    return env


def test_the_highest_break():
    """Fifteen reds, each with the black, then the colours: 147 points, and every step as the rules say."""
    env = racked()
    total = 0
    for red in range(1, 16):
        assert env.ball_on == BallOn.RED
        _, reward, terminated, truncated, info = pot(env, red)
        total += 1
        assert (reward, terminated, truncated) == (1.0, False, False)
        assert (info["points"], info["break"], info["foul"], info["pots"]) == (1.0, total, False, 1)
        assert info["first_ball"] == red
        assert info["ball_on"] == BallOn.RED and env.ball_on == BallOn.ANY_COLOUR
        assert not env.on_table[red] and env.on_table[16:].all() and env.on_table[1:16].sum() == 15 - red
        _, reward, terminated, truncated, info = pot(env, BLACK)
        total += 7
        assert (reward, terminated, info["points"], info["break"]) == (7.0, False, 7.0, total)
        assert info["first_ball"] == BLACK
        assert info["ball_on"] == BallOn.ANY_COLOUR and info["pots"] == 1
        # back on its spot
        assert env.on_table[16:].all() and np.array_equal(env.positions[BLACK], SPOTS[BLACK])
    for colour in range(YELLOW, BLACK + 1):
        assert env.ball_on == colour - 14
        obs, reward, terminated, truncated, info = pot(env, colour)
        total += colour - 14
        assert reward == colour - 14 and info["break"] == total and not info["foul"] and not truncated
        assert not env.on_table[colour] and env.on_table[1:].sum() == BLACK - colour
        assert terminated == (colour == BLACK)
    assert total == 147 == env.points and env.ball_on == BallOn.NOTHING and env.over
    assert obs[-1] == np.float32(147 / 155) and not obs[111:119].any() and env.observation_space.contains(obs)
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(STUN)


@pytest.mark.parametrize("colour", range(YELLOW, BLACK + 1))
def test_any_colour_after_a_red_is_worth_its_value_and_comes_back(colour):
    env = racked()
    pot(env, 1)
    _, reward, terminated, _, _ = pot(env, colour)
    assert reward == colour - 14 and not terminated and env.ball_on == BallOn.RED
    assert env.on_table[colour] and np.allclose(env.positions[colour], SPOTS[colour], atol=1e-12)


def test_the_last_colour_after_the_last_red_comes_back_before_the_sequence():
    env = SnookerEnv()
    table_state(
        env, {ball: SPOTS[ball] for ball in range(YELLOW, N_BALLS)} | {1: BESIDE, CUE: (0.3, 0.0)}, BallOn.RED
    )
    pot(env, 1)
    assert env.ball_on == BallOn.ANY_COLOUR
    pot(env, YELLOW)
    assert env.on_table[YELLOW] and env.ball_on == BallOn.YELLOW and not env.over and env.points == 3


def test_a_miss_ends_the_visit_without_a_foul():
    env = SnookerEnv()
    table_state(env, {CUE: (0.0, -0.5), 2: (0.0, 0.6), BLACK: (0.6, 1.0)}, BallOn.RED, points=8)
    _, reward, terminated, truncated, info = env.step([-0.8, 0.0, 0.0, 0.5])
    assert (reward, terminated, truncated, info["foul"], info["penalty"]) == (0.0, True, False, False, 0)
    assert info["first_ball"] == 2
    assert info["break"] == 8.0 == env.points and info["fouls"] == 0 and env.on_table[[CUE, 2, BLACK]].all()


FAR, STRAIGHT = (0.6, 0.6), [-0.6, 0, 0, 0.5]
WRONG_BALL = [
    ({CUE: (0.0, -0.5), 2: FAR, ball: (0.0, 0.3)}, BallOn.RED, STRAIGHT, Foul.WRONG_FIRST, value, ball)
    for ball, value in ((16, 4), (17, 4), (18, 4), (19, 5), (20, 6), (21, 7))
]
NO_BALL = [
    ({CUE: (0.0, -0.5), PINK: FAR}, BallOn.PINK, [-0.9, 0, 0, 1.0], Foul.NO_CONTACT, 6, -1),
    ({CUE: (0.3, 0.0), BLACK: (-0.4, 1.0)}, BallOn.BLACK, [-0.9, 0, 0, -0.4], Foul.NO_CONTACT, 7, -1),
]


@pytest.mark.parametrize(("places", "on", "action", "foul", "penalty", "first"), WRONG_BALL + NO_BALL)
def test_no_ball_and_a_wrong_ball_first_are_fouls_of_its_value(places, on, action, foul, penalty, first):
    env = SnookerEnv(reward="points_and_fouls")
    table_state(env, places, on, points=5)
    _, reward, terminated, _, info = env.step(action)
    assert (reward, terminated, info["foul"], info["penalty"]) == (-penalty, True, True, penalty) and env.over
    assert (info["first_ball"], info["fouls"], info["points"], info["break"]) == (first, foul, 0.0, 5.0)


def test_an_in_off_is_a_foul_though_a_red_went_too():
    """A straight pot with top spin: the cue ball follows into the same pocket."""
    env = SnookerEnv(reward="points_and_fouls")
    table_state(env, {CUE: (0.5, 0.0), 1: (0.7, 0.0), 2: (-0.5, 0.5), BLACK: (0.0, 1.0)}, BallOn.RED)
    obs, reward, terminated, _, info = env.step([-0.2, 0.0, 1.0, 0.0])
    assert (reward, terminated, info["foul"], info["penalty"], info["pots"]) == (-4.0, True, True, 4, 1)
    assert info["points"] == 0.0
    assert info["fouls"] == Foul.CUE_POTTED and not env.on_table[CUE] and not env.on_table[1]
    assert obs[-2] == 1.0 and env.in_hand and np.all(obs[:3] == 0.0)


def test_two_balls_potted():
    """Two reds count two; a colour that goes with a red is a foul and comes back."""
    pair = {1: (0.83, 0.0), 2: (0.83 - 0.0526, 0.0), CUE: (0.3, 0.0)}
    rest = {3: (-0.6, 0.9)} | {ball: SPOTS[ball] for ball in range(YELLOW, N_BALLS)}
    env = SnookerEnv(reward="points_and_fouls")
    table_state(env, pair | rest, BallOn.RED)
    _, reward, terminated, _, info = env.step([0.3, 0.0, 0.0, 0.0])
    assert (reward, terminated, info["points"], info["pots"]) == (2.0, False, 2.0, 2)
    assert env.ball_on == BallOn.ANY_COLOUR
    others = {2: pair[2], CUE: pair[CUE], PINK: pair[1]}
    table_state(env, rest | others, BallOn.RED)
    _, reward, terminated, _, info = env.step([-0.4, 0.0, 0.0, 0.0])
    assert info["fouls"] & Foul.WRONG_POT and info["penalty"] == 6 and (reward, terminated) == (-6.0, True)
    assert env.on_table[PINK] and np.array_equal(env.positions[PINK], SPOTS[PINK])


@pytest.mark.parametrize("ball_on", [BallOn.BLACK, BallOn.RED])
def test_clearing_the_table_ends_the_visit(ball_on):
    env = SnookerEnv()
    ball = BLACK if ball_on == BallOn.BLACK else 1
    table_state(env, {CUE: (0.3, 0.0), ball: BESIDE}, ball_on, points=20)
    _, reward, terminated, truncated, info = env.step(STUN)
    assert (reward, terminated, truncated, info["foul"]) == (float(ball_on), True, False, False)
    assert info["break"] == 20 + ball_on and not env.on_table[1:].any() and env.ball_on == BallOn.NOTHING


@pytest.mark.parametrize(
    ("name", "rewards"),
    [("points", (7, 0, 0)), ("points_and_fouls", (7, 0, -7)), ("pots", (1, 0, 0)), ("legal", (1, 1, 0))],
)
def test_reward_kinds(name, rewards):
    assert set(REWARDS) == {"points", "points_and_fouls", "pots", "legal"}
    env, got, near = SnookerEnv(reward=name), [], (0.6, 0.3)
    shots = (BESIDE, STUN), (near, [-0.9, 0, 0, 0.25]), (near, [-0.9, 0, 0, 1.0])  # a pot, a miss, a foul
    for black, action in shots:
        places = {CUE: (0.3, 0.0), YELLOW: (-0.6, -1.2), 1: (-0.6, 1.5), BLACK: black}
        table_state(env, places, BallOn.ANY_COLOUR)
        got.append(env.step(np.array(action, np.float32))[1])
    assert got == list(rewards) and all(type(r) is float for r in got)


AWAY, INTO, GRAZE = 1.0, 0.0, 0.5


def touching(gap):
    """The cue ball touches a red on its right."""
    env = SnookerEnv(reward="points_and_fouls")
    table_state(env, {CUE: (0.0, 0.3), 1: (2 * R + gap, 0.3), BLUE: (0.4, 1.2)}, BallOn.RED)
    return env, env.positions[1].copy()


@pytest.mark.parametrize("aim", [AWAY, GRAZE, 0.75])
@pytest.mark.parametrize("gap", [0.0, 1e-12, 5e-7, -5e-7, 4e-5, 49.9e-6])
def test_playing_away_from_a_touching_ball_on_is_fair_and_leaves_it(aim, gap):
    env, before = touching(gap)
    _, reward, terminated, _, info = env.step([-0.9, 0.0, 0.0, aim])
    assert (reward, terminated, info["foul"], info["fouls"]) == (0.0, True, False, 0)
    assert np.array_equal(env.positions[1], before)
    assert info["first_ball"] == -1


@pytest.mark.parametrize("speed", [-0.999, -0.6, 1.0])
@pytest.mark.parametrize("aim", [INTO, 0.2, -0.3, 0.48])
@pytest.mark.parametrize("gap", [0.0, 1e-12, -5e-7, 5e-7, 1e-5, 4e-5, 49.9e-6])
def test_playing_into_a_touching_ball_is_a_push(aim, gap, speed):
    """However small the unseen gap, however thin the contact and however slow the stroke."""
    env, before = touching(gap)
    _, reward, terminated, _, info = env.step([speed, 0.0, 0.0, aim])
    assert info["foul"] and info["fouls"] & Foul.PUSH and (reward, terminated) == (-4.0, True)
    assert not np.array_equal(env.positions[1], before)


def balls_touched(red, black):
    """The red to the right, the black above it, with these gaps."""
    return {1: (2 * R + red, 0.3), BLACK: (0.4 * (2 * R + black), 0.3 + 0.84**0.5 * (2 * R + black))}


SEEN = REFEREE_TOUCH + 1e-7
BLACK_TOUCHED = {BLACK: (2 * R, 0.3), 1: (-0.5, 0.3), BLUE: (0.4, 1.2)}
BETWEEN = {1: (2 * R + 4e-5, 0.3), BLACK: (-0.6 * (2 * R + 4e-5), 0.3 + 0.8 * (2 * R + 4e-5))}
TOUCHED = {
    "a gap that is seen is no touch": ({1: (2 * R + SEEN, 0.3)}, -0.9, AWAY, Foul.NO_CONTACT, 4, -1),
    "over a gap that is seen": ({1: (2 * R + SEEN, 0.3)}, -0.9, INTO, Foul(0), 0, 1),
    "not on: the red is struck": (BLACK_TOUCHED, -0.8, AWAY, Foul(0), 0, 1),
    "not on: the red is missed": (BLACK_TOUCHED, -0.9, 0.75, Foul.NO_CONTACT, 4, -1),
    "not on: pushed": (BLACK_TOUCHED, -0.6, INTO, Foul.PUSH, 7, None),
    "both pushed": (balls_touched(0.0, 0.0), -0.6, 0.18, Foul.PUSH, 7, None),
    "both pushed, the red first": (balls_touched(1e-6, 4e-5), -0.6, 0.18, Foul.PUSH, 7, None),
    "both pushed, the black first": (balls_touched(4e-5, 1e-6), -0.6, 0.18, Foul.PUSH, 7, None),
    "away from the black, into the red": (BETWEEN, -0.6, INTO, Foul.PUSH, 4, None),
    "from the red another ball": ({1: (2 * R, 0.3), BLUE: (-0.5, 0.3)}, -0.8, AWAY, Foul(0), 0, BLUE),
}


@pytest.mark.parametrize(("places", "speed", "aim", "foul", "worth", "first"), TOUCHED.values(), ids=TOUCHED)
def test_what_a_touching_ball_allows(places, speed, aim, foul, worth, first):
    env = SnookerEnv(reward="points_and_fouls")
    table_state(env, {CUE: (0.0, 0.3), BLUE: (-0.4, 1.2)} | places, BallOn.RED)
    info = env.step([speed, 0.0, 0.0, aim])[4]
    assert info["penalty"] == worth and first in (None, info["first_ball"])
    assert info["fouls"] & Foul.PUSH if foul == Foul.PUSH else info["fouls"] == foul


@pytest.mark.parametrize("gap", [0.0, 4e-5])
def test_a_touching_ball_met_again_off_a_cushion_is_no_push(gap):
    """Played away from the red straight onto the near cushion, from which the cue ball returns onto it."""
    env, x = SnookerEnv(), R + 0.2 - HALF_WIDTH
    table_state(env, {CUE: (x, 0.3), 1: (x + 2 * R + gap, 0.3), BLUE: (0.4, 1.2)}, BallOn.RED)
    info = env.step([-0.5, 0.0, 0.0, AWAY])[4]
    assert info["fouls"] == 0 and info["first_ball"] == 1
