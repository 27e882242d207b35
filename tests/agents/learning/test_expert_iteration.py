"""Do value, policy and planner learn from each other, and does a stopped run end as an uninterrupted one?"""

import pickle

import numpy as np
import pytest
import torch
from positions import tables

from agents.features.observed import training_tables
from agents.learning import expert_iteration
from agents.learning.expert_iteration import FRESH, STARTS, ExpertIteration, Starts, judge_rewards
from agents.learning.hyperparameters import Recipe
from agents.learning.model_files import pack_model, read
from agents.learning.models import zip_model
from agents.learning.value_network import value_of
from snooker_env import player
from snooker_env.planning import Positions, spread_of
from snooker_env.planning.learned.learned_value import LearnedValue
from snooker_env.planning.learned.policy_proposals import PolicyProposals
from snooker_env.planning.learned.value_features import value_features
from snooker_env.tasks import LEVELS

OPTIONS = {"action": "discrete", "noise": "professional", "layout": "opened", "fidelity": "fast"}
N, STATES = 8, 64
SHOT = {"noise": "professional", "fidelity": "fast", "physics": "paper", "table": "match"}


@pytest.fixture(autouse=True)
def few(monkeypatch):
    """A small pool of starts, so that a run takes seconds."""
    monkeypatch.setattr(expert_iteration, "POOL", 64)


def model_and_tables(seed=5, n=N):
    venv = training_tables(n, threads=1, **OPTIONS)
    return Recipe.of("ppo_value", n_envs=n).new_model(venv, seed), venv


def weights(model):
    return {name: tensor.clone() for name, tensor in model.policy.state_dict().items()}


def alike(some, others):
    """Whether arrays are equal, one by one."""
    return len(some) == len(others) and all(map(np.array_equal, some, others))


def timeless(state):
    """A state without its clock."""
    return plain({**state, "seconds": 0, "curve": [{**one, "seconds": 0} for one in state["curve"]]})


def plain(x):
    """Arrays and tensors as bytes, so that equality is equality of bits."""
    if isinstance(x, torch.Tensor):
        x = x.numpy()
    if isinstance(x, np.ndarray):
        return x.dtype.str, x.shape, x.tobytes()
    if isinstance(x, dict):
        return [(plain(key), plain(value)) for key, value in x.items()]
    return [plain(one) for one in x] if isinstance(x, list | tuple) else x


def begun(model, venv, states, seed, threads, before=None):
    run = ExpertIteration(model, venv, states, seed, threads, before)
    run.begin()
    return run


def run_to(run, done):
    while run.done < done:
        run.round()
    return run


def a_run(seed=5, threads=1):
    model, venv = model_and_tables(seed)
    return model, run_to(begun(model, venv, STATES, seed, threads), STATES)


def test_a_stopped_run_ends_where_an_uninterrupted_one_does():
    """Bit for bit, stopped before anything has learned, after the value's first steps, and amid the rest."""
    model, whole = a_run()
    expected, ended = timeless(whole.get_state()), weights(model)
    assert whole.done == STATES and whole.curve[-1]["states"] == STATES
    for k in (1, 2, 5):
        model, venv = model_and_tables()
        first = run_to(begun(model, venv, STATES, 5, 1), k * N)
        saved = pickle.dumps((first.get_state(), weights(model), torch.get_rng_state()))
        state, kept, generator = pickle.loads(saved)
        torch.rand(3)
        again, venv = model_and_tables(seed=6)
        again.policy.load_state_dict(kept)
        torch.set_rng_state(generator)
        # also on another number of threads
        second = run_to(begun(again, venv, STATES, 5, 2, state), STATES)
        assert timeless(second.get_state()) == expected, k
        assert all(torch.equal(tensor, ended[name]) for name, tensor in weights(again).items()), k


def test_both_networks_learn_and_the_seed_matters():
    model, venv = model_and_tables()
    before = weights(model)
    run = run_to(begun(model, venv, STATES, 5, 1), STATES)
    after = weights(model)
    moved = {name for name in after if not torch.equal(before[name], after[name])}
    assert any(name.startswith("position_value.") for name in moved)
    assert any(name.startswith("features_extractor.") for name in moved)
    assert any(name.startswith("action_net.") for name in moved)
    assert all(torch.isfinite(tensor).all() for tensor in after.values())
    last = run.curve[-1]
    assert set(last) == {"states", "simulated_shots", "seconds", "loss", "value_loss", "value"}
    assert last["value"] > 0.0
    assert last["seconds"] >= 0.0
    assert timeless(a_run(seed=7)[1].get_state()) != timeless(run.get_state())


