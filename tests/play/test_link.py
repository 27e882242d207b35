"""Is a whole game passed on as text, and played again elsewhere, bit for bit? And is everything else refused in one sentence?"""

import json
import re
import zlib
from base64 import urlsafe_b64decode, urlsafe_b64encode
from contextlib import suppress
from itertools import pairwise
from math import pi

import numpy as np
import pytest

from snooker_env.advice import CueStroke
from snooker_env.game.balls import BLACK, CUE, PINK
from snooker_env.game.fouls import AUTO
from snooker_env.planning import Position
from snooker_env.play import link as module
from snooker_env.play.link import LONGEST, open_link, write_link
from snooker_env.play.session import DECLINED, STEP, Session, numbers_of, steps_of, stroke_of
from snooker_env.players.table_report import nominations_of
from snooker_env.simulation import SimulationError
from tests.play.test_session import standing
from tests.playing import EASY, STRAIGHT

KINDS = {"choice", "declare", "nominate", "place", "practice", "cue"}


def anything(seed, acts=80, *, agreed=False, **game):
    """A game in which all that can be asked for is: random strokes, choices, places, nominations, seats."""
    rng, session = np.random.default_rng(seed), Session(seed=seed)
    session.new(layout="break_off", seed=seed, **game)
    session.noise[:] = ["club", "professional"]
    for k in range(acts):
        frame = session.frame
        if frame.phase == "over":
            break
        if frame.phase == "choice":
            session.choose(frame.choices[0 if agreed else rng.integers(len(frame.choices))])
            continue
        if k % 20 == 10 and not agreed:
            session.noise[0], session.cue = ("none", "free") if session.cue == "real" else ("club", "real")
        session.practice = k % 30 > 24 and not agreed
        if frame.in_hand and k % 3:
            session.place(*rng.uniform(-1.0, 1.0, 2).tolist())
        named = nominations_of(session.frame)
        nominated = DECLINED if frame.free_ball and k % 2 else int(rng.choice(named)) if named else AUTO
        low, high = (0.5, -pi, -0.3, -0.3, -0.3), (7.0, pi, 0.3, 0.3, 0.3)
        speed, aim, side, top, elevation = rng.uniform(low, high).tolist()
        stroke = CueStroke(speed=speed, aim=aim, side=side, top=top, elevation=max(0.0, elevation))
        session.play(stroke, nominated=nominated)
    return session


@pytest.mark.parametrize("game", ["snooker", "six_red", "shoot_out"])
def test_a_game_is_played_again_bit_by_bit(game):
    kinds = set()
    for seed in range(6):
        session, other = anything(seed, game=game), Session(seed=99)
        if session.frame.phase == "choice":
            session.choose("play")
        if session.frame.phase == "stroke":
            session.concede()
        link = write_link(session)
        open_link(other, link)
        for here, there in zip(session.acts[1:], other.acts[1:], strict=True):
            assert (there.state, there.asked) == (here.state, here.asked)
            assert (there.played and there.played.cue) == (here.played and here.played.cue)
        for name in ("noise", "practice", "cue", "options", "state"):
            assert getattr(other, name) == getattr(session, name)
        assert write_link(other) == link and other.begun == 2
        while other.go_to(other.at - 1):
            pass
        assert other.state == session.acts[0].state and other.go_to(other.at + 1)
        asked = [item for act in session.acts for item in act.asked.items()]
        kinds |= {name for name, value in asked if value not in (None, False, AUTO)}
    assert kinds >= KINDS - ({"choice", "declare"} if game == "shoot_out" else set())


def test_strokes_and_places_are_on_the_point_of_the_grid_that_is_nearest():
    rng, high = np.random.default_rng(2), (7.0, 0.3, 0.3, pi, 0.3)
    half = np.array([0.5 / 512, 0.5 / 512, 0.5 / 512, pi / 2**22, 0.5 / 1024])
    for numbers in rng.uniform((0.5, -0.3, -0.3, -pi, 0.0), high, (200, 5)).tolist():
        wish = CueStroke(**dict(zip(("speed", "side", "top", "aim", "elevation"), numbers, strict=True)))
        assert (np.abs(stroke_of(numbers_of(wish)).numbers() - numbers) < 1.000001 * half).all()
    places = rng.uniform(-1.8, 1.8, (200, 2))
    assert np.abs(steps_of(places) * 2.0**-21 - places).max() <= 2.0**-22


