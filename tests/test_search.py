"""Does the search find good shots, and does the look ahead show what will happen?"""

import numpy as np
import pytest

from agents import foresight, lookahead, view
from agents.lookahead import Copies, Position
from agents.looks import LOOKS, errors_of, find, unevenness
from agents.players import DISCRETE, GhostBall, Random, player_of
from agents.search import Search
from agents.visits import play, summary
from snooker_env.envs.choices import SIZE, STROKES, choice_of
from snooker_env.envs.noise import Noise
from snooker_env.envs.vector import SnookerVectorEnv


def tables(n, seed=0, **options):
    env = SnookerVectorEnv(n, **options)
    env.reset(seed=seed)
    return env


def position(env):
    v = env.visits
    return Position(v.positions.copy(), v.on_table.copy(), v.game.copy())


def test_copies_play_what_the_tables_play():
    env = tables(6, noise="club", **DISCRETE)
    at, copies = position(env), Copies(env.visits.rules, env.visits.rules.shooter.noise)
    picks = np.array([int(np.flatnonzero(m)[7]) for m in env.action_masks()])
    assert (env.visits.streams[:, 1] != 0).any()  # the dealing drew from the streams: give the copies streams of their own and play those
    env.visits.streams[:, 1] = 0
    points, goes_on, left, seen = copies.play(at, np.arange(6), picks, env.visits.streams[:, 0])
    observations, rewards, ended, _, _ = env.step(picks)
    assert np.array_equal(rewards, points) and np.array_equal(~ended, goes_on) and np.array_equal(observations, seen)
    assert np.array_equal(left.positions, env.visits.positions) and copies.shots == 6
    assert not np.array_equal(at.positions, left.positions)  # the originals are as they were


def test_choices_as_angles_are_the_same_shots():
    """Said as a float32 angle, a choice's aim is rounded by 2e-7 rad: mostly the balls still stop within a millimetre."""
    choices, angles = tables(40, layout="random:1", **DISCRETE), tables(40, layout="random:1", aim="absolute")
    masks = choices.action_masks()
    picks = np.where(masks[:, choice_of(0, 3, 2, 3)], choice_of(0, 3, 2, 3), 0)
    actions = lookahead.as_actions(position(angles), np.arange(40), picks, angles.visits.rules.shooter)
    assert np.abs(actions).max() <= 1.0
    _, first, _, _, _ = choices.step(picks)
    _, second, _, _, _ = angles.step(actions)
    assert np.mean(first == second) > 0.95 and first.sum() > 10
    apart = np.abs(choices.visits.positions[:, 0] - angles.visits.positions[:, 0]).max(axis=1)
    assert np.median(apart) < 1e-3


def test_prospects_prefer_easy_pots_and_more_to_come():
    env = tables(1, layout="random:2")
    at = position(env)
    at.on_table[0, 1:] = False
    at.on_table[0, [1, 2]] = True
    at.game[0, 0] = 1
    at.positions[0, :3] = (0.0, 0.0), (0.5, 0.8), (-0.7, -1.5)

    def value(p, spread):
        values, chances = lookahead.prospects_of(p, spread)
        return values[0], chances[0]

    easy, chances = value(at, 1e-3)
    assert 0 < chances[1] <= chances[0] <= 1
    assert value(at, 4e-3)[0] < easy  # a shakier hand
    fewer = at[np.array([0])]
    fewer.on_table[0, 2] = False
    assert value(fewer, 1e-3)[0] < easy
    nothing = at[np.array([0])]
    nothing.on_table[0, 1:] = False
    assert value(nothing, 1e-3)[0] == 0


def test_search_beats_the_widest_pot_by_far():
    searched, widest = (summary(play(player, 12, threads=1)) for player in (Search(300, seed=1), GhostBall()))
    assert searched["pots_a_visit"] > 2.0 * widest["pots_a_visit"]
    assert searched["next_pot_after_a_pot"] > 0.8


def test_without_errors_search_clears_tables_and_pots_from_the_break():
    cleared = summary(play(Search(600), 3, noise="none"))
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
    assert asked and set(asked) == {view.SHOWN}


def rows_of(seen):
    return seen[:, view.SHOWN :].reshape(len(seen), foresight.STROKES_SEEN, foresight.ENTRIES)


