"""How are kernels compiled? The one place of numba's options; ``cache.py`` says where machine code is kept.

* Strict IEEE: with ``fastmath`` a fresh and a cached kernel could give different trajectories.
* No ``prange``: GNU OpenMP kills forked workers. Threads run ``nogil`` kernels over slices of a batch."""

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

import numba
from numba.core.registry import CPUDispatcher

from .cache import CACHE_FOLDER, Kept, lies_in_a_file
from .inner import ENTRY_OPTIONS, OPTIONS, Inner
from .notices import Cost

_OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy"}
_ENTRY: dict[str, Any] = _OPTIONS | ENTRY_OPTIONS
_INNER: dict[str, Any] = _OPTIONS | OPTIONS
_INLINED: dict[str, Any] = _INNER | {"inline": "always"}

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


def _inner(function, options):
    made = numba.njit(**options)(function)
    if isinstance(made, CPUDispatcher):  # with NUMBA_DISABLE_JIT it is the function itself
        made.__class__ = Inner
    return made


def kernel(
    function: Callable[..., Any] | None = None, *, seconds: int = 0, uses: tuple[Any, ...] = ()
) -> Any:
    """Compile an inner kernel, which other kernels call. Use as a decorator.

    Python cannot call it. It must not make arrays, so that numba need not count references: a fifth of a shot.

    Parameters
    ----------
    function : callable, optional
        The function to compile; None: the call returns a decorator.
    seconds : int
        Time to compile it on a quiet machine [s], without large kernels that it uses; 0: less than one.
    uses : tuple of kernels
        The large kernels (``seconds`` above 0) that it calls, for the notice before a long compile.

    Returns
    -------
    kernel
        The compiled function, which compiles at its first use; or a decorator.

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
    if function is None:
        return partial(kernel, seconds=seconds, uses=uses)
    made: Any = _inner(function, _INNER)
    made.cost = Cost("", seconds, uses)
    return made


def inline(function: Callable[..., Any]) -> Any:
    """Compile an inner kernel into its one caller, a large ``kernel``, so as to optimise its code once."""
    return _inner(function, _INLINED)


def entry(
    function: Callable[..., Any] | None = None,
    *,
    what: str = "",
    seconds: int = 0,
    uses: tuple[Any, ...] = (),
) -> Any:
    """Compile a kernel that Python calls. Use as a decorator.

    Its machine code is kept on disk, under a hash of the source of the package and of its module. A function
    outside any file (in a prompt or a notebook) is compiled in every process.

    Parameters
    ----------
    function : callable, optional
        The function to compile; None: the call returns a decorator.
    what : str
        What it is, for the line on stderr before a compile of more than a second; "": no line.
    seconds : int
        Time to compile it on a quiet machine [s], without the large kernels that it uses.
    uses : tuple of kernels
        The large kernels that it calls.

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
        return partial(entry, what=what, seconds=seconds, uses=uses)
    made: Any = numba.njit(**_ENTRY)(function)
    if made is not function:  # with NUMBA_DISABLE_JIT it is the function itself
        made.__class__ = Entry
        made.cost = Cost(what, seconds, uses)
        if CACHE_FOLDER is not None and lies_in_a_file(function):
            made._cache = Kept(function)
        ENTRIES.append(made)
    return made