def test_balls_come_to_rest_on_the_grid_or_where_they_lay():
    session, most = anything(5, acts=40), 0.0
    for before, act in pairwise(session.acts):
        after, on = np.array(act.state["positions"]), np.array(act.state["on_table"])
        still = (after == before.state["positions"]).all(axis=1)
        on[0] &= not act.state["frame"]["in_hand"]
        assert (steps_of(after) * STEP == after).all(axis=1)[on & ~still].all()
        if act.played is not None:
            most = max(most, np.abs(act.played.positions - after)[on].max())
    assert 0.1 * STEP < most <= 4.5 * STEP  # what lay between two steps has a free one beside it


def test_a_game_begins_at_the_last_new_table_and_ends_before_what_was_undone():
    session = anything(3, acts=5)
    session.noise[:], session.practice = ["none", "none"], False
    session.set_up(Position(**EASY), scores=(3, 4), striker=1, free_ball=False)
    first = session.state
    session.play(CueStroke(speed=2.0, aim=STRAIGHT))
    session.play(CueStroke(speed=1.0, aim=1.0))
    session.go_to(session.at - 1)
    other = Session()
    open_link(other, write_link(session))
    assert other.acts[0].state == first and len(other.acts) == 2
    assert other.state == session.state and other.frame.scores == (3, 5)


def test_a_free_ball_that_was_declined_is_declined_again():
    scores = {}
    for nominated in (AUTO, DECLINED, PINK):
        session, other = standing(EASY, free_ball=True), Session()
        session.play(CueStroke(speed=2.0, aim=STRAIGHT), nominated=nominated)
        open_link(other, write_link(session))
        assert other.state == session.state and other.acts[-1].asked == session.acts[-1].asked
        scores[nominated] = session.frame.scores
    assert scores == {AUTO: (1, 0), DECLINED: (1, 0), PINK: (0, 4)}


@pytest.mark.slow
def test_sixty_strokes_have_less_than_two_kilobytes():
    for seed in range(3):
        session = anything(seed, acts=400, agreed=True)
        strokes = len(session.strokes)
        assert strokes >= 60 and len(write_link(session)) < 2048 * max(1.0, strokes / 60)


def test_another_processor_takes_the_places_of_the_link(monkeypatch):
    """Its own are elsewhere by as much as last bits may come to; further off is said, with the stroke."""
    session = anything(7, acts=30, agreed=True)
    link, settle = write_link(session), Session._settle

    def shake(by):
        def settled(self, before):
            settle(self, before)
            places, on_table = self.tables.positions[0], self.tables.on_table[0]
            moved = (np.abs(places - before) > 1e-3).any(axis=1) & on_table
            places[moved] += rng.uniform(-by, by, (moved.sum(), 2))

        rng = np.random.default_rng(0)
        monkeypatch.setattr(Session, "_settle", settled)

    shake(2e-4)
    other = Session()
    open_link(other, link)
    assert other.state == session.state
    shake(3e-3)
    before = other.state, list(other.acts)
    with pytest.raises(
        ValueError, match=r"^link, stroke 1: what it leaves = other places or scores here: must be as"
    ):
        open_link(other, link)
    assert (other.state, other.acts) == before


def altered(link, **parts):
    """A link with other bytes and the right sum."""
    raw = bytearray(urlsafe_b64decode(link + "=" * (-len(link) % 4)))[: -module.TAIL]
    for at, byte in parts.items():
        raw[int(at[1:])] ^= byte
    return urlsafe_b64encode(bytes(raw) + zlib.crc32(raw).to_bytes(4, "big")).decode().rstrip("=")


