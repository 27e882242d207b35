"""Which process owns a folder? The one that holds its lock. When that process ends in any way, the folder is free."""

import os
import platform
import time
from contextlib import suppress

from filelock import FileLock, Timeout

from snooker_env.checks import refuse

NAME = "train.lock"
"""The file in the folder. A file left after kill -9 is harmless: only the system's lock on it counts."""


class Lock:
    """Holds a folder until ``release`` or the end of the process. If another process holds it, raises a ValueError
    that names the holder."""

    def __init__(self, folder, field="out"):
        self._path = folder / NAME
        self._lock = FileLock(self._path)
        try:
            self._lock.acquire(timeout=0)
        except Timeout:
            raise _refuse_taken_folder(folder, field, self._path) from None
        with suppress(OSError):  # on Windows nobody can write or read a locked file
            self._path.write_text(
                f"process {os.getpid()} on {platform.node()} since {time.strftime('%Y-%m-%d %H:%M:%S')}\n"
            )
        self._file = self._path.stat()

    def release(self):
        """Release the folder. If the folder was moved and another run began at its old path, that run's lock stays."""
        with suppress(OSError):
            if os.path.samestat(self._file, self._path.stat()):
                self._path.unlink()
        self._lock.release()

    def __enter__(self):
        return self

    def __exit__(self, *error) -> None:
        self.release()


def _refuse_taken_folder(folder, field, path):
    """Make the ValueError for a folder that another process holds."""
    who = ""
    with suppress(OSError):
        who = path.read_text(encoding="utf-8", errors="replace").strip()
    pid = who.split()[1] if who.startswith("process ") else "PID"
    wanted = f"must be a folder that no other process uses: {who or 'another process'} uses it. Wait, stop it with kill"
    return refuse(field, str(folder), f"{wanted} -INT {pid} (it saves its work), or give another --{field}")
