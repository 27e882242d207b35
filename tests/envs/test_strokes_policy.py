"""Do PPO, MaskablePPO and DQN learn on the menu, with one network for every stroke?"""

import numpy as np
import pytest

pytest.importorskip("stable_baselines3")
import torch
from stable_baselines3 import DQN, PPO

from snooker_env.sb3 import SnookerVecEnv, StrokesPolicy, StrokesQPolicy, _StrokesNet
from tests.processes import python

MENU = {"action": "strokes", "observation": "strokes", "threads": 1}
SMALL = {"n_steps": 8, "batch_size": 32, "n_epochs": 2, "device": "cpu", "seed": 0}


def weights(model):
    return {name: value.clone() for name, value in model.policy.state_dict().items()}


@pytest.mark.parametrize("name", ["PPO", "MaskablePPO"])
def test_it_learns_and_is_kept(name, tmp_path):
    algorithm = PPO if name == "PPO" else pytest.importorskip("sb3_contrib").MaskablePPO
    env = SnookerVecEnv(8, seed=1, layout="colours", **MENU)
    model = algorithm(StrokesPolicy, env, **SMALL)
    before = weights(model)
    model.learn(64)
    assert any(not torch.equal(value, before[name]) for name, value in weights(model).items())
    observed = env.reset()
    chosen, _ = model.predict(observed, deterministic=True)
    there = np.array(env.env_method("action_masks"))
    assert there[np.arange(8), chosen].all() and not there.all()
    model.save(tmp_path / "agent.zip")
    again = algorithm.load(tmp_path / "agent.zip", device="cpu")
    assert np.array_equal(again.predict(observed, deterministic=True)[0], chosen)


def test_a_stroke_that_is_not_there_is_never_chosen_without_masks_neither():
    env = SnookerVecEnv(16, seed=2, layout="colours", **MENU)
    model = PPO(StrokesPolicy, env, **SMALL)
    observed = env.reset()
    there = np.array(env.env_method("action_masks"))
    for _ in range(20):
        chosen, _ = model.predict(observed, deterministic=False)
        assert there[np.arange(16), chosen].all()


def test_dqn_learns():
    env = SnookerVecEnv(4, seed=1, layout="colours", **MENU)
    model = DQN(StrokesQPolicy, env, learning_starts=8, batch_size=16, buffer_size=200, device="cpu", seed=0)
    before = weights(model)
    model.learn(40)
    assert any(not torch.equal(value, before[name]) for name, value in weights(model).items())
    assert model.q_net(torch.as_tensor(env.reset())).shape == (4, 108)


def test_each_stroke_is_read_alike():
    """Strokes that change places change their logits with them; the position is read the same."""
    net, rng = _StrokesNet(108, 108 * 23 + 11), np.random.default_rng(3)
    seen = torch.as_tensor(rng.uniform(-1.0, 1.0, (5, 108 * 23 + 11)), dtype=torch.float32)
    order = torch.as_tensor(rng.permutation(108))
    swapped = seen.clone()
    swapped[:, : 108 * 23] = seen[:, : 108 * 23].view(5, 108, 23)[:, order].reshape(5, -1)
    (logits, position), (logits2, position2) = net(seen), net(swapped)
    assert torch.allclose(logits[:, order], logits2, atol=1e-6)
    assert torch.allclose(position, position2, atol=1e-5)
    assert logits.shape == (5, 108) and torch.equal(net.forward_actor(seen), logits)
    assert torch.equal(net.forward_critic(seen), position)


@pytest.mark.slow
def test_it_is_there_without_sb3_contrib():
    code = """
import sys
sys.modules["sb3_contrib"] = None
from stable_baselines3 import PPO
from snooker_env.sb3 import SnookerVecEnv, StrokesPolicy
env = SnookerVecEnv(2, action="strokes", observation="strokes", seed=1, threads=1)
model = PPO(StrokesPolicy, env, n_steps=2, batch_size=4, device="cpu")
print(model.predict(env.reset())[0].shape)
"""
    assert "(2,)" in python(code)[0]


def test_other_spaces_are_refused_with_what_is_allowed():
    with pytest.raises(ValueError, match=r'must be those of action="strokes", observation="strokes"'):
        PPO(StrokesPolicy, SnookerVecEnv(8, action="strokes", threads=1), **SMALL)
