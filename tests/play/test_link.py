"""Is a whole game written down, and played again elsewhere, as it was? By its first table and what was asked for."""

import json
from math import pi

import numpy as np
import pytest

from snooker_env.advice import CueStroke
from snooker_env.game.balls import PINK
from snooker_env.game.fouls import AUTO
from snooker_env.planning import Position
from snooker_env.play.game_record import MOST_ACTS, open_game, record_game
from snooker_env.play.session import DECLINED, Session
from snooker_env.players.table_report import nominations_of
from snooker_env.simulation import SimulationError
from tests.play.test_session import standing
from tests.playing import EASY, STRAIGHT

KINDS = ("choice", "declare", "nominate", "place", "practice", "cue")


def anything(seed, acts=80, **game):
    """A game in which all that can be asked for is: random strokes, choices, places, nominations, seats."""
    rng, session = np.random.default_rng(seed), Session(seed=seed)
    session.new(layout="break_off", seed=seed, **game)
    session.noise[:] = ["club", "professional"]
    for k in range(acts):
        frame = session.frame
        if frame.phase == "over":
            break
        if frame.phase == "choice":
            session.choose(frame.choices[rng.integers(len(frame.choices))])
            continue
        if k % 20 == 10:
            session.noise[0], session.cue = ("none", "free") if session.cue == "real" else ("club", "real")
        session.practice = k % 30 > 24
        if frame.in_hand and k % 3:
            session.place(*rng.uniform(-1.0, 1.0, 2).tolist())
        named = nominations_of(session.frame)
        nominated = DECLINED if frame.free_ball and k % 2 else int(rng.choice(named)) if named else AUTO
        speed, aim, side, top = rng.uniform((0.5, -pi, -0.3, -0.3), (7.0, pi, 0.3, 0.3)).tolist()
        stroke = CueStroke(speed=speed, aim=aim, side=side, top=top)
        session.play(stroke, nominated=nominated)
    return session


def sent(session):
    """What is written down, as it arrives."""
    return json.loads(json.dumps(record_game(session)))


@pytest.mark.parametrize("game", ["snooker", "six_red"])
def test_a_game_is_played_again_bit_by_bit(game):
    kinds = set()
    for seed in range(6):
        session, other = anything(seed, game=game), Session(seed=99)
        if session.frame.phase == "choice":
            session.choose("play")
        if session.frame.phase == "stroke":
            session.concede()
        saved = sent(session)
        open_game(other, saved)
        assert [act.state for act in other.acts[1:]] == [act.state for act in session.acts[1:]]
        assert [act.played and act.played.cue for act in other.acts[1:]] == [
            act.played and act.played.cue for act in session.acts[1:]
        ]
        assert (other.noise, other.practice, other.cue, other.game) == (
            session.noise,
            session.practice,
            session.cue,
            game,
        )
        assert sent(other) == saved and other.begun == 2
        while other.undo():
            pass
        assert other.state == session.acts[0].state and other.redo()
        kinds |= {name for act in saved["acts"] for name in act if act[name]}
    assert kinds >= set(KINDS)


def test_it_begins_at_the_last_new_table_and_ends_before_what_was_undone():
    session = anything(3, acts=5)
    session.noise[:], session.practice = ["none", "none"], False
    session.set_up(Position(**EASY), scores=(3, 4), striker=1, free_ball=False)
    assert sent(session)["acts"] == [] and sent(session)["state"] == session.state
    session.play(CueStroke(speed=2.0, aim=STRAIGHT))
    session.play(CueStroke(speed=1.0, aim=1.0))
    session.undo()
    saved, other = sent(session), Session()
    open_game(other, saved)
    assert saved["state"] == session.acts[-3].state and len(saved["acts"]) == 1
    assert other.state == session.state and len(other.strokes) == 1 and other.frame.scores == (3, 5)
    saved = json.loads(json.dumps(session.save()))
    open_game(other, saved)
    assert other.state == session.state and not other.strokes and len(json.dumps(saved)) < 5000


def test_a_free_ball_that_was_declined_is_declined_again():
    asked = {}
    for nominated in (AUTO, DECLINED, PINK):
        session, other = standing(EASY, free_ball=True), Session()
        session.play(CueStroke(speed=2.0, aim=STRAIGHT), nominated=nominated)
        open_game(other, sent(session))
        assert other.state == session.state
        asked[nominated] = sent(session)["acts"][0]["nominate"], session.frame.scores
    assert asked == {AUTO: (None, (1, 0)), DECLINED: ("none", (1, 0)), PINK: ("pink", (0, 4))}


