"""Does the protocol give a program what it needs, and does it refuse what cannot be?"""

import base64
import json
import re
import time
from math import erf, pi

import numpy as np
import pytest

from snooker_env.advice import advise
from snooker_env.game.balls import PINK
from snooker_env.game.frame_columns import PLAY, PLAY_AGAIN, REPLACE
from snooker_env.geometry import POCKETS
from snooker_env.planning import Position, Positions
from snooker_env.play import routes
from snooker_env.play.session import STEP
from snooker_env.players import Strokes, player
from snooker_env.players.table_report import find_lines
from snooker_env.simulation import SimulationError
from snooker_env.tasks import LEVELS
from snooker_env.tasks.declarations import CLAIMS, CONCEDES
from snooker_env.tasks.frames import Frames
from snooker_env.tasks.options import Options
from tests.playing import COVERED, EASY, FROZEN, STRAIGHT
from tests.processes import ROOT


def waited(game, until, seconds=240.0):
    """The state, once something holds of it."""
    end, state = time.monotonic() + seconds, game.get("state")
    while not until(state):
        assert time.monotonic() < end, state["words"]
        state = game.get("state", after=state["revision"], wait=1.0)
    return state


def test_a_state_says_where_everything_is_and_what_may_be_done(game):
    game("position", position=EASY, scores=[10, 20])
    state = game.get("state")
    reds = dict(zip(("red 1", "red 2"), EASY["reds"], strict=True))
    assert state["positions"] == {name: EASY[name] for name in ("cue", "pink", "black")} | reds
    expected = {"ball_on": "red", "balls_on": [*reds], "phase": "stroke", "striker": 0, "scores": [10, 20]}
    expected |= {"reds": 2, "available": 29, "snookered": False}
    assert {name: state[name] for name in expected} == expected
    assert state["nominations"] == state["choices"] == [] and state["undo"] and not state["redo"]
    assert state["words"] == "Player 1's stroke: red is on."


def test_the_text_gives_a_blind_player_places_lines_and_what_is_in_the_way(game):
    game("players", noise=["club", "none"])
    text = game("position", position=EASY | {"blue": [0.75, 1.602]})["text"]
    for words in (
        "Player 1's stroke: red is on.",
        "Score: Player 1 0, Player 2 0; break 0.",
        "* red 1: (+0.600, +1.400)",
        "pink: (+0.000, +0.892), on its spot",
        "black: (+0.000, +1.460), on its spot",
        "34 points are left",
    ):
        assert words in text, words
    line = game.get("state")["lines"]
    mine = next(one for one in line if one["ball"] == "red 1" and one["pocket"] == "top right")
    assert not mine["open"] and mine["blocked_by"] == ["blue"]
    open_text = game("position", position=EASY)["text"]
    far = r"cue ball 0\.\d\d m, ball 0\.\d\d m, aim 0\.93\d\d rad, may err \d\.\d\d deg, chance \d+ %"
    assert re.search(rf"red 1, top right: open, straight, {far}", open_text)


def test_a_stroke_is_played_and_described_as_in_a_replay(game):
    game("position", position=EASY)
    answer = game("stroke", speed=2.0, aim=STRAIGHT)
    assert answer["stroke"]["points"] == 1 and answer["stroke"]["pots"] == [1]
    assert answer["stroke"]["cue"]["speed"] == 2.0
    state = answer["state"]
    assert state["scores"] == [1, 0] and state["ball_on"] == "any_colour"
    assert state["nominations"] == ["pink", "black"]
    assert "Red potted, 1" in state["last"]
    assert game.get("strokes")["strokes"] == [answer["stroke"]]
    assert game.get("strokes", **{"from": 1})["strokes"] == []


