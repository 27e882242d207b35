"""How is a position kept in a file? As a small JSON object, replaced in one step, and read with strict checks."""

import json
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from .._check import choice, refuse, refuse_what
from .._files import write_atomic
from ..physics.table import TableLike
from .position import Position

NAMES = tuple(f.name for f in fields(Position))
"""Keys that a position in JSON may have."""


def of_dict(given: Any, table: TableLike, field: str = "position") -> Position:
    """The position of a dict of JSON types. ValueError names any key that is not allowed."""
    if not isinstance(given, Mapping):
        raise refuse_what(field, f"a {type(given).__name__}", f"must be a dict with keys of {', '.join(NAMES)}")
    for key in given:
        choice(f"key of {field}", key, NAMES)
    for key, value in given.items():
        if any(isinstance(x, bool) for place in _places(value) for x in place):  # NumPy converts them to 0 and 1
            raise refuse(key, value, "must be two real numbers" + (" for each ball" if key == "reds" else ""))
    return Position(**given, table=table)


def _places(value: Any) -> list[Any]:
    """The lists of numbers in a value: of one ball, or of several."""
    if not isinstance(value, list | tuple):
        return []
    return [part for part in value if isinstance(part, list | tuple)] or [value]


def write(position: Position, path: str | Path) -> None:
    """Write the file: after a crash it holds either the old position or the new one, whole."""
    text = json.dumps(position.to_dict()) + "\n"
    write_atomic(path, text)


def read(path: str | Path, table: TableLike) -> Position:
    """Read a file of ``write``. ValueError, naming the file, the key or the ball that is wrong, unless it is JSON of a position."""
    try:
        text = Path(path).read_text(encoding="utf-8")
        given = json.loads(text, object_pairs_hook=_once)
    except (UnicodeDecodeError, json.JSONDecodeError, RecursionError) as error:
        raise refuse("path", str(path), f"must be a file of JSON ({error})") from None
    return of_dict(given, table, str(path))


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A JSON object as a dict; ValueError if a key is there twice."""
    out = dict(pairs)
    if len(out) < len(pairs):
        names = [key for key, _ in pairs]
        raise refuse("key of the position", next(key for key in names if names.count(key) > 1), "must be there once")
    return out
