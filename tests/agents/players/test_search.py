"""Does the search find good shots, as its docstring says: two shots deep, all under the same errors, within its budget?"""

import numpy as np
import pytest
from positions import tables

from agents.features import pot_features
from agents.players.built_in import DISCRETE, GhostBall, Random
from agents.players.by_name import player_of
from agents.players.search import Search, _Worker
from snooker_env.benchmark import play_visits, summary
from snooker_env.planning import Positions, action_masks, prospects
from snooker_env.tasks.discrete_actions import STROKES
from snooker_env.tasks.noise import Noise


def test_search_beats_the_widest_pot_by_far():
    searched, widest = (summary(play_visits(player, 12, threads=1)) for player in (Search(300, seed=1), GhostBall()))
    assert searched["pots_a_visit"] > 2.0 * widest["pots_a_visit"]
    assert searched["next_pot_after_a_pot"] > 0.8


def test_without_errors_search_clears_tables_and_pots_from_the_break():
    cleared = summary(play_visits(Search(600), 3, noise="none"))
    assert cleared["clearances"] >= 2 / 3 and cleared["longest_break"] > 100
    env = tables(4, layout="break_off", aim="absolute")
    _, rewards, _, _, info = env.step(Search(600).act(env, None, np.ones(4, bool)))
    assert (rewards > 0).sum() >= 2 and not info["foul"][rewards > 0].any()


def test_search_finds_the_same_shots_on_any_number_of_threads():
    env = tables(3, noise="professional", aim="absolute")
    going = np.array([True, False, True])
    first, second = Search(100, seed=3, threads=1), Search(100, seed=3, threads=2)
    a, b = first.act(env, None, going), second.act(env, None, going)
    assert np.array_equal(a, b) and not a[1].any() and a[0].any()
    assert 100 < first.shots <= 200 and first.shots == second.shots
    assert not np.array_equal(a, Search(100, seed=4).act(env, None, going))


def test_search_takes_a_value_in_place_of_its_own():
    env, asked = tables(1, noise="professional", aim="absolute"), []

    def value(seen):
        asked.append(seen.shape[1])
        return np.zeros(len(seen))

    Search(100, value=value).act(env, None, np.ones(1, bool))
    assert asked and set(asked) == {pot_features.SHOWN}


def test_players_by_name(tmp_path):
    assert isinstance(player_of("random"), Random) and isinstance(player_of("ghost_ball"), GhostBall)
    assert player_of("random_absolute").options == {"aim": "absolute"} and isinstance(player_of("search", budget=7), Search)
    for wrong in ("nobody", str(tmp_path)):
        with pytest.raises(ValueError, match="agent = "):
            player_of(wrong)


def test_random_plays_only_what_is_there():
    env = tables(50, layout="random:1", **DISCRETE)
    picks = Random(seed=1).act(env, None, np.ones(50, bool))
    assert env.action_masks()[np.arange(50), picks].all() and len(set(picks // STROKES)) > 1
    assert Noise().silent


@pytest.fixture
def thought():
    """A table, and a mind that thinks about it with 2,000 shots."""
    env = tables(1, seed=5, noise="professional", aim="absolute")
    return Positions.of(env), _Worker(Search(2000), env)


def test_the_second_shot_decides(thought, monkeypatch):
    """Scores turned round by it: another shot is played. It has 0.4 of the budget, and what was left."""
    at, mind = thought
    own, asked = mind.ranked(at, np.random.default_rng(1))[0][0], []
    assert mind.exact.shots > 0.3 * 2000 and mind.noisy.shots + mind.exact.shots <= 2000

    def turned_round(self, scores, records, budget, rng):
        asked.append((len(scores), budget))
        return -scores

    monkeypatch.setattr(_Worker, "_second", turned_round)
    assert not np.array_equal(mind.ranked(at, np.random.default_rng(1))[0][0], own)
    ((finalists, budget),) = asked
    assert finalists == 6 and budget >= 800


def test_the_second_shot_one_by_one(thought):
    """Points, plus the share that goes on times the best of the next shots: its chance times points and value, each played by itself."""
    at, mind = thought
    picks = np.flatnonzero(action_masks(at)[0])[[17, 55, 102]]
    played = np.repeat(mind.exact.as_actions(at, np.zeros(3, np.int64), picks), 5, 0)
    keys = np.tile(np.arange(5, dtype=np.uint64), 3)
    points, goes_on, left, _ = mind.noisy.play(at, np.zeros(15, np.int64), played, keys)
    _, chances = prospects.prospects_of(left, mind._spread)
    shares = goes_on.reshape(3, 5).mean(axis=1)
    assert ((shares > 0) & (shares < 1)).any()
    found = mind._second(np.zeros(3), (points.reshape(3, 5), goes_on.reshape(3, 5), left, chances), 10_000, np.random.default_rng(2))
    rows = np.flatnonzero(goes_on)
    brought = np.zeros(15)
    for row, strokes in zip(rows, mind._next_shots(chances[rows], np.random.default_rng(2)), strict=True):
        here = left[row : row + 1]
        for pick in strokes:
            action = mind.exact.as_actions(here, [0], [pick])
            made, further, then, _ = mind.exact.play(here, np.zeros(1, np.int64), action, np.zeros(1, np.uint64))
            worth = made[0] + further[0] * prospects.prospects_of(then, mind._spread)[0][0]
            brought[row] = max(brought[row], chances[row, pick // STROKES] * worth)
    for k in range(3):
        on = goes_on.reshape(3, 5)[k]
        mean = brought.reshape(3, 5)[k][on].mean() if on.any() else 0.0
        assert found[k] == pytest.approx(points.reshape(3, 5)[k].mean() + shares[k] * mean)


def test_all_candidates_of_a_round_meet_the_same_errors(thought, monkeypatch):
    at, mind = thought
    play_on, rounds = mind.noisy.play, []

    def watched(at, rows, actions, keys):
        rounds.append((actions, keys))
        return play_on(at, rows, actions, keys)

    monkeypatch.setattr(mind.noisy, "play", watched)
    mind.ranked(at, np.random.default_rng(1))
    assert len(rounds) > 2
    for actions, keys in rounds:
        n = len(np.unique(actions, axis=0))
        each = keys.reshape(n, -1)
        assert (each == each[0]).all() and len(set(each[0])) == each.shape[1]
        assert (actions.reshape(n, each.shape[1], 4) == actions.reshape(n, -1, 4)[:, :1]).all()
    assert rounds[-1][1].size > 6  # several errors for each of the last


@pytest.mark.parametrize("layout", ["held_out", "break_off"])
def test_no_more_shots_than_the_budget(layout):
    env = tables(1, seed=3, layout=layout, noise="professional", aim="absolute")
    for budget in (2, 3, 13, 14, 15, 37, 38, 39, 108, 199, 200, 201):
        search = Search(budget, threads=1)
        assert np.abs(search.act(env, None, np.ones(1, bool))).any() and budget // 2 <= search.shots <= budget