def test_a_stroke_brings_the_tables_before_and_after_it(game):
    """After an agent's visit every table on the way is known, as the state would have said it then."""
    before = game("position", position=EASY)
    game("players", players=["person", "ghost_ball"], noise=["none", "none"])
    own = game("stroke", speed=2.0, aim=STRAIGHT)
    first, then = own["stroke"]["tables"]
    assert first == {name: before[name] for name in first} | {"words": "Your stroke: red is on."}
    assert then == {name: own["state"][name] for name in then}
    assert (then["available"], then["ball_on"], then["reds"]) == (28, "any_colour", 1)
    game("stroke", speed=0.5, aim=2.0)
    waited(game, lambda s: not s["thinking"] and (s["striker"] == 0 or s["phase"] == "over"))
    state, strokes = game.get("state"), game.get("strokes")["strokes"]
    assert len(strokes) >= 3
    for k, stroke in enumerate(strokes):
        here, after = stroke["tables"]
        assert here["phase"] == "stroke" and here["striker"] == stroke["player"]
        assert stroke["ball_on"] == ("free ball" if here["free_ball"] else here["ball_on"].replace("_", " "))
        assert after["scores"] == stroke["score"] and stroke["words"] in after["last"]
        assert not {f"red {ball}" for ball in stroke["pots"]} & set(after["positions"])
        if k + 1 < len(strokes) and after["phase"] == "stroke":
            assert strokes[k + 1]["tables"][0] == after
    assert strokes[-1]["tables"][1] == {name: state[name] for name in after}


def test_the_chance_to_win_is_said_of_seat_0_after_each_stroke(game):
    behind = game("position", position=EASY, scores=[0, 130])
    ahead = game("position", position=EASY, scores=[130, 0])
    assert 0.0 < behind["win_chance"] < 0.05 and 0.95 < ahead["win_chance"] < 1.0
    theirs = game("position", position=EASY, scores=[0, 130], striker=1)
    assert theirs["win_chance"] < 0.05
    judge = player("tactician").at(game.session.options_with("amateur"))
    level = game("position", position=EASY, scores=[20, 30])
    assert level["win_chance"] == pytest.approx(judge.chance_to_win(game.session.position)[0], abs=1e-4)
    answer = game("stroke", speed=2.0, aim=STRAIGHT)
    first, then = answer["stroke"]["tables"]
    assert first["win_chance"] == level["win_chance"] != then["win_chance"] == answer["state"]["win_chance"]
    assert game.get("replay")["win_chance"] == [first["win_chance"], then["win_chance"]]
    assert game("concede")["win_chance"] == 0.0


@pytest.mark.parametrize(
    ("who", "noise", "level"),
    [
        (["person", "tactician_500"], ["none", "professional"], "amateur"),
        (["ghost_ball", "person"], ["none", "club"], "club"),
        (["person", "person"], ["robot", "robot"], "professional"),
    ],
)
def test_chance_and_advice_are_counted_with_the_same_errors(game, who, noise, level):
    """Of a frame of even scores the bar said 78 % with a professional's, the best stroke 59 % with an amateur's."""
    game("players", players=who, noise=noise)
    state = game("position", position=EASY, scores=[20, 30], striker=who.index("person"))
    options = Options(task="frame", miss="clear_path", noise=level, cue="real")
    chance = player("tactician").at(options).chance_to_win(game.session.position)[0]
    mine = state["win_chance"] if state["striker"] == 0 else 1.0 - state["win_chance"]
    assert state["level"] == level and mine == pytest.approx(chance, abs=1e-4)
    asked = game("advise", n=2)
    assert asked == game("advise", n=2, noise=level) and asked["noise"] == level
    whose = {"club": "a club player's"}.get(level, f"{'an' if level == 'amateur' else 'a'} {level}'s")
    assert asked["order"] == f"By chance to win, with {whose} errors:"
    assert asked["suggestions"][0]["win"] == pytest.approx(mine, abs=0.1)


def test_an_aim_may_be_given_by_a_pot_and_is_solved(game):
    game("position", position=EASY | {"cue": [0.1, 1.1]})
    assert game("stroke", speed=2.3, top=0.2, aim_at={"pot": ["red 1", "right top"]})["stroke"]["pots"] == [1]
    with pytest.raises(ValueError, match="must be on the table"):
        game("stroke", speed=2.3, aim_at={"pot": ["blue", "top right"]})


