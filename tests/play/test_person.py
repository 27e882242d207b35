"""Is a person's play kept, told and judged, and are the opponents who they say?"""

import json
import time
from dataclasses import replace
from math import log

import pytest

from snooker_env.advice import CueStroke, Recorded
from snooker_env.planning import Position
from snooker_env.play.__main__ import main
from snooker_env.play.person import LEVELS, Person
from tests.play.shown import SETTLED, Shown
from tests.playing import EASY, STRAIGHT

PIP = {"players": ["person", "Pip"], "noise": ["amateur", "beginner"], "practice": False}


@pytest.fixture
def kept(game, tmp_path):
    """The person's file, of a game of "Pip" against a person with an amateur's errors."""
    game.service.person = Person(tmp_path / "own" / "person.json")
    game("players", **PIP)
    return game.service.person


def leave(game):
    """The person gives the frame up at its turn."""
    while game.service.thinking:
        game.service.wait(game.service.revision, 20.0)
    return game.get("state") if game.session.frame.phase == "over" else game("concede")


def end_frame(game, *, seed=1, strokes=0):
    """A frame from the break that the person gives up, after so many strokes."""
    game("new", layout="break_off", seed=seed)
    for _ in range(strokes):
        game("stroke", speed=3.0, aim=1.5)
    return leave(game)


def test_one_of_the_five_sits_down_with_a_name_and_is_no_adviser(game):
    for level in LEVELS:
        state = game("players", players=["person", level.name])
        assert state["labels"] == ["You", level.name] and level.name not in state["advisers"]
        assert game.service.seats.players[level.name].name == level.agent
    assert [one.elo for one in LEVELS] == sorted(one.elo for one in LEVELS)


def test_a_hint_that_comes_after_the_stroke_is_not_counted(game, monkeypatch):
    class Late(list):
        order, noise = "", "none"

    def late(*args, **how):
        game("stroke", speed=3.0, aim=1.5)
        return Late()

    revision = game.get("state")["revision"]
    monkeypatch.setattr("snooker_env.play.routes.advise", late)
    game("advise", revision=revision)
    state = game.get("state")
    assert (state["strokes"], state["hints"]) == (1, [0, 0])


def test_a_frame_is_kept_once_with_what_helped_and_the_strokes_for_the_coach(game, kept):
    assert not kept.path.exists()
    end_frame(game, strokes=1)
    (frame,) = game("person")["frames"]
    told = {"opponent": "Pip", "noise": ["amateur", "beginner"], "won": False, "hints": 0, "undone": 0}
    assert told.items() <= frame.items() and frame["rated"]
    (stroke,) = kept.strokes()
    assert (stroke.cue, stroke.physics) == ("real", game.session.options_with("none").rules.physics)
    assert game("undo")["undone"] == 1
    game("concede")
    assert len(game("person")["frames"]) == 1  # the same frame
    game("new", seed=9)
    game("concede")  # without a stroke
    game("new", seed=2)
    game("advise", n=1, samples=10)
    assert game.get("state")["hints"] == [1, 0]
    game("concede")
    game("players", noise=["none", "beginner"])
    end_frame(game, seed=3, strokes=1)
    game("new", seed=4)
    game("position", position=EASY)
    game("concede")  # of a position that was set up nothing is kept
    assert [one["rated"] for one in kept.read()["frames"]] == [True, False, False, False]


def test_only_a_fair_frame_against_one_opponent_is_rated(game, kept):
    def rated():
        return [one["rated"] for one in kept.read()["frames"]]

    game("new", seed=1)
    game("stroke", speed=3.0, aim=1.5)
    while game.service.thinking:
        game.service.wait(game.service.revision, 20.0)
    game("players", players=["person", "Vera"])  # in the middle of it
    leave(game)
    assert rated() == [False]
    game("players", **PIP)
    game("players", practice=True)
    game("new", seed=2)
    game("stroke", speed=3.0, aim=1.5)
    game("players", practice=False)
    leave(game)
    assert rated() == [False, False]
    game("players", players=["person", "person"], noise=["amateur", "amateur"])
    game("new", seed=3)
    game("concede")
    game("players", players=["person", "Vera"])  # after its end
    assert rated() == [False, False]


