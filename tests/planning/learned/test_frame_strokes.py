"""Do both balls come to rest where it is predicted, as far as nothing else moves, and are fouls told? Judged by simulated
shots."""

import numpy as np

import snooker_env as sn
from snooker_env.planning import Position, Positions
from snooker_env.planning.learned import cue_ball_path as path
from snooker_env.planning.learned.frame_strokes import SAFETIES
from snooker_env.planning.proposals import safeties
from snooker_env.planning.strokes import law_of
from snooker_env.planning.worth import lead_of
from snooker_env.players.stroke_value import StrokeValuePlayer
from snooker_env.players.tactician import Tactician
from snooker_env.players.weights import StrokeLayers
from snooker_env.tasks import Noise

OPTIONS = {"task": "frame", "noise": "none", "cue": "real", **sn.players.FRAMES}


def compared(n):
    """Safeties of frames that ``ghost_ball`` has begun: rows, positions, strokes, what is predicted and what follows."""
    frame = sn.SnookerVectorEnv(n, **OPTIONS)
    frame.reset(seed=8)
    plain, player = sn.player("ghost_ball").at(frame), StrokeValuePlayer(StrokeLayers()).at(frame)
    for k in range(9):
        at = Positions.of(frame)
        frame.step(plain.play(at, np.arange(n) + 50 * k).actions(frame.options, at))
    at = Positions.of(frame)
    at = at[np.flatnonzero(~at.in_hand & ~at.choice & ~at.over)]
    made = safeties(player.search, at.as_visits(), SAFETIES, np.arange(len(at)))
    rows, which = np.nonzero(made.chances > 0.0)
    strokes, m = made.strokes[rows, which], len(rows)
    out, met, legal = np.empty((m, 2, path.SEEN)), np.empty(m, np.int64), np.empty(m, np.bool_)
    places, none = np.empty((m, 22, 2)), (np.zeros((1, 5)), Noise().pack(0.02625, real=True))
    balls, law = (at.positions, at.on_table, at.game), law_of(player.search.dynamics, at)
    path.predict_contacts(balls, rows, strokes, *none, law, out, (places, met, legal))
    after = Tactician(30).at(frame).search.outcomes(at, rows, strokes, np.zeros((m, 5)))
    return at, rows, out, (places, met, legal), after


def test_both_balls_come_to_rest_where_it_is_predicted():
    at, rows, out, (places, met, legal), after = compared(60)
    assert len(rows) > 500
    every = np.arange(len(rows))
    swing = lead_of(after) - lead_of(at)[rows]
    moved = np.hypot(*np.moveaxis(after.positions - at.positions[rows], -1, 0)) > 1e-9
    moved[~at.on_table[rows]] = False
    hit = moved[every, met]
    moved[every, met] = False
    lost = (out[..., path.LOST] > 0.0).any(axis=1)
    alone = (swing == 0.0) & ~moved[:, 1:].any(axis=1) & hit & (met > 0) & ~lost
    assert alone.sum() > 60
    for ball in (np.zeros_like(met), met):
        off = np.hypot(*(places - after.positions)[every, ball][alone].T)
        assert np.median(off) < 0.01 and np.quantile(off, 0.8) < 0.1
    # one knows of nine in ten fouls, and of few strokes that are none says so
    foul, told = swing <= -4.0, ~legal | (out[:, 0, path.LOST] > 0.0)
    assert foul.sum() > 20 and told[foul].mean() > 0.6 and told[~foul].mean() < 0.1


def test_a_stroke_that_meets_a_ball_that_is_not_on_is_told():
    frame = sn.SnookerVectorEnv(1, **OPTIONS)
    player = StrokeValuePlayer(StrokeLayers()).at(frame)
    frame.reset(seed=0)
    one, begun = (
        Positions.of(Position(cue=(0.0, -0.5), reds=[(0.0, 0.5)], black=(0.3, 0.0), on="red")),
        Positions.of(frame),
    )
    one = Positions(one.positions, one.on_table, begun.game, begun.saved)
    strokes = np.array([[2.0, 0.0, 0.0, 0.5 * np.pi, 0.0], [2.0, 0.0, 0.0, np.arctan2(0.5, 0.3), 0.0]])
    strokes = np.concatenate([strokes, [[2.0, 0.0, 0.0, 0.0, 0.0]]])
    out, met, legal, places = (
        np.empty((3, 2, path.SEEN)),
        np.empty(3, np.int64),
        np.empty(3, np.bool_),
        np.empty((3, 22, 2)),
    )
    law, none = law_of(player.search.dynamics, one), (np.zeros((1, 5)), Noise().pack(0.02625, real=True))
    balls = one.positions, one.on_table, one.game
    path.predict_contacts(balls, np.zeros(3, int), strokes, *none, law, out, (places, met, legal))
    assert legal.tolist() == [True, False, False] and met[2] == 0 < min(met[:2])
