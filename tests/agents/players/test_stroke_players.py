"""Do the players that search over strokes play what their names say, each with its own value and proposals?"""

import numpy as np
import pytest
from positions import tables

from agents.features.policy_proposals import PolicyProposals
from agents.features.views import training_tables
from agents.learning import models
from agents.learning.hyperparameters import Recipe
from agents.learning.value_network import Value
from agents.players import stroke_players
from agents.players.by_name import is_player, player_of
from agents.players.stroke_players import BUDGET, NAMES, is_stroke_player, model_for, stroke_player
from snooker_env.benchmark import play_visits, summary
from snooker_env.planning import Planner, Positions, actions_of
from snooker_env.planning.stroke_search import at_pots, schedule
from snooker_env.tasks import LEVELS, Noise

GOING = np.array([True, False, True, True])


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    """The file of an untrained policy with a value."""
    file = tmp_path_factory.mktemp("kept") / "model.zip"
    venv = training_tables(2, threads=1, action="discrete", noise="professional")
    made = Recipe.of("ppo_value", n_envs=2).new_model(venv, 3)
    venv.close()
    file.write_bytes(models.zipped(made))
    return file


def four(layout="held_out", **options):
    return tables(4, seed=2, **{"noise": "professional", "aim": "absolute", "layout": layout} | options)


# names -----------------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", NAMES)
def test_a_name_may_end_in_a_number_of_shots(name):
    assert is_stroke_player(name) and is_player(name) and is_player(f"{name}_60")
    for given, budget in ((name, BUDGET), (f"{name}_8", 8), (f"{name}_2000", 2000)):
        player = player_of(given)
        assert (player.kind, player.budget, player.model, player.options) == (name, budget, None, {"aim": "absolute"})


def test_a_name_may_end_in_a_model(model):
    for kind in ("planner", "planner_value", "planner_policy"):
        for given, budget in ((f"{kind}@{model}", BUDGET), (f"{kind}_60@{model}", 60), (f"{kind}_60@{model.parent}", 60)):
            player = stroke_player(given, seed=4)
            assert (player.kind, player.budget) == (kind, budget) and str(player.model) in (str(model), str(model.parent))


@pytest.mark.parametrize(
    ("name", "complaint"),
    [
        ("lookahead_7", "budget = 7: must be"), ("planner_0", "budget = 0: must be"),
        ("lookahead@ppo_mask", "agent = 'lookahead@ppo_mask': must not name a model"),
        ("best_pot_60@ppo_mask", "agent = 'best_pot_60@ppo_mask': must not name a model"),
        ("planner@ppo_mask", "agent = 'planner@ppo_mask': must be a model of ppo_value"),
        ("planner_60@nowhere/at/all", "agent = 'planner@nowhere/at/all': must name a model: .*ppo_mask.*, a .zip or a run's folder"),
        ("planner_value@pyproject.toml", "agent = 'pyproject.toml': must be a model that train.py saved"),
        ("lookahead_", "agent = 'lookahead_': must be"), ("lookahead_12345678", "agent = 'lookahead_12345678': must be"),
        ("planner@", "agent = 'planner@': must be"), ("planer", "agent = 'planer': must be .*planner"),
        ("lookahead_-60", "agent = 'lookahead_-60': must be"), ("Lookahead", "agent = 'Lookahead': must be"),
    ],
)  # fmt: skip
def test_a_wrong_name_is_refused_by_one_sentence(name, complaint):
    with pytest.raises(ValueError, match=f"^{complaint}") as info:
        player_of(name)
    assert type(info.value) is ValueError and "\n" not in str(info.value)
    if not is_stroke_player(name):
        with pytest.raises(ValueError, match=r"^agent = .*must be best_pot, lookahead, planner"):
            stroke_player(name)


def test_a_run_that_has_not_ended_is_named(tmp_path):
    (tmp_path / models.CHECKPOINT).write_bytes(b"")
    with pytest.raises(ValueError, match=r"^agent = .*this run has not ended, continue it with: python train.py --resume"):
        player_of(f"planner@{tmp_path}")


# which model -----------------------------------------------------------------------------------------------------------------------


def test_a_planner_without_a_pretrained_model_says_what_to_do(monkeypatch):
    monkeypatch.setattr(models, "pretrained", lambda: ["ppo_mask", "ppo_target"])
    env = four()
    with pytest.raises(ValueError, match=r"^agent = 'planner': must name a model \(planner@MODEL\): there is no ppo_value"):
        player_of("planner_30").act(env, None, np.ones(4, bool))


def test_the_model_is_that_of_the_tables_noise_else_of_the_nearest(monkeypatch):
    there = ["ppo_mask", "ppo_value", "ppo_value_club", "ppo_value_none"]
    monkeypatch.setattr(models, "pretrained", lambda: there)
    for level, name in (("professional", "ppo_value"), ("club", "ppo_value_club"), ("none", "ppo_value_none")):
        assert model_for(LEVELS[level]) == name
    # by the ratio of the errors of direction: 0.048 is nearer to 0.035, 0.149 to 0.114, and so is ten degrees
    assert model_for(LEVELS["amateur"]) == "ppo_value" and model_for(LEVELS["olympiad"]) == "ppo_value_club"
    assert model_for(Noise(aim_deg=10.0)) == "ppo_value_club" and model_for(Noise(aim_deg=1e-5)) == "ppo_value_none"
    there.append("ppo_value_amateur")
    assert model_for(LEVELS["amateur"]) == "ppo_value_amateur"
    there[:] = ["ppo_value_club"]
    assert all(model_for(noise) == "ppo_value_club" for noise in LEVELS.values())


