"""Which tools may a client call, on which games? Those of a track, within limits, on free games by the routes of the page or on the
judged tables of a task; an error is one sentence. The menu of strokes says what closed forms foresee of each."""

import base64
import io
import json
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .._lib.check import choice, integer, refuse, refuse_what, truth
from .._lib.install import missing
from .._lib.types import Bools, Floats, Ints, NoiseName
from ..benchmark.agents import Agent
from ..benchmark.playing import Decider, PlayedEpisodes, Repeater, rows_of, tables_for
from ..benchmark.provenance import machine
from ..benchmark.results import result_of, write_result
from ..benchmark.run import read_earlier
from ..benchmark.tasks import HELD_OUT_SEED, Task
from ..game.balls import N_REDS, NAMES
from ..game.frame import CHOICES
from ..game.frame_columns import BALL_ON, PLAY
from ..game.layouts import LAYOUTS
from ..game.rule_sets import RULES
from ..geometry import HALF_LENGTH, HALF_WIDTH, POCKETS
from ..physics.table import Table
from ..planning import Positions, pots
from ..play.routes import GET, POST, answer
from ..play.service import OFFERED, PERSON, BusyError, Seats, Service
from ..play.session import Session
from ..players.cue_stroke import STROKE, cue_strokes
from ..players.program import ProgramPlayer
from ..players.seen import SeenPlayer, begun
from ..render.pygame_view import BOLD, View, draw, pygame_, typeset
from ..render.scene import scene
from ..simulation import SimulationError
from ..tasks import foreseen as columns
from ..tasks.box_actions import FASTEST
from ..tasks.noise import LEVELS
from ..tasks.observations import STROKE_SIZE
from ..tasks.options import Options
from ..tasks.stroke_menu import DECISIONS, SPEEDS, TOPS

if TYPE_CHECKING:
    from mcp.server.lowlevel import Server

TRACKS = ("words", "menu", "picture")
GAMES, CALLS = 100, 20_000  # the most of a session
LONGEST = 1_000  # the longest arguments of a call, as JSON [characters]
SHOWN = 200  # of each end of an error [characters]
LISTED, MOST_LISTED = 20, 160  # strokes that the menu lists
SIZE = (1280, 720)  # of the picture, with the score bar, which is cut off

ALONE = "nobody"  # the opponent of somebody who practises
DEALT = tuple(name for name in LAYOUTS if not name.startswith("held_out"))  # no table of the judging
MOST_ADVICE = 5