def test_a_rated_frame_is_fair_in_each_way_and_the_same_from_either_seat(game, kept):
    """Pip concedes to the person; what is unfair is so at the first strokes alone."""
    told, fair = [], {"hints": [0, 1]}  # the person's own first
    cases = [fair, {"layout": "opened"}, {"game": "six_red"}, {"cue": "free"}, {"undone": 1}]
    cases += [{"noise": ["club", "beginner"]}, {"noise": ["amateur", "club"]}, {"hints": [1, 0]}]
    for seat in (0, 1):
        side, noise = 1 - 2 * seat, ["amateur", "beginner"]
        game("players", players=["person", "Pip"][::side], noise=noise[::side])
        for changes in (*cases, {"practice": True}):  # there player 0 has every turn
            deal = {"layout": "break_off", "game": "snooker"}
            deal |= {name: value for name, value in changes.items() if name in deal}
            game("new", seed=8, breaker=seat, **deal)
            with game.service.acting() as session:
                for name in changes.keys() - deal.keys():
                    value = changes[name]
                    setattr(session, name, value[::side] if isinstance(value, list) else value)
                while len(session.strokes) < 3 or session.frame.striker == seat:
                    if len(session.strokes) == 2:
                        session.noise, session.practice, session.cue = noise[::side], False, "real"
                    if session.frame.phase == "choice":
                        session.choose("play")
                    session.play(CueStroke(speed=3.0, aim=1.5 + len(session.strokes)))
                session.concede()
            frame = game("person")["frames"][-1]
            assert (frame["rated"], frame["won"], frame["noise"]) == (changes is fair, True, noise), changes
        told.append([kept.read()["frames"][: len(cases)], kept.read()["strokes"][: 2 * len(cases)]])
        game("person", delete=True)
    first = told[0][0][0]
    assert told[0] == told[1] and first["breaks"] and len({*first["scores"]}) == 2


def test_what_could_not_be_kept_is_kept_as_soon_as_it_can_be(game, kept):
    kept.path.parent.write_text("in the way")
    assert "The frame was not kept: person = " in end_frame(game, strokes=1)["words"]
    for fields in ({"name": "Anna"}, {"delete": True}):
        with pytest.raises(ValueError, match="must be a file that can be written"):
            game("person", **fields)
    kept.path.parent.unlink()
    game("new", seed=5)
    assert len(kept.read()["frames"]) == 1 and "not kept" not in game.get("state")["words"]


def test_a_break_is_kept_as_a_whole(game, kept):
    game("new", layout="colours", seed=4)
    game("players", noise=["none", "none"])
    runs = []
    for _ in range(12):
        suggested = game("advise", agent="tactician_500", n=1, samples=10)["suggestions"][0]
        stroke = {name: suggested[name] for name in ("speed", "side", "top", "aim", "elevation")}
        runs.append(game("stroke", **stroke)["stroke"]["break"])
        if not runs[-1] or game.session.frame.phase == "over":
            break
    assert max(game.session.breaks[0]) == max(runs) > 5
    leave(game)
    frame = kept.read()["frames"][-1]
    assert max(frame["breaks"]) == max(runs) and len(frame["breaks"]) <= 2 and not frame["rated"]


