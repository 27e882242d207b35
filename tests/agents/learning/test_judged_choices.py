"""Does a policy come to prefer what its judge likes, simulated under errors and counted from the points?"""

import numpy as np
import pytest
import torch

from agents.features.observed import training_tables
from agents.learning import judged_choices
from agents.learning.hyperparameters import Recipe
from agents.learning.judged_choices import RATE, JudgedChoices, to_try
from snooker_env.planning import Planner, Positions, action_masks
from snooker_env.planning.learned.stroke_policy import with_pots
from snooker_env.tasks.discrete_actions import SIZE, STROKES
from tests.positions import tables

OPTIONS = {"noise": "professional", "fidelity": "fast"}
N = 64


def policy(seed=0):
    venv = training_tables(2, threads=1, action="discrete", **OPTIONS)
    made = Recipe.of("ppo_value", n_envs=2).new_model(venv, seed).policy
    venv.close()
    return made


def learner(own, n=N, seed=0, threads=1):
    return JudgedChoices(own, OPTIONS, threads, n, np.random.default_rng(seed))


def flat(network):
    """All its weights."""
    return torch.cat([p.detach().clone().flatten() for p in network.parameters()])


def some(n=N, seed=0, layout="random:6"):
    return Positions.of(tables(n, layout=layout, seed=seed))


def test_a_choice_is_worth_its_points_and_what_the_judge_says_of_what_it_leaves(monkeypatch):
    """What is kept is recomputed with the same keys; the judge is asked only where the visit goes on."""
    kept, asked = [], []
    monkeypatch.setattr(judged_choices, "fit_values", lambda *batch: kept.append(batch) or 0.0)
    at, own = some(12), policy()
    before = at.copy()

    def judge(left):
        assert not left.over.any()
        asked.append(len(left))
        return 100.0 + left.positions[:, 0, 0]

    learning = learner(own, 12, seed=4)
    learning.round(at, judge, 1.0)
    ((seen, masks, picks, there, worths),) = learning._rounds
    rng = np.random.default_rng(4)
    with torch.no_grad():
        scores = own.get_distribution(torch.as_tensor(seen), action_masks(at)).distribution.logits.numpy()
    again, valid = judged_choices.to_try(scores, action_masks(at), rng)
    assert np.array_equal(again, picks) and np.array_equal(valid, there)
    row, column = np.nonzero(there)
    out = Planner({"action": "discrete", **OPTIONS}, threads=1).play(
        at, row, picks[row, column].astype(int), rng.integers(0, 2**63, len(row), dtype=np.uint64)
    )
    expected = out.points + np.where(out.goes_on, 100.0 + out.afterstates.positions[:, 0, 0], 0.0)
    assert worths[row, column] == pytest.approx(expected, rel=1e-6) and not worths[~there].any()
    assert asked == [out.goes_on.sum()] and 0 < asked[0] < len(row)
    assert np.array_equal(np.unpackbits(masks, axis=1, count=540).astype(bool), action_masks(at))
    assert np.array_equal(at.positions, before.positions)
    assert np.array_equal(seen, with_pots(at.observations()))
    _, _, *batch = kept[0]  # of the policy and its optimizer, then rows of what is kept
    shown, offered, chosen, tried, gains = batch
    assert shown.shape == (4 * 12, seen.shape[1]) and offered.dtype == tried.dtype == bool
    assert chosen.dtype == np.int64
    for k in range(48):
        own_row = np.flatnonzero((seen == shown[k]).all(axis=1))[0]
        assert np.array_equal(chosen[k], picks[own_row]) and np.array_equal(gains[k], worths[own_row])
        assert np.array_equal(offered[k], action_masks(at)[own_row])
        assert np.array_equal(tried[k], there[own_row])


def test_the_value_of_positions_is_not_touched():
    """It learns apart: the policy's rounds leave its weights as they are."""
    own = policy()
    value, reader = flat(own.position_value), flat(own.features_extractor)
    learning = learner(own, 16)
    for k in range(2):
        learning.round(some(16, seed=k), lambda left: np.zeros(len(left)), 1.0)
    assert torch.equal(value, flat(own.position_value))
    assert not torch.equal(reader, flat(own.features_extractor))
    learning.round(some(16), lambda left: np.zeros(len(left)), 0.5)
    assert [group["lr"] for group in learning._optimizer.param_groups] == [pytest.approx(0.5 * RATE)]


def opened(n, noise="professional"):
    venv = training_tables(n, threads=1, action="discrete", noise=noise, layout="opened")
    venv.seed(3)
    venv.reset()
    return venv


def test_half_of_the_tries_are_the_best():
    rng = np.random.default_rng(0)
    masks = np.zeros((5, SIZE), bool)
    masks[:, : 2 * STROKES] = True
    masks[4, STROKES // 2 :] = False  # few choices
    scores = rng.normal(size=masks.shape)
    picks, there = to_try(scores, masks, rng)
    half = judged_choices.TRIES // 2
    assert picks.shape == (5, judged_choices.TRIES) and there[:4].all()
    assert np.array_equal(there, np.take_along_axis(masks, picks, 1))
    for k in range(4):
        best = np.argsort(np.where(masks[k], -scores[k], np.inf))[:half]
        assert set(picks[k, :half]) == set(best) and len(set(picks[k, half:])) == half
    assert there[4, :half].all() and set(picks[4][there[4]]) <= set(range(STROKES // 2))


@pytest.mark.slow
def test_the_pupil_becomes_the_softmax_of_worths():
    """One round of positions with made-up worths, learned by heart."""
    venv = opened(4)
    model = Recipe.of("ppo_value").new_model(venv, 0)
    seen, masks = venv.reset(), np.array(venv.env_method("action_masks"))
    rng = np.random.default_rng(0)
    picks, there = to_try(rng.normal(size=masks.shape), masks, rng)
    worths = rng.uniform(0.0, 4.0, SIZE)[picks].astype(np.float32)
    learned = [p for name, p in model.policy.named_parameters() if not name.startswith("position_value.")]
    optimizer = torch.optim.Adam(learned, 1e-3)
    losses = [
        judged_choices.fit_values(model.policy, optimizer, seen, masks, picks, there, worths)
        for _ in range(400)
    ]
    assert losses[-1] < 0.05 * np.var(worths) < losses[0]
    with torch.no_grad():
        logits = model.policy.get_distribution(torch.as_tensor(seen), masks).distribution.logits.numpy()
        value = model.policy.predict_values(torch.as_tensor(seen)).numpy()
    for k in range(4):
        learned = logits[k, picks[k]][there[k]]
        assert np.corrcoef(learned, worths[k][there[k]])[0, 1] > 0.97
        slope = np.polyfit(worths[k][there[k]], learned, 1)[0]
        assert slope == pytest.approx(1.0 / judged_choices.TEMPERATURE, rel=0.1)
        p = np.exp(logits[k])
        fitted = value[k] + judged_choices.TEMPERATURE * (learned - (p * np.maximum(logits[k], -1e3)).sum())
        assert np.sqrt(np.mean((fitted - worths[k][there[k]]) ** 2)) < 0.3