def test_a_foul_asks_for_a_choice_and_a_nomination_counts(game):
    game("position", position=COVERED)
    state = game("stroke", speed=0.6, aim=0.0, nominate="black")["state"]
    assert state["words"] == "Foul and a miss by Player 1: Player 2 chooses." and state["scores"] == [0, 7]
    assert "(black nominated)" in state["last"] and state["choices"] == ["play", "play_again", "replace"]
    with pytest.raises(ValueError, match="choose first"):
        game("stroke", speed=1.0, aim=0.0)
    back = game("stroke", choice="replace")
    foul = state["last"]
    assert "Foul, 7" in foul and back["state"]["last"] == f"{foul} Player 2 had the balls put back."
    assert back["stroke"] is None and back["state"]["striker"] == 0
    assert back["state"]["positions"]["cue"] == COVERED["cue"]
    both = game("undo") and game("stroke", choice="play", speed=1.0, aim=1.0)
    assert both["stroke"]["player"] == 1
    assert both["stroke"]["tables"][0]["last"] == f"{foul} Player 2 played on."


WRONG = """
stroke speed=9.0, aim=1.0, place=[0.1, -1.2] | speed = 9.0
stroke speed=1.0, place=[0.1, -1.2] | aim = None
stroke speed=1.0, aim=0.0, side=0.4, top=0.4 | side, top =
stroke speed=1.0, aim="0" | aim = '0'
stroke speed=1.0, aim=0.0, elevation=1.0 | elevation =
stroke speed=True, aim=0.0 | speed = True
stroke speed=1.0, aim=0.0, nominate="blue" | nominate = 'blue'
stroke speed=1.0, aim=0.0, nominate="white" | nominate = 'white'
stroke speed=1.0, aim=0.0, place=[0.1] | place =
stroke choice="play" | choice = 'play'
stroke speed=1.0, aim=0.0, choice="replace" | choice = 'replace'
stroke | speed = None
stroke speed=1.0, aim=0.0, power=3 | field = 'power'
stroke speed=2.3, aim_at={"pot": ["red 1"]} | aim_at =
stroke speed=2.3, aim_at={"pot": ["cue", "top right"]} | aim_at.pot[0] = 'cue'
stroke speed=2.3, aim_at="pink" | aim_at = 'pink'
stroke speed=2.3, aim_at={"pot": ["pink", "corner"]} | aim_at.pot[1] = 'corner'
position position=EASY | {"blue": [0.33, 1.031]} | blue =
position position=EASY | {"pink": [2.0, 0.0]} | pink =
position position=EASY | {"reds": [[0.6, 1.4], [0.61, 1.4]]} | reds[1] =
position position=EASY | {"on": "blue"} | on =
position position=EASY | {"in_hand": True} | in_hand =
position position=EASY | {"colour": [0, 0]} | key of position =
position position=EASY | {"reds": "x"} | reds =
position position=EASY | {"points": 1.5} | points =
players cue="short" | cue = 'short'
players players=["person", "/tmp/model.zip"] | players[1] = '/tmp/model.zip'
players players=["person", "os:system"] | players[1] = 'os:system'
players players=["person", "ppo_value"] | players[1] = 'ppo_value'
advise agent="ppo_value" | agent = 'ppo_value'
advise agent="../results/weights/ppo_value" | agent = '../results/weights/ppo_value'
new game="pool" | game = 'pool'
new layout="x" | layout = 'x'
new seed=-1 | seed = -1
new seed="1" | seed = '1'
new breaker=2 | breaker = 2
load link=1 | link = a int
load link='AAAA', seat=2 | seat = 2
new by_link=1 | by_link = 1
link more=True | field = 'more'
"""
"""A request with its fields | what is said. No path, no module, no file is a player: such a name is not even read."""


def test_a_request_that_is_refused_names_the_field_and_has_changed_nothing(game):
    before = game.get("state")
    for line in WRONG.strip().splitlines():
        request, _, words = line.rpartition(" | ")
        name, _, fields = request.partition(" ")
        fields = eval(f"dict({fields})")
        with pytest.raises(ValueError) as error:
            game(name, **fields)
        assert str(error.value).startswith(words), line
        if name == "position":
            found = game("position", **fields, check=True)
            assert found["sound"] is False and found["error"]["field"] == words.removesuffix(" ="), line
    assert game("position", position=EASY, check=True) == {"sound": True, "error": None}
    assert game.get("state") == before