Fields = dict[str, Any]
_POT = 'instead of aim: {"pot": [ball, pocket]}, as {"pot": ["red 3", "middle left"]}; throw is compensated'
_PLAY = {
    "speed": {"type": "number", "description": "speed of the cue ball off the cue, 0.2 to 7 m/s"},
    "aim": {"type": "number", "description": "direction of the cue ball [rad], anticlockwise from +x"},
    "aim_at": {"type": "object", "description": _POT},
    "side": {"type": "number", "description": "tip offset to the right, in ball radii; with top within 0.5"},
    "top": {"type": "number", "description": "tip offset upwards, in ball radii: + follows, - draws"},
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

MEANING = (
    "speed: m/s; chance: of potting the ball; x, y: where the cue ball stops; next: worth of the position left, in points, to "
    "whoever plays next; promise: chance times the points of this pot and the next ones."
)
_SHOWN = {
    "speed": (columns.F_SPEED, FASTEST),
    "top": (columns.F_TOP, TOPS[-1]),
    "points": (columns.F_POINTS, 7),
    "chance": (columns.F_CHANCE, 1),
    "foul": (columns.F_FOUL, 1),
    "x": (columns.F_X, HALF_WIDTH),
    "y": (columns.F_Y, HALF_LENGTH),
    "cushions": (columns.F_NOSES, 5),
    "next": (columns.F_PROSPECTS, columns.MOST_WORTH),
    "promise": (columns.F_PROMISE, columns.MOST_PROMISE),
}  # name of a number: the column that holds it, and over what


class FreeGame:
    """A frame against an agent, or practice alone, by the routes of the page."""

    def __init__(self) -> None:
        self._service = Service(Session(layout="opened"), Seats({}))
        self._service.session.practice = True
        self.advice = False  # whether the game allows it

    @property
    def options(self) -> Options:
        session = self._service.session
        return session.options_with(session.noise[0])

    def new(self, fields: dict[str, Any]) -> None:
        """Begin a game; ValueError for a field that is not allowed."""
        opponent = choice("opponent", fields.get("opponent", ALONE), (ALONE, *OFFERED))
        noise: NoiseName = choice("noise", fields.get("noise", "professional"), tuple(LEVELS))  # type: ignore[assignment]
        advice = truth("advice", fields.get("advice", False))
        layout = choice("layout", fields.get("layout", "opened"), DEALT)
        seed = integer("seed", fields.get("seed", 0), 0, HELD_OUT_SEED - 1)
        deal = {"layout": layout, "seed": seed, "game": fields.get("game", "snooker")}
        answer(self._service, POST["new"], deal)
        alone = opponent == ALONE
        seats = {"players": [PERSON, PERSON if alone else opponent], "noise": [noise, noise]}
        answer(self._service, POST["players"], seats | {"practice": alone})
        self.advice = advice

    def state(self) -> dict[str, Any]:
        """The table as the page gets it, once the opponent has played."""
        while (state := answer(self._service, GET["state"], {}))["thinking"]:
            self._service.wait(state["revision"], 25.0)
        if state["trouble"]:
            what = f"ended by an error of the opponent ({state['trouble']})"
            raise refuse_what("game", what, "must be begun again with new_game")
        return state

    def lies(self) -> Positions | None:
        """The one position that a stroke is played from; None if there is none to play."""
        with self._service.reading() as session:
            if session.frame.phase == "over" or self._service.agent_to_play():
                return None
            return session.as_visit() if session.practice else session.position

    def play(self, fields: dict[str, Any]) -> str:
        """Play a stroke of ``POST api/stroke``; what happened, with the opponent's strokes that follow."""
        before = self.state()["strokes"]
        last = answer(self._service, POST["stroke"], fields)["state"]["last"]
        self.state()
        strokes = answer(self._service, GET["strokes"], {"from": before})["strokes"]
        return " ".join(stroke["tables"][1]["last"] for stroke in strokes) or last

    def advise(self, n: object) -> str:
        """What the page advises here, in lines."""
        if not self.advice:
            raise refuse("advice", False, "must be allowed by new_game: this game is played without")
        asked = {"n": integer("n", n, 1, MOST_ADVICE)}
        strokes = answer(self._service, POST["advise"], asked)["suggestions"]
        fields = [{name: one[name] for name in STROKE if one.get(name) is not None} for one in strokes]
        now = answer(self._service, GET["state"], {})
        wins = zip(now["choices"], now["choice_wins"], strict=True)
        lines = [f"{what}: win chance {100.0 * one:.0f} %" for what, one in wins if one is not None]
        lines += [f"{one['words']}: {json.dumps(its)}" for one, its in zip(strokes, fields, strict=True)]
        return "\n".join(lines)


class _Client(ProgramPlayer):
    fields: dict[str, Any]

    def _stroke(self, at: Positions, seed: int) -> Any:
        return self._read(self.fields, at, "play")


class JudgedGame:
    """The first tables of a task, one visit each in their order; a result file holds what was played."""

    def __init__(self, task: Task, track: str, episodes: int, out: str | Path, command: str, **declared: Any):
        self._task, self._out, self._command, self._load = task, out, command, machine()
        self._client = _Client(f"mcp {track}")
        self._agent = Agent.of(self._client, **declared)
        self._seeds = task.seeds(integer("episodes", episodes, 2, task.episodes))
        _, self._played = read_earlier(out, task, self._agent, episodes)
        self._played.foresees = track == "menu"
        self.options = tables_for(task, 1, 1).options
        self._deal()

    def _deal(self) -> None:
        done = len(self._played.rows)
        if done < len(self._seeds):
            seed = [self._seeds[done]]
            self._tables = tables_for(self._task, 1, 1)
            self._tables.reset(seed=[*seed])
            self._decide = Decider(self._client, self._tables, seed, 0)
            self._begun = time.perf_counter()

    def state(self) -> dict[str, Any]:
        """The table as a program gets it."""
        at, done = self.lies(), len(self._played.rows)
        if at is None:
            words = f"All {done} tables are played."
            return {"phase": "over", "words": words, "text": words, "balls_on": [], "positions": {}}
        state = self._decide.player._state(begun(at))  # type: ignore[attr-defined]
        where = f"Table {done + 1} of {len(self._seeds)}: {self._task.title}."
        return state | {"words": f"{where} {state['words']}", "text": f"{where}\n{state['text']}"}

    def lies(self) -> Positions | None:
        return Positions.of(self._tables) if len(self._played.rows) < len(self._seeds) else None

    def play(self, fields: dict[str, Any]) -> str:
        """Play a stroke; after the last one of a visit the file is written, and the next table dealt."""
        if self.lies() is None:
            raise refuse("tables", len(self._seeds), "must not all be played: there is no stroke to play")
        self._decide.player.fields = fields  # type: ignore[attr-defined]
        action = self._decide(np.ones(1, np.bool_), self._decide.decisions)
        _, _, terminated, truncated, info = self._tables.step(action)
        said = "Foul." if info["foul"][0] else f"{int(info['points'][0])} points."
        if not (terminated[0] or truncated[0]):
            return said
        row = self._keep()
        return f"{said} The visit is over: {row[3]} strokes, {row[4]} points."

    def _keep(self) -> list[int]:
        """Add the visit as ``check`` plays it again from its strokes, and write the file."""
        strokes = self._decide.strokes()
        tables = tables_for(self._task, 1, 1)
        again = Repeater(strokes, tables.options.rules.actions.size)
        rows = rows_of(self._task, tables, [self._seeds[len(self._played.rows)]], again)
        self._tables.close()
        cost = self._decide.decisions, time.perf_counter() - self._begun, self._decide.simulated
        self._played.add(PlayedEpisodes(rows, strokes, *cost))
        done, many = len(self._played.rows), len(self._seeds)
        why = None if done == many else f"{done} of {many} tables are played"
        about = {"command": self._command, "load": self._load, "incomplete": why}
        alone = PlayedEpisodes([])  # nothing is timed on one table
        write_result(self._out, result_of(self._task, self._agent, many, self._played, alone, about))
        self._deal()
        return rows[0]


class Tool(NamedTuple):
    """What a client may call; ``fields``: the JSON schema of each argument."""

    about: str
    fields: Fields
    call: Callable[[Fields], tuple[str, bytes | None]]


def _up_to(most: int, default: int, least: int = 1) -> Fields:
    return {"type": "integer", "minimum": least, "maximum": most, "default": default}


class Desk:
    """The tools of one client on its game, one call after the other. ``track``: what it may see, None for everything."""

    def __init__(self, game: FreeGame | JudgedGame, track: str | None = None):
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
            advised = {"n": _up_to(MOST_ADVICE, 3)}
            self.tools["advise"] = Tool("Say what an agent would play here.", advised, self._advise)

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
        where = f"The origin is at column {view.x:.0f}, row {view.y:.0f}"
        return "\n".join([words, *said, f"{where}; {view.scale:.1f} pixels are a metre. {_AXES}"]), jpeg

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


class _Reader:
    """Sees the menu of one position and takes the stroke of a number."""

    def __init__(self, at: Positions, options: Options, number: int):
        task = "frame" if at.of_frames else "visit"
        self.options = {"task": task, "action": "strokes", "observation": "strokes"}
        self.number = number
        try:
            self.strokes = SeenPlayer(self, name="menu").at(options).play(at, [0])
        except ValueError as error:
            raise ValueError(str(error).removeprefix("player menu: act(...) returned ")) from None

    def act(self, observations: Floats, masks: Bools, seeds: Ints) -> list[int]:
        self.row, (self.there,) = observations[0], masks
        number = integer("number", self.number, 0, len(self.there) - 1)
        if not self.there[number]:
            raise refuse("number", number, "must be on the menu of this table")
        return [number]


def take_stroke(number: int, at: Positions, options: Options) -> dict[str, Any]:
    """The stroke with this number, as fields of ``POST api/stroke``."""
    strokes = _Reader(at, options, number).strokes
    decision = int(strokes.decision[0])
    if decision != PLAY:
        return {"choice": CHOICES[decision]}
    fields = cue_strokes(strokes, at)[0].to_dict() | ({"choice": "play"} if at.choice[0] else {})
    return {name: value for name, value in fields.items() if value is not None}


def foresee_strokes(at: Positions, options: Options) -> list[dict[str, Any]]:
    """What is foreseen of each stroke on the menu, the best first: pots by their promise, then others."""
    reader, named = _Reader(at, options, 0), _name_pots(at)
    rows = reader.row[: len(reader.there) * STROKE_SIZE].reshape(-1, STROKE_SIZE).astype(float)
    found = []
    for number in np.flatnonzero(reader.there).tolist():
        one: dict[str, Any] = {"number": number}
        if at.of_frames and number >= len(rows) - DECISIONS:
            found.append(one | {"choice": ("play_again", "replace")[number - len(rows)]})
            continue
        if rows[number, columns.F_POT] > 0:
            one["pot"] = named[number // (SPEEDS * len(TOPS))]
        numbers = {name: round(rows[number, c] * over, 3) for name, (c, over) in _SHOWN.items()}
        found.append(one | numbers)
    return sorted(found, key=_rank)


def _name_pots(at: Positions) -> list[list[str]]:
    """Ball and pocket of each line of the menu that is a pot; with a free ball of both kinds, the widest first."""
    found, kinds = [], [at.as_visits()]
    if at.free_ball[0]:
        kinds.append(kinds[0].copy())
        kinds[1].game[:, BALL_ON] = at.ball_on
    for some in map(pots, kinds):
        found += zip(-some.tolerance[0], some.ball[0].tolist(), some.pocket[0].tolist(), strict=True)
    return [[NAMES[ball], POCKETS[pocket]] for _, ball, pocket in sorted(found) if ball >= 0]


def _rank(one: dict[str, Any]) -> tuple[Any, ...]:
    """Decisions, then fair pots by their promise, then other fair strokes by what they leave, then fouls."""
    if "choice" in one:
        return (0,)
    return 1 + one["foul"], "pot" not in one, -one["promise"], one["next"], one["number"]


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
