"""Does an agent learn on tables that differ from its first position on, and observe their constants if asked to?"""

import pickle
import signal

import numpy as np
import pytest
import torch

import snooker_env as sn
import train
from agents.features.observed import training_tables
from agents.learning import expert_iteration, self_play
from agents.learning.expert_iteration import ExpertIteration
from agents.learning.hyperparameters import Recipe
from agents.learning.imitation import Expert, Imitation
from agents.learning.model_files import packed, read
from agents.learning.models import load_trained
from agents.players.trained import load_player
from snooker_env.benchmark import play_visits, summary
from snooker_env.physics import conditions
from snooker_env.physics.parameters import nominal
from snooker_env.planning import Planner, Positions
from snooker_env.planning.learned.pot_view import SHOWN
from tests.agents.training import results, resume, run, weights

DRAWN = {"action": "discrete", "noise": "professional", "layout": "opened", "conditions": "drawn"}
OBSERVED = ["--conditions", "drawn", "--observe-conditions"]
N = 8


@pytest.fixture
def few(monkeypatch):
    """A small pool of starts, so that a run takes seconds."""
    monkeypatch.setattr(expert_iteration, "POOL", 64)


def model_and_tables(agent="ppo_value", n=N):
    torch.manual_seed(5)
    recipe = Recipe.of(agent, env_kwargs=DRAWN, n_envs=n)
    venv = training_tables(n, threads=1, **recipe.env_kwargs)
    return recipe.new_model(venv, 5), venv


def gains(planner, at, rows, picks, keys):
    """Points of choices, played directly."""
    return planner.play(at, rows, picks, keys).points


def test_what_imitation_values_is_played_on_the_tables_own_constants():
    _, venv = model_and_tables("ppo_mask", 70)  # more than a slice
    tables = venv.unwrapped.tables
    tables.reset(seed=3)
    at, masks = Positions.of(tables), np.array(tables.action_masks())
    picks = np.stack([np.flatnonzero(mask)[np.linspace(0, mask.sum() - 1, 6).astype(int)] for mask in masks])
    worth = Expert(tables, 1, np.random.default_rng(0), ahead=False).worth(picks, np.ones(picks.shape, bool))
    keys = np.random.default_rng(0).integers(0, 2**63, picks.size, dtype=np.uint64)
    rows, own = np.repeat(np.arange(70), 6), tables.options
    assert np.array_equal(worth.ravel(), gains(Planner(own), at, rows, picks.ravel(), keys))
    assert (worth.ravel() != gains(Planner(own.but(conditions="fixed")), at, rows, picks.ravel(), keys)).any()


def test_imitation_asks_for_all_that_decides_a_shot():
    _, venv = model_and_tables("ppo_mask")
    used = Expert(venv.unwrapped.tables, 1, np.random.default_rng(0))._sent["options"]
    assert set(sn.Options.group("shot")) < set(used) and used["conditions"] == "drawn"


def test_expert_iteration_plays_each_visit_on_a_table_of_its_own(few, monkeypatch):
    """What is searched has the constants of the visit, which keeps them; the next one has those that it was dealt."""
    model, venv = model_and_tables()
    run_, searched, judged = ExpertIteration(model, venv, 96, 5, 1), [], []
    search = self_play.search_of(run_._sent, 1)
    outcomes, choices = search.outcomes, self_play.choices

    def watched(at, *given):
        searched.append((at.conditions.copy(), outcomes(at, *given)))
        return searched[-1][1]

    def counted(shared, args, threads):
        judged.append((shared, args, choices(shared, args, threads)))
        return judged[-1][2]

    monkeypatch.setattr(search, "outcomes", watched)
    monkeypatch.setattr(self_play, "choices", counted)
    assert search.planner.rules.drawn
    starts = {
        row.tobytes(): own.tobytes()
        for pool in run_._starts._pools
        for row, own in zip(pool.positions, pool.conditions, strict=True)
    }
    assert len(set(starts.values())) == len(starts) > 50
    kept = fresh = 0
    while run_.done < 96:
        before = run_._at.copy()
        run_.round()
        assert np.array_equal(searched[-1][0], before.conditions)
        for row, was, own in zip(run_._at.positions, before.conditions, run_._at.conditions, strict=True):
            if row.tobytes() in starts:
                assert own.tobytes() == starts[row.tobytes()]
                fresh += 1
            else:
                assert np.array_equal(own, was)
                kept += 1
    assert kept > 40 and fresh > 2
    shared, args, made = judged[-1]
    planner = Planner(sn.Options(action="discrete", **shared["options"]), threads=1)
    at = Positions(*args["at"])
    played = planner.play(at, args["rows"], args["picks"], args["keys"])
    values = played.points.astype(np.float32)
    values[played.goes_on] += shared["value"](played.afterstates[np.flatnonzero(played.goes_on)])
    assert np.array_equal(made["gains"], values)
    nominal = Planner(sn.Options(action="discrete", **shared["options"] | {"conditions": "fixed"}))
    assert (played.points != gains(nominal, at, args["rows"], args["picks"], args["keys"])).any()


