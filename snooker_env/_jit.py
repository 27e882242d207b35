"""How are kernels compiled and where is the machine code kept? The one place that knows numba's options and the cache folder.

* Strict IEEE everywhere: ``fastmath`` would let a freshly compiled and a cached kernel give different trajectories.
* No ``prange``: GNU OpenMP kills forked workers. Threads run ``nogil`` kernels over slices of a batch instead.
* numba notices a change only in the file that *defines* a cached function; a changed callee or constant in another file would
  silently run old machine code. So the cache folder's name is a hash of the whole package source: other source, other folder. Kernels of
  a folder outside the package (agents, benchmarks) have a folder in it, named by a hash of that folder's source.
"""

import hashlib
import os
import tempfile
import warnings
from functools import cache
from pathlib import Path
from typing import Any

import numba
from numba.core import config
from numba.core.registry import CPUDispatcher

_PACKAGE = Path(__file__).resolve().parent


def source_hash(root=_PACKAGE):
    """A hash of every Python file of the package, names included (16 hex digits)."""
    h = hashlib.sha256()
    for path in sorted(root.rglob("*.py")):
        h.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return h.hexdigest()[:16]


def _writable(folder):
    """Can files be made there? Asked by making one: access bits lie on read-only mounts and for root."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def cache_folder():
    """Where compiled entry kernels are kept, or None (then they live in memory only).

    ``$NUMBA_CACHE_DIR`` if set, else ``$XDG_CACHE_HOME`` or ``~/.cache``; below it ``snooker_env/<source hash>``.
    """
    home = os.environ.get("NUMBA_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    folder = Path(home) / "snooker_env" / source_hash()
    if _writable(folder):
        return folder
    warnings.warn(f"{folder} is not writable: every process compiles for itself; set NUMBA_CACHE_DIR", RuntimeWarning, stacklevel=2)
    return None


CACHE_FOLDER = cache_folder()


_OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy"}
_INNER: dict[str, Any] = _OPTIONS | {"_nrt": False, "no_cfunc_wrapper": True, "no_cpython_wrapper": True}
_INLINED: dict[str, Any] = _INNER | {"inline": "always"}


class _Inner(CPUDispatcher):
    """What ``kernel`` makes: machine code without the wrapper for calls from Python, which costs a sixth of all compiling."""

    def __call__(self, *args, **kwargs):
        raise TypeError(f"{self.py_func.__qualname__} is an inner kernel: only kernels can call it")


def _inner(function, options):
    made = numba.njit(**options)(function)
    if isinstance(made, CPUDispatcher):  # with NUMBA_DISABLE_JIT it is the function itself
        made.__class__ = _Inner
    return made


def kernel(function):
    """Compile an inner kernel: called from other kernels, never from Python, never cached by itself.

    It may not make arrays. So numba need not count references to those it is given (``_nrt``), which costs a fifth of a shot.
    """
    return _inner(function, _INNER)


def inlined(function):
    """Compile an inner kernel as a part of its one caller, a large ``kernel``: else its code would be optimised once more there."""
    return _inner(function, _INLINED)


@cache
def _cache_of(folder, home):
    """Where below ``home`` the kernels are kept that are defined in files of this folder."""
    return home if folder.is_relative_to(_PACKAGE) else home / source_hash(folder)


def entry(function):
    """Compile a kernel that Python calls: cached on disk under the hash of the source that it may have been made from."""
    if CACHE_FOLDER is None:
        return numba.njit(**_OPTIONS)(function)
    folder = _cache_of(Path(function.__code__.co_filename).resolve().parent, CACHE_FOLDER)
    before, config.CACHE_DIR = config.CACHE_DIR, str(folder)  # pyright: ignore[reportAttributeAccessIssue]
    try:  # numba reads CACHE_DIR while it decorates, so the setting can be ours for just that moment
        return numba.njit(**_OPTIONS, cache=True)(function)
    finally:
        config.CACHE_DIR = before  # pyright: ignore[reportAttributeAccessIssue]
