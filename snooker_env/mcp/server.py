"""Which tools may a client call? Those of a track, within limits; an error is one sentence."""

import base64
import io
import json
import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

from .._lib.check import choice, integer, refuse, refuse_what
from .._lib.install import missing
from .._lib.types import Bools, Floats
from ..game.balls import N_REDS
from ..game.rule_sets import RULES
from ..physics.table import Table
from ..planning import Positions
from ..play.service import OFFERED, BusyError
from ..players.cue_stroke import STROKE
from ..render.pygame_balls import BOLD, pygame_, typeset
from ..render.pygame_view import View, draw
from ..render.scene import scene
from ..simulation import SimulationError
from ..tasks.noise import LEVELS
from .games import ALONE, DEALT, HELD_OUT_SEED, MOST_ADVICE, FreeGame, Game
from .menu import MEANING, foresee_strokes, take_stroke

if TYPE_CHECKING:
    from mcp.server.lowlevel import Server

TRACKS = ("words", "menu", "picture")
GAMES, CALLS = 100, 20_000  # the most of a session
LONGEST = 1_000  # the longest arguments of a call, as JSON [characters]
SHOWN = 200  # of each end of an error [characters]
LISTED, MOST_LISTED = 20, 160  # strokes that the menu lists
SIZE = (1280, 720)  # of the picture, with the score bar, which is cut off

Fields = dict[str, Any]
_POT = 'instead of aim: {"pot": [ball, pocket]}, as {"pot": ["red 3", "middle left"]}; throw is compensated'
_PLAY = {
    "speed": {"type": "number", "description": "speed of the cue ball off the cue, 0.2 to 7 m/s"},
    "aim": {"type": "number", "description": "direction of the cue ball [rad], anticlockwise from +x"},
    "aim_at": {"type": "object", "description": _POT},
    "side": {"type": "number", "description": "tip offset to the right, in ball radii; with top within 0.5"},
    "top": {
        "type": "number",
        "description": "tip offset upwards, in ball radii: positive follows, negative draws",
    },
    "elevation": {"type": "number", "description": "elevation of the cue, 0 to 0.52 rad"},
    "place": {"type": "array", "description": "where to place a cue ball in hand, [x, y] in metres"},
    "nominate": {"type": "string", "description": "the colour to nominate"},
    "choice": {"type": "string", "description": "after a foul of the opponent: one of the choices"},
    "number": {"type": "integer", "description": "number of a stroke on the menu; give no other argument"},
}
_AXES = (
    'y grows to the right of the picture, towards the black end ("top" in the names of pockets); x grows downwards '
    '("right"). An aim of 0 rad points down, 1.571 points right.'
)


class Tool(NamedTuple):
    """What a client may call; ``fields``: the JSON schema of each argument."""

    about: str
    fields: Fields
    call: Callable[[Fields], tuple[str, bytes | None]]


def _up_to(most: int, default: int, least: int = 1) -> Fields:
    return {"type": "integer", "minimum": least, "maximum": most, "default": default}


