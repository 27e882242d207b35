"""Is the game of a visit snooker? Each rule by shots really played."""

import math

import gymnasium
import numpy as np
import pytest

from snooker_env.envs.snooker import SnookerEnv
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
    places = {ball: SPOTS[ball] for ball in range(YELLOW, N_BALLS)} | {CUE: (0.3, 0.0), 1: BESIDE}
    table_state(env, places, BallOn.RED)
    pot(env, 1)
    assert env.ball_on == BallOn.ANY_COLOUR
    pot(env, YELLOW)
    assert env.on_table[YELLOW] and env.ball_on == BallOn.YELLOW and not env.over and env.points == 3


def test_a_miss_ends_the_visit_without_a_foul():
    env = racked()
    pot(env, 1)
    table_state(env, {CUE: (0.0, -0.5), 2: (0.0, 0.6), BLACK: (0.6, 1.0)}, BallOn.RED, points=8)
    _, reward, terminated, truncated, info = env.step([-0.8, 0.0, 0.0, 0.5])
    assert (reward, terminated, truncated, info["foul"], info["penalty"]) == (0.0, True, False, False, 0)
    assert info["first_ball"] == 2
    assert info["break"] == 8.0 == env.points and info["fouls"] == 0 and env.on_table[[CUE, 2, BLACK]].all()


@pytest.mark.parametrize(("ball", "penalty"), [(16, 4), (17, 4), (18, 4), (19, 5), (20, 6), (21, 7)])
def test_a_wrong_ball_first_is_a_foul_of_its_value(ball, penalty):
    env = SnookerEnv(reward="points_and_fouls")
    table_state(env, {CUE: (0.0, -0.5), 2: (0.6, 0.6), ball: (0.0, 0.3)}, BallOn.RED, points=5)
    _, reward, terminated, _, info = env.step([-0.6, 0.0, 0.0, 0.5])
    assert (reward, terminated, info["foul"], info["penalty"]) == (-penalty, True, True, penalty)
    assert info["first_ball"] == ball
    assert info["fouls"] == Foul.WRONG_FIRST and info["points"] == 0.0 and info["break"] == 5.0


def test_no_contact_is_a_foul():
    env = SnookerEnv(reward="points_and_fouls")
    table_state(env, {CUE: (0.0, -0.5), PINK: (0.6, 0.6)}, BallOn.PINK)
    _, reward, terminated, _, info = env.step([-0.9, 0.0, 0.0, 1.0])
    assert (reward, terminated, info["penalty"], info["first_ball"]) == (-6.0, True, 6, -1)
    assert info["fouls"] == Foul.NO_CONTACT


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
    table_state(
        env,
        {PINK: pair[1], 2: pair[2], CUE: pair[CUE]} | {k: v for k, v in rest.items() if k != PINK},
        BallOn.RED,
    )
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


def test_a_foul_on_the_last_black_ends_it_too():
    env = SnookerEnv(reward="points_and_fouls")
    table_state(env, {CUE: (0.3, 0.0), BLACK: (-0.4, 1.0)}, BallOn.BLACK, points=20)
    _, reward, terminated, _, info = env.step([-0.9, 0, 0, -0.4])
    assert (reward, terminated, info["penalty"]) == (-7.0, True, 7) and env.over


@pytest.mark.parametrize(
    ("name", "rewards"),
    [("points", (7, 0, 0)), ("points_and_fouls", (7, 0, -7)), ("pots", (1, 0, 0)), ("legal", (1, 1, 0))],
)
def test_reward_kinds(name, rewards):
    assert set(REWARDS) == {"points", "points_and_fouls", "pots", "legal"}
    env = SnookerEnv(reward=name)
    got = []
    for places, action in [
        ({BLACK: BESIDE}, STUN),  # a pot
        ({BLACK: (0.6, 0.3)}, [-0.9, 0, 0, math.atan2(0.3, 0.3) / math.pi]),  # a miss
        ({BLACK: (0.6, 0.3)}, [-0.9, 0, 0, 1.0]),  # a foul
    ]:
        table_state(env, {CUE: (0.3, 0.0), YELLOW: (-0.6, -1.2), 1: (-0.6, 1.5)} | places, BallOn.ANY_COLOUR)
        got.append(env.step(np.array(action, np.float32))[1])
    assert got == list(rewards) and all(type(r) is float for r in got)


# A touching ball

AWAY, INTO, GRAZE = 1.0, 0.0, 0.5


def touching(gap=0.0, ball=1, others=None, ball_on=BallOn.RED):
    """The cue ball touches a ball on its right."""
    env = SnookerEnv(reward="points_and_fouls")
    table_state(env, {CUE: (0.0, 0.3), ball: (2 * R + gap, 0.3)} | (others or {BLUE: (0.4, 1.2)}), ball_on)
    return env