def test_a_request_that_is_refused_in_its_middle_or_cannot_be_computed_has_changed_nothing(game, monkeypatch):
    game("position", position=COVERED)
    game("stroke", speed=1.0, aim=1.57)
    before, acts = game.get("state"), list(game.session.acts)

    def fails(*_):
        raise SimulationError("too many events")

    with monkeypatch.context() as patched:
        patched.setattr(Frames, "run", fails)  # after the choice, with the cue ball struck
        with pytest.raises(SimulationError):
            game("stroke", choice="play", speed=1.0, aim=1.0)
    with pytest.raises(ValueError, match="nominate = 'blue'"):
        game("stroke", choice="play", speed=1.0, aim=1.0, nominate="blue")
    assert game.get("state") == before and game.session.acts == acts
    assert game("stroke", choice="play", speed=1.0, aim=1.0)["stroke"]["player"] == 1


def test_an_agent_plays_by_itself_and_waits_after_an_undo(game):
    game("position", position=EASY)
    game("players", players=["person", "ghost_ball"], noise=["none", "professional"])
    state = game("stroke", speed=0.4, aim=1.0)["state"]
    assert state["striker"] == 0 or state["thinking"]
    state = waited(game, lambda s: not s["thinking"])
    assert (state["striker"] == 0 or state["phase"] != "stroke") and state["strokes"] >= 2
    strokes = game.get("strokes")["strokes"]
    assert {stroke["player"] for stroke in strokes} == {0, 1}
    back = game("undo")
    assert back["striker"] == 0 and back["strokes"] == 0  # to where the person had to play
    again = game("redo")
    assert not again["thinking"] and again["strokes"] == len(strokes)
    game("position", position=EASY, striker=1)
    state = game.get("state")
    assert state["paused"] and "Continue" in state["words"]
    with pytest.raises(ValueError, match="turn = 'ghost ball'"):
        game("stroke", speed=1.0, aim=0.0)
    game("go")
    assert waited(game, lambda s: not s["thinking"])["strokes"] >= 1


def test_an_agent_that_fails_is_reported_and_the_game_waits(game):
    class Broken:
        def at(self, rules):
            return self

        def play(self, positions, seeds):
            raise AssertionError

    game.service.seats.players["broken"] = Broken()
    game("position", position=EASY)
    game("players", players=["broken", "person"])
    state = waited(game, lambda s: not s["thinking"])
    assert (
        state["trouble"].startswith("broken failed to choose a stroke") and state["words"] == state["trouble"]
    )
    assert state["strokes"] == 0
    game("players", players=["person", "person"])
    assert game.get("state")["trouble"] == ""


class Deciding:
    """A player of frames that says what it is told: a stroke along +x, and parts of ``Strokes``."""

    def __init__(self, **says):
        self.says, self.saw = says, []

    def at(self, rules):
        assert rules.task == "frame"
        return self

    def play(self, positions, seeds):
        self.saw.append(positions)
        parts = {name: np.array(value) for name, value in self.says.items()}
        return Strokes(np.array([[0.6, 0.0, 0.0, 0.0, 0.0]]), **parts)


def deciding(game, position, *, striker=1, **says):
    """The state after an agent's turn at a position, its acts and the agent."""
    agent = game.service.seats.players["deciding"] = Deciding(**says)
    game("position", position=position, striker=striker)
    game("players", players=["person", "deciding"])
    game("stroke", speed=0.4, aim=-1.0) if striker == 0 else game("go")
    state = waited(game, lambda s: not s["thinking"])
    return state, [act.what for act in game.session.acts], agent


@pytest.mark.parametrize(
    ("decision", "what", "striker"),
    [(PLAY_AGAIN, "play_again", 0), (REPLACE, "replace", 0), (PLAY, "play", None)],
)
def test_an_agent_decides_after_a_foul(game, decision, what, striker):
    state, acts, agent = deciding(game, COVERED, striker=0, decision=[decision])
    choices = [act.asked["choice"] for act in game.session.acts if act.what == "choice"]
    assert choices == [what] and agent.saw[0].choice.tolist() == [True]
    assert agent.saw[0].scores.tolist() == [[7, 0]]
    assert striker is None or state["striker"] == striker
    assert acts[-1] == ("stroke" if what == "play" else "choice")


