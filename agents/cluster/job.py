"""How is a job of many parts played, here or on a cluster? Each part once, with the same results bit for bit.

A part is a task by name, data that it shares with others (an agent's weights) and its own arguments. Its
result is a dict of arrays that depends on these alone: not on where it is played, nor on which parts end
before it, nor on how often a machine died over it.
"""

import importlib
from dataclasses import dataclass

from .keep import digest_of


class ClusterError(Exception):
    """A cluster cannot play on: one line says why and what to do. What was played is kept."""


@dataclass(frozen=True)
class Part:
    """One part of a job: MODULE:FUNCTION, the name of the shared data, and arguments of what JSON knows."""

    task: str
    shared: str
    args: dict


def run(task, shared, args, threads):
    """What the task, MODULE:FUNCTION, returns for the shared data, the arguments and a number of threads."""
    module, _, name = task.partition(":")
    return getattr(importlib.import_module(module), name)(shared, args, threads)


class Here:
    """Plays parts in this process, one after another, with so many threads: default one a processor."""

    here, says = True, ""

    def __init__(self, threads=None):
        self._threads = threads

    def played(self, parts):
        """Yield the number and the result of each (task, shared data, arguments)."""
        for k, (task, shared, args) in enumerate(parts):
            yield k, run(task, shared, args, self._threads)

    def map(self, task, shared, many):
        """The results of a task for many arguments, in their order."""
        return list(in_order(self.played([(task, shared, args) for args in many])))


def ended(parts, shared, where, store=None):
    """Yield number and result of each part: those that the store keeps, then the others, kept as they end."""
    keys, left = keys_of(parts, shared), []
    kept = store.names("parts") if store else ()
    for k, key in enumerate(keys):
        result = store.part(key) if store and f"{key}.npz" in kept else None
        if result is None:
            left.append(k)
        else:
            yield k, result
    for n, result in where.played([(parts[k].task, shared[parts[k].shared], parts[k].args) for k in left]):
        if store:
            store.keep_part(keys[left[n]], result)
        yield left[n], result


def in_order(numbered):
    """The results in the order of their numbers, each as soon as those before it are there."""
    early, k = {}, 0
    for number, result in numbered:
        early[number] = result
        while k in early:
            yield early.pop(k)
            k += 1


def keys_of(parts, shared):
    """The names of parts: each a digest of all that its result depends on."""
    digests = {name: digest_of(data) for name, data in shared.items()}
    return [digest_of([part.task, digests[part.shared], part.args]) for part in parts]