def test_a_file_that_is_not_sound_is_one_error_and_stays_as_it_is(game, kept, capsys):
    end_frame(game, strokes=1)
    sound = json.loads(kept.path.read_text())
    frame = sound["frames"][0]
    for wrong in (
        "{",
        "[]",
        {**sound, "version": 2},
        {**sound, "name": 7},
        {**sound, "frames": [{**frame, "date": "yesterday"}]},
        {**sound, "frames": [{**frame, "breaks": [-1]}]},
        {**sound, "frames": [{**frame, "won": 1}]},
        {**sound, "strokes": [{"position": 3}]},
        {**sound, "strokes": None},
    ):
        text = wrong if isinstance(wrong, str) else json.dumps(wrong)
        kept.path.write_text(text)
        for fields in ({}, {"name": "Anna"}, {"delete": True}):
            with pytest.raises(ValueError, match=r"^person = .*must be a person's file"):
                game("person", **fields)
        assert "The frame was not kept: person = " in end_frame(game)["words"]
        assert kept.path.read_text() == text
    assert main(["--no-browser", "--person", str(kept.path)]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    with pytest.raises(ValueError, match="at most 40"):
        kept.path.write_text(json.dumps(sound))
        game("person", name="x" * 41)
    assert game("person", name="Anna")["name"] == "Anna" and len(kept.read()["frames"]) == 1
    assert not game("person", delete=True)["frames"] and not kept.path.exists()


def test_my_play_shows_the_file_with_a_rating_and_deletes_it(chromium, line, tmp_path):
    frame = {"date": "2026-11-30", "noise": ["amateur", "club"], "scores": [70, 12], "breaks": [33, 87]}
    frame |= {"hints": 0, "undone": 0, "rated": True, "won": True, "opponent": "Walter"}
    frames = [frame] * 3 + [frame | {"won": False, "breaks": []}] * 2 + [frame | {"rated": False}]
    line.server.service.person = person = Person(tmp_path / "person.json")
    at = Position(cue=(0.1, 0.2), black=(-0.3, 1.0))
    pot = Recorded(position=at, ball=21, pocket=4, speed=2.0, potted=True, points=7, cue="real")
    own = replace(pot, physics="match", table="match").to_dict()
    person.change(lambda file: file.update(frames=frames, name="Anna", strokes=[own] * 3))
    shown = Shown(chromium, line)
    shown.until(f"page.state && {SETTLED}")
    shown.page.click("#mine-open")
    shown.until("document.getElementById('mine').open")
    text = shown.page.inner_text("#mine")
    assert "6 frames, 4 won. Highest break: 87. Breaks of 20 and more: 87, 87, 87, 87, 33" in text
    assert "✓ Walter 3:2" in text and str(person.path) in text
    results = (
        [{"elo": 1500, "won": 1000, "lost": 500}],
        [{"elo": one.elo, "won": 0, "lost": 0} for one in LEVELS],
    )
    results[1][1] |= {"won": 3, "lost": 2}
    known, found = shown("import('./play_person.js').then(({rate}) => argument.map(rate))", results)
    spread = 1.96 * 400 / log(10) / (1500 * 2 / 9) ** 0.5  # two wins for a loss are 400 lg 2 points
    assert known == pytest.approx([1620.4 - spread, 1620.4, 1620.4 + spread], abs=6)
    assert f"Rating {found[1]} (95 % interval {found[0]} to {found[2]}), from 5 rated frames" in text
    assert "100 %, 3 of 3" in text  # 0.9 m and 0.9 m
    shown.page.click("#mine-coach")
    shown.until("document.getElementById('mine-coach-says').innerText.includes('pots: 3 of 3 made')")
    shown.page.fill("#mine-name", "Berta")
    shown.page.keyboard.press("Tab")
    end = time.monotonic() + 60
    while person.read()["name"] != "Berta":
        assert time.monotonic() < end
    shown.page.click("#mine-delete")
    shown.page.click("#confirm-yes")
    shown.until("document.getElementById('mine-frames').innerText.startsWith('No frames yet')")
    assert not person.path.exists()
    shown.page.click("#mine button:has-text('Close')")
    shown.page.click("#start summary")
    shown.page.select_option("#level", "Rosa")
    shown.until("page.state.players[1] === 'Rosa' && page.state.noise[1] === 'amateur'")
    assert shown.page.inner_text("#level-about") == f"Rosa is {LEVELS[2].style}."
    shown.close()
    line.server.service.person = None


def try_once(shown, n):
    shown.until(f"page.aiming && {SETTLED}")
    shown("page.play()")
    shown.until("page.moving")
    shown("page.skip()")
    shown.until("page.drills.tries > argument", n)


@pytest.mark.slow
def test_my_position_is_repeated_with_what_is_to_be_expected(chromium, line):
    shown = Shown(chromium, line)
    shown.set_up(EASY)
    line("api/players", {"noise": ["club", "none"]})
    shown.until("page.state.noise[0] === 'club'")
    shown("void page.drills.begin('here')")
    shown.until(f"page.drills.now === 'here' && {SETTLED} && page.aiming")
    assert shown("page.aim.wish.speed") == 2
    shown("page.aim.set({aim: argument, speed: 1.5})", STRAIGHT)
    made, aims = 0, set()
    for n in range(10):
        try_once(shown, n)
        stroke = line("api/strokes")[1]["strokes"][-1]
        made += bool(stroke["points"])
        assert shown("page.drills.said") == f"Try {n + 1} of 10: {stroke['words']}"
        if n < 9:
            shown.until(f"page.aiming && {SETTLED}")
            assert shown.page.inner_text("#last") == shown("page.drills.said")  # until the next try
            aims.add((shown("page.aim.wish.aim"), shown("page.aim.wish.speed")))
            for name, place in EASY.items():
                if name != "reds":
                    assert shown("page.state.positions")[name] == place
    assert aims == {(STRAIGHT, 1.5)}
    words = shown.page.inner_text("#drill-words")
    assert words.startswith(f"This position: {made} of 10 made. Expected with these mistakes: ")
    expected, advised = (float(word) for word in words.split(": ")[2].split()[0:5:4])
    assert 0 < expected <= 10 and 3 < advised <= 10
    shown.page.click("#drills summary")
    shown.page.click("#drill-list button:has-text('The T')")  # inside a drill nothing is asked
    shown.until(f"page.drills.now === 'tee' && {SETTLED} && page.aiming")
    assert shown("page.state.reds") == 10 and not shown("document.getElementById('confirm').open")
    shown.close()


@pytest.mark.slow
def test_the_position_of_the_day_is_the_same_for_everybody_and_counts_once(chromium, line):
    seen = []
    for seed in (1, 2):
        line("api/players", {"players": ["person", "person"], "noise": ["none", "none"], "practice": False})
        line("api/new", {"layout": "break_off", "seed": seed})
        shown = Shown(chromium, line)
        shown.until(f"page.state && {SETTLED}")
        shown("void page.drills.begin('day')")
        shown.until(f"page.drills.now === 'day' && {SETTLED} && page.aiming")
        assert shown("page.state.noise") == ["amateur", "amateur"]
        first = shown("[page.state.positions, page.state.lines.filter(one => one.open).length > 0]")
        shown("page.aim.set({speed: 2, aim: 1})")
        try_once(shown, 0)
        seen.append([first, shown("page.state.positions")])  # errors are the same, too
        counted = shown("page.drills.first.score")
        assert shown("page.drills.over") and str(counted) in shown("page.drills.shared('Anna')")
        assert shown.page.is_visible("#drill-copy")
        shown.close()
    assert seen[0] == seen[1] and seen[0][0][1]
