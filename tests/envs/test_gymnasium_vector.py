"""Do Gymnasium's own vector environments play, bit for bit, what single ones play?"""

import os

import gymnasium
import numpy as np
import pytest

import snooker_env as sn
from tests.tables import INFO


def make_noisy():
    return gymnasium.make("Snooker-v0", noise="club", layout="random:4", aim="target")


@pytest.mark.parametrize("kind", ["sync", "async"])
def test_vector_environments_play_as_single_ones(kind):
    if kind == "sync":
        vector = gymnasium.vector.SyncVectorEnv([make_noisy] * 2)
    else:
        sn.warmup()
        vector = gymnasium.vector.AsyncVectorEnv(
            [make_noisy] * 2, context="fork" if hasattr(os, "fork") else "spawn"
        )
    singles = [make_noisy() for _ in range(2)]
    try:
        got, infos = vector.reset(seed=10)
        want = [env.reset(seed=10 + k)[0] for k, env in enumerate(singles)]
        assert np.array_equal(got, want)
        over = [False, False]
        ends = 0
        for _ in range(12):
            got, rewards, terminated, truncated, infos = vector.step(np.zeros((2, 4), np.float32))
            for k, env in enumerate(singles):
                if over[k]:  # NEXT_STEP: the step after the end is the reset
                    obs, info = env.reset()
                    reward, over[k] = 0.0, False
                else:
                    obs, reward, over[k], _, info = env.step(np.zeros(4, np.float32))
                ends += over[k]
                assert np.array_equal(got[k], obs) and rewards[k] == reward and terminated[k] == over[k]
                assert not truncated[k]
                assert all(infos[name][k] == info[name] for name in INFO)
        assert ends > 1
        assert infos["seconds"].dtype == infos["break"].dtype == np.float64 and infos["foul"].dtype == bool
    finally:
        vector.close()