@pytest.mark.parametrize("aim", [AWAY, GRAZE, 0.75])
@pytest.mark.parametrize("gap", [0.0, 1e-12, 5e-7, -5e-7, 4e-5, 49.9e-6])
def test_playing_away_from_a_touching_ball_on_is_fair_and_leaves_it(aim, gap):
    env = touching(gap)
    before = env.positions[1].copy()
    _, reward, terminated, _, info = env.step([-0.9, 0.0, 0.0, aim])
    assert (reward, terminated, info["foul"], info["fouls"]) == (0.0, True, False, 0)
    assert np.array_equal(env.positions[1], before)
    assert info["first_ball"] == -1


def test_a_gap_that_can_be_seen_is_no_touch():
    env = touching(REFEREE_TOUCH + 1e-7)
    assert env.step([-0.9, 0, 0, AWAY])[4]["fouls"] == Foul.NO_CONTACT
    env = touching(REFEREE_TOUCH + 1e-7)
    assert env.step([-0.9, 0, 0, INTO])[4]["fouls"] == 0


@pytest.mark.parametrize("speed", [-0.999, -0.6, 1.0])
@pytest.mark.parametrize("aim", [INTO, 0.2, -0.3, 0.48])
@pytest.mark.parametrize("gap", [0.0, 1e-12, -5e-7, 5e-7, 1e-5, 4e-5, 49.9e-6])
def test_playing_into_a_touching_ball_is_a_push(aim, gap, speed):
    """However small the unseen gap, however thin the contact and however slow the stroke."""
    env = touching(gap)
    before = env.positions[1].copy()
    _, reward, terminated, _, info = env.step([speed, 0.0, 0.0, aim])
    assert info["foul"] and info["fouls"] & Foul.PUSH and (reward, terminated) == (-4.0, True)
    assert not np.array_equal(env.positions[1], before)


def test_a_touching_ball_that_is_not_on_does_not_count():
    """Touching the black with a red on: playing away and missing is a foul, striking a red is not."""
    places = {1: (-0.5, 0.3), BLUE: (0.4, 1.2)}
    env = touching(0.0, BLACK, places)
    assert env.step([-0.8, 0.0, 0.0, AWAY])[4]["fouls"] == 0
    env = touching(0.0, BLACK, places)
    info = env.step([-0.9, 0.0, 0.0, 0.75])[4]
    assert info["fouls"] == Foul.NO_CONTACT and info["penalty"] == 4
    env = touching(0.0, BLACK, places)
    info = env.step([-0.6, 0.0, 0.0, INTO])[4]
    assert info["fouls"] & Foul.PUSH and info["penalty"] == 7


def test_of_several_touching_balls_each_that_is_played_into_is_pushed():
    """Between red and black, into both; with different gaps it meets one after the other."""
    for gap_red, gap_black in [(0.0, 0.0), (1e-6, 4e-5), (4e-5, 1e-6)]:
        env = touching(
            gap_red,
            1,
            {BLACK: (0.4 * (2 * R + gap_black), 0.3 + 0.84**0.5 * (2 * R + gap_black)), BLUE: (-0.4, 1.2)},
        )
        info = env.step([-0.6, 0.0, 0.0, 0.18])[4]
        assert info["fouls"] & Foul.PUSH and info["penalty"] == 7
    env = touching(4e-5, 1, {BLACK: (-0.6 * (2 * R + 4e-5), 0.3 + 0.8 * (2 * R + 4e-5))})
    info = env.step([-0.6, 0.0, 0.0, INTO])[4]  # away from the black, into the red
    assert info["fouls"] & Foul.PUSH and info["penalty"] == 4


def test_a_touching_ball_met_again_off_a_cushion_is_no_push():
    """Played away from the red straight onto the near cushion, from which the cue ball returns onto it."""
    for gap in (0.0, 4e-5):
        env = SnookerEnv(reward="points_and_fouls")
        table_state(
            env,
            {
                CUE: (-HALF_WIDTH + R + 0.2, 0.3),
                1: (-HALF_WIDTH + R + 0.2 + 2 * R + gap, 0.3),
                BLUE: (0.4, 1.2),
            },
            BallOn.RED,
        )
        info = env.step([-0.5, 0.0, 0.0, AWAY])[4]
        assert info["fouls"] == 0 and info["first_ball"] == 1


def test_from_a_touching_red_another_ball_may_be_struck():
    """The touching red is on and counts as struck, so the blue may be played onto."""
    env = touching(0.0, 1, {BLUE: (-0.5, 0.3)})
    info = env.step([-0.8, 0.0, 0.0, AWAY])[4]
    assert info["fouls"] == 0 and info["first_ball"] == BLUE
