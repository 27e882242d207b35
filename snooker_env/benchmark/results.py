"""What stands in a result file, and how is it written and read? ``schema`` documents every field.

Figures follow from rows and label alone: the same label draws the same bootstrap samples. ``check`` compares."""

import base64
import hashlib
import json
import zlib
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import numpy as np

from .._lib.check import refuse, refuse_what
from .._lib.files import read_json, with_checksum, write_atomic
from .._lib.types import Floats
from ..players import FRAMES, VISITS
from ..players.degenerate import is_degenerate
from ..players.resolver import PROGRAM
from .agents import Agent
from .playing import COLUMNS, PARTS, STROKES, Kept, PlayedEpisodes
from .provenance import arithmetic, commit, machine, software
from .schema import DATE, NAME, PROTOCOL, VERSION, line
from .statistics import RESAMPLES, Resamples, adjust, bound_if_none, figure, iqm
from .tasks import TASKS, Task

BUDGETS = {"none": 0, "50k": 50_000, "1M": 1_000_000, "5M": 5_000_000}  # of training [simulated shots]
SLACK = 1.02  # by how much a budget may be exceeded: training runs in whole rollouts


def figures_of(task: Task, label: str, rows: list[list[int]]) -> dict[str, Any] | None:
    """Compute all figures of an agent's rows (docs/benchmark_files.md); None unless all runs have played the same tables."""
    table = np.array(rows, np.float64).reshape(-1, len(COLUMNS))
    runs = [table[table[:, 0] == run] for run in np.unique(table[:, 0])]
    if not runs or any(not np.array_equal(one[:, 1], runs[0][:, 1]) for one in runs):
        return None
    columns = dict(zip(COLUMNS, np.moveaxis(np.stack(runs), 2, 0), strict=True))  # each (runs, episodes)
    score, counted = columns["score"], task.counts
    samples = Resamples(len(score), score.shape[1], RESAMPLES, zlib.crc32(label.encode()))
    count = samples.sums(np.ones(score.shape))

    def mean(values: Floats, *, share: bool = False) -> dict[str, Any]:
        """The figure of a mean; a share of 0 or 1 has the exact one-sided bound."""
        made = figure(float(values.mean()), samples.sums(values) / count) | {"exact": False}
        if share and made["low"] is None and made["value"] in (0.0, 1.0):
            most = bound_if_none(score.shape[1])
            low, high = (0.0, most) if made["value"] == 0.0 else (1.0 - most, 1.0)
            made |= {"low": low, "high": high, "exact": True}
        return made

    return {
        "score": mean(score, share=not counted),
        "adjusted": mean(adjust(score, columns["luck"] / PARTS), share=not counted),
        "iqm": figure(iqm(score), samples.iqms(score)) | {"exact": False} if counted else None,
        "profile": [{"at_least": t} | mean((score >= t).astype(float), share=True) for t in task.thresholds],
        "by_run": score.mean(axis=1).tolist(),
        "best": int(score.max()),
        **{name: mean(columns[name]) for name in ("points", "pots", "strokes")},
        "fouls": mean(columns["fouls"], share=not task.frame),
        "cleared": mean(columns["cleared"], share=True),
    }


def missing(result: dict[str, Any], task: Task) -> list[str]:
    """List in a few words each what a result lacks to be official."""
    agent, episodes = result["agent"], result["protocol"]["episodes"]
    reasons = {
        "incomplete": result["incomplete"] is not None,
        f"{episodes:,} of {task.episodes:,} episodes": episodes != task.episodes,
        "training shots unknown: give --training-shots": agent["budget"] == "unknown",
        "simulated shots unknown: give --simulated-shots": agent["class"] == "undeclared",
    }
    return [reason for reason, so in reasons.items() if so]


def complete(record: dict[str, Any], task: Task) -> dict[str, Any]:
    """Return the record with every derived field computed again; ``check`` compares."""
    agent, rows, shots = record["agent"], record["rows"], record["timing"]["simulated_shots"]
    declared = agent["simulated_shots"] if agent["declared"] else None
    mean: float | None = shots / max(1, sum(row[STROKES] for row in rows))
    # counted, unless it cannot be, or a higher number is declared
    if by_word := agent["sources"][0].startswith(PROGRAM) or (declared is not None and declared > mean):
        mean = None if declared is None else float(declared)
    name = "foresight" if agent["foresees"] else "model_free"
    name = "undeclared" if mean is None else "planning" if mean > 0 else name
    name = "degenerate" if all(map(is_degenerate, agent["sources"])) else name
    trained = agent["training_shots"]
    fit = [budget for budget, most in BUDGETS.items() if trained is not None and trained <= SLACK * most]
    budget = "unknown" if trained is None else [*fit, "open"][0]
    made = {"class": name, "simulated_shots": mean, "declared": by_word, "budget": budget}
    record = record | {
        "schema": {"name": NAME, "version": VERSION},
        "protocol": record["protocol"] | {"version": PROTOCOL},
        "agent": agent | made,
        "columns": list(COLUMNS),
        "figures": figures_of(task, agent["label"], rows) if rows else None,
    }
    record["protocol"]["official"] = not missing(record, task)
    return record


