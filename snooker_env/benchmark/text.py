"""How well does a program play that reads words, as a language model does? Visits on fixed tables, within budgets.

Rules: docs/benchmark.md. An answer that is no stroke is not the end: the state comes again with an ``error``."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from .._lib.check import integer, refuse
from .._lib.files import read_json, with_checksum, write_atomic
from ..planning import Positions
from ..players import Player, Strokes, ask_player, decision_seeds
from ..players.program import AnswerError, ProgramPlayer
from ..players.resolver import PROGRAM
from .agents import Agent
from .playing import tables_for
from .provenance import commit, machine, software
from .schema import MOST_WHOLE
from .statistics import Resamples, figure
from .tasks import TASKS

TASK = TASKS["SnookerBreak-v0"]  # its judged tables, its errors and its rules are those of the track
VISITS, MOST = 50, 200  # tables of a result, the first ones judged; and the most there are
STROKES, TRIES = 10, 3  # budgets: strokes of a visit, and answers for a stroke
COUNTS = ("points", "strokes", "pots", "fouls", "forfeited", "answers", "refused", "read", "written")
"""Of a visit: ``refused``: answers that were no stroke; ``read``, ``written``: characters of ``text`` and of answers."""


class TextPlayer(ProgramPlayer):
    """A program that is told what was wrong with its answer, and asked again; ``counts`` of the current visit."""

    def __init__(self, command: str, *, timeout: float = 60.0):
        super().__init__(command, timeout=timeout)
        self.counts: dict[str, int] = {}
        self._error: str | None = None

    def _stroke(self, at: Positions, seed: int) -> Strokes:
        self._error = None
        for left in reversed(range(TRIES)):
            try:
                return super()._stroke(at, seed)
            except AnswerError as error:
                self.counts["refused"] += 1
                self._error = str(error)
                if not left:
                    raise
        raise AssertionError

    def _answer(self, state: dict[str, Any]) -> bytes:
        answer = super()._answer(state | {"error": self._error})
        for name, more in (("answers", 1), ("read", len(state["text"])), ("written", len(answer))):
            self.counts[name] += more
        return answer


def play_text(agent: Agent, visits: int, done: list[dict[str, int]], each: Callable[[], object]) -> None:
    """Play the visits after those ``done``, to which their counts are added; ``each`` is called after every one."""
    command = agent.texts[0].removeprefix(PROGRAM)
    player = TextPlayer(command, timeout=agent.timeout) if agent.program else agent.player(TASK)
    try:
        for table in TASK.seeds(visits)[len(done) :]:
            done.append(_visit(player, table))
            each()
    finally:
        if isinstance(player, TextPlayer):
            player.close()


def _visit(player: Player, table: int) -> dict[str, int]:
    """Play one visit: the table and its counts."""
    counts: dict[str, int] = dict.fromkeys(COUNTS, 0)
    if isinstance(player, TextPlayer):
        player.counts = counts
    tables = tables_for(TASK, 1, threads=1)
    tables.reset(seed=[table])
    bound, going = player.at(tables), np.ones(1, np.bool_)
    try:
        for number in range(STROKES):
            seeds = decision_seeds(0, np.array([table]), number)
            try:
                action = ask_player(bound, tables, going, seeds).astype("<f4")
            except AnswerError:
                counts["forfeited"] = 1
                break
            _, _, terminated, _, info = tables.step(action)
            counts["strokes"] += 1
            counts["points"] += int(info["points"][0])
            counts["pots"] += int(info["points"][0] > 0)
            counts["fouls"] += int(info["foul"][0])
            if terminated[0]:
                break
    finally:
        tables.close()
    return {"table": table, **counts}


def figures_of(rows: list[dict[str, int]]) -> dict[str, Any]:
    """Points a visit with their interval, and means of all counts."""
    points = np.array([[row["points"] for row in rows]], float)
    samples = Resamples(1, len(rows)).sums(points) / len(rows)
    means = {name: float(np.mean([row[name] for row in rows])) for name in COUNTS[1:]}
    return {"points": figure(float(points.mean()), samples), **means}


def judge_text(
    agent: Agent,
    *,
    visits: int = VISITS,
    out: str | Path,
    resume: bool = False,
    tick: Callable[[int, int], None] | None = None,
) -> dict[str, Any]:
    """Play the track and keep the result in ``out`` after every visit, with which ``resume`` goes on; returns it."""
    integer("visits", visits, 2, MOST)
    if len(agent.texts) > 1:
        raise refuse("agent", ", ".join(agent.texts), "must be one: this track has no training seeds")
    out = Path(out)
    head = {"track": "text", "agent": agent.label, "source": agent.texts[0], "visits": visits}
    head["budget"] = {"strokes": STROKES, "tries": TRIES, "timeout": agent.timeout}
    rows: list[dict[str, int]] = []
    if out.exists():
        if not resume:
            raise refuse("out", str(out), "must be a new file; --resume goes on with one")
        rows = _rows_in(out, head)

    def keep(done: bool = False) -> dict[str, Any]:
        about = {"software": software(), "machine": machine(), "commit": commit()} if done else {}
        result = head | {"figures": figures_of(rows) if done else None, "rows": rows} | about
        write_atomic(out, json.dumps(with_checksum(result), indent=1) + "\n")
        if tick is not None:
            tick(len(rows), visits)
        return result

    if len(rows) < visits:
        play_text(agent, visits, rows, keep)
    return keep(done=True)


def _rows_in(out: Path, head: dict[str, Any]) -> list[dict[str, int]]:
    """The visits in a file that was begun with the same head."""
    wanted = "must be a result of this track"
    try:
        kept = read_json(out, "out", wanted, checked=True)
        same = {name: kept[name] for name in head} == head
        rows = [{name: row[name] for name in ("table", *COUNTS)} for row in kept["rows"]]
    except (KeyError, TypeError):  # what its fields cannot be
        raise refuse("out", str(out), wanted) from None
    for row in rows:
        for name, value in row.items():
            integer(f"{name} of {out}", value, 0, MOST_WHOLE)
    if not same or [row["table"] for row in rows] != TASK.seeds(head["visits"])[: len(rows)]:
        raise refuse("out", str(out), "must be of the same agent, visits and budget to be gone on with")
    return rows
