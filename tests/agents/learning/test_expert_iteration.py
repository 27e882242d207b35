"""Do value, policy and planner learn from each other, and does a stopped run end as an uninterrupted one?"""

import numpy as np
import pytest
import torch

from agents.features.observed import training_tables
from agents.learning import expert_iteration
from agents.learning.expert_iteration import FRESH, ExpertIteration, judge_rewards
from agents.learning.hyperparameters import Recipe
from agents.learning.value_network import value_of
from snooker_env.planning import Positions
from snooker_env.planning.learned.learned_worth import LearnedValue
from snooker_env.planning.learned.stroke_policy import PolicyProposals
from snooker_env.planning.learned.value_features import value_features
from snooker_env.tasks import LEVELS
from tests.positions import tables

OPTIONS = {"action": "discrete", "noise": "professional", "layout": "opened", "fidelity": "fast"}
N, STATES = 8, 64


@pytest.fixture(autouse=True)
def few(monkeypatch):
    """A small pool of starts, so that a run takes seconds."""
    monkeypatch.setattr(expert_iteration, "POOL", 64)


def model_and_tables(seed=5):
    venv = training_tables(N, threads=1, **OPTIONS)
    return Recipe.of("ppo_value", n_envs=N).new_model(venv, seed), venv


def begun(states=STATES, seed=5):
    """A model and its expert iteration before the first round."""
    model, venv = model_and_tables(seed)
    run = ExpertIteration(model, venv, states, seed, 1)
    run.begin()
    return model, run


def a_run(seed=5):
    model, run = begun(seed=seed)
    before = weights(model)
    while run.done < STATES:
        run.round()
    return before, weights(model), run


def weights(model):
    return {name: tensor.clone() for name, tensor in model.policy.state_dict().items()}


@pytest.mark.slow
def test_both_networks_learn_and_the_seed_matters():
    before, after, run = a_run()
    moved = {name for name in after if not torch.equal(before[name], after[name])}
    assert any(name.startswith("position_value.") for name in moved)
    assert any(name.startswith("features_extractor.") for name in moved)
    assert any(name.startswith("action_net.") for name in moved)
    assert all(torch.isfinite(tensor).all() for tensor in after.values())
    last = run.curve[-1]
    assert set(last) == {"states", "simulated_shots", "seconds", "loss", "value_loss", "value"}
    assert last["value"] > 0.0
    assert last["seconds"] >= 0.0
    assert a_run(seed=7)[2].curve[-1]["loss"] != last["loss"]


def test_the_rule_and_even_proposals_come_first():
    """To the round: an eighth of all positions by the rule of thumb, a fifth with even proposals."""
    _, run = begun(320)
    for done in range(0, 80, N):
        assert run.done == done
        run.round()
        assert isinstance(run._judge.value, LearnedValue) == (done > 40)
        assert isinstance(run._search.propose[0], PolicyProposals) == (done >= 64)
        assert bool(run._value.losses) == (done >= 40)  # the value is fitted


def test_a_round_keeps_what_its_samples_led_to(monkeypatch):
    """Features before and after, points, ends; the next position is what the played stroke left."""
    (_, run), added, played = begun(), [], []
    planner, spread = run._judge.planner, run._judge.spread
    play_strokes = planner.play_strokes
    monkeypatch.setattr(run._value, "add", lambda *one: added.append(one))

    def watched(*given, errors):
        played.append((given, play_strokes(*given, errors=errors)))
        return played[-1][1]

    monkeypatch.setattr(planner, "play_strokes", watched)
    monkeypatch.setattr(run._value, "fit", lambda remaining: None)
    followed = 0
    for _ in range(6):
        at = run._at.copy()
        run._play()
        (given, rows, strokes), out = played[-1]
        seen, after, points, goes_on, follows = added[-1]
        assert np.array_equal(seen, value_features(at, spread).astype(np.float16))
        assert np.array_equal(given.positions, at.positions)
        assert rows.tolist() == [*np.repeat(np.arange(N), FRESH), *range(N)]
        for i in range(N):
            assert (strokes[FRESH * i : FRESH * (i + 1)] == strokes[FRESH * i]).all()
            for j in range(FRESH):
                k = FRESH * i + j
                assert points[i, j] == out.points[k] and goes_on[i, j] == out.goes_on[k]
                left = value_features(out.afterstates[[k]], spread)[0].astype(np.float16)
                assert np.array_equal(after[i, j], left if out.goes_on[k] else np.zeros(seen.shape[1]))
            now = run._at.positions[i]
            if follows[i]:
                assert goes_on[i, 0] and np.array_equal(now, out.afterstates.positions[FRESH * i])
                followed += 1
            elif np.array_equal(now, out.afterstates.positions[FRESH * N + i]):
                assert out.goes_on[FRESH * N + i]  # the exploratory stroke
            else:
                pool = np.concatenate([one.positions for one in run._starts._pools])
                assert (now == pool).all(axis=(1, 2)).any()
        assert not run._at.over.any() and not run._at.points.any()
    assert followed > 15


def test_a_judge_adds_its_value_only_where_the_visit_goes_on():
    """Against the same tables without a judge: rewards and its word on what was left, none after the end."""
    judged, usual = (training_tables(24, threads=1, **{**OPTIONS, "layout": "random:6"}) for _ in range(2))
    asked, on = [], 0

    def judge(left):
        asked.append(left.positions.copy())
        return 50.0 + 10.0 * left.positions[:, 0, 1]

    judged.judge = judge
    for venv in (judged, usual):
        venv.seed(4)
        venv.reset()
    for step in range(6):
        masks = np.array(usual.env_method("action_masks"))
        picks = np.array([np.flatnonzero(mask)[(31 + 7 * step) % mask.sum()] for mask in masks])
        one, other = (venv.step(picks) for venv in (judged, usual))
        (seen, rewards, done, infos), (plain_seen, points, ended, plain_infos) = one, other
        assert np.array_equal(seen, plain_seen) and np.array_equal(done, ended)
        left = Positions.of(usual.unwrapped.tables).positions[~done]
        assert np.array_equal(rewards[done], points[done]) and np.array_equal(asked[-1], left)
        assert rewards[~done] == pytest.approx(points[~done] + 50.0 + 10.0 * left[:, 0, 1], rel=1e-6)
        # an episode's return is that of the points alone
        returns = [[info.get("episode", {}).get("r") for info in some] for some in (infos, plain_infos)]
        assert returns[0] == returns[1]
        on += (~done).sum()
    assert on > 20 and len(asked) == 6


def test_ppo_is_judged_by_the_models_own_value():
    model, venv = model_and_tables()
    assert venv.judge is None
    judge_rewards(venv, model.policy, 2)
    at = Positions.of(tables(10, layout="random:5"))
    expected = value_of(model.policy.position_value, LEVELS["professional"].spread())(at)
    assert np.array_equal(venv.judge(at), expected) and venv.judge.threads == 2
