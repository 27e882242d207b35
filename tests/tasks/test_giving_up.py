"""Does it pay to give a frame up? With points as the reward it costs those that are left on the table."""

import json

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game.balls import BLACK, PINK
from tests.tables import PLACES, frame_env, frame_state
from tests.tasks.test_misses_in_hand import after_failures

LEFT = 2 * 8 + 6 + 7
"""On the table of ``PLACES``: two reds, pink and black."""
GIVES_UP = [0.0] * 7 + [-1.0]


def test_to_concede_costs_what_is_left_on_the_table():
    env = frame_state(frame_env(concede=True, opponent="ghost_ball"), PLACES, {"scores": (10, 30)})
    _, reward, terminated, _, info = env.step(GIVES_UP)
    assert (reward, terminated, info["winner"]) == (-LEFT, True, 1)
    assert (info["score"], info["opponent_score"]) == (10.0, 30.0)  # the score stands


def test_from_the_start_it_costs_147():
    env = sn.SnookerEnv(task="frame", concede=True)
    env.reset(seed=1)
    assert env.step([0.0] * 4 + [-1.0])[1] == -147.0


def test_what_was_not_paid_yet_is_paid_with_it():
    env = frame_env(concede=True, opponent="ghost_ball")
    state = frame_state(env, PLACES, {"scores": (10, 30)}).get_state() | {"unpaid": -5}
    env.reset(options={"state": json.loads(json.dumps(state))})
    assert env.step(GIVES_UP)[1] == -5 - LEFT


@pytest.mark.parametrize("striker", [0, 1])
def test_of_two_players_the_other_one_gets_it(striker):
    match = sn.match_env(concede=True)
    match.reset(seed=1)
    state = frame_state(frame_env(), PLACES, {"scores": (10, 30), "striker": 0}).get_state()
    state["frame"]["striker"] = striker
    match.reset(options={"state": state})
    match.step(GIVES_UP)
    assert match.rewards == {f"player_{striker}": -LEFT, f"player_{1 - striker}": LEFT}


@pytest.mark.parametrize(("reward", "expected"), [("win", -1.0), ("frames", -1.0), ("points", -(147 + LEFT))])
def test_of_a_match_each_frame_given_up_is_paid_once(reward, expected):
    env = sn.SnookerEnv(task="match", frames=3, concede=True, aim="target", reward=reward)
    env.reset(seed=1)
    total = env.step([0.0] * 4 + [-1.0])[1]
    state = env.get_state()
    assert state["frames"] == [0, 1]
    positions, on_table = np.array(state["positions"]), [ball in PLACES for ball in range(22)]
    for ball, place in PLACES.items():
        positions[ball] = place
    frame = state["frame"] | {"on_table": 2 | 4 | 1 << PINK | 1 << BLACK, "in_hand": False}
    env.reset(
        options={"state": state | {"positions": positions.tolist(), "on_table": on_table, "frame": frame}}
    )
    total += env.step([0.0] * 4 + [-1.0])[1]
    assert total == {"frames": 2 * expected}.get(reward, expected)


def test_a_frame_lost_by_a_third_miss_is_given_up_too():
    """Each failure costs four; the red, the brown and the black are left."""
    _, (_, reward, terminated, _, info) = after_failures("clear_path", 3)
    assert terminated and info["opponent_score"] == 12.0
    assert reward == -4 - (8 + 4 + 7)
