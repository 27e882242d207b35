"""How does a command end? With an exit code; what stops it from outside is one line, or none if nobody reads its output."""

import errno
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

INTERRUPTED = 130  # the exit code after Ctrl-C, as shells have it
DISK = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS, errno.EIO)  # of a full or failing disk


def say(text: str) -> None:
    """Print a line to stderr, unless ``SNOOKER_ENV_QUIET`` is set or there is no stderr."""
    if os.environ.get("SNOOKER_ENV_QUIET", "0") in ("", "0") and sys.stderr is not None:
        with suppress(OSError, ValueError):
            print(f"snooker_env: {text}", file=sys.stderr, flush=True)


@contextmanager
def stop_with_reader() -> Iterator[None]:
    """Around all that a command prints, ``--help`` too: SystemExit(1) once the reader has left, as in ``... | head``."""
    try:
        try:
            yield
        finally:
            sys.stdout.flush()  # text left in the buffer would be lost in silence, or reported as Python ends
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise SystemExit(1) from None


def of_file(error: OSError) -> str:
    """The error of a file or a full disk in words."""
    if error.strerror is None:
        return str(error)
    written = " cannot be written" if error.errno in DISK else ""
    return f"{error.filename or 'the output'}{written}: {error.strerror}"


def exit_code(name: str, command: Callable[[], int], missing: Callable[[ImportError], str] = str) -> int:
    """The result of ``command()``; 130 after Ctrl-C, 1 if a library is missing (``missing`` says how to install it) or a file
    cannot be read or written, with one line on stderr that begins with ``name``."""
    code = 1
    try:
        with stop_with_reader():
            return command()
    except KeyboardInterrupt:
        why, code = "interrupted", INTERRUPTED
    except ImportError as error:
        why = missing(error)
    except OSError as error:
        why = of_file(error)
    print(f"{name}: {why}", file=sys.stderr)
    return code
