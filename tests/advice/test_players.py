"""Is every player asked in the same way? Its first stroke is the one that it would play on tables; players of one's own are asked, too."""

import sys

import numpy as np
import pytest
from cases import ALL, ENDGAME, IN_HAND, OPEN, RESPOTTED, state_of

import snooker_env as sn
from snooker_env.advice import player_of, stroke_of
from snooker_env.tasks import choice_of
from tests.refusals import refused

QUICK = {"samples": 30, "visits": 2}


def dealt(position, player, **options):
    """A table of a player with a position on it, and what is seen of it."""
    tables = sn.SnookerVectorEnv(1, **{**player.options, **options})
    observations, _ = tables.reset(seed=0, options={"state": state_of(position)})
    return tables, observations


class Soft:
    """Always the first pot, softly."""

    options = {"action": "discrete"}  # noqa: RUF012

    def act(self, tables, observations, going):
        assert observations.shape == (1, 121) and going.tolist() == [True]
        return np.array([choice_of(0, 0, 1, 2)])


class Ranking(Soft):
    """Two strokes with scores; the second one pots more surely."""

    def rank(self, tables, observations, going):
        return [(np.array([choice_of(0, 8, 0, 0), choice_of(0, 3, 1, 2)]), np.array([2.0, 1.0]))]


class Aiming:
    """A stroke with side, aimed away from +x, and placed where it says."""

    options = {"aim": "absolute", "placement": True}  # noqa: RUF012

    def act(self, tables, observations, going):
        return np.array([[0.0, 0.6, -0.2, 0.5, 0.5, -1.0]], np.float32)


def test_a_players_stroke_is_read_as_the_environment_reads_it():
    """Squirt and all: the same stroke from the same place ends where the player's own action does."""
    for player, position in ((Soft(), OPEN), (Aiming(), OPEN), (Aiming(), IN_HAND)):
        tables, observations = dealt(position, player, noise="none")
        tables.step(player.act(tables, observations, np.ones(1, bool)))
        stroke = stroke_of(player, position)
        other = sn.SnookerVectorEnv(1, aim="absolute", placement=True)
        other.reset(seed=0, options={"state": state_of(position)})
        other.step(stroke.action(placement=True)[None])
        own, ours = tables.get_state()[0], other.get_state()[0]
        assert own["on_table"] == ours["on_table"]
        assert np.allclose(own["positions"], ours["positions"], atol=2e-3)  # float32, magnified by impacts
    assert stroke_of(Aiming(), IN_HAND).place == pytest.approx((0.146, -1.0475)) and stroke_of(Aiming(), OPEN).side == pytest.approx(0.3)


def test_a_player_who_cannot_place_the_cue_ball_plays_from_the_best_place():
    """From the usual place a colour is in the way of the only red; from the side it can be potted."""
    position = sn.Position(in_hand=True, reds=[(0.0, -0.2)], blue=(0.03, -0.8), green=(-0.03, -0.8), pink=(0.1, -0.7), black=(-0.1, -0.7))
    usual = sn.Position(**position.to_dict() | {"in_hand": False})
    assert sn.planning.pots(usual).ball[0, 0] == -1
    stroke = stroke_of(Soft(), position)
    there = sn.Position(**position.to_dict() | {"cue": stroke.place})
    assert sn.planning.pots(there).ball[0, 0] == 1
    assert stroke == stroke_of(Soft(), there, seed=5)


def test_a_ranking_chooses_and_its_scores_are_kept():
    """Its first stroke pots less surely, and so comes second where both are shown."""
    (first,) = sn.advise(ENDGAME, agent=Ranking(), n=1, samples=200, visits=0)
    advice = sn.advise(ENDGAME, agent=Ranking(), n=2, samples=200, visits=0)
    assert [one.score for one in advice] == [1.0, 2.0] and advice[0].points > advice[1].points and advice.agent == "Ranking"
    assert first == advice[1]
    assert [one.score for one in sn.advise(ENDGAME, agent=Soft(), n=3, **QUICK)] == [None]


def test_a_class_by_its_name():
    player = player_of("agents.players.built_in:GhostBall")
    assert player.name == "agents.players.built_in:GhostBall" and stroke_of(player, OPEN) == stroke_of("ghost_ball", OPEN)


@pytest.mark.parametrize("name", ["lookahead", "ghost_ball", "random"])
def test_built_in_advisors_play_tables_too(name):
    player = player_of(name)
    tables = sn.SnookerVectorEnv(3, noise="professional", task="frame", **player.options)
    observations, _ = tables.reset(seed=1)
    for _ in range(3):
        actions = player.act(tables, observations, np.array([True, False, True]))
        assert actions.shape == tables.action_space.shape and not actions[1].any() and actions[0].any()
        observations, *_ = tables.step(actions)
        if any(state["frame"]["free_ball"] for state in tables.get_state()):
            break


@pytest.mark.parametrize("name", ["geometric", "search", "random_absolute", "agents.players.built_in:ForesightRule"])
@pytest.mark.parametrize("position", [OPEN, RESPOTTED, ALL["snookered"]], ids=["open", "respotted", "snookered"])
def test_players_of_the_repository_give_advice(name, position):
    advice = sn.advise(position, agent=name, n=2, **QUICK)
    assert len(advice) >= 1 and advice.agent == name
    assert (advice[0].place is not None) == position.in_hand


def test_a_pretrained_agent_gives_its_probabilities():
    pytest.importorskip("sb3_contrib")
    advice = sn.advise(OPEN, agent="ppo_mask", n=4, **QUICK)
    scores = [one.score for one in advice]
    assert len(set(scores)) == len(scores) > 1 and min(scores) > 0.0 and sum(scores) <= 1.0


def test_without_the_repository_the_built_in_players_are_there(monkeypatch):
    """As in an installed wheel, which does not hold the folder agents."""
    for module in [name for name in sys.modules if name.split(".")[0] == "agents"]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.setitem(sys.modules, "agents", None)
    from snooker_env.advice import names

    assert names() == ["lookahead", "ghost_ball", "random"]
    assert len(sn.advise(ENDGAME, n=1, **QUICK)) == 1
    refused(lambda: player_of("ppo_mask"), "agent", "ppo_mask", "need a clone of the repository")


def test_a_fault_in_the_repositorys_own_code_is_not_hidden(monkeypatch):
    import importlib

    def broken(name):
        raise ModuleNotFoundError("No module named 'torch'", name="torch")

    monkeypatch.setattr(importlib, "import_module", broken)
    with pytest.raises(ModuleNotFoundError, match="torch"):
        player_of("ppo_mask")
