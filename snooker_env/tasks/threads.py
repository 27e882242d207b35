"""How are many tables divided among threads? In chunks, each thread with its own work space."""

import os
import threading
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from .._lib.types import Ints
from .stroke import ShotBuffers
from .tables import Crew, Task, Watch

CHUNK = 128  # most tables in one call: few enough for the work space to stay in the cache, enough to make calls cheap
LEAST = 8  # smallest number of tables for which another thread or chunk is worth its cost


def processors() -> int:
    """Return how many processors this process may use, by scheduler and container.

    Returns
    -------
    int
        At least 1.

    Examples
    --------
    >>> from snooker_env.planning import processors
    >>> processors() >= 1
    True
    """
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class Threads(Crew):
    """The crew of many tables, in chunks on threads; several may call it. Watched strokes keep a path."""

    def __init__(self, threads: int, *, watch: Watch | None = None):
        super().__init__(watch=watch)
        self.threads, self._path = threads, watch is not None
        self._pool, self._pool_process, self._desks = None, 0, []
        self._lock = threading.Lock()

    def __call__(self, which: Ints, task: Task) -> None:
        """Run the task, one chunk at a time."""
        n = len(which)
        threads = max(1, min(self.threads, n // LEAST))
        even = n if threads == 1 else max(LEAST, -(-n // (4 * threads)))  # shots differ in length
        size = min(CHUNK, even)
        starts = iter(range(0, n, max(1, size)))

        def play():
            desk = self._desk(size)
            for start in starts:  # the threads share one iterator, which yields each start once
                task(which[start : start + size], desk)
            self._desks.append(desk)

        if threads == 1:
            play()
            return
        with self._lock:
            # a forked process has none of its parent's threads
            if self._pool is None or self._pool_process != os.getpid():
                self._pool, self._pool_process = ThreadPoolExecutor(self.threads - 1, "snooker"), os.getpid()
            others = [self._pool.submit(play) for _ in range(threads - 1)]
        try:
            play()
        finally:
            for other in others:
                other.exception()  # wait for all of them, even after an error
        for other in others:
            other.result()

    def _desk(self, size: int) -> ShotBuffers:
        """Unused work space for that many shots."""
        try:
            desk = self._desks.pop()
        except IndexError:
            return ShotBuffers(size, path=self._path)
        return desk if len(desk) >= size else ShotBuffers(size, path=self._path)

    def shutdown(self) -> None:
        """End the threads."""
        if self._pool is not None and self._pool_process == os.getpid():
            self._pool.shutdown()
        self._pool = None

    def __getstate__(self) -> dict[str, Any]:
        kept = {k: v for k, v in self.__dict__.items() if k != "_lock"}
        return kept | {"_pool": None, "_desks": []}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state, _lock=threading.Lock())  # threads and locks belong to one process