def test_what_is_not_sound_is_refused_in_one_sentence_and_changes_nothing(monkeypatch):
    session = standing(EASY)
    session.play(CueStroke(speed=2.0, aim=STRAIGHT))
    session.play(CueStroke(speed=1.0, aim=-2.5))
    link, other = write_link(session), standing(EASY)
    before, acts = other.save(), list(other.acts)
    damaged = r"^link = \d+ characters: must be whole: this one is damaged, copy it again"
    raw = urlsafe_b64decode(link + "=" * (-len(link) % 4))
    wrong = {
        None: "^link = a NoneType: must be a text of at most 30000",
        "A" * (LONGEST + 1): "^link = 30001 characters",
        "": damaged,
        "é" * 40: damaged,
        link[:-4]: damaged,
        link + "A": damaged,
        link + "AAAA": damaged,
        altered(link, b0=1): "^version = '1.0.0'",
        altered(link, b2=3): r"^version = '1.3.0': must be 1\.0\.0, as here",
        altered(link, b5=1): "^physics = other constants: must be as here",
        altered(link, b15=1): "^link = no table at its beginning",
    }
    wrong |= {urlsafe_b64encode(raw[:k]).decode().rstrip("="): damaged for k in range(len(raw))}
    for k in range(8 * len(raw)):  # each bit
        bits = bytearray(raw)
        bits[k // 8] ^= 1 << k % 8
        wrong[urlsafe_b64encode(bits).decode().rstrip("=")] = damaged
    for one, words in wrong.items():
        with pytest.raises(ValueError, match=words):
            open_link(other, one)
    assert other.save() == before and other.acts == acts
    rng, said = np.random.default_rng(1), set()
    number = module.HEAD + module.TABLE + int.from_bytes(raw[module.HEAD : module.HEAD + module.TABLE], "big")
    for k in range(
        300
    ):  # with the right sum: other strokes and places; then another table, which may be sound
        at = int(
            rng.integers(number, len(raw) - module.TAIL) if k < 200 else rng.integers(module.HEAD, number)
        )
        with pytest.raises(ValueError) if k < 200 else suppress(ValueError) as error:
            open_link(other, altered(link, **{f"b{at}": int(rng.integers(1, 256))}))
        if k < 200:
            assert other.save() == before and other.acts == acts
            said.add(re.sub(r"[ =].*", "", re.sub(r"^link, stroke \d: ", "stroke: ", str(error.value))))
    assert "stroke:" in said and len(said) < 5
    before, acts = other.save(), list(other.acts)
    with pytest.raises(ValueError, match=r"^link, stroke 1: shot 0 has too many events"):
        monkeypatch.setattr(Session, "play", fail)
        open_link(other, link)
    assert other.save() == before and other.acts == acts


def test_balls_that_overlap_are_refused_although_the_check_is_theirs(monkeypatch):
    monkeypatch.setattr(
        module, "NEAR", 2**24
    )  # else no place of a link is far enough from that of the stroke
    session = standing(EASY)
    places = session.play(CueStroke(speed=1.0, aim=-2.5)).state["positions"]
    open_link(Session(), write_link(session))
    places[CUE] = (steps_of(places[BLACK]) * STEP).tolist()
    with pytest.raises(ValueError, match=r"^link, stroke 1: what it leaves = other places"):
        open_link(Session(), write_link(session))


def fail(self, *args, **kwargs):
    raise SimulationError("shot 0 has too many events")


def test_by_link_two_persons_play_each_its_own_seat(game):
    game("new", layout="colours", seed=5, by_link=True)
    state = game.get("state")
    assert state["by_link"] == {"seat": 0, "visit": 0} and state["players"] == ["person", "friend_by_link"]
    state = game("stroke", speed=1.0, aim=2.0)["state"]
    assert (state["striker"], state["labels"]) == (1, ["You", "Friend"]) and not state["undo"]
    assert not state["thinking"] and "send the link" in state["words"]
    for name, fields in (
        ("stroke", {"choice": "play"}),
        ("concede", {}),
        ("undo", {}),
        ("players", {"practice": True}),
    ):
        with pytest.raises(ValueError, match=r"^(turn|game) = "):
            game(name, **fields)
    link = game("link")["link"]
    state = game("load", link=link, seat=None)  # as the friend opens it
    assert (state["by_link"], state["labels"]) == ({"seat": 1, "visit": 0}, ["Friend", "You"])
    if state["phase"] == "choice":
        game("stroke", choice="play")
    assert game("concede")["words"].startswith("Frame over: Friend won.")
    assert game("load", link=game("link")["link"], seat=None)["by_link"]["seat"] == 0
    with pytest.raises(
        ValueError, match=r"^link = an older or different game: must begin with what was played"
    ):
        game("load", link=link, seat=0)  # an older one
    assert game("load", link=link)["players"] == ["person", "person"]  # to watch, take back and try
    assert game("load", link=link, seat=0)["words"].startswith("It is your friend's turn")
    changed = standing(EASY)
    for noise in ("club", "none"):
        changed.noise[:] = [noise, noise]
        changed.play(CueStroke(speed=0.5, aim=-2.5))
        if changed.frame.phase == "choice":
            changed.choose("play")
    with pytest.raises(ValueError, match=r"^link, stroke \d+: noise = .*must stay as at the beginning"):
        game("load", link=write_link(changed), seat=None)
    assert json.dumps(game("new")["by_link"]) == "null"


def test_a_game_by_link_leaves_nothing_behind_and_begins_at_a_break(game):
    """The errors of those who sat here come back with them; a table that was set up with points is no beginning."""
    game("players", players=["person", "Walter"], noise=["professional", "club"])
    game("new", by_link=True)
    assert game.get("state")["noise"] == ["professional", "professional"]
    state = game("new")
    assert (state["players"], state["noise"]) == (["person", "Walter"], ["professional", "club"])
    forged = standing(EASY, scores=(0, 90))
    with pytest.raises(
        ValueError, match=r"^scores = \[0, 90\]: must be 0 at the beginning of a game by link"
    ):
        game("load", link=write_link(forged), seat=0)
