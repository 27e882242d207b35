"""How are kernels compiled? The one place that knows numba's options; ``_cache.py`` knows where the machine code is kept.

* Strict IEEE everywhere: ``fastmath`` would let a freshly compiled and a cached kernel give different trajectories.
* No ``prange``: GNU OpenMP kills forked workers. Threads run ``nogil`` kernels over slices of a batch instead.
* Only entry kernels are cached, under the hash of all the source that they may have been made from.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

import numba
from numba.core.registry import CPUDispatcher

from ._cache import CACHE_FOLDER, Kept
from ._notices import Cost

_OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy"}
_INNER: dict[str, Any] = _OPTIONS | {"_nrt": False, "no_cfunc_wrapper": True, "no_cpython_wrapper": True}
_INLINED: dict[str, Any] = _INNER | {"inline": "always"}

ENTRIES: list[Any] = []
"""All entry kernels that were made, in the order of their making."""


class _Inner(CPUDispatcher):
    """What ``kernel`` makes: machine code without the wrapper for calls from Python, which costs a sixth of all compiling."""

    def __call__(self, *args, **kwargs):
        raise TypeError(f"{self.py_func.__qualname__} is an inner kernel: only kernels can call it")


def _inner(function, options):
    made = numba.njit(**options)(function)
    if isinstance(made, CPUDispatcher):  # with NUMBA_DISABLE_JIT it is the function itself
        made.__class__ = _Inner
    return made


def kernel(function: Callable[..., Any] | None = None, *, seconds: int = 0, uses: tuple[Any, ...] = ()) -> Any:
    """Compile an inner kernel: called from other kernels, never from Python, never cached by itself.

    It may not make arrays. So numba need not count references to those it is given (``_nrt``), which costs a fifth of a shot.
    ``seconds``: how long a large one takes to compile on a quiet machine, besides the other large ones that it ``uses``.
    """
    if function is None:
        return partial(kernel, seconds=seconds, uses=uses)
    made: Any = _inner(function, _INNER)
    made.cost = Cost("", seconds, uses)
    return made


def inlined(function: Callable[..., Any]) -> Any:
    """Compile an inner kernel as a part of its one caller, a large ``kernel``: else its code would be optimised once more there."""
    return _inner(function, _INLINED)


def entry(function: Callable[..., Any] | None = None, *, what: str = "", seconds: int = 0, uses: tuple[Any, ...] = ()) -> Any:
    """Compile a kernel that Python calls: its machine code is kept on disk.

    One that takes over a second to compile says ``what`` it is, for a line on stderr before it does; ``seconds`` and ``uses`` as for
    ``kernel``.
    """
    if function is None:
        return partial(entry, what=what, seconds=seconds, uses=uses)
    made: Any = numba.njit(**_OPTIONS)(function)
    if made is not function:  # with NUMBA_DISABLE_JIT it is
        made.cost = Cost(what, seconds, uses)
        if CACHE_FOLDER is not None:
            made._cache = Kept(function)
        ENTRIES.append(made)
    return made