def test_an_agent_nominates_concedes_and_claims(game):
    _, acts, _ = deciding(game, COVERED, nominate=[PINK])
    assert (
        acts[-1] == "stroke" and game.session.acts[-1].asked["nominate"] == PINK
    )  # the blue is struck first
    assert game.session.frame.scores == (6, 0)
    state, acts, _ = deciding(game, COVERED, declare=[CONCEDES])
    assert acts[-1] == "concede" and state["winner"] == 0
    black = {"cue": [0.0, -0.5], "black": [0.5, -0.5]}
    _, acts, _ = deciding(game, black, declare=[CLAIMS])
    assert acts[-1] == "stroke"  # a lead of nothing is no claim
    game.service.seats.players["deciding"] = Deciding(declare=[CLAIMS])
    game("position", position=black, scores=[0, 20], striker=1)
    game("go")
    state = waited(game, lambda s: not s["thinking"])
    assert state["winner"] == 1 and state["last"] == "deciding claimed the frame."


@pytest.mark.parametrize(
    ("layout", "agent", "pots"), [("opened", "mine", True), ("break_off", "tactician_500", False)]
)
def test_hints_are_those_of_advise_one_for_each_stroke(game, layout, agent, pots):
    """One for each pot, and for each kind of safety: what an agent ranks are mostly ways of the same one."""
    game("new", layout=layout, seed=2)
    asked = {"noise": "amateur", "samples": 40, "seed": 3}
    game.service.seats.players["mine"] = player("stroke_value")
    session, by = game.session, game.service.seats.players[agent]
    options = {"cue": session.cue, "miss": session.options.miss}
    advised = advise(session.position, agent=by, n=5, options=options, **asked)
    ideas = [(one.ball, one.pocket) if one.kind == "pot" else one.words for one in advised]
    found = game("advise", agent=agent, n=5, **asked)
    assert [one["words"] for one in found["suggestions"]] == [one.words for one in advised]
    assert 1 < len(ideas) == len(set(ideas)) and any(isinstance(idea, tuple) for idea in ideas) >= pots
    assert [one["win"] for one in found["suggestions"]] == sorted(
        (one["win"] for one in found["suggestions"]), reverse=True
    )
    assert any(one["kind"] == "pot" for one in found["suggestions"][:2]) == pots
    one = game("advise", agent=agent, n=1, **asked)["suggestions"]
    assert len(one) == 1


def test_a_question_about_a_table_that_is_gone_is_refused(game):
    revision = game("position", position=EASY)["revision"]
    assert "cue" in game("destinations", speed=1.0, aim=0.0, samples=8, revision=revision)
    game("stroke", speed=1.0, aim=STRAIGHT)
    assert game("destinations", speed=1.0, aim=0.0, revision=revision) == {"stale": True}
    assert game("advise", revision=revision) == {"stale": True}
    before = game.get("state")
    assert game("stroke", speed=1.0, aim=0.0, revision=revision) == {"stale": True}
    assert game.get("state")["strokes"] == before["strokes"]
    assert game.get("state")["revision"] == before["revision"]


def test_undo_redo_new_load_and_replay(game):
    with pytest.raises(ValueError, match="nothing has been played"):
        game.get("replay")
    game("position", position=EASY)
    game("stroke", speed=2.0, aim=STRAIGHT)
    replay = game.get("replay")
    assert replay["format"] == "snooker-replay" and len(replay["strokes"]) == 1
    assert replay["players"] == ["Player 1", "Player 2"]
    assert json.loads(json.dumps(replay))["strokes"][0]["words"] in game.get("replay_page")["html"]
    link = game("link")["link"]
    assert game("undo")["scores"] == [0, 0] and game("redo")["scores"] == [1, 0]
    fresh = game("new", layout="colours", seed=4)
    assert fresh["reds"] == 0 and fresh["ball_on"] == "yellow" and not fresh["undo"] and fresh["strokes"] == 0
    again, other = (game("new", layout="colours", seed=seed)["positions"] for seed in (4, 5))
    assert again == fresh["positions"] != other
    begun = game.get("state")["begun"]
    opened = game("load", link=link)
    assert opened["begun"] == begun + 1 and opened["strokes"] == 1 and opened["scores"] == [1, 0]
    assert game.get("replay")["strokes"] == replay["strokes"]
    with pytest.raises(ValueError, match=r"^link = \d+ characters: must be whole"):
        game("load", link=link[:-1])
    assert game.get("state") == opened | {"revision": game.get("state")["revision"]}


