"""Does each name stand for its player, and is search the search by a rule of thumb with a larger budget?"""

import numpy as np
import pytest
from positions import tables

from agents.players.built_in import DISCRETE, GhostBall, Random
from agents.players.by_name import player_of
from snooker_env.benchmark import play_visits, summary
from snooker_env.tasks.discrete_actions import STROKES
from snooker_env.tasks.noise import Noise


def test_search_is_lookahead_with_2000_shots():
    searching, env = player_of("search"), tables(3, noise="professional", aim="absolute")
    assert (searching.kind, searching.budget) == ("lookahead", 2000)
    going = np.array([True, False, True])
    assert np.array_equal(searching.act(env, None, going), player_of("lookahead_2000").act(env, None, going))
    assert searching.search.shots == 2 * 1995


def test_search_beats_the_widest_pot_by_far():
    searched, widest = (summary(play_visits(player, 12, threads=1)) for player in (player_of("search", budget=300), GhostBall()))
    assert searched["pots_a_visit"] > 2.0 * widest["pots_a_visit"]
    assert searched["next_pot_after_a_pot"] > 0.8


def test_without_errors_search_clears_tables_and_pots_from_the_break():
    cleared = summary(play_visits(player_of("search", budget=600), 3, noise="none"))
    assert cleared["clearances"] >= 2 / 3 and cleared["longest_break"] > 100
    env = tables(4, layout="break_off", aim="absolute")
    _, rewards, _, _, info = env.step(player_of("search", budget=600).act(env, None, np.ones(4, bool)))
    assert (rewards > 0).sum() >= 2 and not info["foul"][rewards > 0].any()


def test_players_by_name(tmp_path):
    assert isinstance(player_of("random"), Random) and isinstance(player_of("ghost_ball"), GhostBall)
    assert player_of("random_absolute").options == {"aim": "absolute"} and player_of("search", budget=9).budget == 9
    for wrong in ("nobody", str(tmp_path)):
        with pytest.raises(ValueError, match="agent = "):
            player_of(wrong)
    with pytest.raises(ValueError, match="budget = 7"):
        player_of("search", budget=7)


def test_random_plays_only_what_is_there():
    env = tables(50, layout="random:1", **DISCRETE)
    picks = Random(seed=1).act(env, None, np.ones(50, bool))
    assert env.action_masks()[np.arange(50), picks].all() and len(set(picks // STROKES)) > 1
    assert Noise().silent