# what is played --------------------------------------------------------------------------------------------------------------------


def test_each_kind_has_its_value_and_its_proposals(model):
    env = four()
    kinds = {}
    for kind in NAMES:
        player = stroke_player(f"{kind}_30@{model}" if kind.startswith("planner") else f"{kind}_30")
        player.act(env, None, GOING)
        search = player.search
        kinds[kind] = (
            isinstance(search.value, Value),
            isinstance(search.propose, PolicyProposals),
            search.propose is at_pots,
            search.pots_only,
        )
        assert search.budget == 30 and search.shots <= 30 * 3
    assert kinds == {
        "best_pot": (False, False, True, True), "lookahead": (False, False, True, False), "planner": (True, True, False, False),
        "planner_value": (True, False, True, False), "planner_policy": (False, True, False, False),
    }  # fmt: skip


@pytest.mark.parametrize("kind", NAMES)
@pytest.mark.parametrize("noise", ["professional", "none"])
def test_the_first_of_a_ranking_is_played(kind, noise, model):
    name = f"{kind}_60@{model}" if kind.startswith("planner") else f"{kind}_60"
    env = four(noise=noise)
    acted = stroke_player(name).act(env, None, GOING)
    assert acted.dtype == np.float32 and acted.shape == (4, 4) and not acted[1].any() and np.abs(acted).max() <= 1.0
    ranking = stroke_player(name).rank(env, None, GOING)
    assert len(ranking) == 3
    for own, (actions, scores) in zip(acted[GOING], ranking, strict=True):
        assert np.array_equal(own, actions[0]) and len(actions) == len(scores)
        assert (np.diff(scores) <= 0.0).all()  # best first
        assert len(scores) == 10 if noise == "none" else 1 < len(scores) <= schedule(60)[1][0][0]
    assert (Planner(env, noise="none").play(env, np.flatnonzero(GOING), acted[GOING]).points > 0).sum() >= 2


def test_the_strokes_of_a_search_are_what_is_played():
    env = four()
    player = stroke_player("lookahead_60", seed=6)
    acted = player.act(env, None, GOING)
    seeds = np.random.SeedSequence([6, 0]).generate_state(4)[GOING]
    best = player.search.rank(Positions.of(env)[GOING], seeds).strokes[:, 0]
    assert np.array_equal(acted[GOING], actions_of(best[:, 0], best[:, 3], best[:, 1], best[:, 2]))


def test_decisions_are_reproducible_and_each_is_its_own():
    """By the seed, the number of the decision and the table; not by who else is still playing."""
    env = four()
    one, other = stroke_player("lookahead_30", seed=3), stroke_player("lookahead_30", seed=3)
    everyone = np.ones(4, bool)
    first, second = one.act(env, None, everyone), one.act(env, None, everyone)
    assert not (first == second).all(axis=1).any()  # fresh noise samples each time
    assert np.array_equal(first, other.act(env, None, everyone)) and np.array_equal(second, other.act(env, None, everyone))
    part = stroke_player("lookahead_30", seed=3).act(env, None, GOING)
    assert np.array_equal(part[GOING], first[GOING])
    assert not (stroke_player("lookahead_30", seed=5).act(env, None, everyone) == first).all(axis=1).any()


def test_a_player_goes_on_at_other_tables_with_their_noise():
    player = stroke_player("lookahead_30")
    player.act(four(), None, GOING)
    player.act(four(noise="club"), None, GOING)
    assert player.search.noise == LEVELS["club"]


def test_when_all_visits_have_ended_there_is_nothing_to_play(model):
    for name in ("lookahead_30", f"planner_30@{model}"):
        player = stroke_player(name)
        acted = player.act(four(), None, np.zeros(4, bool))
        assert acted.shape == (4, 4) and not acted.any() and player.rank(four(), None, np.zeros(4, bool)) == []


def test_lookahead_makes_more_points_than_the_best_pot_and_that_more_than_the_widest():
    points = {
        name: summary(play_visits(player_of(name, seed=1), 60, threads=1))["points_a_visit"] for name in ("lookahead_60", "best_pot_60")
    }
    points["ghost_ball"] = summary(play_visits(player_of("ghost_ball"), 60, threads=1))["points_a_visit"]
    assert points["lookahead_60"] > 1.5 * points["best_pot_60"] > 1.5 * points["ghost_ball"]


def test_a_trained_policy_is_read_once(model, monkeypatch):
    stroke_players._trained.cache_clear()
    read = []
    load = models.load_trained
    monkeypatch.setattr(models, "load_trained", lambda *given: read.append(given) or load(*given))
    for name in (f"planner_30@{model}", f"planner_value_30@{model}"):
        stroke_player(name).act(four(), None, GOING)
    assert len(read) == 1
