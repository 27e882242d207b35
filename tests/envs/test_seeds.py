"""Does the seed decide everything, bit for bit, and nothing from outside?"""

import pickle
import random

import numpy as np
import pytest

from snooker_env.envs.snooker import SnookerEnv
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


FRAME = {"task": "frame", "decision": True, "placement": True, "layout": "random:3"}
FRAMES = [FRAME | {"opponent": name} for name in ("none", "random", "ghost_ball")]


@pytest.mark.parametrize("options", [*({"layout": layout} for layout in LAYOUTS), *FRAMES])
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
