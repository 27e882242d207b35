"""Is the game of a visit snooker? Each rule by shots really played."""

import gymnasium
import numpy as np
import pytest

from snooker_env import SnookerEnv
from snooker_env.game.balls import BLACK, BLUE, CUE, N_BALLS, REFEREE_TOUCH, SPOTS, YELLOW, BallOn
from snooker_env.game.fouls import Foul
from snooker_env.geometry import BALL_RADIUS as R
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


@pytest.mark.parametrize(
    ("name", "rewards"),
    [("points", (7, 0, 0)), ("points_and_fouls", (7, 0, -7)), ("pots", (1, 0, 0)), ("legal", (1, 1, 0))],
)
def test_reward_kinds(name, rewards):
    assert set(REWARDS) == {"points", "points_and_fouls", "pots", "legal"}
    env, got, near = SnookerEnv(aim="absolute", reward=name), [], (0.6, 0.3)
    shots = (BESIDE, STUN), (near, [-0.9, 0, 0, 0.25]), (near, [-0.9, 0, 0, 1.0])  # a pot, a miss, a foul
    for black, action in shots:
        places = {CUE: (0.3, 0.0), YELLOW: (-0.6, -1.2), 1: (-0.6, 1.5), BLACK: black}
        table_state(env, places, BallOn.ANY_COLOUR)
        got.append(env.step(np.array(action, np.float32))[1])
    assert got == list(rewards) and all(type(r) is float for r in got)


AWAY, INTO, GRAZE = 1.0, 0.0, 0.5


def touching(gap):
    """The cue ball touches a red on its right."""
    env = SnookerEnv(aim="absolute", reward="points_and_fouls")
    table_state(env, {CUE: (0.0, 0.3), 1: (2 * R + gap, 0.3), BLUE: (0.4, 1.2)}, BallOn.RED)
    return env, env.positions[1].copy()


@pytest.mark.parametrize(("gap", "aim"), [(0.0, AWAY), (1e-12, GRAZE), (-5e-7, 0.75), (49.9e-6, GRAZE)])
def test_playing_away_from_a_touching_ball_on_is_fair_and_leaves_it(gap, aim):
    env, before = touching(gap)
    _, reward, terminated, _, info = env.step([-0.9, 0.0, 0.0, aim])
    assert (reward, terminated, info["foul"], info["fouls"]) == (0.0, True, False, 0)
    assert np.array_equal(env.positions[1], before)
    assert info["first_ball"] == -1


@pytest.mark.parametrize("speed", [-0.999, 1.0])
@pytest.mark.parametrize(
    ("gap", "aim"), [(0.0, INTO), (1e-12, 0.48), (-5e-7, 0.2), (1e-5, 0.48), (49.9e-6, INTO)]
)
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
    env = SnookerEnv(aim="absolute", reward="points_and_fouls")
    table_state(env, {CUE: (0.0, 0.3), BLUE: (-0.4, 1.2)} | places, BallOn.RED)
    info = env.step([speed, 0.0, 0.0, aim])[4]
    assert info["penalty"] == worth and first in (None, info["first_ball"])
    assert info["fouls"] & Foul.PUSH if foul == Foul.PUSH else info["fouls"] == foul
