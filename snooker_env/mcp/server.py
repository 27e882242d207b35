"""What may a client call? The tools of a track, within limits; an error is one sentence."""

import base64
import json
import threading
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

from .._lib.check import choice, integer, refuse, refuse_what
from .._lib.install import missing
from ..game.rule_sets import RULES
from ..play.service import OFFERED, BusyError
from ..players.requests import STROKE
from ..render.still import draw_png
from ..simulation import SimulationError
from ..tasks.noise import LEVELS
from .games import ALONE, DEALT, HELD_OUT_SEED, MOST_ADVICE, FreeGame, Game
from .menu import foresee_strokes, take_stroke

if TYPE_CHECKING:
    from mcp.server.lowlevel import Server

TRACKS = ("words", "menu", "picture")
GAMES, CALLS = 100, 20_000  # the most of a session
LONGEST = 1_000  # the longest arguments of a call, as JSON [characters]
SHOWN = 200  # of each end of an error [characters]
LISTED, MOST_LISTED = 20, 160  # strokes that the menu lists

_NUMBER = {"type": "number"}
_PAIR = {"type": "array", "items": _NUMBER, "minItems": 2, "maxItems": 2}
_STROKE = {
    "speed": _NUMBER | {"minimum": 0.2, "maximum": 7, "description": "of the ball off the cue [m/s]"},
    "aim": _NUMBER | {"description": "direction of the cue ball [rad], anticlockwise from +x"},
    "aim_at": {
        "type": "object",
        "description": 'instead of aim: {"pot": [ball, pocket]}, as ["red 3", "middle left"]; throw is solved for',
    },
    "side": _NUMBER | {"description": "tip offset to the right, over the ball's radius, up to 0.5 with top"},
    "top": _NUMBER | {"description": "tip offset upwards: above 0 follows, below 0 draws"},
    "elevation": _NUMBER | {"description": "of the cue [rad], up to 0.52"},
    "place": _PAIR | {"description": "where the cue ball in hand is put first, [x, y] in metres"},
}
_FRAME = {
    "nominate": {"type": "string", "description": "a colour of a frame that may be named"},
    "choice": {"type": "string", "description": "after a foul of the opponent: one of the choices"},
}
_MEANING = (
    "speed: m/s; chance: that the ball is potted; cue_ball: where it stops; next: points that what is left is worth to "
    "whoever plays it; promise: points, chance times what the pot and the next ones bring."
)
_AXES = (
    "y grows to the right of the picture, to the black end, which pockets call top; x grows downwards, to what they call "
    "right. An aim of 0 rad points down, of 1.571 to the right."
)
_MENU = {"number": {"type": "integer", "description": "a stroke of the menu, alone"}}


class Said(NamedTuple):
    """The answer to a call."""

    text: str
    png: bytes | None = None
    failed: bool = False


class Tool(NamedTuple):
    """What a client may call; ``fields``: the JSON schema of each argument."""

    about: str
    fields: dict[str, Any]
    call: Callable[[dict[str, Any]], Said]


def _one_of(names: tuple[str, ...], default: str) -> dict[str, Any]:
    return {"enum": [*names], "default": default}


