"""How is a file written so that no reader ever sees half of it? Into a temporary file beside it, which is then moved there."""

import itertools
import os
from collections.abc import Callable
from pathlib import Path

_NUMBERS = itertools.count()


def write_whole(path: str | Path, write: Callable[[Path], object]) -> None:
    """Let ``write(temporary)`` make a file in the folder of ``path``, then move it to ``path``.

    After a crash the old file is there, or the new one.

    The temporary file has the suffix of ``path`` and a name that no other call uses. If anything fails, it is removed.
    """
    target = Path(os.path.realpath(path))
    temporary = target.with_name(f".{os.getpid()}-{next(_NUMBERS)}{target.suffix}")
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
