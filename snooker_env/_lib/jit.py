"""How are kernels compiled, and what is said of it? The one place of numba's options; ``cache.py`` keeps machine code.

* Strict IEEE: with ``fastmath`` a fresh and a cached kernel could give different trajectories.
* No ``prange``: GNU OpenMP kills forked workers. Threads run ``nogil`` kernels over slices of a batch."""

import dis
import gc
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

import numba
from numba.core import event
from numba.core.registry import CPUDispatcher

from .cache import CACHE_FOLDER, Kept, lies_in_a_file
from .command import say
from .inner import ENTRY_OPTIONS, OPTIONS, Inner

# of "raise", of "assert" and, in Python 3.10, of "try": newer ones keep a table of it
_ERRORS = {dis.opmap[name] for name in ("RAISE_VARARGS", "SETUP_FINALLY") if name in dis.opmap}
_OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy"}

ENTRIES: list[Any] = []  # all entry kernels of this process, in the order in which they were made


@contextmanager
def collecting_no_garbage() -> Iterator[None]:
    """Let Python collect no garbage: it takes a seventh of a compile's time, and a sixteenth between compiles."""
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()


class Entry(CPUDispatcher):
    """What ``entry`` makes of a function."""

    def compile(self, sig: Any) -> Any:
        """Compile it for these types, or load it."""
        with collecting_no_garbage():
            return super().compile(sig)


def _inner(function, **options):
    code = function.__code__  # of each two bytes the first says what to do
    if not _ERRORS.isdisjoint(code.co_code[::2]) or getattr(code, "co_exceptiontable", b""):
        raise TypeError(f"{function.__qualname__} raises or catches errors, which no inner kernel can")
    made = numba.njit(**_OPTIONS, **OPTIONS, **options)(function)
    if isinstance(made, CPUDispatcher):  # with NUMBA_DISABLE_JIT it is the function itself
        made.__class__ = Inner
    return made


def kernel(function: Callable[..., Any]) -> Any:
    """Compile an inner kernel, which other kernels call. Use as a decorator.

    Python cannot call it. It must not make arrays, so that numba need not count references: a fifth of a shot. Nor
    may anything in it raise, or two kernels call each other: no call asks whether it failed, and the result is undefined.

    Parameters
    ----------
    function : callable
        The function to compile.

    Returns
    -------
    kernel
        The compiled function, which compiles at its first use.

    Examples
    --------
    >>> from snooker_env.kernels import entry, kernel
    >>> @kernel
    ... def double(x):
    ...     return 2.0 * x
    >>> double(1.0)
    Traceback (most recent call last):
    ...
    TypeError: double is an inner kernel: only kernels can call it
    """
    return _inner(function)


def inline(function: Callable[..., Any]) -> Any:
    """Compile an inner kernel into its one caller, a large ``kernel``, so as to optimise its code once."""
    return _inner(function, inline="always")


def entry(function: Callable[..., Any] | None = None, *, what: str = "", seconds: int = 0) -> Any:
    """Compile a kernel that Python calls. Use as a decorator.

    Its machine code is kept on disk, under a hash of the source of the package and of its module. A function
    outside any file (in a prompt or a notebook) is compiled in every process.

    Parameters
    ----------
    function : callable, optional
        The function, or inner kernel, to compile; None: the call returns a decorator.
    what, seconds
        What it is, and the most time [s] that a quiet machine compiles it: for the line on stderr before. "": no line.

    Returns
    -------
    kernel
        The compiled function, which compiles or is loaded at its first call; or a decorator.

    Examples
    --------
    >>> import numpy as np
    >>> from snooker_env.kernels import balls_on, bits, entry
    >>> @entry
    ... def mask_on(ball_on, on_table):
    ...     return balls_on(ball_on, bits(on_table))
    >>> on_table = np.ones(22, np.bool_)
    >>> mask_on(1, on_table) == 0xFFFE  # a red is on: balls 1 to 15
    True
    """
    if function is None:
        return partial(entry, what=what, seconds=seconds)
    plain: Any = getattr(function, "py_func", function)
    made: Any = numba.njit(**_OPTIONS, **ENTRY_OPTIONS)(plain)
    if made is not plain:  # with NUMBA_DISABLE_JIT it is the function itself
        made.__class__ = Entry
        made.notice = what, seconds
        if CACHE_FOLDER is not None and lies_in_a_file(plain):
            made._cache = Kept(plain)
        ENTRIES.append(made)
    return made


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
        what, seconds = getattr(kernel, "notice", ("", 0))  # other packages compile too
        if not what:
            return
        if _bars and sys.stderr is not None and sys.stderr.isatty():
            _bars[-1]()
            return
        cache = getattr(kernel, "_cache", None)
        kept = isinstance(cache, Kept) and cache.has_room()
        once, where = ("once, ", f"kept in {CACHE_FOLDER}") if kept else ("", "for this process only")
        hint = "" if _bars else "python -m snooker_env warmup compiles everything ahead; "
        text = f"compiling {what} to machine code, {once}up to {seconds} s"
        say(f"{text} ({where}; {hint}SNOOKER_ENV_QUIET=1 hides this)")

    def on_end(self, event):
        pass


event.register("numba:compile", _Listener())
