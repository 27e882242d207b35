"""Does the seed decide everything, bit for bit, and nothing from outside?"""

import pickle
import random

import numpy as np
import pytest

from snooker_env import SnookerEnv
from snooker_env.game.balls import CUE, BallOn
from snooker_env.geometry import BALL_RADIUS as R
from snooker_env.tasks.box_actions import AIMS
from tests.tables import LAYOUTS, jsonable


def play(env, seed, steps=6, actions=1):
    """The bytes of everything a run returns."""
    rng = np.random.default_rng(actions)
    out = [env.reset(seed=seed)]
    for _ in range(steps):
        out.append(env.step(rng.uniform(-1, 1, env.action_space.shape) * 0.5))
        if out[-1][2]:
            out.append(env.reset())
    return pickle.dumps(jsonable(out))


FRAME = {"task": "frame", "says": ["decision"], "placement": True, "layout": "random:3"}
GAMES = ({"layout": "opened"}, FRAME | {"opponent": "random"}, FRAME | {"opponent": "ghost_ball"})


@pytest.mark.parametrize("options", GAMES)
def test_the_same_seed_plays_the_same_game_bit_for_bit(options):
    env, other = (SnookerEnv(noise="club", aim="target", **options) for _ in range(2))
    first = play(env, 5, 30)
    assert play(env, 5, 30) == first  # again in the same environment
    assert play(other, 5, 30) == first  # and in a new one
    assert play(env, 6, 30) != first


@pytest.mark.parametrize("layout", LAYOUTS)
def test_different_seeds_start_from_different_tables(layout):
    env = SnookerEnv(layout=layout)
    starts = {env.reset(seed=seed)[0].tobytes() for seed in range(8)}
    tables = 2 if layout == "break_off" else 8  # the cue ball left or right of the brown
    assert len(starts) == tables
    # nor does the same table come again and again
    assert len({env.reset()[0].tobytes() for _ in range(8)}) == tables
    assert env.reset(seed=3)[0].tobytes() in starts


def test_the_random_numbers_of_others_are_left_alone():
    """Neither numpy's nor Python's global generator is used or moved."""

    def global_states():
        _, keys, at, *_ = np.random.get_state()  # noqa: NPY002
        return keys.tobytes(), at, random.getstate()

    env = SnookerEnv(noise="club", layout="random:5", placement=True)
    runs = []
    for seed in (1, 2):
        np.random.seed(seed)  # noqa: NPY002 - the global generator is what is tested
        random.seed(seed)
        before = global_states()
        runs.append(play(env, 4))
        assert global_states() == before
    assert runs[0] == runs[1]


# Random play loses, doubles, overlaps and misplaces no ball: checked after every shot


def check_table(env, before, info):
    """After a shot: nothing lost, nothing doubled, nothing overlapping, nothing outside."""
    here = env.on_table
    places = env.positions[here]
    gaps = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1))[np.triu_indices(len(places), 1)]
    assert np.isfinite(env.positions).all()
    assert gaps.size == 0 or gaps.min() >= 2 * R - 1e-6
    env.options.rules.table.check(env.positions, R, on_table=here)
    assert env.points <= 155
    lost = before & ~here
    assert not (here & ~before)[1:].any()
    potted = env.last_shot.potted >= 0
    assert not (lost & ~potted)[1:].any() and not (potted & ~before).any()
    assert lost[1:16].tolist() == potted[1:16].tolist()  # a red in a pocket never comes back
    if here.any() and env.ball_on != BallOn.NOTHING:
        gone = before[16:] & ~here[16:]
        assert gone.sum() <= 1
        if gone.any():
            assert info["ball_on"] == 2 + gone.argmax() and not info["foul"] and info["points"]
    assert env.over or here[CUE]
    assert env.over == (not info["points"]) or not here[1:].any()
    assert info["break"] == env.points


@pytest.mark.parametrize("layout", LAYOUTS)
def test_random_play_loses_no_ball(layout):
    """Some 40 visits a layout, wild shots and good ones, level and raised cues, noise, all three rewards."""
    rng = np.random.default_rng(LAYOUTS.index(layout))
    strokes = most = 0
    for aim in AIMS:
        arguments = {"aim": aim, "layout": layout, "noise": "club", "fidelity": "fast"}
        arguments |= {"elevation": aim == "absolute", "placement": layout == "break_off"}
        env = SnookerEnv(reward="points_and_fouls", **arguments)
        obs, _ = env.reset(seed=LAYOUTS.index(layout))
        for _ in range(19):
            if env.over:
                obs, _ = env.reset()
            while not env.over:
                assert env.observation_space.contains(obs)
                before = env.on_table.copy()
                action = rng.uniform(-1, 1, env.action_space.shape)
                if aim == "target":
                    action[:4] = rng.uniform(-0.6, 0.3), 0.0, rng.uniform(-0.8, 0.5), 0.0
                obs, reward, *_, info = env.step(action)
                assert env.observation_space.contains(obs)
                assert reward == info["points"] - info["penalty"]
                check_table(env, before, info)
                strokes += 1
                most = max(most, env.points)
    assert strokes >= 38
    assert most > 0 or layout == "break_off"
