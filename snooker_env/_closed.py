"""What does a command do when nobody reads its output on, as in ``... | head``? It ends, without a word."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def until_closed() -> Iterator[None]:
    """Around all that a command prints, ``--help`` too: SystemExit(1) once the reader has left."""
    try:
        try:
            yield
        finally:
            sys.stdout.flush()  # what is left would be lost without a word, or be said when Python ends
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise SystemExit(1) from None
