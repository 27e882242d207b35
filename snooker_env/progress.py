"""How far is a long command? On a terminal ``tqdm`` says it; elsewhere, and with ``SNOOKER_ENV_QUIET=1``, nothing does."""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import TextIO

from tqdm import tqdm

__all__ = ["Progress"]


class Progress(tqdm):
    """A progress bar of ``tqdm`` for a part of a long command: what it does, how far and fast it is, the time left.

    Parameters
    ----------
    what, total, unit
        The work in words, its amount, and its unit in the plural.
    done : int
        Amount that an earlier run did, if this one resumes it.
    to : text stream, optional
        Default None: ``sys.stderr``. Nothing is written unless it is a terminal.

    Examples
    --------
    >>> from snooker_env.progress import Progress
    >>> with Progress("self-play", 4, "frames") as progress:
    ...     for frame in range(4):
    ...         progress.at(frame + 1, "lead 3.2")
    """

    def __init__(self, what: str, total: int, unit: str, *, done: int = 0, to: TextIO | None = None):
        self.done: int = done
        silent = os.environ.get("SNOOKER_ENV_QUIET", "0") not in ("", "0")
        super().__init__(
            desc=what,
            total=total,
            initial=done,
            unit=f" {unit}",
            file=to or sys.stderr,
            disable=True if silent else None,  # None: where there is no terminal
            dynamic_ncols=True,
        )

    def at(self, done: int, figures: str = "") -> None:
        """Note how much is done, and ``figures`` to say with it."""
        self.set_postfix_str(figures, refresh=False)
        self.update(done - self.done)
        self.done = done


@contextmanager
def ticking(what: str, unit: str) -> Iterator[Callable[[int, int], None]]:
    """A function of work done and total that shows the progress, from its first call on."""
    with ExitStack() as ending:
        shown_by: list[Progress] = []

        def tick(done: int, total: int) -> None:
            if not shown_by:
                shown_by.append(ending.enter_context(Progress(what, total, unit, done=done)))
            shown_by[0].at(done)

        yield tick
