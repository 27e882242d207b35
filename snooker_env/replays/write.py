"""How is a file written so that nobody ever sees half of it? Beside its place first, then moved there."""

from collections.abc import Callable
from pathlib import Path


def write_whole(target: Path, write: Callable[[Path], object]) -> None:
    """Have ``write(path)`` make a file beside the target and put it in its place: nobody sees half a file."""
    temporary = target.with_name(f".{target.stem}.part{target.suffix}")
    try:
        write(temporary)
        temporary.replace(target)
    finally:
        temporary.unlink(missing_ok=True)
