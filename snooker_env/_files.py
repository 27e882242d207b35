"""How are files written so that no reader ever sees half of one, beside them, to be moved there; and how is JSON read?"""

import json
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

UNFINISHED = re.compile(r"\..+\.[0-9a-f]{16}\.tmp(\.\w+)?")  # temporary files: a killed process leaves one


def write_atomic(path: str | Path, content: bytes | str | Callable[[Path], object]) -> None:
    """Write a file so that ``path`` holds the old or the new content, complete, whenever the machine stops.

    ``content``: bytes, a text, or a function that writes the file at a path with the same suffix. On failure
    nothing is left, and the OSError names ``path``. A device or a pipe is written directly."""
    target, data = Path(os.path.realpath(path)), content.encode() if isinstance(content, str) else content
    write = data if callable(data) else lambda file: file.write_bytes(data)
    if target.exists() and not target.is_file():
        write(target)
        return
    name = f".{target.stem}.{os.urandom(8).hex()}.tmp{target.suffix}"  # that no machine uses twice
    temporary = target.with_name(name)
    try:
        write(temporary)
        with temporary.open("rb+") as file:
            os.fsync(file.fileno())
        os.replace(temporary, target)
    except BaseException as error:
        temporary.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.filename in (None, str(temporary)):
            error.filename = str(path)  # the file that the caller named
            del error.filename2
        raise


def strict_json(text: str) -> Any:
    """What a text of JSON holds; ValueError for NaN or Infinity, too, and for a key twice in one object."""

    def no_number(name: str) -> Any:
        raise ValueError(f"{name} is no number of JSON")

    def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        made: dict[str, Any] = {}
        for name, value in pairs:
            if name in made:
                raise ValueError(f"the key {name!r} stands there twice")
            made[name] = value
        return made

    return json.loads(text, parse_constant=no_number, object_pairs_hook=once)


def read_json(path: str | Path) -> Any:
    """``strict_json`` of a file in UTF-8; the ValueError names it."""
    try:
        return strict_json(Path(path).read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{path}: must be JSON ({error})") from None
