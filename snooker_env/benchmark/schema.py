"""What is a result file? Its fields with types and meanings; ``docs/benchmark_files.md`` prints this table."""

import re
from collections.abc import Mapping
from datetime import datetime, timedelta, timezone
from typing import Any, TypeAlias

from .provenance import LIBRARIES

NAME, VERSION = "snooker_env.benchmark.result", 4
PROTOCOL = 3  # Version of the rules: tables, episodes, figures. Only results of one version compare.
PACKAGES = ("1.0.0",)  # versions whose results compare by these rules, the present one last
BEGUN = "2026-11-21T00:00:00Z"  # no result is older than the project
DATE = "%Y-%m-%dT%H:%M:%SZ"
NUMBER = (int, float)
_ALIKE = "machines with the same one play strokes alike, bit for bit"

Fields: TypeAlias = Mapping[str, tuple[Any, bool, str]]
Ranges: TypeAlias = Mapping[str, tuple[float, float]]

FIELDS: dict[str, tuple[Any, bool, str]] = {
    "schema.name": (str, False, f'"{NAME}"'),
    "schema.version": (int, False, f"{VERSION}; another number means other fields"),
    "protocol.version": (int, False, f"{PROTOCOL}: version of the benchmark's rules"),
    "protocol.episodes": (int, False, "episodes asked for, for each training seed"),
    "protocol.official": (bool, False, "whether the rules for a leaderboard entry are kept"),
    "task": (str, False, "id of the task, with its version"),
    "agent.label": (str, False, "the name in tables; 1 to 20 letters, digits or . + - _"),
    "agent.sources": (list, False, "what was given to --agent: one, or a source for each training seed"),
    "agent.class": (str, False, "model_free, foresight, planning, undeclared or degenerate"),
    "agent.budget": (str, False, "none, 50k, 1M, 5M, open or unknown"),
    "agent.training_shots": (int, True, "all simulated shots of its training; null: not known"),
    "agent.foresees": (bool, False, "whether it sees, or predicts, what each of its strokes would do"),
    "agent.simulated_shots": (NUMBER, True, "simulated shots a decision, mean; null: not known"),
    "agent.declared": (bool, False, "true: that number was declared; false: this process counted it"),
    **{f"software.{name}": (str, False, "version") for name in ("snooker_env", "python")},
    **{f"software.{name}": (str, True, "version; null: not installed") for name in LIBRARIES},
    "machine.platform": (str, False, "operating system and processor architecture"),
    "machine.cpu": (str, False, "the processor's name"),
    "machine.cores": (int, False, "logical processors"),
    "machine.load": (NUMBER, True, "load average of the minute before the first episode"),
    "machine.load_at_end": (NUMBER, True, "load average of the minute before the last one ended"),
    "machine.arithmetic": (str, False, f"digest of 128 strokes: {_ALIKE}"),
    "timing.seconds": (NUMBER, False, "what all decisions took together"),
    "timing.simulated_shots": (int, False, "shots that this process simulated for them"),
    "timing.one_table_ms": (NUMBER, True, "ms a decision on one table, alone; null: not measured"),
    "command": (str, False, "how this file was made"),
    "commit": (str, True, "of the checkout, with -dirty if files were changed; null outside one"),
    "date": (str, False, "when, in UTC: 2026-11-22T19:00:00Z"),
    "columns": (list, False, "names of the columns of rows"),
    "rows": (list, False, "one list of whole numbers for each episode, see below"),
    "figures": (dict, True, "what follows from the rows, see below; null: the runs are not complete"),
    "incomplete": (str, True, "why episodes are missing; null: none are"),
    "strokes.sha256": (str, False, "digest of the strokes, against damage"),
    "strokes.data": (str, False, "every stroke that was played, see below"),
}  # dotted name: type, whether it may be null, meaning
_PLAYED = "schema", "protocol", "task", "columns", "rows", "figures", "strokes"
_PROVED = (*_PLAYED, "agent.class", "agent.budget", "software.snooker_env")
UNPROVED = tuple(name for name in FIELDS if not name.startswith(_PROVED))  # what no replay proves

