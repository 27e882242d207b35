"""Does the native vector environment keep Gymnasium's contract of many tables, on any threads?"""

import os
import signal
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

import snooker_env as sn
from snooker_env import SnookerEnv, SnookerVectorEnv
from snooker_env.tasks import OBSERVATIONS, stroke
from tests.envs.one_by_one import MODES, native, same
from tests.tables import acting, begun, viewed


def test_seeds_none_int_and_list():
    env = native(4)
    a, _ = env.reset(seed=7)
    b, _ = env.reset(seed=[7, 8, 9, 10])
    assert np.array_equal(a, b)
    for k in range(4):
        assert np.array_equal(SnookerEnv().reset(seed=7 + k)[0], a[k])
    assert env.np_random_seed == (7, 8, 9, 10)
    c, _ = env.reset(seed=[7, None, 9, None])
    assert np.array_equal(a[[0, 2]], c[[0, 2]]) and not (a[1] == c[1]).all() and not (a[3] == c[3]).all()
    d, _ = env.reset()
    assert not any((x == y).all() for x, y in zip(c, d, strict=True))
    # before the first reset, and without a seed
    for read in (lambda env: None, lambda env: env.np_random, lambda env: env.get_state()):
        env = native(50, layout="random:3")
        read(env)
        assert len({row.tobytes() for row in env.reset()[0]}) == 50
    with pytest.raises(ValueError, match="seed = 3 seeds"):
        native(4).reset(seed=[1, 2, 3])


@pytest.mark.parametrize("observation", OBSERVATIONS)
@pytest.mark.parametrize("mode", MODES)
def test_what_is_returned_is_the_callers_own(observation, mode):
    """Spoiling every array that was returned changes nothing that comes later."""
    options = viewed(observation) | {"noise": "club", "layout": "random:3", "max_episode_steps": 3}
    clean, spoiled = (native(8, autoreset_mode=mode, **options) for _ in range(2))
    want, got = clean.reset(seed=1), spoiled.reset(seed=1)

    def spoil(x):
        if isinstance(x, dict | tuple) or (isinstance(x, np.ndarray) and x.dtype == object):
            for value in x.values() if isinstance(x, dict) else x:
                spoil(value)
        elif isinstance(x, np.ndarray):
            x[...] = True if x.dtype == bool else 1 - x if x.dtype == np.int8 else 1

    rng = np.random.default_rng(0)
    a = rng.integers(0, 135, (10, 8)) if observation == "masked" else rng.uniform(-1, 1, (10, 8, 4))
    for k in range(10):
        assert same(want, got)
        done = (want[2] | want[3]).copy() if len(want) == 5 else np.zeros(8, bool)
        spoil(got)
        mine = a[k].copy()
        if mode == AutoresetMode.DISABLED and done.any():
            clean.reset(options={"reset_mask": done.copy()})
            spoil(spoiled.reset(options={"reset_mask": done}))
            done[:] = True
        want, got = clean.step(a[k]), spoiled.step(mine)
        mine[:] = 9
    assert same(want, got)


def test_spaces_types_and_metadata(strict):
    of_one = dict(SnookerEnv.metadata)  # Gymnasium's SyncVectorEnv before 1.3 writes into it
    env = native(5, aim="target")
    assert isinstance(env, SnookerVectorEnv) and env.num_envs == 5 and env.spec.id == "Snooker-v0"
    assert env.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP is env.autoreset_mode
    assert native(2, autoreset_mode="SameStep").metadata["autoreset_mode"] is AutoresetMode.SAME_STEP
    assert SnookerEnv.metadata == of_one
    observations, infos = env.reset(seed=0)
    assert observations in env.observation_space and observations.dtype == np.float32
    observations, rewards, terminated, truncated, infos = env.step(env.action_space.sample())
    assert observations in env.observation_space and rewards.dtype == np.float64 and rewards.shape == (5,)
    assert terminated.dtype == truncated.dtype == bool and infos["seconds"].dtype == np.float64
    assert infos["pots"].dtype == np.int64
    assert gymnasium.make_vec(env.spec).num_envs == 5
    gymnasium.wrappers.vector.RecordEpisodeStatistics(env).reset(seed=1)