def test_who_waits_hears_of_a_change_and_not_of_none(game):
    revision = game.get("state")["revision"]
    start = time.monotonic()
    assert game.get("state", after=revision, wait=0.2)["revision"] == revision
    assert time.monotonic() - start >= 0.2
    game("place", place=[0.0, -1.2])
    start = time.monotonic()
    assert game.get("state", after=revision, wait=20.0)["revision"] > revision
    assert time.monotonic() - start < 5


def test_every_route_and_part_of_a_state_is_documented(game):
    page = (ROOT / "docs/play/protocol.md").read_text(encoding="utf-8")
    for method, table in (("GET", routes.GET), ("POST", routes.POST)):
        for name, route in table.items():
            assert f"`{method} api/{name}`" in page, name
            part = page.partition(f"`{method} api/{name}`")[2].partition("\n### ")[0]
            for field in route.fields:
                of_stroke = "of a stroke" in part and field in routes.STROKE
                assert f"`{field}`" in part or of_stroke, (name, field)
    page = (ROOT / "docs/play/protocol.md").read_text(encoding="utf-8")
    assert not [name for name in game.get("state") if f"`{name}`" not in page]


def test_the_room_of_a_stroke_is_said_before_it(game):
    state = game("position", position=FROZEN)
    assert state["cue"] == "real" and game.get("scene")["cues"] == ["free", "real"]
    before = game.session.state
    room = game("room", speed=2.0, aim=pi, top=-0.4, revision=state["revision"])
    assert room["over"] == "rail" and room["moved"] and room["raised"] and room["top"] > -0.4
    assert room["elevation"] == pytest.approx(pi / 4) and room["words"].startswith(
        "cue raised to 45 degrees over"
    )
    assert game("room", speed=2.0, aim=pi, top=-0.4, revision=state["revision"] + 5) == {"stale": True}
    assert game("room", speed=2.0, aim=-pi / 2)["elevation"] < 0.1
    assert game.session.state == before
    struck = game("stroke", speed=2.0, aim=pi, top=-0.4)
    assert struck["stroke"]["cue"]["elevation"] == pytest.approx(room["elevation"])


def test_other_games_are_played_and_the_other_player_may_break(game):
    state = game("new", game="six_red", seed=4)
    assert (state["game"], state["reds"], state["available"]) == ("six_red", 6, 75)
    assert state["time_left"] is None and game("concede")["winner"] == 1
    state = game("new", breaker=1, seed=5)
    assert (state["striker"], state["breaker"], state["reds"]) == (1, 1, 6)


def test_in_the_shoot_out_a_clock_runs_and_after_a_foul_the_cue_ball_goes_anywhere(game):
    state = game("new", game="shoot_out", seed=1)
    assert state["time_left"] == 600.0
    duration = game("stroke", speed=1.0, aim=-0.5 * pi)["stroke"]["duration"]  # it strikes nothing
    state = game.get("state")
    assert state["time_left"] == pytest.approx(600 - duration, abs=0.002)  # it runs from the break-off on
    assert (state["phase"], state["striker"], state["in_hand"], state["anywhere"]) == (
        "stroke",
        1,
        True,
        True,
    )
    assert game("place", place=[0.3, 0.4])["place"] == pytest.approx([0.3, 0.4], abs=STEP / 2)
    played = game("stroke", speed=1.0, aim=0.5 * pi, place=[0.3, 0.5])["stroke"]
    assert game.get("state")["time_left"] == pytest.approx(600 - duration - 9 - played["duration"], abs=0.003)
    start = np.frombuffer(base64.b64decode(played["start"]), "<f8")[:2]
    assert start == pytest.approx([0.3, 0.5], abs=STEP / 2)
    link, saved, state = game("link")["link"], game.session.save(), game.get("state")
    game("new", game="snooker")
    again = game("load", link=link)
    kept = ("game", "time_left", "positions", "scores")
    assert again["game"] == "shoot_out" and all(again[name] == state[name] for name in kept)
    before = game("new", game="snooker")
    for key, value in (("positions", "?"), ("frame", saved["state"]["frame"] | {"rules": "pool"})):
        with pytest.raises(ValueError):
            game.session.load(saved | {"state": saved["state"] | {key: value}})
        assert all(game.get("state")[name] == before[name] for name in kept)


