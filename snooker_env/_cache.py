"""Where is machine code kept, and which of it is loaded? A folder of the user's own; nothing of others, nothing old, nothing broken.

* What is kept is pickled: whoever can write there decides what runs here. So the folders are made for the user alone, and one that
  belongs to somebody else or that others can write to is not used. root is trusted: it can do anything anyway.
* numba notices a change only in the file that *defines* a cached function; a changed callee or constant in another file would
  silently run old machine code. So the cache folder's name is a hash of the whole package source: other source, other folder. Kernels
  defined outside the package (agents, benchmarks) have a folder in it, named by a hash of the whole package that they come from. Where
  the source lies does not matter: equal copies share their machine code.
* Each file ends with its checksum: a pickle cut short would raise, but damaged machine code would crash the process.
* Whatever goes wrong, it is compiled again, and said once in a process.
"""

import hashlib
import io
import os
import tempfile
import warnings
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any

from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile, _CacheLocator

_PACKAGE = Path(__file__).resolve().parent
_WRITE_GROUP, _WRITE_OTHERS, _STICKY = 0o020, 0o002, 0o1000
_DIGEST = hashlib.sha256().digest_size


def source_hash(root: Path = _PACKAGE) -> str:
    """A hash of every Python file of the package, names included (16 hex digits)."""
    h = hashlib.sha256()
    for path in sorted(root.rglob("*.py")):
        h.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return h.hexdigest()[:16]


@cache  # what was imported from there stays what it was
def _hash_of(folder: Path) -> str:
    """The hash of the whole package that a folder outside this one belongs to; of the folder alone if it is in none."""
    while (folder / "__init__.py").is_file() and (folder.parent / "__init__.py").is_file():
        folder = folder.parent
    return source_hash(folder)


# Folders that are the user's own


class UnsafeFolderError(OSError):
    """A folder into which somebody else could put code; says which and why."""


def _check_own(folder: Path, *, home: bool = False) -> None:
    """Raise UnsafeFolderError unless only this user (and root) decides what lies in ``folder``, and if it is a link, where that leads.

    ``home`` is the folder that the user has chosen: others may write to it where they cannot exchange what is not theirs (as in /tmp),
    and so may its group, which on many systems is the user alone.
    """
    if not hasattr(os, "geteuid"):  # Windows: these numbers mean nothing there, and a user's folders are closed to others
        return
    for found in (os.lstat(folder), os.stat(folder)):
        if found.st_uid not in (os.geteuid(), 0):
            raise UnsafeFolderError(f"{folder} belongs to another user (uid {found.st_uid})")
    mode = os.stat(folder).st_mode & 0o7777
    if mode & (_WRITE_OTHERS if home else _WRITE_OTHERS | _WRITE_GROUP) and not (home and mode & _STICKY):
        raise UnsafeFolderError(f"others can write to {folder} (mode {mode:04o})")


def _claim(home: Path, folder: Path) -> None:
    """Make ``folder``, which is below ``home``, for this user alone, with all that leads to it; UnsafeFolderError where it is there already
    and is not his alone."""
    for part in (*reversed(folder.parents), folder):
        part.mkdir(0o700, exist_ok=True)
        if part == home or part.is_relative_to(home):
            _check_own(part, home=part == home)


