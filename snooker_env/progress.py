"""How far is a long command? On a terminal ``tqdm`` says it, elsewhere a line a minute, with ``SNOOKER_ENV_QUIET=1`` nothing."""

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import TextIO

from tqdm import tqdm

__all__ = ["Progress"]

EVERY = 60.0  # between two lines [s]


class Progress(tqdm):
    """A progress bar of ``tqdm`` for a part of a long command: what it does, how far and fast it is, the time left.

    Parameters
    ----------
    what, total, unit
        The work in words, its amount, and its unit in the plural.
    done : int
        Amount that an earlier run did, if this one resumes it.
    to : text stream, optional
        Default None: ``sys.stderr``. If it is no terminal, it gets a line a minute.

    Examples
    --------
    >>> from snooker_env.progress import Progress
    >>> with Progress("self-play", 4, "frames") as progress:
    ...     for frame in range(4):
    ...         progress.at(frame + 1, "lead 3.2")
    """

    def __init__(self, what: str, total: int, unit: str, *, done: int = 0, to: TextIO | None = None):
        self.done: int = done
        self._what, self._all, self._last = what, f"{total:,} {unit}", time.monotonic()
        self._to, self._silent = to or sys.stderr, os.environ.get("SNOOKER_ENV_QUIET", "0") not in ("", "0")
        super().__init__(
            desc=what,
            total=total,
            initial=done,
            unit=f" {unit}",
            file=self._to,
            disable=True if self._silent else None,  # None: where there is no terminal
            dynamic_ncols=True,
        )

    def at(self, done: int, figures: str = "") -> None:
        """Note how much is done, and ``figures`` to say with it."""
        self.set_postfix_str(figures, refresh=False)
        self.update(done - self.done)
        self.done, now = done, time.monotonic()
        if self.disable and not self._silent and now - self._last >= EVERY:
            self._last = now
            line = f"{self._what}: {done:,} of {self._all}{figures and ', '}{figures}"
            print(line, file=self._to, flush=True)


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
