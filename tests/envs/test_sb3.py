"""Is ``SnookerVecEnv`` what ``DummyVecEnv`` of monitored single tables is, and does PPO run on it?"""

import numpy as np
import pytest

pytest.importorskip("stable_baselines3")
from stable_baselines3 import PPO, SAC
from stable_baselines3.common.env_util import make_vec_env
from stable_baselines3.common.evaluation import evaluate_policy

from snooker_env.sb3 import SnookerVecEnv
from snooker_env.tasks.tables import COUNTS, REALS
from tests.envs.one_by_one import same
from tests.processes import ROOT, python
from tests.refusals import refused

KEYS = (*REALS, *COUNTS, "foul")


def both(n, **options):
    ours = SnookerVecEnv(n, info_keys=KEYS, **options)
    ours.seed(5)
    return ours, make_vec_env("Snooker-v0", n, env_kwargs=options, seed=5)


TARGET = {"aim": "target"}
CHOICES = {"action": "discrete", "observation": "masked"}
OPTIONS = {
    "flat": TARGET | {"noise": "club", "layout": "random:5"},
    "balls": TARGET | {"observation": "balls", "layout": "random:5", "reward": "points_and_fouls"},
    "limit": TARGET | {"max_episode_steps": 2, "layout": "random:3"},
    "strokes": {"action": "strokes", "observation": "strokes", "cue": "real", "max_episode_steps": 3},
    "masked": CHOICES | {"max_episode_steps": 2, "layout": "random:3"},
}


@pytest.mark.parametrize("options", OPTIONS.values(), ids=OPTIONS)
def test_it_gives_what_dummy_vec_env_gives(options):
    """Observations, rewards, ends, infos, terminal observations, episodes: all but the clock."""
    ours, theirs = both(6, **options)
    assert ours.observation_space == theirs.observation_space and ours.action_space == theirs.action_space
    assert same(ours.reset(), theirs.reset())
    rng, ends, cut = np.random.default_rng(0), 0, 0
    for _ in range(40):
        a = rng.uniform(-1, 1, (6, 4)).astype(np.float32)
        a[:, 1:4] *= 0.2
        a = rng.integers(0, 60, 6) if "action" in options else a
        (o, r, d, infos), (o2, r2, d2, infos2) = ours.step(a), theirs.step(a)
        assert same(o, o2) and same(r, r2) and same(d, d2)
        for k in range(6):
            info, other = infos[k], dict(infos2[k])
            if not d[k]:
                assert other.pop("TimeLimit.truncated") is False
            else:
                ends, cut = ends + 1, cut + info["TimeLimit.truncated"]
                assert info["episode"].pop("t") >= 0 and other["episode"].pop("t") >= 0
            assert set(info) == set(other) and all(same(info[key], other[key]) for key in info)
            assert all(type(info[key]) is type(other[key]) for key in KEYS)
    assert ends > 60 and (cut > 5) == ("max_episode_steps" in options)


def test_a_seed_at_the_start_is_as_one_given_later():
    """Table k begins with seed + k; later visits follow from it."""
    at_once, later, other = SnookerVecEnv(5, seed=3), SnookerVecEnv(5), SnookerVecEnv(5, seed=np.int64(4))
    later.seed(3)
    first = at_once.reset()
    assert np.array_equal(first, later.reset()) and np.array_equal(first[1:], other.reset()[:4])
    assert at_once.tables.np_random_seed == (3, 4, 5, 6, 7)
    a = np.zeros((5, 4), np.float32)
    assert all(np.array_equal(at_once.step(a)[0], later.step(a)[0]) for _ in range(5))
    assert not np.array_equal(SnookerVecEnv(5).reset(), SnookerVecEnv(5).reset())
    assert not np.array_equal(at_once.reset(), first)


@pytest.mark.parametrize("seed", [-1, 1.0, "1", True, [1, 2], 2**63])
def test_wrong_seeds_are_refused(seed):
    allowed = "must be an integer in [0, 9223372036854775807]"
    refused(lambda: SnookerVecEnv(2, seed=seed), "seed", repr(seed), allowed)


def test_states_are_saved_and_restored():
    env = SnookerVecEnv(3, noise="club")
    env.seed(1)
    env.reset()
    states = env.env_method("get_state")
    a = np.full((3, 4), 0.2, np.float32)
    want = env.step(a)[:3]
    env.set_options([{"state": state} for state in states])
    env.reset()
    assert all(map(np.array_equal, want, env.step(a)[:3]))
    assert env.env_method("get_state", indices=[1])[0]["stream"] == env.env_method("get_state")[1]["stream"]
    env.set_options([{"state": states[0]}, {}, {"state": states[2]}])
    # not the whole of another's state
    refused(env.reset, "keys of options[1]", "[]", 'must be "state", "position" or "breaker" alone')
    env.set_options({"layout": 1})
    with pytest.raises(ValueError, match="options"):
        env.reset()


def test_without_stable_baselines_one_line_says_how_to_get_it():
    lacking = "import sys\nsys.modules['stable_baselines3'] = None"
    code = f"{lacking}\ntry: import snooker_env.sb3\nexcept ImportError as error: print(error)"
    needs = "snooker_env.sb3 needs Stable-Baselines3; install it, in the clone"
    assert python(code)[0].strip() == f'{needs} {ROOT}, with: pip install -c constraints.txt -e ".[train]"'


def test_attributes():
    env = SnookerVecEnv(2)
    assert env.get_attr("num_envs") == [2, 2] and env.has_attr("options") and not env.has_attr("no_such")
    assert not env.has_attr("last_shot") and env.metadata["render_fps"] == 1
    env.seed(3)
    env.reset()
    assert env.get_attr("np_random_seed", [1]) == [4]
    with pytest.raises(AttributeError, match="cannot be set"):
        env.set_attr("observation", "balls")
    with pytest.raises(ValueError, match="method_name"):
        env.env_method("step")
    with pytest.raises(ValueError, match="autoreset_mode"):
        SnookerVecEnv(2, autoreset_mode="NextStep")
    with pytest.raises(ValueError, match="info_keys"):
        SnookerVecEnv(2, info_keys=("score",))


@pytest.mark.parametrize("observation", ["flat", pytest.param("balls", marks=pytest.mark.slow)])
def test_ppo_and_sac_learn_on_it_without_a_warning(observation, strict):
    policy = "MlpPolicy" if observation == "flat" else "MultiInputPolicy"
    env = SnookerVecEnv(8, observation=observation, aim="target")
    model = PPO(policy, env, n_steps=16, batch_size=64, n_epochs=1, seed=0, device="cpu").learn(256)
    assert model.num_timesteps == 256 and len(model.ep_info_buffer) > 0 and "l" in model.ep_info_buffer[0]
    SAC(policy, env, learning_starts=16, buffer_size=100, seed=0, device="cpu").learn(64)
    evaluate_policy(model, env, n_eval_episodes=4)
    env.close()