def cache_folder() -> Path | None:
    """Where compiled entry kernels are kept, or None (then they live in memory only).

    ``$NUMBA_CACHE_DIR`` if set, else ``$XDG_CACHE_HOME`` or ``~/.cache``; below it ``snooker_env/<source hash>``.
    """
    chosen = os.environ.get("NUMBA_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    home = Path(chosen).absolute()
    folder = home / "snooker_env" / source_hash()
    try:
        if chosen == "~/.cache":  # of a user without a home: a folder wherever he stands, made by whoever gave it to him
            raise UnsafeFolderError("there is no home folder")
        _claim(home, folder)
        with tempfile.TemporaryFile(dir=folder):  # asked by making one: access bits lie on read-only mounts and for root
            return folder
    except UnsafeFolderError as error:
        why = f"{error}: no machine code is loaded from there or kept there; every process compiles for itself"
        advice = "set NUMBA_CACHE_DIR to a folder of your own, or remove this one"
    except OSError:
        why, advice = f"{folder} is not writable: every process compiles for itself", "set NUMBA_CACHE_DIR"
    warnings.warn(f"{why}; {advice}", RuntimeWarning, stacklevel=2)
    return None


CACHE_FOLDER = cache_folder()


# numba's cache of one kernel, in such a folder

_said = set()


def _warn_once(kind, message):
    if kind not in _said:
        _said.add(kind)
        warnings.warn(message, RuntimeWarning, stacklevel=3)


class _Place(_CacheLocator):
    """Where the kernels are kept that one file defines."""

    def __init__(self, function, file):
        assert CACHE_FOLDER is not None
        self._py_file, self._line = file, function.__code__.co_firstlineno
        folder = Path(file).resolve().parent
        inside = folder.is_relative_to(_PACKAGE)
        self._folder = CACHE_FOLDER / (".".join(folder.relative_to(_PACKAGE.parent).parts) if inside else _hash_of(folder))

    @classmethod
    def from_function(cls, py_func, py_file):
        return cls(py_func, py_file)

    def ensure_cache_path(self):
        _claim(self._folder.parents[2], self._folder)

    def get_cache_path(self):
        return str(self._folder)

    def get_source_stamp(self):
        return ""  # the folder's name says it

    def get_disambiguator(self):
        return str(self._line)


class _Implementation(CompileResultCacheImpl):
    _locator_classes = [_Place]  # noqa: RUF012 - numba's own convention


def _check_whole(path):
    """ValueError unless the file ends with the checksum of what stands before."""
    data = Path(path).read_bytes()
    if hashlib.sha256(data[:-_DIGEST]).digest() != data[-_DIGEST:]:
        raise ValueError("it is damaged")


class _Files(IndexDataCacheFile):
    """numba's index and data files of one kernel, with checksums: what stands behind a pickle is not read by ``pickle.loads``."""

    def _load_index(self):
        with suppress(FileNotFoundError):
            _check_whole(self._index_path)
        return super()._load_index()

    def _load_data(self, name):
        _check_whole(self._data_path(name))
        return super()._load_data(name)

    @contextmanager
    def _open_for_write(self, filepath):
        content = io.BytesIO()
        yield content
        data = content.getvalue()
        handle, name = tempfile.mkstemp(dir=self._cache_path)
        try:
            with open(handle, "wb") as file:
                file.write(data + hashlib.sha256(data).digest())
            os.replace(name, filepath)
        except BaseException:
            with suppress(OSError):
                os.unlink(name)
            raise

    def discard(self):
        """Forget what is kept; the next compile is kept anew."""
        with suppress(OSError):
            os.unlink(self._index_path)


class Kept(FunctionCache):
    """The machine code of one entry kernel on disk. What cannot be read is compiled, what cannot be kept lives in memory."""

    _impl_class = _Implementation

    def __init__(self, py_func: Any):
        super().__init__(py_func)
        self._cache_file = _Files(self.cache_path, self._impl.filename_base, self._impl.locator.get_source_stamp())

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The machine code for this signature, or None."""
        try:
            self._impl.locator.ensure_cache_path()
            return super().load_overload(sig, target_context)
        except OSError as error:
            _warn_once("place", f"machine code is not read from {self.cache_path} ({error}): every process compiles for itself")
        except Exception as error:  # whatever a damaged file makes pickle, numba or LLVM raise
            self._cache_file.discard()
            what = f"{type(error).__name__}: {error}"
            _warn_once("broken", f"machine code kept in {self.cache_path} cannot be used ({what}): it is compiled and kept anew")
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep it, if that is possible."""
        try:
            super().save_overload(sig, data)
        except Exception as error:  # a full disk, or an index that was damaged in the meantime
            _warn_once("place", f"machine code cannot be kept in {self.cache_path} ({error}): every process compiles for itself")
