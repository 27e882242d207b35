"""Which games does a client play? Free ones, over the routes of the page, or the judged tables of a task."""

import json
import time
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from .._lib.check import choice, integer, refuse, refuse_what, truth
from .._lib.types import NoiseName
from ..benchmark.agents import Agent
from ..benchmark.playing import Decider, PlayedEpisodes, Repeater, rows_of, tables_for
from ..benchmark.provenance import machine
from ..benchmark.results import result_of, write_result
from ..benchmark.run import read_earlier
from ..benchmark.tasks import HELD_OUT_SEED, Task
from ..game.layouts import LAYOUTS
from ..planning import Positions
from ..play.routes import GET, POST, answer
from ..play.service import OFFERED, PERSON, Seats, Service
from ..play.session import Session
from ..players.cue_stroke import STROKE
from ..players.program import ProgramPlayer
from ..players.seen import begun
from ..tasks.noise import LEVELS
from ..tasks.options import Options

ALONE = "nobody"  # the opponent of somebody who practises
DEALT = tuple(name for name in LAYOUTS if not name.startswith("held_out"))  # no table of the judging
MOST_ADVICE = 5


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
        found = answer(self._service, POST["advise"], {"n": integer("n", n, 1, MOST_ADVICE)})
        head = [f"{found['agent']} would choose {found['choice']}."] if found["choice"] else []
        strokes = found["suggestions"]
        fields = [{name: one[name] for name in STROKE if one.get(name) is not None} for one in strokes]
        lines = [f"{one['words']}: {json.dumps(its)}" for one, its in zip(strokes, fields, strict=True)]
        return "\n".join([*head, *lines])


class _Client(ProgramPlayer):
    fields: dict[str, Any]

    def _stroke(self, at: Positions, seed: int) -> Any:
        return self._read(self.fields, at, "play")

    def told(self, at: Positions) -> dict[str, Any]:
        return self._state(begun(at))


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
            self._tables, self._number = tables_for(self._task, 1, 1), 0
            self._tables.reset(seed=[*seed])
            self._decide = Decider(self._client, self._tables, seed, 0)
            self._begun = time.perf_counter()

    def state(self) -> dict[str, Any]:
        """The table as a program gets it."""
        at, done = self.lies(), len(self._played.rows)
        if at is None:
            words = f"All {done} tables are played."
            return {"phase": "over", "words": words, "text": words, "balls_on": [], "positions": {}}
        state = self._decide.player.told(at)  # type: ignore[attr-defined]
        where = f"Table {done + 1} of {len(self._seeds)}: {self._task.title}."
        return state | {"words": f"{where} {state['words']}", "text": f"{where}\n{state['text']}"}

    def lies(self) -> Positions | None:
        return Positions.of(self._tables) if len(self._played.rows) < len(self._seeds) else None

    def play(self, fields: dict[str, Any]) -> str:
        """Play a stroke; after the last one of a visit the file is written, and the next table dealt."""
        if self.lies() is None:
            raise refuse("tables", len(self._seeds), "must not all be played: there is no stroke to play")
        self._decide.player.fields = fields  # type: ignore[attr-defined]
        action = self._decide(np.ones(1, np.bool_), self._number)
        _, _, terminated, truncated, info = self._tables.step(action)
        self._number += 1
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


Game: TypeAlias = FreeGame | JudgedGame
