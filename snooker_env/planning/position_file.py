"""How is a position kept in a file? As a small JSON object, replaced in one step, and read with strict
checks."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from .._check import choice, refuse, refuse_what
from .._files import write_atomic


def checked(raw: Any, names: Sequence[str], field: str = "position") -> Mapping[str, Any]:
    """A dict of JSON types that has keys of ``names`` only and no truth values where numbers belong."""
    if not isinstance(raw, Mapping):
        raise refuse_what(field, f"a {type(raw).__name__}", f"must be a dict with keys of {', '.join(names)}")
    for key in raw:
        choice(f"key of {field}", key, names)
    for key, value in raw.items():
        # NumPy converts them to 0 and 1
        if any(isinstance(x, bool) for place in _places(value) for x in place):
            raise refuse(key, value, "must be two real numbers" + (" for each ball" if key == "reds" else ""))
    return raw


def _places(value: Any) -> list[Any]:
    """The lists of numbers in a value: of one ball, or of several."""
    if not isinstance(value, list | tuple):
        return []
    return [part for part in value if isinstance(part, list | tuple)] or [value]


def write(position: dict[str, Any], path: str | Path) -> None:
    """Write the file: after a crash it holds either the old position or the new one, whole."""
    write_atomic(path, json.dumps(position) + "\n")


def read(path: str | Path, names: Sequence[str]) -> Mapping[str, Any]:
    """Read a file of ``write``; ValueError names the file or the key that is wrong."""
    try:
        text = Path(path).read_text(encoding="utf-8")
        raw = json.loads(text, object_pairs_hook=_once)
    except (UnicodeDecodeError, json.JSONDecodeError, RecursionError) as error:
        raise refuse("path", str(path), f"must be a file of JSON ({error})") from None
    return checked(raw, names, str(path))


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A JSON object as a dict; ValueError if a key is there twice."""
    out = dict(pairs)
    if len(out) < len(pairs):
        names = [key for key, _ in pairs]
        repeated = next(key for key in names if names.count(key) > 1)
        raise refuse("key of the position", repeated, "must be there once")
    return out