class Desk:
    """The tools of one client on its game, one call after the other. ``track``: what it may see, None for everything."""

    def __init__(self, game: Game, track: str | None = None):
        self._game, self._track = game, track
        self._calls, self._games, self._one = 0, 0, threading.Lock()
        free, menu = isinstance(game, FreeGame), track in ("menu", None)
        left_out = ({"nominate", "choice"} if not free else set()) | ({"number"} if not menu else set())
        strokes = {name: field for name, field in _PLAY.items() if name not in left_out}
        self.tools: dict[str, Tool] = {
            "look": Tool("Show the table.", {}, self._look),
            "play": Tool("Play a stroke and show the table after it.", strokes, self._play),
        }
        if menu:
            about = "List strokes, best first, with what closed forms foresee of each; nothing is simulated."
            self.tools["strokes"] = Tool(about, {"n": _up_to(MOST_LISTED, LISTED)}, self._strokes)
        if free:
            fields = {
                "layout": {"enum": [*DEALT], "default": "opened"},
                "opponent": {"enum": [ALONE, *OFFERED], "default": ALONE},
                "noise": {"enum": [*LEVELS], "default": "professional"},
                "game": {"enum": [*RULES], "default": "snooker"},
                "seed": _up_to(HELD_OUT_SEED - 1, 0, 0),
                "advice": {"type": "boolean", "description": "whether advise may be called (default: no)"},
            }
            self.tools["new_game"] = Tool("Start a frame, or practice alone.", fields, self._new)
            advises = Tool("Say what an agent would play here.", {"n": _up_to(MOST_ADVICE, 3)}, self._advise)
            self.tools["advise"] = advises

    def answer(self, name: str, arguments: Fields) -> tuple[str, bytes | None, bool]:
        """Words, a picture, and whether the call was refused; if so, the words say why, and nothing has changed."""
        with self._one:
            self._calls += 1
            try:
                if self._calls > CALLS:
                    raise refuse("calls", self._calls, f"must be at most {CALLS:,} in a session")
                tool = self.tools[choice("tool", name[:60], tuple(self.tools))]
                _check_length(arguments)
                for field in arguments:
                    choice(f"argument of {name}", field[:60], tuple(tool.fields))
                return *tool.call(arguments), False
            except (ValueError, SimulationError, BusyError) as error:
                text = " ".join(str(error).split())
                short = len(text) <= 2 * SHOWN
                return text if short else f"{text[:SHOWN]} ... {text[-SHOWN:]}", None, True

    def _look(self, fields: Fields) -> tuple[str, bytes | None]:
        state, at = self._game.state(), self._game.lies()
        words = state["words" if self._track == "picture" else "text"]
        if at is None or self._track in ("words", "menu"):
            return words, None
        jpeg, view = draw_jpeg(self._game.options.rules.table, at.positions[0], at.on_table[0])
        if self._track is None:
            return words, jpeg
        shown = ("scores", "break", "balls_on", "nominations", "choices", "in_hand")
        said = [f"{name}: {state[name]}" for name in shown] + [f"on the table: {[*state['positions']]}"]
        where = (
            f"The origin is at column {view.x:.0f}, row {view.y:.0f}; {view.scale:.1f} pixels are a metre."
        )
        return "\n".join([words, *said, f"{where} {_AXES}"]), jpeg

    def _strokes(self, fields: Fields) -> tuple[str, None]:
        n, at = integer("n", fields.get("n", LISTED), 1, MOST_LISTED), self._lies()
        found = foresee_strokes(at, self._game.options)
        head = f"The best {min(n, len(found))} of {len(found)} strokes. {MEANING}"
        return "\n".join([head, *map(json.dumps, found[:n])]), None

    def _lies(self) -> Positions:
        self._game.state()  # the opponent has played
        if (at := self._game.lies()) is None:
            raise refuse("phase", "over", "must not be over: there is no stroke to play")
        return at

    def _play(self, fields: Fields) -> tuple[str, bytes | None]:
        if "number" in fields:
            if len(fields) > 1:
                raise refuse_what("number", "one argument of several", "must be given alone")
            fields = take_stroke(fields["number"], self._lies(), self._game.options)
        elif not {"choice", *STROKE} & set(fields):
            raise refuse_what("speed", "nothing", "must be given, with aim or aim_at")
        happened = self._game.play(fields)
        words, jpeg = self._look({})
        return f"{happened}\n\n{words}", jpeg

    def _new(self, fields: Fields) -> tuple[str, bytes | None]:
        integer("number of games", self._games + 1, 1, GAMES)
        assert isinstance(self._game, FreeGame)
        self._game.new(fields)
        self._games += 1
        return self._look({})

    def _advise(self, fields: Fields) -> tuple[str, None]:
        assert isinstance(self._game, FreeGame)
        self._lies()
        return self._game.advise(fields.get("n", 3)), None


def draw_jpeg(table: Table, positions: Floats, on_table: Bools) -> tuple[bytes, View]:
    """The JPEG of a table with balls (22, 2) [m], and where its points lie in the picture."""
    one, view, out = scene(table, positions, on_table), View.of(table, SIZE), io.BytesIO()
    pygame = pygame_()
    surface = pygame.image.frombuffer(draw(one, view), SIZE, "RGB")
    for ball, place in zip(one.ids.tolist(), view(one.positions).tolist(), strict=True):
        if 0 < ball <= N_REDS:
            number = typeset(str(ball), (255, 255, 255), 1.6 * one.ball_radius * view.scale, BOLD)
            surface.blit(number, number.get_rect(center=[round(x) for x in place]))
    pygame.image.save(surface.subsurface((0, 0, view.width, view.height - view.bar)), out, "table.jpg")
    return out.getvalue(), view


def _check_length(arguments: Fields) -> None:
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
    tools: list[types.Tool] = []
    for name, tool in desk.tools.items():
        schema = {"type": "object", "properties": tool.fields, "additionalProperties": False}
        tools.append(types.Tool(name=name, description=tool.about, input_schema=schema))

    async def list_tools(_: Any, params: types.PaginatedRequestParams | None) -> types.ListToolsResult:
        return types.ListToolsResult(tools=tools)

    async def call_tool(_: Any, params: types.CallToolRequestParams) -> types.CallToolResult:
        asked = params.name, params.arguments or {}
        text, jpeg, failed = await anyio.to_thread.run_sync(desk.answer, *asked)
        content: list[types.ContentBlock] = [types.TextContent(text=text)]
        if jpeg is not None:
            content.append(types.ImageContent(data=base64.b64encode(jpeg).decode(), mime_type="image/jpeg"))
        return types.CallToolResult(content=content, is_error=failed)

    about = "Snooker with real physics. Look, then play. Metres, seconds, radians; the origin is the middle of the table."
    return Server("snooker_env", instructions=about, on_list_tools=list_tools, on_call_tool=call_tool)
