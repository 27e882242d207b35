"""Can a client of the Model Context Protocol play, only by the rules of its track, and leave a result that checks?"""

import io
import json
import sys
from types import SimpleNamespace

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.benchmark import faults
from snooker_env.benchmark.playing import play_episodes
from snooker_env.benchmark.results import read_result, strokes_of
from snooker_env.benchmark.tasks import TASKS
from snooker_env.mcp import server as limits
from snooker_env.mcp.server import TRACKS, Desk, FreeGame, JudgedGame, draw_jpeg, serve
from snooker_env.physics.table import Table
from snooker_env.play.routes import POST, answer
from snooker_env.players import decision_seeds, player
from snooker_env.players.cue_stroke import cue_strokes
from snooker_env.render.palette import COLOURS
from tests.processes import ROOT

pytest.importorskip("mcp")
import anyio
from mcp import Client, MCPError, StdioServerParameters

TASK = TASKS["SnookerBreak-v0"]


def talk(desk, conversation):
    """Have a client of the SDK talk to a desk: ``await conversation(call)``."""

    async def run():
        async with Client(serve(desk)) as client:

            async def call(name, **arguments):
                result = await client.call_tool(name, arguments)
                return result.is_error, result.content

            return await conversation(call)

    return anyio.run(run)


def judged(path, track, episodes=2):
    declared = {"label": "me", "training_shots": 0, "shots_declared": 0}
    return JudgedGame(TASK, track, episodes, path, "by a test", **declared)


@pytest.mark.parametrize("track", ["words", "picture"])
def test_an_anchor_that_plays_over_the_protocol_leaves_its_own_result(tmp_path, track):
    """``ghost_ball``, asked for its strokes, plays the same visits as in the benchmark; after the first one it goes on."""
    path, seeds, numbers = tmp_path / "me.json", TASK.seeds(2), []

    async def one_visit(call):
        done = len(game._played.rows)
        while len(game._played.rows) == done:
            at = game.lies()
            key = decision_seeds(0, np.array([seeds[done]]), game._decide.decisions)
            (stroke,) = cue_strokes(player("ghost_ball").at(game.options).play(at, key), at)
            fields = {name: value for name, value in stroke.to_dict().items() if value is not None}
            failed, content = await call("play", **fields)
            assert not failed and len(content) == (1 + (track == "picture") if game.lies() else 1)
        numbers.append(done)

    game = judged(path, track)
    talk(Desk(game, track), one_visit)
    kept = read_result(path)
    assert faults(kept) == [] and kept["incomplete"] == "1 of 2 tables are played"
    game = judged(path, track)
    talk(Desk(game, track), one_visit)
    kept, own = read_result(path), play_episodes(TASK, "ghost_ball", seeds)
    assert faults(kept) == [] and kept["incomplete"] is None and kept["rows"] == own.rows
    assert numbers == [0, 1]
    assert all(map(np.array_equal, strokes_of(kept), own.strokes))
    assert (kept["agent"]["sources"], kept["agent"]["class"]) == ([f"program:mcp {track}"], "model_free")
    with pytest.raises(ValueError, match="must be a result of"):
        judged(path, "menu")


def test_the_menu_track_is_of_the_class_that_foresees_and_no_judged_table_is_open(tmp_path):
    game = judged(tmp_path / "me.json", "menu")

    async def conversation(call):
        while game.lies() is not None:
            failed, (text,) = await call("strokes", n=1)
            assert not failed
            failed, content = await call("play", number=json.loads(text.text.splitlines()[1])["number"])
            assert not failed and len(content) == 1
        return [await call(name) for name in ("play", "strokes", "new_game", "advise")], await call("look")

    refused, (failed, (text,)) = talk(Desk(game, "menu"), conversation)
    assert [failed for failed, _ in refused] == [True] * 4
    assert not failed and text.text == "All 2 tables are played."
    kept = read_result(tmp_path / "me.json")
    assert faults(kept) == [] and kept["agent"]["class"] == "foresight" and kept["agent"]["foresees"]