def pushed(saved, by):
    """With the cue ball elsewhere after its stroke, by so many metres."""
    x, y = saved["acts"][0]["left"]["cue"]
    saved["acts"][0]["left"]["cue"] = [x, y + by]


ACT = r"^saved\.acts\[0\]\."
WRONG = {  # what is done to a record | what is said
    "s.update(acts={})": r"^saved\.acts = something else: must be a list of at most 1000",
    "s.update(acts=s['acts'] * (MOST_ACTS + 1))": "must be a list of at most 1000",
    "s.update(acts=[1])": ACT + "act = 1: must be an object",
    "s['acts'][0].update(speed=99)": ACT + "speed = 99",
    "s['acts'][0].pop('aim')": ACT + "stroke",
    "s['acts'][0].update(spin=1)": ACT + "field = 'spin'",
    "s['acts'][0].update(noise='perfect')": ACT + "noise = 'perfect'",
    "s['acts'][0].pop('practice')": ACT + "practice = None",
    "s['acts'][0].update(cue=[])": ACT + "cue",
    "s['acts'][0].update(place=[0.0, -1.2])": ACT + "place",
    "s['acts'][0].update(nominate='red 1')": ACT + "nominate = 'red 1'",
    "s['acts'].insert(1, {'choice': 'play'})": r"^saved\.acts\[1\]\.choice = 'play'",
    "s['acts'].append({'declare': 'claim'})": r"^saved\.acts\[2\]\.lead",
    "s['acts'].append({'declare': 'resign'})": r"^saved\.acts\[2\]\.declare = 'resign'",
    "s['acts'].append({'declare': 'concede', 'aim': 1})": r"^saved\.acts\[2\]\.field = 'aim'",
    "s['acts'][0].update(aim=1.0)": ACT + r"left\.scores = \[1, 0\]: must be \[0, 0\]",
    "s['acts'][1].update(speed=1.1)": r"^saved\.acts\[1\]\.left\.[\w ]+ = \[.*\]: must be \[.*another version",
    "s['acts'][0].pop('left')": ACT + "left = None: must be an object",
    "s['acts'][0]['left'].pop('cue')": ACT + r"left\.cue",
    "s['acts'][0]['left'].pop('red 1')": ACT + r"left\.red 1 = \[.*: must be off the table",
    "pushed(s, 1.3e-3)": ACT + r"left\.cue",
    "s['acts'][0]['left'].update(pink='x')": ACT + r"left\.pink = 'x'",
    "s['acts'][0]['left'].update(scores=[1, None])": ACT + "left = None: must be a finite",
    "s['acts'][0]['left'].update(white=[0, 0])": ACT + "field of left = 'white'",
    "s.pop('noise')": "^saved = version 1",
    "s.update(format='x')": "must be a saved game",
    "s.update(noise=['none', 'perfect'])": r"saved.noise\[1\]",
    "s.update(more=1)": "must be version 1",
    "s.update(cue='long')": r"saved\.cue",
    "s['state'].update(stream=[1])": "stream",
    "s['state'].update(rng={})": "must be a dict with",
    "s['state']['positions'][1].__setitem__(0, 5.0)": r"positions\[1\]",
    "s['state']['frame'].update(scores=[-1, 0])": r"scores\[0\]",
    "s['state']['frame'].update(striker=2)": "striker",
}


@pytest.mark.parametrize(("change", "words"), WRONG.items(), ids=WRONG)
def test_what_is_not_sound_is_refused_and_changes_nothing(change, words):
    session = standing(EASY)
    session.play(CueStroke(speed=2.0, aim=STRAIGHT))
    session.play(CueStroke(speed=1.0, aim=-2.5))
    saved, other = sent(session), standing(EASY)
    before, acts = other.save(), list(other.acts)
    eval(change, {"s": saved, "pushed": pushed, "MOST_ACTS": MOST_ACTS})
    with pytest.raises(ValueError, match=words):
        open_game(other, saved)
    assert other.save() == before and other.acts == acts


def test_an_act_that_cannot_be_computed_is_named(monkeypatch):
    session = standing(EASY)
    session.play(CueStroke(speed=2.0, aim=STRAIGHT))

    def fails(self, *args, **kwargs):
        raise SimulationError("shot 0 has too many events")

    monkeypatch.setattr(Session, "play", fails)
    with pytest.raises(ValueError, match=r"^saved\.acts\[0\]\.shot 0 has too many events"):
        open_game(Session(), sent(session))
