"""Is the cue ball where it is predicted to be, as far as no other ball moves in its way? Judged by simulated shots."""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.planning import Planner, Position, Positions, pots
from snooker_env.planning.aims import Dynamics, law_of
from snooker_env.planning.learned.value_features import value_features
from snooker_env.planning.stroke_columns import AIM
from snooker_env.players import VISITS
from snooker_env.tasks import STROKES, Noise, cue_ball_path
from snooker_env.tasks.noise import Spread


def predicted(at, rows, strokes, options, pot=None):
    """What is predicted of strokes at the widest pots of ``at[rows]``, or at ``pot``, and the positions after them."""
    direct, n = pots(at, most=1), len(rows)
    at_pots = np.stack([direct.ball[rows, 0], direct.pocket[rows, 0]], axis=1)
    if pot is not None:
        at_pots[:] = pot
    out, none, on = np.empty((n, 1, cue_ball_path.SEEN)), np.empty(0, np.int64), np.empty(n, np.int64)
    places, there = np.empty((n, 22, 2)), np.empty((n, 22), np.bool_)
    balls = at.positions, at.on_table
    law = law_of(Dynamics.of(sn.Options(**options).rules), at)
    exact = np.zeros((1, 5)), Noise().pack(0.02625)
    cue_ball_path.predict(balls, rows, strokes, at_pots, *exact, law, out, none)
    cue_ball_path.leave_pots((*balls, at.ball_on.copy()), rows, at_pots, out[:, 0], (places, there, on))
    return out[:, 0], Positions(places, there, np.column_stack([on, np.zeros((n, 4), np.int64)]))


@pytest.fixture(scope="module", params=["free", "real"])
def pots_of_600(request):
    """Choices at the widest pots of random tables: positions, rows, strokes, what follows, and what is predicted."""
    options = {"cue": request.param, "noise": "none"}
    tables = sn.SnookerVectorEnv(600, **options, **VISITS)
    tables.reset(seed=4)
    at, rng = Positions.of(tables), np.random.default_rng(5)
    rows = np.flatnonzero(pots(at).ball[:, 0] >= 0)
    planner, choices = Planner({"action": "discrete", **options}), rng.integers(STROKES, size=len(rows))
    strokes, _ = planner.strokes_of(at, rows, choices)
    return at, rows, strokes, planner.play(at, rows, choices), predicted(at, rows, strokes, options)


def test_the_path_is_the_engines_as_long_as_nothing_else_is_met(pots_of_600):
    at, rows, _, stops, (out, _) = pots_of_600
    direct = pots(at, most=1).ball[rows, 0]
    moved = np.abs(stops.places - at.positions[rows]).max(axis=2) > 1e-9
    moved[np.arange(len(rows)), direct] = False
    alone = (stops.points > 0) & ~moved[:, 1:].any(axis=1) & (stops.potted[:, 0] < 0)
    off = np.hypot(*(stops.places[:, 0] - out[:, [cue_ball_path.X, cue_ball_path.Y]]).T)
    none, some = (alone & (out[:, cue_ball_path.NOSES] == k) for k in (0, 1))
    assert none.sum() > 20 and some.sum() > 20
    assert np.median(off[none]) < 0.003 and np.quantile(off[none], 0.95) < 0.03
    assert np.median(off[some]) < 0.01 and np.quantile(off[some], 0.9) < 0.1
    assert (out[alone, cue_ball_path.BALLS] == 0.0).mean() > 0.97
    assert (out[alone, cue_ball_path.MISSED] == 0.0).all()


def test_a_cue_ball_that_will_be_lost_is_told(pots_of_600):
    _, _, _, stops, (out, _) = pots_of_600
    lost, told = stops.potted[:, 0] >= 0, out[:, cue_ball_path.LOST] > 0.0
    assert lost[told].mean() > 5.0 * lost.mean() and told[lost].mean() > 0.4 and told.sum() > 3


def test_what_is_left_is_what_the_referee_leaves(pots_of_600):
    at, rows, _, stops, (_, left) = pots_of_600
    meant = stops.potted[np.arange(len(rows)), pots(at, most=1).ball[rows, 0]] >= 0
    good = meant & (stops.points > 0) & stops.goes_on & ((stops.potted[:, 1:] >= 0).sum(axis=1) == 1)
    assert good.sum() > 100
    assert np.array_equal(left.ball_on[good], stops.afterstates.ball_on[good])
    assert np.array_equal(left.on_table[good], stops.afterstates.on_table[good])


@pytest.mark.parametrize(
    ("position", "after", "on"),
    [
        (Position(cue=(0.0, 0.9), black=(0.4, 1.3), on="black"), 0, 8),  # nothing is left
        (Position(cue=(0.0, 0.9), pink=(0.4, 1.3), black=(0.0, -0.5), on="pink"), 1, 7),
        (Position(cue=(0.0, 0.9), black=(0.4, 1.3), yellow=(-0.2, -1.0), on="any_colour"), 2, 2),
        (Position(cue=(0.0, 0.9), black=(0.4, 1.3), reds=[(0.4, -1.0)], on="any_colour"), 2, 1),
        (Position(cue=(0.0, 0.9), reds=[(0.4, 1.3)], black=(0.0, -0.5), on="red"), 1, 0),
    ],
)
def test_which_ball_is_on_next(position, after, on):
    at = Positions.of(position)
    strokes = np.zeros((1, 5))
    strokes[0, 0], strokes[0, AIM] = 2.0, 0.3
    out, left = predicted(at, np.array([0]), strokes, {})
    assert left.ball_on.tolist() == [on] and left.on_table[0, 1:].sum() == after
    assert out[0, cue_ball_path.MISSED] == 2.0 and out[0, cue_ball_path.NOSES] == 0.0
    assert left.positions[0, 0].tolist() == out[0, [cue_ball_path.X, cue_ball_path.Y]].tolist()


def test_balls_that_were_met_and_the_potted_one_are_met_no_more():
    """It pots the black, comes back off the cushion through its place, and meets a red
    that it follows once."""
    strokes = np.zeros((1, 5))
    strokes[0, 0], strokes[0, 2], strokes[0, AIM] = 5.0, 0.3, np.pi / 2.0
    straight = Position(cue=(0.0, 0.5), black=(0.0, 1.4605), reds=[(0.0, 1.3)], on="any_colour")
    out, _ = predicted(Positions.of(straight), np.array([0]), strokes, {}, (21, 3))
    assert out[0, cue_ball_path.BALLS] == 1.0 and out[0, cue_ball_path.NOSES] >= 1.0


def test_a_batch_is_as_each_row_where_only_the_cue_ball_lies_elsewhere():
    """The windows of balls are kept for such rows: the features must not depend on their neighbours."""
    tables = sn.SnookerVectorEnv(6)
    tables.reset(seed=2)
    at = Positions.of(tables)[np.repeat(np.arange(6), 4)]
    at.positions[:, 0] += np.random.default_rng(0).uniform(-0.02, 0.02, (24, 2))
    at.on_table[9:11, 21] = False
    spread = Spread(1e-3)
    together = value_features(at, spread)
    assert all(np.array_equal(value_features(at[[k]], spread)[0], together[k]) for k in range(24))
