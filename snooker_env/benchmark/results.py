"""What stands in a result file, and how is it written and read? ``schema`` documents every field."""

import base64
import hashlib
import json
import zlib
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import numpy as np

from .._check import refuse, refuse_what
from .._files import write_atomic
from ..players import FRAMES, VISITS
from ..players.resolver import PROGRAM
from .agents import Agent
from .figures import figures_of
from .playing import COLUMNS, STROKES, Kept, PlayedEpisodes
from .provenance import arithmetic, commit, machine, software
from .schema import DATE, NAME, PROTOCOL, VERSION, line
from .tasks import TASKS, Task

BUDGETS = {"50k": 50_000, "1M": 1_000_000, "5M": 5_000_000}
"""Training budgets [simulated shots]."""
SLACK = 1.02
"""By how much a budget may be exceeded: training runs in whole rollouts."""


def budget_of(shots: int | None) -> str:
    """The budget class of an agent, by its training shots.

    Parameters
    ----------
    shots : int or None
        Number of simulated shots of its training; None: unknown.

    Returns
    -------
    str
        "none", "50k", "1M", "5M", "open" or "unknown".

    Examples
    --------
    >>> from snooker_env.benchmark import budget_of
    >>> budget_of(0), budget_of(49_152), budget_of(1_015_808), budget_of(30_000_000), budget_of(None)
    ('none', '50k', '1M', 'open', 'unknown')
    """
    if not shots:
        return "unknown" if shots is None else "none"
    return next((name for name, most in BUDGETS.items() if shots <= SLACK * most), "open")


def of_decisions(program: bool, declared: int | None, shots: int, decisions: int) -> dict[str, Any]:
    """Class and shots a decision: declared if they cannot be counted or the number is higher, else counted."""
    counted = shots / max(1, decisions)
    by_word = program or (declared is not None and declared > counted)
    mean = counted if not by_word else None if declared is None else float(declared)
    name = "undeclared" if mean is None else "planning" if mean > 0 else "model_free"
    return {"class": name, "simulated_shots": mean, "declared": by_word}


def missing(result: dict[str, Any], task: Task) -> list[str]:
    """What a result lacks to be official, in a few words each."""
    agent, episodes = result["agent"], result["protocol"]["episodes"]
    reasons = {
        "incomplete": result["incomplete"] is not None,
        f"{episodes:,} of {task.episodes:,} episodes": episodes != task.episodes,
        "training shots unknown: give --training-shots": agent["budget"] == "unknown",
        "simulated shots unknown: give --simulated-shots": agent["class"] == "undeclared",
    }
    return [reason for reason, so in reasons.items() if so]


def completed(record: dict[str, Any], task: Task) -> dict[str, Any]:
    """The record with all that follows from its other fields, computed anew; ``check`` compares."""
    agent, rows = record["agent"], record["rows"]
    decisions = sum(row[STROKES] for row in rows)
    declared = agent["simulated_shots"] if agent["declared"] else None
    program, shots = agent["sources"][0].startswith(PROGRAM), record["timing"]["simulated_shots"]
    record = record | {
        "schema": {"name": NAME, "version": VERSION},
        "protocol": record["protocol"] | {"version": PROTOCOL},
        "agent": agent
        | {"budget": budget_of(agent["training_shots"])}
        | of_decisions(program, declared, shots, decisions),
        "columns": list(COLUMNS),
        "figures": figures_of(task, agent["label"], rows) if rows else None,
    }
    record["protocol"]["official"] = not missing(record, task)
    return record


def result_of(
    task: Task,
    agent: Agent,
    episodes: int,
    played: PlayedEpisodes,
    alone: PlayedEpisodes,
    why: str | None,
    about: Any,
) -> dict[str, Any]:
    """The record of a run. ``alone``: played on one table; ``about``: "command", and "load" before it began."""
    record = {
        "schema": {},
        "protocol": {"version": PROTOCOL, "episodes": episodes, "official": False},
        "task": task.id,
        "agent": {
            "label": agent.label,
            "sources": agent.texts,
            "budget": None,
            "training_shots": agent.training_shots,
            "class": None,
            "simulated_shots": agent.shots_declared,
            "declared": agent.shots_declared is not None,
        },
        "software": software(),
        "machine": about["load"] | {"load_at_end": machine()["load"], "arithmetic": arithmetic()},
        "timing": {
            "seconds": played.seconds,
            "simulated_shots": played.simulated,
            "one_table_ms": 1e3 * alone.seconds / alone.decisions if alone.decisions else None,
        },
        "command": line(about["command"]),
        "commit": commit(),
        "date": datetime.now(timezone.utc).strftime(DATE),
        "columns": [],
        "rows": played.rows,
        "figures": None,
        "incomplete": why and line(why),
        "strokes": packed(played.strokes),
    }
    return completed(record, task)


