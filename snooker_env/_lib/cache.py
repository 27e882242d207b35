"""Where is machine code kept, and which is loaded? In the user's own folder; nothing foreign, old or damaged.

* Files are pickles: whoever can write there can run code here. So folders are made for the user alone; a folder
  that somebody else (but root) owns or can write to is not used.
* numba notices changes only in the file that *defines* a cached function. So the folder is named by a hash of all
  source in the rooms that kernels are made from; the kernels of other packages have a folder in it, named by a
  hash of their whole package. Equal copies share machine code.
* Files end with a checksum of bytes and place: damaged machine code, or another kernel's, would crash the process.
* Whatever goes wrong, the kernel is compiled again, and the process warns once."""

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

from .seal import seal, unseal

_PACKAGE = Path(__file__).resolve().parents[1]
_WRITE_GROUP, _WRITE_OTHERS, _STICKY = 0o020, 0o002, 0o1000
_LARGE = 2**21  # bytes: twice the machine code of the largest kernel


KERNEL_ROOMS = ("_lib", "geometry.py", "game", "physics", "planning", "simulation", "tasks")
"""What holds kernels, and all that their kernels take from (tests/repository/test_kernel_rooms.py)."""


def source_hash(root: Path, rooms: tuple[str, ...] = ()) -> str:
    """A hash of a package's Python files (or those in ``rooms``) and their names, 16 hex digits."""
    h = hashlib.sha256()
    for path in sorted(root.rglob("*.py")):
        inside = path.relative_to(root)
        if not rooms or inside.parts[0] in rooms:
            h.update(inside.as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return h.hexdigest()[:16]


def kernel_hash(root: Path = _PACKAGE) -> str:
    """The hash of this package's ``KERNEL_ROOMS``: the name of its cache folder."""
    return source_hash(root, KERNEL_ROOMS)


@cache  # the modules imported from there do not change in this process
def _hash_of(folder: Path) -> str:
    """The hash of the whole package of a folder outside the rooms; of the folder alone if in none."""
    while (folder / "__init__.py").is_file() and (folder.parent / "__init__.py").is_file():
        folder = folder.parent
    return source_hash(folder)


# Folders that belong to the user alone


_ALONE = "every process compiles for itself"


class UnsafeFolderError(OSError):
    """A folder into which somebody else could put code; the message says which and why."""


def _check_own(folder: Path, *, home: bool = False) -> None:
    """UnsafeFolderError unless only this user (and root) can change what is in ``folder`` and its target. In ``home``, which
    the user chose, their group may write, and others if the folder is sticky (/tmp)."""
    if not hasattr(os, "geteuid"):  # Windows: no such numbers, and a user's folders are closed to others
        return
    for status in (os.lstat(folder), os.stat(folder)):
        if status.st_uid not in (os.geteuid(), 0):
            raise UnsafeFolderError(f"{folder} belongs to another user (uid {status.st_uid})")
    mode = os.stat(folder).st_mode & 0o7777
    if mode & (_WRITE_OTHERS if home else _WRITE_OTHERS | _WRITE_GROUP) and not (home and mode & _STICKY):
        raise UnsafeFolderError(f"others can write to {folder} (mode {mode:04o})")


def _claim(home: Path, folder: Path) -> None:
    """Make ``folder`` and those up to ``home`` for this user alone; UnsafeFolderError if others can write."""
    for part in (*reversed(folder.parents), folder):
        part.mkdir(0o700, exist_ok=True)
        if part == home or part.is_relative_to(home):
            _check_own(part, home=part == home)


def cache_folder() -> Path | None:
    """``snooker_env/<kernel hash>`` in ``$NUMBA_CACHE_DIR``, ``$XDG_CACHE_HOME`` or ``~/.cache``; None: in memory only."""
    asked = map(os.environ.get, ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME"))
    chosen = next(filter(None, asked), None) or os.path.expanduser("~/.cache")
    home = Path(chosen).absolute()
    folder = home / "snooker_env" / kernel_hash()
    try:
        # expanduser found no home; this would be a folder below the working directory
        if chosen == "~/.cache":
            raise UnsafeFolderError("there is no home folder")
        _claim(home, folder)
        # a trial: access bits are wrong on read-only mounts and for root
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except UnsafeFolderError as error:
        why = f"{error}: no machine code is loaded from there or kept there; {_ALONE}"
        advice = "set NUMBA_CACHE_DIR to a folder of your own, or remove this one"
    except OSError:
        why, advice = f"{folder} is not writable: {_ALONE}", "set NUMBA_CACHE_DIR"
    warnings.warn(f"{why}; {advice}", RuntimeWarning, stacklevel=2)
    return None


CACHE_FOLDER = cache_folder()


# numba's cache of one kernel in such a folder

_warned = set()


def _warn_once(kind, message):
    if kind not in _warned:
        _warned.add(kind)
        warnings.warn(message, RuntimeWarning, stacklevel=3)


class _Place(_CacheLocator):
    """The folder for the kernels that one file defines."""

    def __init__(self, function, file):
        assert CACHE_FOLDER is not None
        self._py_file, self._line = file, function.__code__.co_firstlineno
        path = Path(file).resolve()
        inside = path.is_relative_to(_PACKAGE) and path.relative_to(_PACKAGE).parts[0] in KERNEL_ROOMS
        name = ".".join(path.parent.relative_to(_PACKAGE.parent).parts) if inside else _hash_of(path.parent)
        self._folder = CACHE_FOLDER / name

    @classmethod
    def from_function(cls, py_func, py_file):
        return cls(py_func, py_file)

    def ensure_cache_path(self):
        _claim(self._folder.parents[2], self._folder)

    def get_cache_path(self):
        return str(self._folder)

    def get_source_stamp(self):
        return ""  # the folder's name holds the hash

    def get_disambiguator(self):
        return str(self._line)


class _Implementation(CompileResultCacheImpl):
    _locator_classes = [_Place]  # noqa: RUF012 - numba's own convention


class _Files(IndexDataCacheFile):
    """numba's index and data files of one kernel, sealed by their place: ``pickle.loads`` ignores a tail."""

    def _name(self, path):
        assert CACHE_FOLDER is not None
        return Path(path).relative_to(CACHE_FOLDER.parent).as_posix()

    def _load_index(self):
        try:
            with suppress(FileNotFoundError):
                unseal(Path(self._index_path).read_bytes(), self._name(self._index_path))
            return super()._load_index()
        except OSError:
            raise
        except Exception:  # without it the next compile is kept again
            with suppress(OSError):
                os.unlink(self._index_path)
            raise

    def _load_data(self, name):
        path = self._data_path(name)
        unseal(Path(path).read_bytes(), self._name(path))
        return super()._load_data(name)

    @contextmanager
    def _open_for_write(self, filepath):
        content = io.BytesIO()
        yield content
        data = content.getvalue()
        handle, name = tempfile.mkstemp(dir=self._cache_path)
        try:
            with open(handle, "wb") as file:
                file.write(seal(data, self._name(filepath)))
            os.replace(name, filepath)
        except BaseException:
            with suppress(OSError):
                os.unlink(name)
            raise


def lies_in_a_file(py_func: Any) -> bool:
    """Whether a function is in a file, whose folder's hash changes with it; code of a prompt is in none."""
    return Path(py_func.__code__.co_filename).is_file()


class Kept(FunctionCache):
    """One entry kernel's machine code on disk. Unreadable: compiled anew; not writable: in memory."""

    _impl_class = _Implementation

    def __init__(self, py_func: Any):
        super().__init__(py_func)
        stamp = self._impl.locator.get_source_stamp()
        self._cache_file = _Files(self.cache_path, self._impl.filename_base, stamp)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The machine code for this signature, or None."""
        try:
            self._impl.locator.ensure_cache_path()
            return super().load_overload(sig, target_context)
        except OSError as error:
            _warn_once("place", f"machine code is not read from {self.cache_path} ({error}): {_ALONE}")
        except Exception as error:  # a damaged file can make pickle, numba or LLVM raise anything
            what = f"cannot be used ({type(error).__name__}: {error}): it is compiled and kept anew"
            _warn_once("broken", f"machine code kept in {self.cache_path} {what}")
        return None

    def has_room(self) -> bool:
        """Whether what is compiled now could be kept: a full disk still makes a file, but holds nothing in it."""
        try:
            self._impl.locator.ensure_cache_path()
            with tempfile.TemporaryFile(dir=self.cache_path) as file:
                file.write(bytes(_LARGE))
            return True
        except OSError:
            return False

    def save_overload(self, sig: Any, data: Any) -> None:
        """Write the machine code to disk, if that is possible."""
        try:
            super().save_overload(sig, data)
        except Exception as error:  # for instance a full disk, or an index that was damaged in the meantime
            _warn_once("place", f"machine code cannot be kept in {self.cache_path} ({error}): {_ALONE}")
