"""How is a job of many parts played, here or on a cluster, each part counted once?

A part is a task by name, data that it shares with others (an agent's weights) and its own arguments. Its result is a dict of arrays that
depends on these alone. So the results of a job are the same bit for bit wherever its parts are played, in whatever order they end, and
however often one had to be played again.
"""

import hashlib
import importlib
import json
from collections import Counter, deque
from contextlib import suppress
from dataclasses import dataclass

from .store import opened, packed, unpacked

TASKS = {
    "visits": "agents.evaluation.visits:play",
    "encounters": "agents.evaluation.encounters:play",
    "searched": "agents.evaluation.searched:play",
    "worths": "agents.learning.worths:play",
    "strokes": "agents.learning.self_play:strokes",
    "choices": "agents.learning.self_play:choices",
}
"""Name -> module and function: called with the shared data, the part's arguments and a number of threads."""


def run(task, shared, given, threads):
    """Play one part: the result of its task."""
    module, _, name = TASKS[task].partition(":")
    return getattr(importlib.import_module(module), name)(shared, given, threads)


@dataclass(frozen=True)
class Part:
    """One part of a job.

    Attributes
    ----------
    task : str
        One of ``TASKS``.
    shared : str
        Name of the data that it shares with other parts.
    given : dict
        Its own arguments, of what JSON knows.
    """

    task: str
    shared: str
    given: dict


@dataclass(frozen=True, eq=False)
class _Waiting:
    """A part that this process will play when its result is asked for."""

    task: str
    shared: object
    given: dict


class Here:
    """Plays parts in this process, one after another.

    Parameters
    ----------
    threads : int, optional
        Of each part; default one for each processor. Results do not depend on it.
    """

    here, width, says = True, 1, ""

    def __init__(self, threads=None):
        self._threads = threads

    def put(self, shared):
        """Shared data, as ``submit`` takes it."""
        return shared

    def submit(self, task, shared, given):
        """A part that is to be played."""
        return _Waiting(task, shared, given)

    def wait(self, submitted):
        """Those that have a result."""
        return submitted[:1]

    def get(self, submitted):
        """The result of one."""
        return run(submitted.task, submitted.shared, submitted.given, self._threads)

    def map(self, task, shared, many):
        """The results of a task for many arguments, in their order."""
        return [run(task, shared, given, self._threads) for given in many]

    def close(self):
        """Nothing is left open."""


class Job:
    """Parts that are played once each.

    Parameters
    ----------
    parts : list of Part
        In the order in which they will be asked for.
    shared : dict
        Name -> what parts share: a dict of texts, numbers, bytes and lists.
    where : Here or Cluster
        Who plays them.
    store : Folder or Remote, optional
        Where results are kept. Parts that it holds are not played again.
    about : dict, optional
        What is played, for the store: it refuses to mix jobs.
    tick : callable, optional
        Called with each ``Part`` that is done and its result, once for each time that it was announced, also if it was kept.
    """

    def __init__(self, parts, shared, where, store=None, about=None, tick=None):
        self._where, self._store, self._tick, self._shared = where, store, tick, shared
        self._digests = {name: digest_of(data) for name, data in shared.items()}
        self._sent, self._running, self._done = {}, {}, {}
        self._kept = {name.removesuffix(".npz") for name in opened(store, about or {})} if store else set()
        self._parts = {self.key(part): part for part in parts}
        self._asked = Counter(map(self.key, parts))  # an agent under two labels has the same parts: they are played once
        self._told, self._pending = set(), deque(self._parts)

    def key(self, part):
        """The name of a part: a digest of all that its result depends on."""
        what = [part.task, self._digests[part.shared], part.given]
        return hashlib.sha256(json.dumps(what, sort_keys=True).encode()).hexdigest()[:32]

    def take(self, parts):
        """The results of these parts, in order, each as often as it was announced. Meanwhile the workers that are free play others."""
        keys = [self.key(part) for part in parts]
        for key in dict.fromkeys(keys):
            if key in self._kept and key not in self._done:
                self._done[key] = self._read(key)
                self._tell(key, self._done[key])
        while any(key not in self._done for key in keys):
            self._fill()
            if not self._running:
                raise KeyError("a part was taken more often than it was announced")
            self._collect(self._where.wait(list(self._running)))
        found = [self._done[key] for key in keys]
        self._asked.subtract(keys)
        for key in keys:
            if self._asked[key] <= 0:
                self._done.pop(key, None)
        return found

    def finish(self):
        """Play all parts; ``tick`` gets their results as they end, in any order."""
        for key in [key for key in self._pending if key in self._kept]:
            self._tell(key, self._read(key))
        while self._pending or self._running:
            self._fill()
            if self._running:
                self._collect(self._where.wait(list(self._running)))
                self._done.clear()

    def total(self, size):
        """The sum of ``size(part)`` over all parts."""
        return sum(size(part) * self._asked[key] for key, part in self._parts.items())

    def keep_finished(self):
        """After an interruption or a fault: keep what had ended, as far as it can still be had."""
        if hasattr(self._where, "finished"):
            with suppress(Exception):
                self._collect(self._where.finished(list(self._running)))

    def _read(self, key):
        """The result of a part that is kept. Another job may have ended and removed it: then it is played."""
        data, part = self._store.read(f"parts/{key}.npz") if self._store else None, self._parts[key]
        if data is None:
            played = self._where.map(part.task, self._shared[part.shared], [part.given])[0]
            if self._store:
                self._store.write(f"parts/{key}.npz", packed(played))
            return played
        return unpacked(data, f"{self._store}/parts/{key}.npz")

    def _fill(self):
        """Send parts until the workers have enough to do."""
        while self._pending and len(self._running) < self._where.width:
            key = self._pending.popleft()
            if key in self._kept or key in self._done:
                continue
            part = self._parts[key]
            if part.shared not in self._sent:
                self._sent[part.shared] = self._where.put(self._shared[part.shared])
            self._running[self._where.submit(part.task, self._sent[part.shared], part.given)] = key

    def _collect(self, ended):
        """Take the results of parts that have ended. If one failed, the others are kept before its error is raised."""
        failed = None
        for one in ended:
            try:
                result = self._where.get(one)
            except Exception as error:
                del self._running[one]
                failed = failed or error
                continue
            if self._store:
                self._store.write(f"parts/{self._running[one]}.npz", packed(result))
            key = self._running.pop(one)
            self._done[key] = result
            self._tell(key, result)
        if failed is not None:
            raise failed

    def _tell(self, key, result):
        if self._tick is not None and key not in self._told:
            self._told.add(key)
            for _ in range(self._asked[key]):
                self._tick(self._parts[key], result)


def digest_of(data):
    """A digest of data of dicts, lists, texts, numbers and bytes."""
    plain = lambda value: hashlib.sha256(value).hexdigest()  # noqa: E731
    return hashlib.sha256(json.dumps(data, sort_keys=True, default=plain).encode()).hexdigest()[:32]
