"""How is a file written so that nobody ever sees half of it? Beside its place first, then moved there."""

import os
from collections.abc import Callable
from pathlib import Path


def write_whole(path: str | Path, write: Callable[[Path], object]) -> None:
    """Have ``write(temporary)`` make a file beside ``path`` and put it in its place: after a crash the old file is there, or the new one.

    The temporary file has the suffix of ``path`` and belongs to this process alone; if anything fails, nothing is left of it.
    """
    target = Path(os.path.realpath(path))
    temporary = target.with_name(f".{target.stem}.{os.getpid()}.part{target.suffix}")
    try:
        write(temporary)
        with temporary.open("rb+") as file:
            os.fsync(file.fileno())
        temporary.replace(target)
    except BaseException as error:
        temporary.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.filename == str(temporary):
            error.filename = str(path)  # the file that the caller named
        raise