@pytest.mark.parametrize(("kind", "agent"), [(ExpertIteration, "ppo_value"), (Imitation, "ppo_mask")])
def test_a_stopped_run_goes_on_with_its_tables(few, kind, agent):
    def to(run_, done):
        while run_.done < done:
            run_.round()
        return run_

    def learned(model):
        return np.concatenate([p.detach().numpy().ravel() for p in model.policy.parameters()])

    model, venv = model_and_tables(agent)
    to(kind(model, venv, 48, 5, 1), 48)
    other, venv = model_and_tables(agent)
    first = to(kind(other, venv, 48, 5, 1), 24)
    kept = pickle.dumps((first.get_state(), other.policy.state_dict(), venv.env_method("get_state")))
    state, parameters, tables = pickle.loads(kept)
    again, venv = model_and_tables(agent)
    again.policy.load_state_dict(parameters)
    venv.reset()  # with the seed of the model, which would hold against the streams of the states
    venv.set_options([{"state": table} for table in tables])
    to(kind(again, venv, 48, 5, 1, state), 48)
    assert np.array_equal(learned(again), learned(model))


@pytest.fixture(scope="module")
def observed(tmp_path_factory):
    """Folders of runs of agents that observe the constants of their tables."""
    folder = tmp_path_factory.mktemp("observed")
    for agent in ("ppo_mask", "ppo_target", "tqc_target"):
        more = ["--imitate", "64"] if agent == "ppo_mask" else []
        assert run(folder / agent, "--agent", agent, *more, *OBSERVED) == 0
    return folder


@pytest.mark.parametrize("agent", ["ppo_mask", "ppo_target", "tqc_target"])
def test_an_agent_can_observe_the_constants_of_its_table(observed, agent):
    found, trained = results(observed / agent), load_trained(observed / agent, "agent")
    words = found["command"].split()
    assert words[words.index("--conditions") :][:3] == OBSERVED
    assert (
        trained.policy.observation_space.shape == (SHOWN + 8,) and trained.env_options["observe_conditions"]
    )
    player = load_player(observed / agent)
    options = {"noise": "professional", "cue": "real", "conditions": "drawn"}
    assert summary(play_visits(player, 4, **options)) == found["evaluation"]["trained"]


@pytest.mark.parametrize("agent", ["ppo_mask", "ppo_target"])
def test_it_sees_those_of_the_table_that_it_plays_on(observed, agent, monkeypatch):
    """In training as when it plays: behind the pots, in their order; on a table that it does not know the nominal."""
    recipe = Recipe.of(agent, env_kwargs={"conditions": "drawn", "observe_conditions": True})
    venv = training_tables(3, threads=1, **recipe.env_kwargs)
    assert venv.observation_space.shape == (SHOWN + 8,)
    venv.seed(1)
    still = np.zeros((3, *venv.action_space.shape), venv.action_space.dtype)
    for show in (venv.reset, lambda: venv.step(still)[0]):
        shown, at = show(), Positions.of(venv.unwrapped.tables)
        assert np.allclose(shown[:, SHOWN:], conditions.normalised(at.conditions), atol=1e-6)
    player, seen = load_player(observed / agent), []
    policy = player.model.policy
    take = policy.obs_to_tensor
    monkeypatch.setattr(policy, "obs_to_tensor", lambda row: seen.append(np.squeeze(row)) or take(row))
    for options, wanted in (
        ({"conditions": "drawn"}, at.conditions),
        ({"physics": "match"}, np.tile(nominal(sn.Physics.preset("match")), (3, 1))),
    ):
        del seen[:]
        player.at(options).play(at, np.arange(3))
        assert np.allclose(np.stack(seen)[:, SHOWN:], conditions.normalised(wanted), atol=1e-6)


