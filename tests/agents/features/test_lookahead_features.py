"""Does the lookahead predict the outcomes, entry by entry, and are its noise samples even?"""

from itertools import product

import numpy as np
from positions import tables

import snooker_env as sn
from agents.features import lookahead_features as ahead
from agents.features.noise_samples import find, first_of, unevenness
from snooker_env.benchmark import play_visits, summary
from snooker_env.game.balls import BallOn
from snooker_env.planning import Planner, Positions, action_masks, prospects
from snooker_env.planning.learned import pot_view
from snooker_env.planning.sobol import EVEN_SAMPLES
from snooker_env.tasks.discrete_actions import SIZE
from snooker_env.tasks.noise import errors_of
from snooker_env.tasks.visit import BALL_ON

DISCRETE = {"action": "discrete"}


def rows_of(seen):
    return seen[:, pot_view.SHOWN :].reshape(len(seen), ahead.STROKES_SEEN, ahead.ENTRIES)


def test_foresight_shows_what_happens_without_errors():
    env = tables(5, noise="none", **DISCRETE)
    view = ahead.ForesightView(2).at(env.options)
    observations = env.reset(seed=4)[0]
    at = Positions.of(env)
    seen = view(at, observations)
    assert seen.shape == (5, *ahead.SPACE.shape) and ahead.SPACE.contains(seen[0])
    assert np.array_equal(seen[:, : pot_view.SHOWN], pot_view.with_pots(observations))
    rows, exact = rows_of(seen), tables(5, noise="none", **DISCRETE)
    assert np.array_equal(rows[:, :, ahead.THERE] > 0, env.action_masks()[:, ahead.PICKS])
    for stroke in (0, 8, 14):
        exact.reset(options={"states": env.get_state()})
        _, rewards, ended, _, _ = exact.step(ahead.PICKS[np.full(5, stroke)])
        row = rows[:, stroke]
        assert np.allclose(row[:, ahead.POINTS], rewards / 7.0)
        assert np.array_equal(row[:, ahead.GOES_ON] > 0, ~ended)
        assert not row[:, ahead.SPREAD].any()
        assert np.array_equal(row[:, ahead.SCORED] > 0, rewards > 0)
        cue = exact.tables.positions[~ended, 0] / (pot_view.HALF_WIDTH, pot_view.HALF_LENGTH)
        assert np.allclose(row[~ended, ahead.CUE_X : ahead.CUE_Y + 1], cue, atol=1e-6)
        assert np.allclose(ahead.worth_by_rule(rows)[ended, stroke], rewards[ended], atol=1e-5)
    part = view(at[[1, 3]], observations[[1, 3]])
    assert np.array_equal(part, seen[[1, 3]])
    allowed = view.allowed(action_masks(at))
    assert allowed.sum() == (rows[:, :, 0] > 0).sum() and allowed.shape == (5, SIZE)


def test_foresight_is_the_mean_over_noise_samples_with_the_errors_of_the_tables():
    """Against the tables themselves, given the streams of each noise sample in turn."""
    env, other = tables(4, noise="club", **DISCRETE), tables(4, noise="club", **DISCRETE)
    observations = env.reset(seed=8)[0]
    seen = rows_of(ahead.ForesightView(1).at(env.options)(Positions.of(env), observations))
    spread = prospects.spread_of(env.tables.rules.noise, env.tables.rules.physics)
    for stroke in (1, 10):
        points, worth, cue, on = (np.zeros((5, 4)) for _ in range(4))
        next_best = np.zeros((5, 4, 3))
        for i, key in enumerate(EVEN_SAMPLES):
            other.reset(options={"states": env.get_state()})
            other.tables.streams[:] = (key, 0)
            _, points[i], ended, _, _ = other.step(ahead.PICKS[np.full(4, stroke)])
            values, chances = prospects.prospects_of(Positions.of(other), spread, most=8)
            on[i], worth[i] = ~ended, ~ended * values
            next_best[i] = ~ended[:, None] * -np.sort(-chances)[:, :3]
            cue[i] = ~ended * other.tables.positions[:, 0, 1] / pot_view.HALF_LENGTH
        row, goes_on = seen[:, stroke], np.maximum(1, on.sum(0))
        for entry, expected in (
            (ahead.POINTS, points.mean(0) / 7.0),
            (ahead.SCORED, (points > 0).mean(0)),
            (ahead.GOES_ON, on.mean(0)),
            (ahead.VALUE, worth.mean(0) / 25.0),
            (ahead.SPREAD, worth.std(0) / 25.0),
            (slice(ahead.FIRST, ahead.THIRD + 1), next_best.sum(0) / goes_on[:, None]),
            (ahead.CUE_Y, cue.sum(0) / goes_on),
        ):
            assert np.allclose(row[:, entry], expected, atol=1e-6), entry
        assert (next_best[..., 2] > 0).any() and 0 < on.mean() < 1