def test_a_stroke_of_the_menu_pots_the_ball_that_it_names():
    game = FreeGame()

    async def conversation(call):
        for seed in range(2):
            await call("new_game", layout="opened", seed=seed, noise="none")
            _, (text,) = await call("strokes", n=160)
            rows = [json.loads(line) for line in text.text.splitlines()[1:]]
            pots = {tuple(row["pot"]): row for row in reversed(rows) if row["chance"] > 0.8}
            assert len(pots) > 1 and rows[0]["promise"] == max(row["promise"] for row in rows)
            for (ball, _), row in pots.items():
                await call("new_game", layout="opened", seed=seed, noise="none")
                failed, _ = await call("play", number=row["number"])
                left, x, y = game.state()["positions"], row["x"], row["y"]
                assert not failed and ball not in left
                assert row["next"] == 0 or np.hypot(left["cue"][0] - x, left["cue"][1] - y) < 0.5

    talk(Desk(game, "menu"), conversation)


def test_with_a_free_ball_the_menu_names_reds_and_colours():
    game = FreeGame()
    position = {"cue": [0, 0], "reds": [[0.5, 0.9]], "blue": [0.6, -0.3], "pink": [-0.5, 1.2]}
    game.new({"noise": "none", "opponent": "random"})
    place = {"position": position | {"black": [0, 1.46], "on": "red"}, "free_ball": True}

    def play(number):
        answer(game._service, POST["position"], place)
        text, _, failed = Desk(game, "menu").answer(*number)
        assert not failed
        return text

    rows = [json.loads(line) for line in play(("strokes", {"n": 160})).splitlines()[1:]]
    pots = {tuple(row["pot"]): row for row in reversed(rows) if "pot" in row and row["chance"] > 0.9}
    assert {ball for ball, _ in pots} >= {"red 1", "blue"}
    for (ball, _), row in pots.items():
        words = play(("play", {"number": row["number"]}))
        assert f"You: {'Red' if 'red' in ball else ball.capitalize()}" in words and "potted" in words, words


BAD = [
    ("shutdown", {}),
    ("look", {"path": "/etc/passwd"}),
    ("strokes", {"n": 10**9}),
    ("strokes", {"n": "all"}),
    ("play", {}),
    ("play", {"speed": "2", "aim": 0}),
    ("play", {"speed": 1e999, "aim": 0}),
    ("play", {"speed": 2, "aim": {"a": []}}),
    ("play", {"speed": 2, "aim_at": {"pot": ["red 99", "the moon"]}}),
    ("play", {"speed": 2, "aim": 0, "place": [0, "x"]}),
    ("play", {"speed": 2, "aim": 0, "side": 0.4, "top": 0.4}),
    ("play", {"number": 10**6}),
    ("play", {"number": True}),
    ("play", {"number": 0, "speed": 2}),
    ("play", {"speed": 2, "aim": 0, "revision": 0}),
    ("play", {"speed": 10**400, "aim": 0}),
    ("play", {"speed": 10**5000, "aim": 0}),
    ("play", {"choice": "x" * 10**6}),
    ("play", {"x" * 3000: 1}),
    ("new_game", {"layout": "../../secret.json"}),
    ("new_game", {"layout": "held_out"}),
    ("new_game", {"seed": 1_000_000}),
    ("new_game", {"seed": -1}),
    ("new_game", {"seed": True}),
    ("new_game", {"opponent": "program:sh -c id"}),
    ("new_game", {"opponent": "model.zip"}),
    ("new_game", {"noise": None}),
    ("new_game", {"advice": 1}),
    ("advise", {}),
    ("advise", {"n": 1, "agent": "program:id"}),
    ("save", {"out": "/tmp/x"}),
]