def test_the_constants_reach_choices_and_values(observed):
    policy = load_trained(observed / "ppo_mask", "agent").policy
    seen = torch.rand(2, SHOWN + 8, generator=torch.Generator().manual_seed(1))
    seen[1, :SHOWN] = seen[0, :SHOWN]
    with torch.no_grad():
        read_ = policy.extract_features(seen)
        values = policy.value_net(read_)
    assert not torch.equal(read_[0], read_[1]) and values[0] != values[1]
    # mirroring turns places and cuts, not constants
    assert policy.features_extractor.flips[SHOWN:].sum() == 0


def test_such_a_model_is_stored_and_read(observed, tmp_path):
    trained = load_trained(observed / "ppo_mask", "agent")
    (tmp_path / "plain.zip").write_bytes(packed(trained))
    again = read(tmp_path / "plain.zip", "agent")
    assert packed(again) == packed(trained) and again.env_options == trained.env_options


def test_a_resumed_run_goes_on_observing(observed, tmp_path, refused, monkeypatch):
    from agents.learning import callback

    step = callback.RunCallback._on_step

    def interrupted(self):
        if self.num_timesteps == 100:
            signal.raise_signal(signal.SIGTERM)
        return step(self)

    options = ["--imitate", "64", *OBSERVED]
    with monkeypatch.context() as patch:
        patch.setattr(callback.RunCallback, "_on_step", interrupted)
        assert run(tmp_path / "run", *options) == 128 + signal.SIGTERM
    assert resume(tmp_path / "run") == 0
    assert np.array_equal(weights(tmp_path / "run"), weights(observed / "ppo_mask"))
    assert run(tmp_path / "plain", "--conditions", "drawn") == 0
    error = refused(train.main, "--resume", "--out", tmp_path / "plain", "--observe-conditions")
    assert "--observe-conditions is True but the run" in error and "has False" in error


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (
            "--agent ppo_mask --observe-conditions",
            'observe_conditions = True: must be False with conditions="fixed"',
        ),
        (
            "--agent ppo_value --imitate 8",
            "observe_conditions = True: must be left out for ppo_value: its planner",
        ),
    ],
)
def test_what_cannot_observe_them_is_refused(tmp_path, refused, monkeypatch, options, said):
    monkeypatch.setattr(train.snooker_env, "warmup", None)  # nothing is compiled before
    more = [] if "--observe" in options else OBSERVED
    assert said in refused(train.main, *options.split(), *more, "--out", tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_weights_of_an_agent_that_observes_something_else_are_refused(observed, tmp_path, refused):
    start = ["--agent", "ppo_mask", "--start", observed / "ppo_mask", "--out", tmp_path / "run"]
    error = refused(train.main, *start, "--conditions", "drawn")
    assert "start = " in error and "must be a model that observes the same as this one" in error
    assert not (tmp_path / "run").exists()
    assert run(tmp_path / "run", *map(str, start[:4]), *OBSERVED, "--set", "learning_rate=0.0") == 0
    assert np.array_equal(weights(tmp_path / "run"), weights(observed / "ppo_mask"))


def test_a_planner_of_a_run_over_tables_plays_them(few, tmp_path):
    """Of train.py from end to end: expert iteration, PPO and the evaluation."""
    out = tmp_path / "run"
    assert run(out, "--agent", "ppo_value", "--envs", "4", "--imitate", "64", "--conditions", "drawn") == 0
    found = results(out)
    again = play_visits(sn.player(f"planner@{out}"), 4, conditions="drawn", noise="professional", cue="real")
    assert summary(again) == found["evaluation"]["planner"]
    fixed = play_visits(sn.player(f"planner@{out}"), 4, noise="professional", cue="real")
    assert found["evaluation"]["planner"] != summary(fixed)