def result_of(
    task: Task, agent: Agent, many: int, played: PlayedEpisodes, alone: PlayedEpisodes, about: dict[str, Any]
) -> dict[str, Any]:
    """The record of a run. ``alone``: played on one table; ``about``: "command", "load", "incomplete"."""
    shots, why = agent.shots_declared, about["incomplete"]
    who: dict[str, Any] = {"label": agent.label, "sources": agent.texts, "budget": None}
    who |= {"training_shots": agent.training_shots, "foresees": played.foresees}
    one_table = 1e3 * alone.seconds / alone.decisions if alone.decisions else None
    record = {
        "schema": {},
        "protocol": {"version": PROTOCOL, "episodes": many, "official": False},
        "task": task.id,
        "agent": who | {"class": None, "simulated_shots": shots, "declared": shots is not None},
        "software": software(),
        "machine": about["load"] | {"load_at_end": machine()["load"], "arithmetic": arithmetic()},
        "timing": {"seconds": played.seconds, "simulated_shots": played.simulated, "one_table_ms": one_table},
        "command": line(about["command"]),
        "commit": commit(),
        "date": datetime.now(timezone.utc).strftime(DATE),
        "columns": [],
        "rows": played.rows,
        "figures": None,
        "incomplete": why and line(why),
        "strokes": pack_strokes(played.strokes),
    }
    return complete(record, task)


def write_result(path: str | Path, result: dict[str, Any]) -> None:
    """Write a result, as ``judge`` returns it, as JSON with one line for each row; the file is replaced in one step."""
    rows = ",\n".join("  " + json.dumps(row, separators=(",", ":")) for row in result["rows"])
    text = json.dumps(with_checksum(result) | {"rows": "@rows@"}, indent=1, allow_nan=False)
    write_atomic(path, text.replace('"@rows@"', f"[\n{rows}\n ]" if rows else "[]") + "\n")


def read_result(path: str | Path) -> Any:
    """Read a result file, whose content ``faults`` checks. ValueError if it is no strict JSON; OSError if it cannot be read."""
    return read_json(path)


def pack_strokes(strokes: Kept) -> dict[str, str]:
    """The field ``strokes`` of a file: little-endian float32, by zlib, in base64, with a digest."""
    rows = [np.ascontiguousarray(one, "<f4") for one in strokes if len(one)]
    raw = np.concatenate(rows).view(np.uint8).T.tobytes() if rows else b""
    data = base64.b64encode(zlib.compress(raw, 9)).decode()
    return {"sha256": hashlib.sha256(raw).hexdigest(), "data": data}


def strokes_of(result: dict[str, Any]) -> Kept:
    """The actions (n, size) of each row of a result whose rows have their form; ValueError if they are damaged or no actions."""
    field, lengths = result["strokes"], [row[STROKES] for row in result["rows"]]
    task = TASKS[result["task"]]
    size = task.judged_options(**(FRAMES if task.frame else VISITS)).rules.actions.size
    n, width, much = sum(lengths), 4 * size, f"{len(field['data']):,} characters"
    try:
        packing = zlib.decompressobj()
        raw = packing.decompress(base64.b64decode(field["data"], validate=True), n * width + 1)
    except (zlib.error, ValueError) as error:
        raise refuse_what("strokes.data", much, f"must be zlib in base64 ({error})") from None
    if len(raw) != n * width or not packing.eof or packing.unused_data:
        much = f"{len(raw):,} bytes" if packing.eof else f"more than {len(raw) - 1:,} bytes, or cut off"
        must = f"must be {n * width:,} bytes, {width} for each of {n:,} strokes"
        raise refuse_what("strokes.data", much, must)
    digest = hashlib.sha256(raw).hexdigest()
    if digest != field["sha256"]:
        raise refuse("strokes.sha256", field["sha256"], f"must be {digest}, the digest of the strokes")
    actions = np.frombuffer(raw, np.uint8).reshape(width, n).T.copy().view("<f4").reshape(n, size)
    for k, c in np.argwhere(~(np.abs(actions) <= 1.0))[:1].tolist():  # not for NaN either
        raise refuse(f"strokes.data[{k}, {c}]", float(actions[k, c]), "must be finite and within [-1, 1]")
    return np.split(actions, np.cumsum(lengths)[:-1]) if lengths else []