def test_foresight_says_which_stroke_it_is():
    """Strokes in the docstring's order: each of two pots, then speed, then top."""
    env = tables(6, noise="professional", layout="random:6", **DISCRETE)
    env.tables.game[:3, BALL_ON], env.tables.game[3:, BALL_ON] = int(BallOn.RED), int(BallOn.ANY_COLOUR)
    planner, at, masks = Planner(env), Positions.of(env), env.action_masks()[:, ahead.PICKS]
    rows = ahead.ForesightView(1).at(env.options).ahead(at, masks)
    chances = prospects.prospects_of(at, prospects.spread_of(planner.noise, planner.physics))[1]
    strokes = list(product((0, 1), (1.3, 2.3, 3.6, 5.3), (-0.4, 0.0, 0.4)))
    there = np.array([[chances[k, pot] > 0 for pot, _, _ in strokes] for k in range(6)])
    assert len(strokes) == ahead.STROKES_SEEN
    assert np.array_equal(rows[..., ahead.THERE] > 0, there)
    assert there[:3, -1].any() and there[3:, -1].any() and np.ptp(chances[:, :2], axis=1).max() > 0.1
    for entry, expected in (
        (ahead.CHANCE, [[chances[k, pot] for pot, _, _ in strokes] for k in range(6)]),
        (ahead.SPEED, [[speed / 6.3 for _, speed, _ in strokes]] * 6),
        (ahead.TOP, [[top / 0.4 for _, _, top in strokes]] * 6),
        (ahead.RED_ON, [[float(k < 3)] * len(strokes) for k in range(6)]),
    ):
        assert np.allclose(rows[..., entry], there * np.array(expected), atol=1e-6), entry


def test_worth_by_hand():
    """Points, and 25 for a value of 1."""
    rows = np.zeros((1, 3, ahead.ENTRIES))
    rows[0, :2, ahead.THERE] = 1.0
    rows[0, :, [ahead.POINTS, ahead.VALUE]] = (1.0, 1 / 7, 1.0), (0.0, 0.5, 1.0)
    assert np.allclose(ahead.worth_by_rule(rows), [[7.0, 13.5, -np.inf]])


def test_noise_samples_are_even():
    errors = errors_of(first_of(EVEN_SAMPLES))
    likely = [-1.2816, -0.5244, 0.0, 0.5244, 1.2816]
    assert np.abs(np.sort(errors[:, [0, 3]], axis=0).T - likely).max() < 0.25
    assert np.abs(errors.mean(0)).max() < 0.15
    assert np.abs(np.corrcoef(errors[:, :4].T) - np.eye(4)).max() < 0.55
    _, least, median = find(len(EVEN_SAMPLES), keys=200, starts=1)
    assert unevenness(errors) < least < median / 2
    many = errors_of(first_of(range(1, 400_001)))  # standard errors: 0.0016 of a mean, 0.0022 of a variance
    assert np.abs(many.mean(0)).max() < 0.01 and np.abs(np.cov(many.T) - np.eye(5)).max() < 0.01
    assert unevenness(many[:2000]) < 0.01


def test_lookahead_plays_the_stroke_that_promises_most():
    env = tables(6, noise="professional", **DISCRETE)
    observations = env.reset(seed=0)[0]
    at, player = Positions.of(env), sn.player("foresight_rule")
    rows = rows_of(ahead.ForesightView().at(env.options)(at, observations))
    picks = ahead.PICKS[ahead.worth_by_rule(rows).argmax(1)]
    expected = Planner(env).strokes_of(at, np.arange(6), picks)[0]
    assert np.array_equal(player.at(env).play(at, np.arange(6)).values, expected)
    far = play_visits(player, 60, first_seed=5)
    plain = play_visits(sn.player("ghost_ball"), 60, first_seed=5)
    assert summary(far)["points_a_visit"] > 2.0 * summary(plain)["points_a_visit"]
