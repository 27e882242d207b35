"""Is ``FastPPO`` the algorithm of sb3-contrib: the same advantages, updates, files, and weights of a seed?"""

import io

import numpy as np
import pytest
import torch
from sb3_contrib import MaskablePPO
from sb3_contrib.common.maskable.buffers import MaskableRolloutBuffer

from agents.features.observed import training_tables
from agents.learning.fast_ppo import BoolMasks, FastPPO
from agents.learning.hyperparameters import Recipe

TABLES = 8


def made(seed=0, **changes):
    """An untrained agent on a few tables."""
    changes = {"n_steps": 16, "n_epochs": 2, "batch_size": 64} | changes
    recipe = Recipe.of("ppo_value", [f"{key}={value}" for key, value in changes.items()], n_envs=TABLES)
    return recipe.new_model(training_tables(TABLES, threads=1, **recipe.env_kwargs), seed)


def with_rollout(model):
    """The model with a rollout in its buffer."""
    _, callback = model._setup_learn(1, None)
    assert model.collect_rollouts(model.env, callback, model.rollout_buffer, model.n_steps)
    return model


def weights(model):
    return torch.cat([p.detach().flatten() for p in model.policy.parameters()])


def test_an_update_is_that_of_sb3():
    """Of one rollout in one minibatch, by gradient descent: Adam would enlarge rounding errors.

    Gradients of single strokes are up to a hundred times their mean, so its rounding in float32 is up to 1e-4 of the
    largest movement, by the order of the sums (the number of threads); an error of the formula of 1 % is fifty times that."""
    found, before, said = [], None, []
    for train in (FastPPO.train, MaskablePPO.train):
        model = with_rollout(made(batch_size=16 * TABLES, learning_rate=0.3, vf_coef=0.5))
        learned = [p for n, p in model.policy.named_parameters() if not n.startswith("position_value.")]
        model.policy.optimizer = torch.optim.SGD(learned)
        before = weights(model)
        train(model)
        found.append(weights(model))
        figures = model.logger.name_to_value
        said.append({name: figures[name] for name in figures if name.startswith("train/")})
    moved = (found[0] - before).abs().max()
    assert (found[0] - found[1]).abs().max() < 2e-4 * moved and moved > 1e-3
    assert said[0].keys() == said[1].keys() and len(said[0]) == 10
    for name, value in said[1].items():
        assert said[0][name] == pytest.approx(value, rel=1e-4, abs=1e-6), name


def test_each_epoch_uses_every_shot_once_in_minibatches(monkeypatch):
    """And scales the advantages of each minibatch by itself, as SB3 does; the last of 128 in tens has eight."""
    model, met = with_rollout(made(batch_size=10)), []
    advantages = model.rollout_buffer.advantages.reshape(-1).copy()

    def watch(rows, rollout, *rest):
        met.append((rows, rollout.advantages[rows]))
        return np.zeros(5)

    monkeypatch.setattr(model.policy.fused, "ppo_gradient", watch)
    model.train()
    assert len(met) == 2 * 13 and [len(rows) for rows, _ in met[:13]] == 12 * [10] + [8]
    for epoch in (met[:13], met[13:]):
        assert np.array_equal(np.sort(np.concatenate([rows for rows, _ in epoch])), np.arange(128))
    for rows, scaled in met:
        own = torch.as_tensor(advantages[rows])
        assert np.allclose(scaled, (own - own.mean()) / (own.std() + 1e-8), atol=1e-5)
    assert not np.array_equal(met[0][0], met[13][0])


def test_the_buffer_is_sb3s_with_masks_as_bool():
    """What was seen, done and masked belongs to the same step, and the advantages are SB3's."""
    model = with_rollout(made())
    own, (n, k) = model.rollout_buffer, (model.n_steps, TABLES)
    assert isinstance(own, BoolMasks) and own.action_masks.dtype == np.bool_
    assert own.action_masks.shape == (n, k, 540)
    spaces = own.observation_space, own.action_space
    other = MaskableRolloutBuffer(n, *spaces, "cpu", own.gae_lambda, own.gamma, k)
    for t in range(n):
        parts = own.observations[t], own.actions[t], own.rewards[t], own.episode_starts[t]
        figures = torch.as_tensor(own.values[t]), torch.as_tensor(own.log_probs[t])
        other.add(*parts, *figures, action_masks=own.action_masks[t])
    last = model.policy.predict_values(torch.as_tensor(model._last_obs)).detach()
    other.compute_returns_and_advantage(last, model._last_episode_starts)
    for name in ("advantages", "returns", "observations", "actions"):
        assert np.array_equal(getattr(own, name), getattr(other, name)), name
    assert np.array_equal(own.action_masks, other.action_masks != 0) and own.advantages.std() > 0.1
    flat = own.observations.reshape(n * k, -1), own.action_masks.reshape(n * k, -1)
    assert np.take_along_axis(flat[1], own.actions.reshape(n * k, 1), 1).all()
    parts = map(torch.as_tensor, (flat[0], own.actions.reshape(-1), flat[1]))
    with torch.no_grad():
        values, logs, _ = model.policy.evaluate_actions(*parts)
    assert np.abs(values[:, 0].numpy() - own.values.reshape(-1)).max() < 1e-5
    assert np.abs(logs.numpy() - own.log_probs.reshape(-1)).max() < 1e-5
    offered = flat[0][:, 121::13][:, :4].sum(1)  # the masks are those of the pots that were seen
    masked = flat[1].reshape(-1, 4, 135).any(2).sum(1)
    # without a pot: other lines; a real cue may leave no stroke at a pot
    assert (masked[offered > 0] <= offered[offered > 0]).all() and (masked[offered == 0] >= 1).all()
    assert (masked[offered > 0] == offered[offered > 0]).mean() > 0.95


def test_its_files_are_read_by_sb3_and_learning_goes_on():
    model = made(n_steps=2, batch_size=16).learn(16)
    file = io.BytesIO()
    model.save(file)
    for read in (MaskablePPO, FastPPO):
        file.seek(0)
        again = read.load(file, env=model.env, device="cpu")
        assert torch.equal(weights(again), weights(model))
        seen = {"action_masks": np.array(model.env.env_method("action_masks")), "deterministic": True}
        assert np.array_equal(*(one.predict(model._last_obs, **seen)[0] for one in (again, model)))
        again.learn(16)
        assert not torch.equal(weights(again), weights(model))