def test_the_rule_and_even_proposals_come_first():
    """To the round: an eighth of all positions by the rule of thumb, a fifth with even proposals."""
    model, venv = model_and_tables()
    run = begun(model, venv, 320, 5, 1)
    for done in range(0, 80, N):
        assert run.done == done
        run.round()
        assert isinstance(run._judge.value, LearnedValue) == (done > 40)
        assert isinstance(run._search.propose[0], PolicyProposals) == (done >= 64)
        assert bool(run._value.losses) == (done >= 40)  # the value is fitted


def test_a_round_keeps_what_its_samples_led_to(monkeypatch):
    """Features before and after, points, ends; the next position is what the played stroke left."""
    model, venv = model_and_tables()
    run, added, played = begun(model, venv, STATES, 5, 1), [], []
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


def test_visits_begin_in_all_layouts_by_their_shares(monkeypatch):
    assert sum(share for _, share in STARTS) == pytest.approx(1.0)
    starts = Starts(3, "opened", SHOT)
    kept = [one.positions.copy() for one in starts._pools]
    drawn = starts.draw(3000, np.random.default_rng(0))
    assert len(drawn) == 3000 and not drawn.over.any()
    pools = np.concatenate([np.full(len(one), k) for k, one in enumerate(starts._pools)])
    places = {one.tobytes(): k for k, one in zip(pools, np.concatenate(kept), strict=True)}
    counts = np.bincount([places[one.tobytes()] for one in drawn.positions], minlength=len(STARTS)) / 3000
    assert counts == pytest.approx([share for _, share in STARTS], abs=0.03)
    drawn.positions[:] = 0.0
    assert alike([one.positions for one in starts._pools], kept)
    again, other = ([one.positions for one in Starts(seed, "opened", SHOT)._pools] for seed in (3, 4))
    assert alike(again, kept) and not any(map(np.array_equal, other, kept))


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        ({"layout": "held_out"}, "layout = 'held_out': must be another for training"),
        ({"layout": "nowhere"}, "layout = 'nowhere'"),
        ({"action": "box"}, "action = 'box': must be 'discrete'"),
        ({"noise": "loud"}, "noise = 'loud'"),
    ],
)
def test_wrong_options_are_refused_before_anything_is_played(changes, complaint):
    with pytest.raises(ValueError, match=f"^{complaint}"):
        training_tables(2, threads=1, **Recipe.of("ppo_value", env_kwargs=changes).env_kwargs)


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
    expected = value_of(model.policy.position_value, spread_of(LEVELS["professional"]))(at)
    assert np.array_equal(venv.judge(at), expected) and venv.judge.threads == 2


def test_ppo_leaves_the_value_of_positions_alone():
    model, _ = model_and_tables()
    own = {id(p) for p in model.policy.position_value.parameters()}
    learned = {id(p) for group in model.policy.optimizer.param_groups for p in group["params"]}
    assert own and not own & learned and len(own) + len(learned) == len(list(model.policy.parameters()))


def test_policy_and_value_are_saved_and_read_together(tmp_path):
    """From the zip of train.py and from that of results/weights; what is read plays as what was written."""
    model, _ = model_and_tables(seed=9)
    with torch.no_grad():
        for p in model.policy.position_value.parameters():
            p.add_(0.05)
    model.imitated = STATES
    at = Positions.of(tables(30, layout="random:5"))
    expected = value_of(model.policy.position_value, 1e-3)(at)
    scores = PolicyProposals(model.policy.fused).scores(at)[0]
    (tmp_path / "model.zip").write_bytes(zip_model(model))
    trained = read(tmp_path / "model.zip", "agent")
    (tmp_path / "plain.zip").write_bytes(pack_model(trained))
    again = read(tmp_path / "plain.zip", "agent")
    for one in (trained, again):
        assert one.recipe == "ppo_value" and one.imitated == STATES and one.gamma == 0.0
        assert np.array_equal(value_of(one.policy.position_value, 1e-3)(at), expected)
        assert np.array_equal(PolicyProposals(one.policy.fused).scores(at)[0], scores)
    assert pack_model(again) == pack_model(trained)
    env = tables(3, noise="professional", aim="absolute")
    planners = [player(f"planner_30@{tmp_path / name}") for name in ("model.zip", "plain.zip", "")]
    one, *others = (made.at(env).play(Positions.of(env), np.arange(3)).values for made in planners)
    assert alike([one, one], others) and one.any(axis=1).all()
