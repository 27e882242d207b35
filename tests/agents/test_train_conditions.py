"""Does an agent learn on tables that differ from its first position on, and observe their constants if asked to?"""

import numpy as np
import pytest
import torch

import snooker_env as sn
from agents.evaluation.visit_figures import summary
from agents.features.observed import training_tables
from agents.learning import expert_iteration
from agents.learning.expert_iteration import ExpertIteration
from agents.learning.hyperparameters import Recipe
from agents.learning.models import load_trained
from agents.players.trained import load_player
from snooker_env.benchmark import play_visits
from snooker_env.physics import conditions
from snooker_env.physics.parameters import nominal
from snooker_env.planning import Positions
from snooker_env.planning.learned.stroke_policy import SHOWN
from tests.agents.training import results, run

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


def test_expert_iteration_plays_each_visit_on_a_table_of_its_own(few, monkeypatch):
    """What is searched has the constants of the visit, which keeps them; the next one has those that it was dealt."""
    model, venv = model_and_tables()
    run_, searched = ExpertIteration(model, venv, 96, 5, 1), []
    run_.begin()
    planner, play_strokes = run_._judge.planner, run_._judge.planner.play_strokes

    def watched(at, *given, **errors):
        searched.append((at.conditions.copy(), play_strokes(at, *given, **errors)))
        return searched[-1][1]

    monkeypatch.setattr(planner, "play_strokes", watched)
    assert planner.rules.drawn
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


@pytest.fixture(scope="module")
def observed(tmp_path_factory):
    """The folder of a run of an agent that observes the constants of its tables."""
    out = tmp_path_factory.mktemp("observed") / "run"
    assert run(out, *OBSERVED) == 0
    return out


def test_an_agent_can_observe_the_constants_of_its_table(observed):
    found, trained = results(observed), load_trained(observed, "agent")
    words = found["command"].split()
    assert words[words.index("--conditions") :][:3] == OBSERVED
    assert (
        trained.policy.observation_space.shape == (SHOWN + 8,) and trained.env_options["observe_conditions"]
    )
    player = load_player(observed)
    options = {"noise": "professional", "cue": "real", "conditions": "drawn"}
    assert summary(play_visits(player, 4, **options)) == found["evaluation"]["trained"]


def test_it_sees_those_of_the_table_that_it_plays_on(observed, monkeypatch):
    """In training as when it plays: behind the pots, in their order; on a table that it does not know the nominal."""
    recipe = Recipe.of("ppo_target", env_kwargs={"conditions": "drawn", "observe_conditions": True})
    venv = training_tables(3, threads=1, **recipe.env_kwargs)
    assert venv.observation_space.shape == (SHOWN + 8,)
    venv.seed(1)
    still = np.zeros((3, *venv.action_space.shape), venv.action_space.dtype)
    for show in (venv.reset, lambda: venv.step(still)[0]):
        shown, at = show(), Positions.of(venv.unwrapped.tables)
        assert np.allclose(shown[:, SHOWN:], conditions.scale_to_unit(at.conditions), atol=1e-6)
    player, seen = load_player(observed), []
    policy = player.model.policy
    take = policy.obs_to_tensor
    monkeypatch.setattr(policy, "obs_to_tensor", lambda row: seen.append(np.squeeze(row)) or take(row))
    for options, wanted in (
        ({"conditions": "drawn"}, at.conditions),
        ({"physics": "match"}, np.tile(nominal(sn.Physics.preset("match")), (3, 1))),
    ):
        del seen[:]
        player.at(options).play(at, np.arange(3))
        assert np.allclose(np.stack(seen)[:, SHOWN:], conditions.scale_to_unit(wanted), atol=1e-6)