LABEL = re.compile(r"[A-Za-z0-9_.+-]{1,20}")
MOST_WHOLE = 2**53  # whole numbers up to here are exact in every reader of JSON
RANGES: dict[str, tuple[float, float]] = {  # lowest and highest value of every field that is a number
    name: (0.0, 1e12) if kind is NUMBER else (0, MOST_WHOLE)
    for name, (kind, _, _) in FIELDS.items()
    if kind in (int, NUMBER)
}
RANGES["agent.simulated_shots"] = 0, MOST_WHOLE
RANGES["protocol.episodes"] = RANGES["machine.cores"] = 1, 2**20
_CONTROL = r"\x00-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff"
_LINE = re.compile(f"[^{_CONTROL}]{{1,200}}"), "one line of at most 200 characters"
LONG_LINE = re.compile(f"[^{_CONTROL}]{{0,2000}}"), "one line of at most 2,000 characters"
MOST_SOURCES = 100  # training seeds of one result
PATTERNS: dict[str, tuple[re.Pattern[str], str]] = {
    "agent.label": (LABEL, "1 to 20 letters, digits or . + - _"),
    **{name: (re.compile(r"[\w.+!-]{1,60}"), "a version") for name in FIELDS if name.startswith("software.")},
    **dict.fromkeys(("machine.platform", "machine.cpu"), _LINE),
    **dict.fromkeys(("command", "incomplete"), LONG_LINE),
    "machine.arithmetic": (re.compile("[0-9a-f]{16}"), "16 hexadecimal digits"),
    "commit": (re.compile(r"[0-9a-f]{7,64}(-dirty)?"), "a commit's hash, with -dirty if files were changed"),
}  # texts that must have a form


def faults_of_fields(
    record: object, fields: Fields = FIELDS, ranges: Ranges | None = None, version: int = VERSION
) -> list[str]:
    """List the faults of a record; ``fields`` as ``FIELDS``, ``ranges`` in addition to ``RANGES``."""
    ranges = RANGES | dict(ranges or {})
    if not isinstance(record, dict):
        return ["the file must hold one JSON object"]
    wrong = []
    for name, (kind, empty, _) in fields.items():
        value: object = record
        for part in name.split("."):
            value = value.get(part, _MISSING) if isinstance(value, dict) else _MISSING
        if value is _MISSING:
            wrong.append(f"{name}: is missing")
        elif not (value is None and empty) and (  # True is no number
            not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool)
        ):
            wrong.append(fault(name, value, _WORDS.get(kind, "a number") + " or null" * empty))
        elif value is not None and (allowed := _requirement(name, value, ranges)):
            wrong.append(fault(name, value, allowed))
    for name, inner in record.items():
        several = isinstance(inner, dict) and name not in fields
        names = [f"{name}.{key}" for key in inner] if several else [name]
        wrong += [f"{one}: is no field of version {version}" for one in names if one not in fields]
    return wrong


_MISSING = object()
_WORDS = {str: "a text", int: "a whole number", bool: "true or false", list: "a list", dict: "an object"}


def _requirement(name, value, ranges):
    """What a value of the right type must be instead; None if it is sound."""
    if name in ranges and not (ranges[name][0] <= value <= ranges[name][1] and str(value) != "-0.0"):
        return f"between {ranges[name][0]:g} and {ranges[name][1]:g}"
    if name in PATTERNS and not PATTERNS[name][0].fullmatch(value):
        return PATTERNS[name][1]
    if name != "date":
        return None
    try:
        sound = datetime.strptime(value, DATE).strftime(DATE) == value
    except ValueError:
        sound = False
    if not sound:
        return "a time in UTC, as 2026-11-22T19:00:00Z"
    latest = (datetime.now(timezone.utc) + timedelta(hours=1)).strftime(DATE)
    return None if BEGUN <= value <= latest else f"between {BEGUN} and now"


def line(text: str) -> str:
    """A text as one line that a result file may hold."""
    return re.sub(f"[{_CONTROL}]+", " ", text)[:2000]


def shorten(value: object) -> str:
    """A value in at most 60 characters of one line, for a message."""
    try:
        text = repr(value)
    except ValueError:  # a whole number of thousands of digits
        text = "a number too long to print"
    return text if len(text) <= 60 else text[:57] + "..."


def fault(name: str, value: object, must: str) -> str:
    """The line for a value that must be something else."""
    return f"{name} = {shorten(value)}: must be {must}"
