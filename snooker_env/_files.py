"""How is a file written so that no reader ever sees half of it? Beside it, to be moved there."""

import os
import re
from collections.abc import Callable
from pathlib import Path

UNFINISHED = re.compile(r"\..+\.[0-9a-f]{16}\.tmp(\.\w+)?")
"""Names of the temporary files; a process that was killed leaves one behind."""


def write_atomic(path: str | Path, content: bytes | str | Callable[[Path], object]) -> None:
    """Write a file so that ``path`` holds the old or the new content, complete, whenever the machine stops.

    ``content``: bytes, a text, or a function that writes the file at a path with the same suffix. On failure
    nothing is left, and the OSError names ``path``. A device or a pipe is written directly.
    """
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
