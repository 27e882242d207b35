"""What does compiling report, unless ``SNOOKER_ENV_QUIET=1``? Each compile of over a second, on stderr."""

import os
import sys
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


_bars: list[Callable[[], None]] = []  # of the warm-ups that run


@contextmanager
def warming_up(kernels: Iterable[Any], tick: Callable[[int, int], None]) -> Iterator[None]:
    """Within this context notices are, on a terminal, a bar of the ``kernels``: ``tick(ready, all)`` before each long compile."""
    asked, shown = [kernel for kernel in kernels if not kernel.signatures], []

    def show() -> None:
        shown.append(sum(bool(kernel.signatures) for kernel in asked))
        tick(shown[-1], len(asked))

    _bars.append(show)
    try:
        yield
        if shown:
            show()
    finally:
        _bars.pop()


class _Listener(event.Listener):
    """numba calls it for every compile of this process, that is for what was not in the cache."""

    def on_start(self, event):
        kernel = (event.data or {}).get("dispatcher")
        cost = getattr(kernel, "cost", None)  # other packages compile too
        if cost is None or not cost.what or (seconds := cost.total()) < 1:
            return
        if _bars and sys.stderr is not None and sys.stderr.isatty():
            _bars[-1]()
            return
        cache = getattr(kernel, "_cache", None)
        kept = isinstance(cache, Kept) and cache.has_room()
        once, where = ("once, ", f"kept in {CACHE_FOLDER}") if kept else ("", "for this process only")
        hint = "" if _bars else "python -m snooker_env warmup compiles everything ahead; "
        text = f"compiling {cost.what} to machine code, {once}about {seconds} s"
        say(f"{text} ({where}; {hint}SNOOKER_ENV_QUIET=1 hides this)")

    def on_end(self, event):
        pass


event.register("numba:compile", _Listener())
