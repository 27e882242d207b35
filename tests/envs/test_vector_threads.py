"""Do the threads of the native vector environment stay its own: across forks, and in number?"""

import os
import signal
import warnings

import gymnasium
import numpy as np
import pytest

from tests.envs.test_vector import native


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on Windows")
def test_processes_forked_while_threads_are_kept_play_on():
    """AsyncVectorEnv forks; the threads of a vector environment in the parent do no harm."""
    env = native(32, threads=2)
    env.reset(seed=0)
    a = np.zeros((32, 4), np.float32)
    want = env.step(a)[0]
    forked = gymnasium.vector.AsyncVectorEnv([lambda: gymnasium.make("Snooker-v0")] * 2, context="fork")
    try:
        forked.reset(seed=0)
        assert np.array_equal(forked.step(a[:2])[0], want[:2])
    finally:
        forked.close()
    env.step(a)
    env.close()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on Windows")
def test_an_environment_that_has_played_on_threads_plays_on_in_a_forked_process():
    """A child has none of its parent's threads; waiting for them would be for ever."""
    env = native(64, threads=2)
    env.reset(seed=3)
    a = np.zeros((64, 4))
    env.step(a)
    mine, yours = os.pipe()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of forking beside threads
        child = os.fork()
    if child == 0:
        signal.alarm(30)  # kills it if it waits
        os.write(yours, np.ascontiguousarray(env.step(a)[0]).tobytes())
        os._exit(0)
    os.close(yours)
    with os.fdopen(mine, "rb") as pipe:
        got = pipe.read()
    os.waitpid(child, 0)
    assert got == np.ascontiguousarray(env.step(a)[0]).tobytes()
    env.close()


def test_the_number_of_threads_is_fixed():
    """Work space is made for it: a different number would write beyond its end."""
    env = native(64, threads=2)
    with pytest.raises(AttributeError):
        env.threads = 1
