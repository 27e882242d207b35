"""Do both balls come to rest where it is predicted, as far as nothing else moves, and are fouls told? Judged by simulated
shots."""

import numpy as np

import snooker_env as sn
from snooker_env.planning import Position, Positions
from snooker_env.planning.aims import law_of
from snooker_env.planning.learned.frame_strokes import POT_SIZE, SAFETIES, SHARED
from snooker_env.planning.learned.stroke_value import LOOKS
from snooker_env.planning.proposals import safeties
from snooker_env.planning.worth import lead_of
from snooker_env.players.search_player import StrokeValuePlayer, Tactician
from snooker_env.players.weights import StrokeLayers, learned_strokes
from snooker_env.tasks import Noise
from snooker_env.tasks import cue_ball_path as path

OPTIONS = {"task": "frame", "noise": "none", "cue": "real", **sn.players.FRAMES}


def predicted(search, at, rows, strokes):
    """Of strokes without errors: what is predicted, where the balls lie then, and which ball is met and whether fairly."""
    m, none = len(rows), (np.zeros((1, 5)), Noise().pack(0.02625, real=True))
    out, places = np.empty((m, 2, path.SEEN)), np.empty((m, 22, 2))
    met, fair = np.empty(m, np.int64), np.empty(m, np.bool_)
    balls, law = (at.positions, at.on_table), law_of(search.dynamics, at)
    path.predict(balls, rows, strokes, np.empty((0, 2), np.int64), *none, law, out, met)
    path.leave_contacts((*balls, at.game), rows, met, out, (places, fair))
    return out, places, (met, fair)


def contacts(frame, position, strokes):
    """The same of strokes in a position of a visit, as one of the frame that ``frame`` begins."""
    visit, begun = Positions.of(position), Positions.of(frame)
    at = Positions(visit.positions, visit.on_table, begun.game, begun.saved)
    search = StrokeValuePlayer(StrokeLayers()).at(frame).search
    return predicted(search, at, np.zeros(len(strokes), int), np.array(strokes))


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
    out, places, told = predicted(player.search, at, rows, strokes)
    after = Tactician(30).at(frame).judge.outcomes(at, rows, strokes, np.zeros((m, 5)))
    return at, rows, out, (places, *told), after


def test_both_balls_come_to_rest_where_it_is_predicted():
    at, rows, out, (places, met, legal), after = compared(60)
    assert len(rows) > 500
    every = np.arange(len(rows))
    wanted, some = at.positions[rows], np.flatnonzero(met)
    wanted[some, 0], wanted[some, met[some]] = out[some, :, : path.Y + 1].swapaxes(0, 1)
    assert (places == wanted).all()
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
    foul, told = swing <= -4.0, ~legal | (out[:, 0, path.LOST] > 0.0)
    assert foul.sum() > 20 and told[foul].mean() > 0.9 and told[~foul].mean() < 0.1
    in_off = foul & legal  # it met the right ball first
    assert in_off.sum() > 5 and (out[in_off, 0, path.LOST] > 0.0).mean() > 0.5


def test_what_strokes_seem_to_be_worth_is_about_what_they_are_worth():
    """Of pots and of safeties, before anything of frames is learned: beside the same strokes under 32 execution errors."""
    frame = sn.SnookerVectorEnv(24, layout="opened", **OPTIONS | {"noise": "professional"})
    frame.reset(seed=3)
    at, rng = Positions.of(frame), np.random.default_rng(4)
    search = StrokeValuePlayer(StrokeLayers(learned_strokes().visits)).at(frame).search
    looked, judge = search.look(at, np.arange(len(at))), Tactician(30).at(frame).judge
    seems = search.scores(looked.seen)
    for kind, alike in ((slice(0, LOOKS), 0.75), (slice(LOOKS, None), 0.45)):
        rows, which = np.nonzero(looked.there[:, kind])
        some = rng.permutation(len(rows))[:300]
        rows, which = rows[some], which[some] + kind.start
        again, errors = np.repeat(rows, 32), judge.noise.draw_errors(rng, 32 * len(rows))
        strokes = np.repeat(looked.strokes[rows, which], 32, axis=0)
        worth = judge.gains(at, again, strokes, errors)[:, 1].reshape(-1, 32).mean(axis=1)
        said = seems[rows, which]
        assert np.corrcoef(said, worth)[0, 1] > alike
        assert abs(said.mean() - worth.mean()) < 9.0
    # of the safeties, under every error that is predicted
    fouls = looked.seen[rows, which, SHARED + POT_SIZE + 4] == 1.0
    assert fouls.sum() > 20 and abs(said[fouls].mean() - worth[fouls].mean()) < 12.0
    assert said[fouls].mean() < said[~fouls].mean()


def test_what_is_predicted_to_foul_is_not_played_where_anything_else_is_there():
    frame = sn.SnookerVectorEnv(24, layout="opened", **OPTIONS | {"noise": "professional"})
    frame.reset(seed=3)
    at, keys = Positions.of(frame), np.arange(24)
    search = sn.player("stroke_value").at(frame).search
    looked = search.look(at, keys)
    fouls = looked.there & (looked.seen[..., SHARED + POT_SIZE + 4] > 0.5)
    some = 0
    for k, one in enumerate(search.rank(at, keys)):
        ranked = {stroke.tobytes() for stroke in one.strokes.values}
        poor = [stroke.tobytes() in ranked for stroke in looked.strokes[k, fouls[k]]]
        some += len(poor)
        assert not any(poor) or fouls[k].sum() == looked.there[k].sum()
    assert some > 20


def test_a_touching_ball_that_is_on_counts_as_struck_and_a_push_is_a_foul():
    frame = sn.SnookerVectorEnv(1, **OPTIONS)
    frame.reset(seed=0)
    touching = Position(cue=(0.0, 0.0), reds=[(0.0, 0.05252), (0.0, -0.8)], black=(0.5, 0.0), on="red")
    for turn, fair in ((0.5, False), (-0.5, True), (0.0, True)):  # into it, at the other red, at the black
        _, _, (met, legal) = contacts(frame, touching, [[1.5, 0.0, 0.0, turn * np.pi, 0.0]])
        assert met[0] > 0 and legal[0] == fair
    apart = Position(cue=(0.0, 0.0), reds=[(0.0, 0.2), (0.0, -0.8)], black=(0.5, 0.0), on="red")
    for turn, fair in ((0.5, True), (-0.5, True), (0.0, False)):
        assert contacts(frame, apart, [[1.5, 0.0, 0.0, turn * np.pi, 0.0]])[2][1][0] == fair