def test_a_hostile_client_gets_one_sentence_and_changes_nothing(monkeypatch):
    monkeypatch.setattr(limits, "GAMES", 2)
    monkeypatch.setattr(limits, "CALLS", len(BAD) + 6)
    desk = Desk(FreeGame())

    async def conversation(call):
        before = await call("look")
        for name, arguments in BAD:
            try:
                failed, (text,) = await call(name, **arguments)
            except (MCPError, ValueError):  # the SDK itself does not send it, or refuses it
                continue
            assert failed and 0 < len(text.text) < 420 and "\n" not in text.text, (name, text)
            assert " = " in text.text and ": must " in text.text and "Traceback" not in text.text
        assert await call("look") == before
        assert [(await call("new_game"))[0] for _ in range(3)] == [False, False, True]
        return [await call("look") for _ in range(len(BAD))][-1]

    failed, (text,) = talk(desk, conversation)
    assert failed and text.text.startswith("calls = ") and "must be at most" in text.text


def test_each_track_offers_its_own_tools_and_the_command_serves_them_on_standard_input():
    offered = {track: set(Desk(FreeGame(), track).tools) for track in TRACKS}
    common = {"look", "play", "new_game", "advise"}
    assert offered == {"words": common, "menu": common | {"strokes"}, "picture": common}

    async def conversation():
        words = ["-m", "snooker_env", "mcp", "--track", "picture"]
        async with Client(StdioServerParameters(command=sys.executable, args=words, cwd=ROOT)) as client:
            tools = {tool.name: tool.input_schema for tool in (await client.list_tools()).tools}
            new = await client.call_tool("new_game", {"layout": "colours", "advice": True})
            return tools, new, await client.call_tool("advise", {"n": 1})

    tools, new, advice = anyio.run(conversation)
    assert set(tools) == common and "number" not in tools["play"]["properties"]
    text, picture = new.content
    assert "x = " not in text.text and "(+0." not in text.text and picture.mime_type == "image/jpeg"
    assert not advice.is_error and '"speed"' in advice.content[0].text


def test_after_a_foul_advice_tells_what_each_choice_is_worth():
    game = FreeGame()
    game.new({"layout": "opened", "advice": True})
    game._service.session.practice = False  # two persons: an agent's foul cannot be ordered
    answer(game._service, POST["stroke"], {"speed": 0.2, "aim": 0.0})
    choices = game.state()["choices"]
    told = [line.partition(": win chance ") for line in game.advise(1).splitlines()[: len(choices)]]
    assert [what for what, *_ in told] == choices and len(choices) > 1
    assert all(0 <= int(chance.removesuffix(" %")) <= 100 for *_, chance in told)


def test_the_picture_shows_every_ball_in_its_colour_and_which_red_is_which():
    import pygame

    position = sn.Position(cue=(0.3, -1.2), reds=[(0.5, 0.5), (-0.5, 1.2)], blue=(-0.7, 0.1), black=(0, 1.46))
    positions, on_table, _ = position.arrays()
    jpeg, view = draw_jpeg(Table.of("match"), positions, on_table)
    image = pygame.surfarray.array3d(pygame.image.load(io.BytesIO(jpeg))).astype(int)
    for ball in np.flatnonzero(on_table):
        column, row = view(positions[ball]).round().astype(int)
        around = image[column - 6 : column + 7, row - 6 : row + 7]
        assert (np.abs(around - COLOURS[ball]).max(axis=-1) < 60).sum() > 20, ball
    one, other = (
        (image[column - 5 : column + 6, row - 5 : row + 6] > 200).all(axis=-1)
        for column, row in view(positions[1:3]).round().astype(int)
    )
    assert one.any() and other.any() and (one != other).any()


def test_an_opponent_that_fails_ends_the_game_with_one_sentence():
    def fail(options):
        raise RuntimeError("broken")

    game = FreeGame()
    desk = Desk(game, "words")
    assert not desk.answer("new_game", {"opponent": "random"})[2]
    game._service.seats.players["random"] = SimpleNamespace(at=fail)
    for name, fields in (
        ("play", {"speed": 0.5, "aim": -1.6}),
        ("look", {}),
        ("play", {"speed": 1.0, "aim": 0.0}),
    ):
        text, _, failed = desk.answer(name, fields)
        assert (
            failed and "RuntimeError: broken" in text and text.endswith("must be begun again with new_game")
        )
    assert not desk.answer("new_game", {})[2] and not desk.answer("look", {})[2]