def test_after_a_foul_each_choice_has_its_chance_and_advice_is_for_the_table_as_it_lies(game):
    game("players", noise=["club", "club"])
    game("position", position=COVERED, scores=[10, 20])
    game("stroke", speed=1.0, aim=0.5 * pi)
    asked = game("advise", agent="tactician_500", n=2, samples=20)
    state = game.get("state")
    assert state["phase"] == "choice" and state["choices"] == ["play", "play_again", "replace"]
    assert asked["suggestions"]
    for choice, win in zip(state["choices"], state["choice_wins"], strict=True):
        game("stroke", choice=choice)
        assert game.get("state")["win_chance"] == pytest.approx(1 - win, abs=1e-9)  # the striker is seat 1
        game("undo")


def test_lines_agree_with_geometry():
    at = Positions.of(Position(**EASY))
    lines = {(line.ball, POCKETS[line.pocket]): line for line in find_lines([at], 0b110, "none")}
    assert len(lines) == 12
    straight = lines[1, "top right"]
    assert straight.open and straight.cut < 0.01 and straight.aim == pytest.approx(STRAIGHT, abs=1e-3)
    assert straight.chance is None
    assert straight.to_pocket == pytest.approx(np.hypot(0.87376 - 0.6, 1.76926 - 1.4), abs=1e-6)
    (club,) = (line for line in find_lines([at], 0b010, "club") if line.pocket == straight.pocket)
    noise = LEVELS["club"]
    share = straight.tolerance / (np.sqrt(2.0) * np.radians(noise.direction_deg()))
    within = (1.0 - noise.lapse) * erf(share) + noise.lapse * erf(share / noise.lapse_factor)
    assert club.chance == pytest.approx(within * np.exp(-0.01 * (straight.to_ball + straight.to_pocket)))
    away = lines[1, "bottom left"]
    assert not away.open and away.why == "cut too thin"


def test_a_frame_is_reviewed_beside_the_game_and_played_again_from_a_stroke(game):
    """Strokes of persons alone; the game goes on meanwhile, and later stands as before a stroke, redo included."""
    session, states = game.session, []
    for aim in (1.5, 1.8, 1.2):
        if session.frame.phase == "choice":
            game("stroke", choice="play")
        states.append(session.state)
        game("stroke", speed=2.0, aim=aim)
    game("players", noise=["club", "amateur"])
    before = session.state
    found = game("review", samples=20, agent="tactician_500")
    assert game("advise", n=1, samples=5)["suggestions"] and session.state == before
    while found["running"]:
        time.sleep(0.05)
        found = game("reviewed")
    assert found["trouble"] == "" and found["done"] == found["total"] == 6 and found["noise"] == "club"
    assert [one["number"] for one in found["strokes"]] == [1, 2, 3] and sorted(found["costliest"]) == [
        1,
        2,
        3,
    ]
    drawn = game("reviewed", stroke=2)
    assert drawn["table"]["scores"] == states[1]["frame"]["scores"] and "0" in drawn["best"]["paths"]
    assert drawn["played"]["paths"]["0"][0] == pytest.approx(states[1]["positions"][0], abs=1e-4)
    game("again", stroke=2)
    assert session.state == states[1]
    assert game("redo")["strokes"] == 2
    with pytest.raises(ValueError, match="stroke = 4: must be"):
        game("again", stroke=4)
    assert not game("review", stop=True)["running"]
    game("new", seed=3)
    with pytest.raises(ValueError, match="must be begun first"):
        game("reviewed")