def write_result(path: str | Path, result: dict[str, Any]) -> None:
    """Write a result as JSON, with one line for each row.

    Parameters
    ----------
    path : str or Path
        The file; after a crash it holds the old result or the new one.
    result : dict
        The result, as ``judge`` returns it.

    Examples
    --------
    >>> import os, tempfile
    >>> from snooker_env.benchmark import read_result, write_result
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_result(os.path.join(folder, "result.json"), {"rows": [[0, 1]]})
    ...     read_result(os.path.join(folder, "result.json"))
    {'rows': [[0, 1]]}
    """
    rows = ",\n".join("  " + json.dumps(row, separators=(",", ":")) for row in result["rows"])
    text = json.dumps(result | {"rows": "@rows@"}, indent=1, allow_nan=False)
    write_atomic(path, text.replace('"@rows@"', f"[\n{rows}\n ]" if rows else "[]") + "\n")


def read_result(path: str | Path) -> Any:
    """Read a result file; ``faults`` checks its content.

    Parameters
    ----------
    path : str or Path
        The file.

    Returns
    -------
    object
        The JSON content, a dict for a result.

    Raises
    ------
    ValueError
        If it is not JSON in UTF-8, contains NaN or Infinity, or a key twice in one object.
    OSError
        If it cannot be read.

    Examples
    --------
    >>> from snooker_env.benchmark import read_result
    >>> read_result("nothing.json")
    Traceback (most recent call last):
    ...
    FileNotFoundError: [Errno 2] No such file or directory: 'nothing.json'
    """

    def no_number(name: str) -> Any:
        raise ValueError(f"{name} is no number of JSON")

    def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        made: dict[str, Any] = {}
        for name, value in pairs:
            if name in made:
                raise ValueError(f"the key {name!r} stands there twice")
            made[name] = value
        return made

    try:
        text = Path(path).read_text(encoding="utf-8")
        return json.loads(text, parse_constant=no_number, object_pairs_hook=once)
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{path}: must be JSON ({error})") from None


def packed(strokes: Kept) -> dict[str, str]:
    """The field ``strokes`` of a file: little-endian float32, by zlib, in base64, with a digest."""
    rows = [np.ascontiguousarray(one, "<f4") for one in strokes if len(one)]
    raw = np.concatenate(rows).view(np.uint8).T.tobytes() if rows else b""
    return {
        "sha256": hashlib.sha256(raw).hexdigest(),
        "data": base64.b64encode(zlib.compress(raw, 9)).decode(),
    }


def unpacked(field: dict[str, str], lengths: list[int], size: int) -> Kept:
    """Actions (n, ``size``) of each episode; ValueError if they are damaged or no actions."""
    n, width = sum(lengths), 4 * size
    try:
        packing = zlib.decompressobj()
        raw = packing.decompress(base64.b64decode(field["data"], validate=True), n * width + 1)
    except (zlib.error, ValueError) as error:
        much = f"{len(field['data']):,} characters"
        raise refuse_what("strokes.data", much, f"must be zlib in base64 ({error})") from None
    if len(raw) != n * width or not packing.eof or packing.unused_data:
        much = f"{len(raw):,} bytes" if packing.eof else f"more than {len(raw) - 1:,} bytes, or cut off"
        raise refuse_what(
            "strokes.data", much, f"must be {n * width:,} bytes, {width} for each of {n:,} strokes"
        )
    digest = hashlib.sha256(raw).hexdigest()
    if digest != field["sha256"]:
        raise refuse("strokes.sha256", field["sha256"], f"must be {digest}, the digest of the strokes")
    actions = np.frombuffer(raw, np.uint8).reshape(width, n).T.copy().view("<f4").reshape(n, size)
    sound = np.abs(actions) <= 1.0  # False for NaN
    if not sound.all():
        k, c = np.argwhere(~sound)[0].tolist()
        raise refuse(f"strokes.data[{k}, {c}]", float(actions[k, c]), "must be finite and within [-1, 1]")
    return np.split(actions, np.cumsum(lengths)[:-1]) if lengths else []


def strokes_of(result: dict[str, Any]) -> Kept:
    """The strokes of each row of a result whose rows have their form; ValueError if they are damaged."""
    task = TASKS[result["task"]]
    actions = task.judged(**(FRAMES if task.frame else VISITS)).rules.actions
    return unpacked(result["strokes"], [row[STROKES] for row in result["rows"]], actions.size)
