"""Does the expert say what choices are worth, and does the learner follow it?"""

import numpy as np
import pytest
import torch

from agents.features.views import training_tables
from agents.learning import imitation
from agents.learning.hyperparameters import Recipe
from agents.learning.imitation import Expert, Imitation, to_try
from snooker_env.planning import Positions, prospects_of, spread_of
from snooker_env.tasks.discrete_actions import SIZE, STROKES


def tables(n, noise="professional"):
    venv = training_tables(n, threads=1, action="discrete", noise=noise, layout="opened")
    venv.seed(3)
    venv.reset()
    return venv


def test_a_choice_is_worth_its_points_and_what_it_leaves():
    """Against the tables themselves, which play the same choices without errors."""
    venv = tables(8, noise="none")
    env = venv.unwrapped.tables
    picks = np.array([np.flatnonzero(m)[[20, 37, 60]] for m in env.action_masks()])
    there = np.ones(picks.shape, bool)
    states = env.get_state()
    worth = Expert(env, 2, np.random.default_rng(0)).worth(picks, there)
    points_only = Expert(env, 1, np.random.default_rng(0), ahead=False).worth(picks, there)
    rules = env.tables.rules
    for k in range(picks.shape[1]):
        env.reset(options={"states": states})
        _, rewards, ended, _, _ = env.unwrapped.step(picks[:, k])
        after = prospects_of(Positions.of(env), spread_of(rules.noise, rules.physics))[0]
        if ended.any():  # such a table was dealt anew in the same step
            after = np.where(ended, 0.0, after)
        assert np.allclose(worth[:, k], rewards + after, rtol=1e-6)
        assert np.array_equal(points_only[:, k], rewards)
    assert worth.max() > 5.0
    there[2:5, 1] = False
    env.reset(options={"states": states})
    some = Expert(env, 1, np.random.default_rng(0)).worth(picks, there)
    assert not some[~there].any() and np.array_equal(some[there], worth[there])


def test_half_of_the_tries_are_the_best():
    rng = np.random.default_rng(0)
    masks = np.zeros((5, SIZE), bool)
    masks[:, : 2 * STROKES] = True
    masks[4, STROKES // 2 :] = False  # few choices
    scores = rng.normal(size=masks.shape)
    picks, there = to_try(scores, masks, rng)
    half = imitation.TRIES // 2
    assert picks.shape == (5, imitation.TRIES) and there[:4].all()
    assert np.array_equal(there, np.take_along_axis(masks, picks, 1))
    for k in range(4):
        best = np.argsort(np.where(masks[k], -scores[k], np.inf))[:half]
        assert set(picks[k, :half]) == set(best) and len(set(picks[k, half:])) == half
    assert there[4, :half].all() and set(picks[4][there[4]]) <= set(range(STROKES // 2))


def test_the_pupil_becomes_the_softmax_of_worths():
    """One round of positions with made-up worths, learned by heart."""
    venv = tables(4)
    model = Recipe.of("ppo_mask").new_model(venv, 0)
    seen, masks = venv.reset(), np.array(venv.env_method("action_masks"))
    rng = np.random.default_rng(0)
    picks, there = to_try(rng.normal(size=masks.shape), masks, rng)
    worths = rng.uniform(0.0, 4.0, SIZE)[picks].astype(np.float32)
    optimizer = torch.optim.Adam(model.policy.parameters(), 1e-3)
    losses = [
        imitation.fit_values(model.policy, optimizer, seen, masks, picks, there, worths) for _ in range(400)
    ]
    assert losses[-1] < 0.05 * np.var(worths) < losses[0]
    with torch.no_grad():
        logits = model.policy.get_distribution(torch.as_tensor(seen), masks).distribution.logits.numpy()
        value = model.policy.predict_values(torch.as_tensor(seen)).numpy()
    for k in range(4):
        learned = logits[k, picks[k]][there[k]]
        assert np.corrcoef(learned, worths[k][there[k]])[0, 1] > 0.97
        slope = np.polyfit(worths[k][there[k]], learned, 1)[0]
        assert slope == pytest.approx(1.0 / imitation.TEMPERATURE, rel=0.1)
        p = np.exp(logits[k])
        fitted = value[k] + imitation.TEMPERATURE * (learned - (p * np.maximum(logits[k], -1e3)).sum())
        assert np.sqrt(np.mean((fitted - worths[k][there[k]]) ** 2)) < 0.3


def test_imitation_is_reproducible_on_any_number_of_threads():
    found = []
    for threads in (1, 2):
        venv = tables(8)
        model = Recipe.of("ppo_mask").new_model(venv, 5)
        run = Imitation(model, venv, 64, 5, threads)
        while run.done < 64:
            run.round()
        assert run.curve[-1]["states"] == 64
        found.append(torch.cat([p.detach().flatten() for p in model.policy.parameters()]))
    assert torch.equal(*found)
