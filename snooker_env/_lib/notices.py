"""What does compiling report, unless ``SNOOKER_ENV_QUIET=1``? Each compile of over a second, on stderr."""

import os
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import Any, NamedTuple

from numba.core import event

from .cache import CACHE_FOLDER, Kept


def say(text: str) -> None:
    """Print a line to stderr, unless ``SNOOKER_ENV_QUIET`` is set or there is no stderr."""
    if os.environ.get("SNOOKER_ENV_QUIET", "0") in ("", "0") and sys.stderr is not None:
        with suppress(OSError, ValueError):
            print(f"snooker_env: {text}", file=sys.stderr, flush=True)


AHEAD = "python -m snooker_env warmup compiles everything ahead; "


class Cost(NamedTuple):
    """The time that the compiling of a kernel takes; fields as the arguments of ``jit.entry``."""

    what: str
    seconds: int
    uses: tuple[Any, ...]

    def total(self) -> int:
        """Time [s], with the large kernels that it uses and that are not compiled yet."""
        return self.seconds + sum(kernel.cost.seconds for kernel in self._missing())

    def _missing(self):
        direct = {kernel for kernel in self.uses if not kernel.signatures}
        return direct.union(*(kernel.cost._missing() for kernel in direct))


class _WarmUp:
    """The kernels that a warm-up makes ready."""

    def __init__(self, kernels, tick):
        self.kernels = [kernel for kernel in kernels if not kernel.signatures]
        self.tick = tick
        self.spoke = False

    def note(self, text, line="warm-up, kernel {} of {}: {}"):
        """On a terminal the bar, else a line."""
        self.spoke = True
        ready, many = sum(bool(kernel.signatures) for kernel in self.kernels), len(self.kernels)
        if sys.stderr is not None and sys.stderr.isatty():
            self.tick(ready, many)
        else:
            say(line.format(min(ready + 1, many), many, text))


_running: list[_WarmUp] = []


@contextmanager
def warming_up(kernels: Iterable[Any], tick: Callable[[int, int], None]) -> Iterator[None]:
    """Within this context notices count the ``kernels``, on a terminal by ``tick(ready, all)``; the last gives the whole time."""
    _running.append(_WarmUp(kernels, tick))
    start = time.perf_counter()
    try:
        yield
        if _running[-1].spoke:
            elapsed = f"{time.perf_counter() - start:.0f} s"
            _running[-1].note(elapsed, "warm-up: {1} kernels ready after {2}")
    finally:
        _running.pop()


class _Listener(event.Listener):
    """numba calls it for every compile of this process, that is for what was not in the cache."""

    def on_start(self, event):
        kernel = (event.data or {}).get("dispatcher")
        cost = getattr(kernel, "cost", None)  # other packages compile too
        if cost is None or not cost.what or (seconds := cost.total()) < 1:
            return
        cache = getattr(kernel, "_cache", None)
        kept = isinstance(cache, Kept) and cache.has_room()
        text = f"compiling {cost.what} to machine code, {'once, ' if kept else ''}about {seconds} s"
        where = f"kept in {CACHE_FOLDER}" if kept else "for this process only"
        if not _running:
            say(f"{text} ({where}; {AHEAD}SNOOKER_ENV_QUIET=1 hides this)")
        elif _running[-1].spoke:  # where it is kept is said once
            _running[-1].note(text)
        else:
            _running[-1].note(f"{text} ({where}; SNOOKER_ENV_QUIET=1 hides this)")

    def on_end(self, event):
        pass


event.register("numba:compile", _Listener())