class Desk:
    """The tools of one client on its game. ``track``: what it may see, None for everything.

    Calls come one after the other."""

    def __init__(self, game: Game, track: str | None = None):
        self._game, self._track = game, track
        self._calls, self._games = 0, 0
        self._one = threading.Lock()
        strikes = {**_STROKE, **(_FRAME if isinstance(game, FreeGame) else {})}
        self.tools: dict[str, Tool] = {"look": Tool("The table as it lies.", {}, self._look)}
        if track in ("menu", None):
            about = "The menu: strokes with what closed forms foresee of each, the best first; nothing is simulated."
            many = {"type": "integer", "minimum": 1, "maximum": MOST_LISTED, "default": LISTED}
            self.tools["strokes"] = Tool(about, {"n": many}, self._strokes)
            strikes |= _MENU
        self.tools["play"] = Tool("Play a stroke, and see the table after it.", strikes, self._play)
        if isinstance(game, FreeGame):
            fields = {
                "layout": _one_of(DEALT, "opened"),
                "opponent": _one_of((ALONE, *OFFERED), ALONE),
                "noise": _one_of(tuple(LEVELS), "professional"),
                "game": _one_of(tuple(RULES), "snooker"),
                "seed": {"type": "integer", "minimum": 0, "maximum": HELD_OUT_SEED - 1, "default": 0},
                "advice": {
                    "type": "boolean",
                    "default": False,
                    "description": "whether advise may be called",
                },
            }
            self.tools["new_game"] = Tool("Begin a frame, or practice alone.", fields, self._new)
            many = {"type": "integer", "minimum": 1, "maximum": MOST_ADVICE, "default": 3}
            self.tools["advise"] = Tool("What an agent would play here.", {"n": many}, self._advise)

    def answer(self, name: str, arguments: dict[str, Any]) -> Said:
        """What a call brings, or in one sentence why it is refused; then nothing has changed."""
        with self._one:
            self._calls += 1
            try:
                if self._calls > CALLS:
                    raise refuse("calls", self._calls, f"must be at most {CALLS:,} in a session")
                tool = self.tools[choice("tool", name[:60], tuple(self.tools))]
                _check_length(arguments)
                for field in arguments:
                    allowed = f"must be one of {[*tool.fields]}" if tool.fields else "must be left out"
                    if field not in tool.fields:
                        raise refuse(f"argument of {name}", field[:60], allowed)
                return tool.call(arguments)
            except (ValueError, SimulationError, BusyError) as error:
                text = " ".join(str(error).split())
                text = text if len(text) <= 2 * SHOWN else f"{text[:SHOWN]} ... {text[-SHOWN:]}"
                return Said(text, failed=True)

    def _look(self, fields: dict[str, Any]) -> Said:
        state, at = self._game.state(), self._game.lies()
        words = state["words" if self._track == "picture" else "text"]
        if at is None or self._track in ("words", "menu"):
            return Said(words)
        png, view = draw_png(self._game.options.rules.table, at.positions[0], at.on_table[0])
        if self._track is None:
            return Said(words, png)
        of_game = (
            f"Scores {state['scores']}, break {state['break']}. May be struck first: {state['balls_on']}."
        )
        if state["nominations"] or state["choices"]:
            of_game += f" Nominations: {state['nominations']}; choices: {state['choices']}."
        scale = f"The origin, the middle of the table, is at column {view.x:.0f}, row {view.y:.0f}; {view.scale:.1f} pixels a metre"
        axes = f"{scale}. {_AXES}"
        there = f"On the table: {', '.join(state['positions'])}."
        return Said("\n".join([words, of_game, there, axes]), png)

    def _strokes(self, fields: dict[str, Any]) -> Said:
        n, at = integer("n", fields.get("n", LISTED), 1, MOST_LISTED), self._lies()
        found = foresee_strokes(at, self._game.options)
        head = f"The best {min(n, len(found))} of {len(found)} strokes, by closed forms. {_MEANING}"
        return Said("\n".join([head, *map(json.dumps, found[:n])]))

    def _lies(self):
        self._game.state()  # the opponent has played
        if (at := self._game.lies()) is None:
            raise refuse("phase", "over", "must not be over: there is no stroke to play")
        return at

    def _play(self, fields: dict[str, Any]) -> Said:
        if "number" in fields:
            for name in set(fields) - {"number"}:
                raise refuse(name, fields[name], "must be left out with number")
            fields = take_stroke(fields["number"], self._lies(), self._game.options)
        elif not {"choice", *STROKE} & set(fields):
            raise refuse_what("speed", "nothing", "must be given, with aim or aim_at")
        happened = self._game.play(fields)
        seen = self._look({})
        return seen._replace(text=f"{happened}\n\n{seen.text}")

    def _new(self, fields: dict[str, Any]) -> Said:
        if self._games >= GAMES:
            raise refuse("games", self._games + 1, f"must be at most {GAMES} in a session")
        assert isinstance(self._game, FreeGame)
        self._game.new(fields)
        self._games += 1
        return self._look({})

    def _advise(self, fields: dict[str, Any]) -> Said:
        assert isinstance(self._game, FreeGame)
        self._lies()
        return Said(self._game.advise(fields.get("n", 3)))


def _check_length(arguments: dict[str, Any]) -> None:
    try:
        length = len(json.dumps(arguments))
    except (ValueError, RecursionError):  # a number of thousands of digits; too deep
        length = LONGEST + 1
    if length > LONGEST:
        raise refuse_what("arguments", "too many characters", f"must be at most {LONGEST:,} as JSON")


def serve(desk: Desk) -> "Server[Any]":
    """The server of the SDK whose tools are those of a desk."""
    try:
        import anyio.to_thread
        from mcp import types
        from mcp.server.lowlevel import Server
    except ImportError as error:
        raise missing("a server of the Model Context Protocol needs mcp", "mcp") from error
    from .. import __version__

    tools = [
        types.Tool(
            name=name,
            description=tool.about,
            input_schema={"type": "object", "properties": tool.fields, "additionalProperties": False},
        )
        for name, tool in desk.tools.items()
    ]

    async def list_tools(_: Any, params: types.PaginatedRequestParams | None) -> types.ListToolsResult:
        return types.ListToolsResult(tools=tools)

    async def call_tool(_: Any, params: types.CallToolRequestParams) -> types.CallToolResult:
        said = await anyio.to_thread.run_sync(partial(desk.answer, params.name, params.arguments or {}))
        content: list[Any] = [types.TextContent(type="text", text=said.text)]
        if said.png is not None:
            data = base64.b64encode(said.png).decode()
            content.append(types.ImageContent(type="image", data=data, mime_type="image/png"))
        return types.CallToolResult(content=content, is_error=said.failed)

    about = "Snooker with its real physics. look, then play; units are metres, seconds and radians, the origin is the middle of the table."
    return Server(
        "snooker_env",
        version=__version__,
        instructions=about,
        on_list_tools=list_tools,
        on_call_tool=call_tool,
    )
