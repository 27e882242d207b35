"""Do the players that search play what their names say, and how well?"""

import numpy as np
import pytest

import snooker_env as sn
from agents.evaluation.visit_figures import summary
from snooker_env.benchmark import count_shots, play_visits
from snooker_env.game import frame_columns as columns
from snooker_env.planning import Positions
from snooker_env.planning.learned.learned_worth import LearnedValue
from snooker_env.planning.learned.stroke_policy import PolicyProposals
from snooker_env.players import FRAMES, weights
from snooker_env.players.degenerate import SILLY
from snooker_env.players.search_player import BUDGET, KINDS
from snooker_env.tasks import LEVELS, Noise
from tests.positions import tables


def held_out(n=4, seed=2):
    return Positions.of(tables(n, seed, layout="held_out", threads=1))


@pytest.mark.parametrize("kind", KINDS)
def test_a_name_may_end_in_a_number_of_shots(kind):
    for name, budget in ((kind, BUDGET), (f"{kind}_8", 8), (f"{kind}_2000", 2000)):
        player = sn.player(name)
        assert (player.kind, player.budget) == (kind, budget)
        assert player.name == (kind if budget == BUDGET else f"{kind}_{budget}")


def test_each_kind_has_its_value_and_its_proposals():
    kinds = {}
    for kind in KINDS:
        player = sn.player(f"{kind}_30").at({"noise": "professional"})
        (propose,) = player.search.propose
        learned = isinstance(player.judge.value, LearnedValue), isinstance(propose, PolicyProposals)
        kinds[kind] = (*learned, player.judge.pots_only)
    assert kinds == {
        "best_pot": (False, False, True),
        "search": (False, False, False),
        "planner": (True, True, False),
    }


def test_a_decision_takes_as_many_shots_as_its_name_says():
    player = sn.player("planner_60").at({"noise": "professional"})
    at, before = held_out(), count_shots()
    player.play(at, np.arange(4))
    assert 0.9 * 4 * 60 <= count_shots() - before <= 4 * 60


def test_the_weights_are_those_of_the_noise_else_of_the_nearest():
    assert weights.levels() == ["none", "professional", "amateur", "club"]
    for level in weights.levels():
        assert weights.level_for(LEVELS[level]) == level
    # by the ratio of the errors of direction
    assert weights.level_for(Noise(aim_deg=10.0)) == "club"
    assert weights.level_for(Noise(aim_deg=1e-5)) == "none"
    with pytest.raises(ValueError, match="level = 'robot': must be one of none, professional"):
        weights.learned_at("robot")


@pytest.mark.slow
def test_planner_search_best_pot_and_ghost_ball_make_points_in_this_order():
    players = map(sn.player, ("planner_60", "search_60", "best_pot_60", "ghost_ball"))
    points = [summary(play_visits(player, 60, threads=1))["points_a_visit"] for player in players]
    assert points[0] > 1.1 * points[1] > 1.5 * points[2] > 1.5 * points[3]


@pytest.mark.parametrize("name", ["planner_30", "search_30", "best_pot_30"])
def test_after_a_foul_each_choice_is_compared(name):
    """Of a foul that leaves nothing the other plays again, or from where it was a miss; of one that leaves a pot not."""
    twins = sn.MatchVectorEnv(40, **FRAMES, layout="safety", miss="clear_path", noise="professional")
    twins.reset(seed=1, options={"breaker": 0})
    at = sn.Positions.of(twins)
    twins.step(SILLY["softest_away"]().at(twins).play(at, np.arange(40)).actions(twins.options, at))
    at = sn.Positions.of(twins)
    fouled = at[np.flatnonzero(at.choice)]
    assert len(fouled) > 20
    made = sn.player(name).at(twins).play(fouled, np.arange(len(fouled)))
    kinds = set(made.decision.tolist())
    assert columns.PLAY_AGAIN in kinds and columns.REPLACE in kinds, kinds
    assert not (made.decision[~fouled.miss_called] == columns.REPLACE).any()
