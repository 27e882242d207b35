"""Which process owns a folder? The one that holds its lock; no process once that one has ended, however it ended."""

import os
import platform
import sys
import time

from snooker_env.checks import refuse

try:
    import fcntl
except ImportError:  # Windows has none
    fcntl = None

NAME = "train.lock"
"""The file in the folder of a training."""


class Lock:
    """Holds a folder until ``release`` or the end of the process. Raises ValueError, naming the holder, if another process does.

    The system's lock (flock) on a file counts, not the file's existence: one left by kill -9 is no obstacle. Without flock (Windows) the
    file itself is the lock: after a kill it has to be deleted, as the error explains. On a file system without locks a warning is printed
    and nothing is locked.

    Parameters
    ----------
    folder : Path
        The folder.
    field : str
        Name of the option that gave it, for the error.
    path : Path, optional
        The file; default ``train.lock`` in the folder. Who removes the whole folder keeps it elsewhere.
    """

    def __init__(self, folder, field="out", path=None):
        self._folder, self._field, self._path = folder, field, path or folder / NAME
        self._file = self._held_by_file() if fcntl is None else self._held_by_system(fcntl)
        try:
            self._file.truncate(0)
            self._file.write(f"process {os.getpid()} on {platform.node()} since {time.strftime('%Y-%m-%d %H:%M:%S')}\n")
            self._file.flush()
        except OSError:
            self.release()
            raise

    def _held_by_system(self, system):
        while True:
            file = open(self._path, "a+", encoding="utf-8")  # noqa: SIM115 - kept open: the lock ends with it
            try:
                system.flock(file, system.LOCK_EX | system.LOCK_NB)
            except BlockingIOError:
                file.close()
                raise self._taken("") from None
            except OSError as error:
                print(f"{self._folder}: no lock ({error.strerror}): let no other run use it", file=sys.stderr)
                return file
            if self._is(file):
                return file
            file.close()  # its last holder deleted the file in between

    def _is(self, file):
        """Is this open file the one at the lock's path?"""
        try:
            return os.path.samestat(os.fstat(file.fileno()), os.stat(self._path))
        except FileNotFoundError:
            return False

    def _held_by_file(self):
        try:
            return open(self._path, "x", encoding="utf-8")
        except FileExistsError:
            raise self._taken(f"; if that process is gone, delete {self._path}") from None

    def _taken(self, more):
        """The ValueError for a folder that another process holds."""
        try:
            who = self._path.read_text(encoding="utf-8", errors="replace").strip()
        except FileNotFoundError:  # released in between
            who = ""
        pid = who.split()[1] if who.startswith("process ") else "PID"
        return refuse(
            self._field, str(self._folder), f"must be a folder that no other process uses: {who or 'another process'} does. Wait, or "
            f"stop it, which saves what it did (kill -INT {pid}), or give another --{self._field}{more}",
        )  # fmt: skip

    def release(self):
        """Release the folder."""
        own = self._is(self._file)  # the folder may have been moved and another run started at its old path
        if fcntl is None:
            self._file.close()
        if own:
            self._path.unlink(missing_ok=True)
        self._file.close()

    def __enter__(self):
        return self

    def __exit__(self, *error) -> None:
        self.release()
