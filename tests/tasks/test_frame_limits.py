"""Do frames hold at their limits? Mouths of pockets, before the first reset, two players' table alone."""

import json

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game.balls import BLACK, CUE, PINK
from snooker_env.game.ruling import AUTO
from tests.tables import frame_env, frame_state

SOFT = [-1.0, 0, 0, 0.5, 0, 0, 0]
"""A soft stroke up the table (with ``aim="absolute"``)."""


@pytest.mark.parametrize("observation", ["flat", "balls"])
def test_the_layout_that_replace_restores_is_within_its_space(observation):
    """A ball may rest in the mouth of a middle pocket, farther out than the cushions' noses."""
    env = frame_env(
        opponent=lambda seen, rng: np.array(SOFT), miss="clear_path", aim="absolute", observation=observation
    )
    frame_state(env, {CUE: (0.0, 0.0), 1: (-0.3, -1.0), PINK: (0.3, 0.5), BLACK: (0.8993, -0.035)}, {})
    seen, _, _, _, _ = env.step(SOFT)
    assert env.frame.miss_called and env.positions[BLACK, 0] > 0.889
    assert env.observation_space.contains(seen)
    replaced = seen["replaced"] if observation == "balls" else seen[-66:].reshape(22, 3)
    assert replaced[BLACK].tolist() == [pytest.approx(0.8993 / 0.889), pytest.approx(-0.035 / 1.7845), 1.0]


@pytest.mark.parametrize("game", ["snooker", "six_red", "shoot_out"])
def test_the_state_before_the_first_reset_is_sound(game):
    env = sn.SnookerEnv(task="frame", game=game)
    state = env.get_state()
    env.set_state(json.loads(json.dumps(state)))
    assert env.get_state() == state


@pytest.mark.parametrize("decision", [-1.0, 0.0, 1.0])
def test_who_plays_alone_stays_at_the_table_after_a_decision(decision):
    """The state comes from a frame of two players: a foul of the other one."""
    env = frame_state(
        frame_env(aim="absolute"), {CUE: (0.0, 0.0), 1: (-0.3, -1.0), PINK: (0.3, 0.5)}, {"phase": "choice"}
    )
    env.step([*SOFT[:6], decision])
    assert env.frame.striker == 0 and env.frame.phase == "stroke"


def test_a_nomination_does_not_outlive_its_frame():
    """An error in a stroke, or in an opponent, may leave one behind."""
    env = frame_env()
    env.reset(seed=1)
    state = env.get_state()
    position = sn.Position(cue=(0.0, 0.0), black=(0.3, 0.3), on="black")
    for start in ({}, {"state": state}, {"position": position}):
        env.tables.nominated[0] = PINK
        env.reset(options=start)
        assert env.tables.nominated[0] == AUTO