def test_tables_of_the_same_options_share_no_space_and_what_they_give_is_a_copy():
    options = sn.Options()
    one, other = SnookerVectorEnv(2, options), SnookerVectorEnv(2, options)
    assert one.single_action_space is not other.single_action_space
    assert SnookerEnv(options).action_space is not SnookerEnv(options).action_space
    begun(one, 0)
    one.positions[:], one.on_table[:] = 0.0, False
    assert one.positions.any() and one.on_table.any()


def test_it_must_be_reset_first():
    env = native(3)
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(np.zeros((3, 4)))
    with pytest.raises(gymnasium.error.ResetNeeded, match="table 1"):
        env.reset(options={"reset_mask": np.array([True, False, True])})
    env = begun(native(3, autoreset_mode=AutoresetMode.DISABLED), 0)
    env.step(np.full((3, 4), -1.0))  # as soft as can be: all miss
    with pytest.raises(gymnasium.error.ResetNeeded, match="table 0 is over"):
        env.step(np.zeros((3, 4)))


def test_pictures_of_all_tables():
    pytest.importorskip("pygame")
    env = begun(native(2, render_mode="rgb_array"), 0)
    first, second = env.render()
    assert first.dtype == np.uint8 and first.ndim == 3 and not np.array_equal(first, second)
    env = begun(native(2, render_mode="ansi"), 0)
    assert "break 0" in env.render()[0]


def test_a_log_that_is_too_short_is_enlarged(monkeypatch):
    """The same shots with room for three events at first as with room for 512."""
    runs = []
    for log in (512, 3):
        with monkeypatch.context() as patch:
            patch.setattr(stroke.ShotBuffers.__init__, "__defaults__", (log,))
            env = begun(native(20, noise="club", aim="target", autoreset_mode=AutoresetMode.SAME_STEP), 3)
            runs.append([env.step(np.full((20, 4), 0.1))[:4] for _ in range(4)])
            single = begun(SnookerEnv(noise="club", aim="target"), 3)
            single.step(np.full(4, 0.1))
            runs[-1].append((single.last_shot.events.tobytes(), single.last_shot.positions))
    assert same(*runs)


@pytest.mark.parametrize("threads", [1, 2])
def test_a_shot_that_cannot_be_computed_names_its_table(monkeypatch, threads):
    monkeypatch.setattr(stroke, "MAX_EVENTS", 40)
    env = begun(native(40, threads=threads), 0)
    before = env.tables.positions.copy()
    with pytest.raises(sn.SimulationError, match=r"the shot on table \d+ did not come to rest") as info:
        env.step(np.full((40, 4), 0.9))
    k = int(str(info.value).split("table ")[1].split()[0])
    assert np.array_equal(env.tables.positions[k], before[k])
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(np.zeros((40, 4)))
    env.reset()


def test_a_wrong_seed_or_state_changes_no_table():
    env = begun(native(3, noise="club"))
    before, seeds = env.get_state(), env.np_random_seed
    good, spoilt = before[0], before[0] | {"points": 400}
    states = ([4, -1, 5], {}), ([4, 5, -1], {"state": good}), (9, {"states": [good, good, spoilt]})
    for seed, options in (*states, (9, {"state": {}})):
        with pytest.raises((ValueError, gymnasium.error.Error)):
            env.reset(seed=seed, options=options)
        assert env.get_state() == before and env.np_random_seed == seeds


forks = pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on Windows")


@forks
def test_an_environment_that_has_played_on_threads_plays_on_in_a_forked_process():
    """A child has none of its parent's threads; waiting for them would be for ever."""
    env = begun(native(64, threads=2), 3)
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


def test_an_error_of_an_opponent_asks_for_a_reset():
    def failing(observation, rng):
        raise KeyError("no turn")

    env = SnookerVectorEnv(4, task="frame", opponent=acting(failing))
    with pytest.raises(RuntimeError, match="no turn"):
        env.reset(seed=3)
    with pytest.raises(Exception, match=r"reset\(\) before step"):
        env.step(np.zeros((4, 4)))