def test_foresight_shows_what_happens_without_errors():
    env = tables(5, noise="none", **DISCRETE)
    look = foresight.Foresight(2)
    observations = env.reset(seed=4)[0]
    seen = look(env, observations)
    assert seen.shape == (5, *foresight.SPACE.shape) and foresight.SPACE.contains(seen[0])
    assert np.array_equal(seen[:, : view.SHOWN], view.with_pots(observations))
    rows, exact = rows_of(seen), tables(5, noise="none", **DISCRETE)
    assert np.array_equal(rows[:, :, foresight.THERE] > 0, env.action_masks()[:, foresight.PICKS])
    for stroke in (0, 8, 14):
        exact.reset(options={"states": env.get_state()})
        _, rewards, ended, _, _ = exact.step(foresight.PICKS[np.full(5, stroke)])
        row = rows[:, stroke]
        assert np.allclose(row[:, foresight.POINTS], rewards / 7.0) and np.array_equal(row[:, foresight.GOES_ON] > 0, ~ended)
        assert not row[:, foresight.SPREAD].any() and np.array_equal(row[:, foresight.SCORED] > 0, rewards > 0)
        cue = exact.visits.positions[:, 0] / (view.HALF_WIDTH, view.HALF_LENGTH)
        assert np.allclose(row[~ended, foresight.CUE_X : foresight.CUE_Y + 1], cue[~ended], atol=1e-6)
        assert np.allclose(foresight.worth_by_hand(rows)[ended, stroke], rewards[ended], atol=1e-5)
    part = look(env, observations[[1, 3]], np.array([False, True, False, True, False]))
    assert np.array_equal(part, seen[[1, 3]])
    assert look.masks(env).sum() == (rows[:, :, 0] > 0).sum() and look.masks(env).shape == (5, SIZE)


def test_foresight_is_the_mean_over_looks_with_the_errors_of_the_tables():
    """Against the tables themselves, given the streams of each look in turn."""
    env, other = tables(4, noise="club", **DISCRETE), tables(4, noise="club", **DISCRETE)
    seen = rows_of(foresight.Foresight(1)(env, env.reset(seed=8)[0]))
    spread = lookahead.spread_of(env.visits.rules.shooter.noise, env.visits.rules.shooter.physics)
    for stroke in (1, 10):
        points, worth, next_best, cue, on = (np.zeros((5, 4)) for _ in range(5))
        for i, key in enumerate(LOOKS):
            other.reset(options={"states": env.get_state()})
            other.visits.streams[:] = (key, 0)
            _, points[i], ended, _, _ = other.step(foresight.PICKS[np.full(4, stroke)])
            values, chances = lookahead.prospects_of(position(other), spread)
            on[i], worth[i], next_best[i] = ~ended, ~ended * values, ~ended * chances.max(1)
            cue[i] = ~ended * other.visits.positions[:, 0, 1]
        row, goes_on = seen[:, stroke], np.maximum(1, on.sum(0))
        assert np.allclose(row[:, foresight.POINTS], points.mean(0) / 7.0) and np.allclose(row[:, foresight.SCORED], (points > 0).mean(0))
        assert np.allclose(row[:, foresight.GOES_ON], on.mean(0)) and 0 < on.mean() < 1
        assert np.allclose(row[:, foresight.VALUE], worth.mean(0) / 25.0) and np.allclose(row[:, foresight.SPREAD], worth.std(0) / 25.0)
        assert np.allclose(row[:, foresight.FIRST], next_best.sum(0) / goes_on)
        assert np.allclose(row[:, foresight.CUE_Y], cue.sum(0) / goes_on / view.HALF_LENGTH, atol=1e-6)


def test_looks_are_even():
    errors = errors_of(LOOKS)
    likely = [-1.2816, -0.5244, 0.0, 0.5244, 1.2816]
    assert np.abs(np.sort(errors[:, [0, 3]], axis=0).T - likely).max() < 0.25 and np.abs(errors.mean(0)).max() < 0.15
    assert np.abs(np.corrcoef(errors[:, :4].T) - np.eye(4)).max() < 0.55
    _, least, median = find(len(LOOKS), keys=200, starts=1)
    assert unevenness(errors) < least < median / 2
    many = errors_of(range(1, 20_001))
    assert np.abs(many.mean(0)).max() < 0.03 and np.abs(np.cov(many.T) - np.eye(5)).max() < 0.03
    assert unevenness(many[:2000]) < 0.01


def test_lookahead_plays_the_stroke_that_promises_most():
    env, going = tables(6, noise="professional", **DISCRETE), np.array([True, False, True, True, True, True])
    player = player_of("lookahead")
    picks = player.act(env, None, going)
    rows = rows_of(foresight.Foresight()(env, env.reset(seed=0)[0]))
    assert np.array_equal(picks[going], foresight.PICKS[foresight.worth_by_hand(rows).argmax(1)][going]) and picks[1] == 0
    far = play(player, 60, first_seed=5)
    plain = play(GhostBall(), 60, first_seed=5)
    assert summary(far)["points_a_visit"] > 2.0 * summary(plain)["points_a_visit"]


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
