"""Can every game be played as a frame, with states that go on as the same?"""

import json

import numpy as np
import pytest

from snooker_env.envs.snooker import SnookerEnv
from snooker_env.game.balls import CUE
from snooker_env.geometry import HALF_LENGTH, HALF_WIDTH


@pytest.mark.parametrize(
    ("game", "more"), [("six_red", {"miss": "clear_path"}), ("shoot_out", {"time_to_play": 12.0})]
)
def test_a_frame_goes_on_from_its_state_as_the_same(game, more):
    options = {
        "task": "frame",
        "game": game,
        "opponent": "random",
        "placement": True,
        "decision": True,
        "aim": "target",
        **more,
    }
    env, twin, rng = SnookerEnv(**options), SnookerEnv(**options), np.random.default_rng(1)
    env.reset(seed=3)
    twin.reset(seed=8)
    over = anywhere = 0
    for _ in range(120):
        twin.set_state(json.loads(json.dumps(env.get_state())))
        action = rng.uniform(-1, 1, env.action_space.shape).astype(np.float32)
        action[1:3] *= 0.4
        one, two = env.step(action), twin.step(action)
        assert np.array_equal(one[0], two[0]) and one[1:4] == two[1:4]
        assert env.observation_space.contains(one[0])
        assert env.get_state() == twin.get_state()
        anywhere += env.get_state()["frame"]["anywhere"]
        if one[2] or one[3]:
            over += 1
            env.reset()
    assert over >= (game == "shoot_out") and (anywhere > 5) == (game == "shoot_out")


def test_six_reds_are_racked():
    env = SnookerEnv(task="frame", game="six_red")
    env.reset(seed=1)
    assert env.on_table[1:7].all() and not env.on_table[7:16].any() and env.on_table[16:].all()
    full = SnookerEnv(task="frame")
    full.reset(seed=1)
    assert np.array_equal(env.positions[CUE], full.positions[CUE])


def test_the_place_anywhere_is_a_share_of_the_table():
    env = SnookerEnv(task="frame", game="shoot_out", placement=True)
    env.reset(seed=1)
    env.step(np.array([-1, 0, 0, -0.5, 0, 0], np.float32))  # softly away from the reds: a foul
    state = env.get_state()
    assert state["frame"]["anywhere"] and state["frame"]["in_hand"]
    env.keep_history = True
    env.step(np.array([-1, 0, 0, 0.5, 0.5, 0.4], np.float32))
    start = env.history[0].shot.segments[0]
    assert start[:2] == pytest.approx([0.5 * HALF_WIDTH, 0.4 * HALF_LENGTH], abs=1e-6)
