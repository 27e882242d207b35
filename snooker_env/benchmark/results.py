"""What stands in a result file, and how is it written and read? One JSON object; ``schema`` documents every field."""

import json
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from .._files import write_atomic
from .agents import Agent
from .figures import figures_of
from .playing import COLUMNS, PlayedEpisodes
from .provenance import arithmetic, commit, machine, software
from .schema import DATE, NAME, PROTOCOL, VERSION, line
from .strokes import packed
from .tasks import Task

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
    if shots is None:
        return "unknown"
    return "none" if shots == 0 else next((name for name, most in BUDGETS.items() if shots <= SLACK * most), "open")


def class_of(shots: float | None) -> str:
    """The class of an agent that simulates so many shots a decision.

    Parameters
    ----------
    shots : float or None
        None: neither counted nor declared.

    Returns
    -------
    str
        "model_free", "planning" or "undeclared".
    """
    return "undeclared" if shots is None else "planning" if shots > 0 else "model_free"


def simulated_shots(agent_kind: str, declared: int | None, shots: int, decisions: int) -> tuple[float | None, bool]:
    """Simulated shots a decision, and whether they are declared. A program's own shots cannot be counted; of two numbers the higher holds.

    Parameters
    ----------
    agent_kind : str
    declared : int or None
    shots, decisions : int
        Counted here.

    Returns
    -------
    shots : float or None
    declared : bool
    """
    counted = shots / decisions if decisions else 0.0
    if declared is not None and (agent_kind == "program" or declared > counted):
        return float(declared), True
    return (None, True) if agent_kind == "program" else (counted, False)


def missing(found: dict[str, Any], task: Task) -> list[str]:
    """What a result lacks to be official: complete, all episodes of the protocol, training and simulated shots known.

    Parameters
    ----------
    found : dict
    task : Task

    Returns
    -------
    list of str
        Reasons in a few words each; empty for a result that may stand on the leaderboard.
    """
    agent, episodes = found["agent"], found["protocol"]["episodes"]
    reasons = {
        "incomplete": found["incomplete"] is not None,
        f"{episodes:,} of {task.episodes:,} episodes": episodes != task.episodes,
        "training shots unknown: give --training-shots": agent["budget"] == "unknown",
        "simulated shots unknown: give --simulated-shots": agent["class"] == "undeclared",
    }
    return [reason for reason, so in reasons.items() if so]


def result_of(
    task: Task, agent: Agent, episodes: int, played: PlayedEpisodes, *, command: str, options: dict[str, Any], load: dict[str, Any],
    one_table: PlayedEpisodes | None, incomplete: str | None,
) -> dict[str, Any]:  # fmt: skip
    """The object of a result file.

    Parameters
    ----------
    task : Task
    agent : Agent
    episodes : int
        Asked for, for each training seed.
    played : PlayedEpisodes
        All that was played.
    command : str
    options : dict
        Of the player.
    load : dict
        ``provenance.machine`` before the first episode.
    one_table : PlayedEpisodes, optional
        Decisions timed on one table.
    incomplete : str, optional
        Why episodes are missing.

    Returns
    -------
    dict
    """
    shots, declared = simulated_shots(agent.kind, agent.shots_declared, played.simulated, played.decisions)
    found: dict[str, Any] = {
        "schema": {"name": NAME, "version": VERSION},
        "protocol": {"version": PROTOCOL, "episodes": episodes, "official": False},
        "task": task.id,
        "agent": {
            "label": agent.label, "kind": agent.kind, "sources": list(agent.sources), "options": options, "class": class_of(shots),
            "budget": budget_of(agent.training_shots), "training_shots": agent.training_shots, "simulated_shots": shots,
            "declared": declared,
        },
        "software": software(),
        "machine": load | {"load_at_end": machine()["load"], "arithmetic": arithmetic()},
        "timing": {
            "seconds": played.seconds, "simulated_shots": played.simulated,
            "one_table_ms": 1e3 * one_table.seconds / one_table.decisions if one_table is not None and one_table.decisions else None,
        },
        "command": line(command), "commit": commit(), "date": datetime.now(timezone.utc).strftime(DATE),
        "columns": list(COLUMNS), "rows": played.rows, "figures": figures_of(task, agent.label, played.rows) if played.rows else None,
        "incomplete": incomplete and line(incomplete), "strokes": packed(played.strokes),
    }  # fmt: skip
    found["protocol"]["official"] = not missing(found, task)
    return found


def write_result(path: str | Path, found: dict[str, Any]) -> None:
    """Write a result as JSON, with one line for each row.

    Parameters
    ----------
    path : str or Path
        The file; after a crash it holds the old result or the new one.
    found : dict
        The result, as ``judge`` returns it.

    Returns
    -------
    None

    Examples
    --------
    >>> import os, tempfile
    >>> from snooker_env.benchmark import read_result, write_result
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_result(os.path.join(folder, "result.json"), {"rows": [[0, 1]]})
    ...     read_result(os.path.join(folder, "result.json"))
    {'rows': [[0, 1]]}
    """
    rows = ",\n".join("  " + json.dumps(row, separators=(",", ":")) for row in found["rows"])
    text = json.dumps(found | {"rows": "@rows@"}, indent=1, allow_nan=False)
    text = text.replace('"@rows@"', f"[\n{rows}\n ]" if rows else "[]")
    write_atomic(path, text + "\n")


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

    def no_number(name):
        raise ValueError(f"{name} is no number of JSON")

    def once(pairs):
        found = dict(pairs)
        if len(found) < len(pairs):
            names = [name for name, _ in pairs]
            raise ValueError(f"the key {next(name for name in names if names.count(name) > 1)!r} stands there twice")
        return found

    try:
        return json.loads(Path(path).read_text(encoding="utf-8"), parse_constant=no_number, object_pairs_hook=once)
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{path}: must be JSON ({error})") from None
