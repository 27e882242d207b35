"""Is a frame that goes nowhere stopped by the referee, and can no score that play reaches break it?"""

import copy
import json

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import snooker_env as sn
from snooker_env.envs.snooker import SnookerEnv
from snooker_env.game.frame import Frame
from snooker_env.game.referee import Stroke
from snooker_env.tasks.options import MAX_STROKES

FOUL = np.array([-1.0, 0, 0, -0.5, 0, 0, -1], np.float32)
"""Straight down the table, as softly as can be, and the other is to play again after his foul."""


def frame_of(**options):
    return SnookerEnv(**{"task": "frame", "decision": True, "placement": True} | options)


# Scores


def test_fouls_without_end_score_without_end():
    """A rule has no ceiling: a hundred fouls around what the first version could count to, and beyond."""
    for scores in ((9_980, 0), (0, 9_980), (9_800, 9_800), (2**53, 2**40)):
        frame = Frame(scores=scores, miss="clear_path")
        for _ in range(200):
            frame, _ = frame.play(Stroke(), clear_path=True)
            frame = Frame.from_dict(json.loads(json.dumps(frame.to_dict()))).choose("play_again")
        assert sum(frame.scores) == sum(scores) + 800


@pytest.mark.parametrize("opponent", ["none", "random", "ghost_ball"])
def test_random_play_goes_on_beyond_ten_thousand_points(opponent):
    env = SnookerEnv(task="frame", opponent=opponent, max_strokes=None)
    env.reset(seed=1)
    state, rng = env.get_state(), np.random.default_rng(0)
    env.reset(options={"state": state | {"frame": state["frame"] | {"scores": [9_990, 9_990]}}})
    for _ in range(60):
        obs, reward, terminated, truncated, info = env.step(rng.uniform(-1, 1, 4))
        assert env.observation_space.contains(obs) and abs(reward) < 1000 and not truncated
        if terminated:
            break
    assert info["score"] + info["opponent_score"] > 20_000 or terminated


def test_a_match_of_fouls_and_orders_to_play_again_ends_by_itself():
    pytest.importorskip("pettingzoo")
    env = sn.match_env(layout="random:2")
    env.reset(seed=1)
    state = env.get_state()
    env.reset(options={"state": state | {"frame": state["frame"] | {"scores": [9_990, 9_990]}}})
    for _ in range(2000):  # a turn is a stroke, or gives the table over
        env.step(FOUL)
        assert not any(env.terminations.values())
        if any(env.truncations.values()):
            break
    assert env.strokes == MAX_STROKES == 1000 and all(env.truncations.values())
    assert sum(env.frame.scores) >= 19_980 + 4 * 900 and env.infos["player_0"]["strokes"] == 1000
    assert all(env.observation_spaces[player].contains(env.observe(player)) for player in env.possible_agents)


def test_random_play_with_all_defaults_ends_at_the_limit_and_starts_anew():
    env = gymnasium.make("Snooker-v0", task="frame")
    env.reset(seed=2)
    env.action_space.seed(2)
    ends, strokes = [], 0
    for _ in range(3000):
        obs, _, terminated, truncated, info = env.step(env.action_space.sample())
        assert env.observation_space.contains(obs) and type(terminated) is type(truncated) is bool
        strokes += 1
        assert info["strokes"] == strokes
        if terminated or truncated:
            assert truncated == (strokes == 1000 and info["winner"] == -1)
            ends.append(truncated)
            strokes = 0
            env.reset()
    assert len(ends) >= 3 and any(ends)


# The limit


@pytest.mark.parametrize("opponent", ["none", "random", "ghost_ball"])
def test_the_referee_stops_the_frame_after_the_very_stroke(opponent):
    env, cut = frame_of(opponent=opponent, max_strokes=6), 0
    for seed in range(12):
        _, info = env.reset(seed=seed)
        played, rng = info["strokes"], np.random.default_rng(seed)
        assert played < 6
        while True:
            obs, _, terminated, truncated, info = env.step(rng.uniform(-1, 1, 7))
            played += (info["events"] > 0 or info["seconds"] > 0) + info["opponent_strokes"]
            assert info["strokes"] == played <= 6 and env.observation_space.contains(obs)
            assert truncated == (played == 6 and not terminated) and type(truncated) is bool
            if terminated or truncated:
                break
        assert terminated or info["winner"] == -1
        before = json.dumps(env.get_state())
        with pytest.raises(gymnasium.error.ResetNeeded):
            env.step(np.zeros(7))
        assert json.dumps(env.get_state()) == before
        cut += truncated and env.frame.striker == 1
        other = frame_of(opponent=opponent, max_strokes=6)
        other.set_state(json.loads(before))  # in the middle of a visit of the opponent, too
        assert other.over and json.dumps(other.get_state()) == before
        with pytest.raises(ValueError, match=r"state\.strokes = 6: must be below max_strokes = 6"):
            other.reset(options={"state": json.loads(before)})
    assert (cut > 0) == (opponent != "none")  # alone the agent is always to play


def test_the_strokes_are_counted_on_from_a_state():
    env = frame_of(opponent="none", max_strokes=9)
    env.reset(seed=1)
    for _ in range(4):
        env.step(FOUL)
    state = json.loads(json.dumps(env.get_state()))
    assert state["strokes"] == 4
    other = frame_of(opponent="none", max_strokes=9)
    assert other.reset(options={"state": state})[1]["strokes"] == 4
    assert [other.step(FOUL)[3] for _ in range(5)] == [False] * 4 + [True]
    assert other.reset()[1]["strokes"] == 0
    endless = frame_of(opponent="none", max_strokes=None)
    endless.reset(options={"state": state | {"strokes": 10**6}})
    assert not endless.step(FOUL)[3]


def test_a_frame_that_is_stopped_in_the_opening_visit_is_reported_by_the_next_step():
    """After the opponent's break-off the agent plays nothing, and is paid what the opponent scored."""
    env, opened = frame_of(opponent="random", max_strokes=1), 0
    for seed in range(10):
        _, info = env.reset(seed=seed)
        opened += info["strokes"]
        _, reward, terminated, truncated, after = env.step(FOUL)
        assert (terminated, truncated, after["strokes"]) == (False, True, 1) and after["winner"] == -1
        assert reward == after["score"] - after["opponent_score"]
        assert info["strokes"] == 0 or after["events"] == 0
    assert 0 < opened < 10


def test_it_is_sound_for_gymnasium_and_round_trips():
    env = gymnasium.make("Snooker-v0", task="frame", max_strokes=3, opponent="random")
    check_env(env.unwrapped, skip_render_check=True)
    for limit in (3, None):
        spec = copy.deepcopy(gymnasium.spec("Snooker-v0"))  # it is the registry's own
        spec.kwargs = {"task": "frame", "max_strokes": limit}
        again = gymnasium.make(gymnasium.envs.registration.EnvSpec.from_json(spec.to_json()))
        assert again.unwrapped.options.max_strokes == limit
