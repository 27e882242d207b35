"""What does a user hear of compiling? One line on stderr before each compile that takes over a second, and how far a warm-up is.

``SNOOKER_ENV_QUIET=1`` silences both. Nothing is said of machine code that is loaded from the cache.
"""

import os
import sys
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import Any, NamedTuple

from numba.core import event

from ._cache import CACHE_FOLDER


def say(text: str) -> None:
    """A line on stderr, unless the user wants none or has no stderr."""
    if os.environ.get("SNOOKER_ENV_QUIET", "0") in ("", "0") and sys.stderr is not None:
        with suppress(OSError, ValueError):
            print(f"snooker_env: {text}", file=sys.stderr, flush=True)


class Cost(NamedTuple):
    """What the compiling of a kernel costs; fields as the arguments of ``_jit.entry``."""

    what: str
    seconds: int
    uses: tuple[Any, ...]

    def total(self) -> int:
        """How long it will take [s]: the large kernels that it uses are compiled with it unless that was done before in this process."""
        return self.seconds + sum(kernel.cost.seconds for kernel in self._missing())

    def _missing(self):
        direct = {kernel for kernel in self.uses if not kernel.signatures}
        return direct.union(*(kernel.cost._missing() for kernel in direct))


class _WarmUp:
    """Which kernels a warm-up makes ready."""

    def __init__(self, kernels):
        self.kernels = [kernel for kernel in kernels if not kernel.signatures]
        self.spoke = False

    def place(self):
        """Which one is next, of how many, for a line that is said now."""
        self.spoke = True
        return f"warm-up, kernel {1 + sum(bool(kernel.signatures) for kernel in self.kernels)} of {len(self.kernels)}: "


_running: list[_WarmUp] = []


@contextmanager
def warming_up(kernels: Iterable[Any]) -> Iterator[None]:
    """While it lasts, each notice says which of the ``kernels`` it is about; the last one says how long they all took."""
    _running.append(_WarmUp(kernels))
    start = time.perf_counter()
    try:
        yield
        if _running[-1].spoke:
            say(f"warm-up: {len(_running[-1].kernels)} kernels ready after {time.perf_counter() - start:.0f} s")
    finally:
        _running.pop()


class _Listener(event.Listener):
    """Hears of every compile of this process, after the cache had nothing: numba calls it."""

    def on_start(self, event):
        kernel: Any = (event.data or {}).get("dispatcher")
        cost = getattr(kernel, "cost", None)  # other packages compile too
        if cost is None or not cost.what or (seconds := cost.total()) < 1:
            return
        text = f"compiling {cost.what}, {'once, ' if CACHE_FOLDER else ''}about {seconds} s"
        if not (_running and _running[-1].spoke):  # the rest of a warm-up need not say it again
            text += f" ({f'kept in {CACHE_FOLDER}' if CACHE_FOLDER else 'for this process only'}; SNOOKER_ENV_QUIET=1 hides this)"
        say(_running[-1].place() + text if _running else text)

    def on_end(self, event):
        pass


event.register("numba:compile", _Listener())
