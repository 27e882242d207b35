"""How is a job divided into parts, played here or on a Ray cluster? The same code gives the same bits.

A part consists of a module's function, shared data (an agent's weights) and its own arguments. Its result, a dict of arrays,
depends only on these. Ray queues the parts, keeps shared data on each node, and repeats a part if its worker or node died.
"""

import hashlib
import json
import logging
import os
import re
import socket
from contextlib import contextmanager
from functools import cache
from pathlib import Path

from agents._lib.files import keep_arrays, kept_arrays
from snooker_env.benchmark.provenance import software
from snooker_env.checks import refuse

ROOT, KEPT = Path(__file__).parents[1], Path("runs/kept")
"""The clone, and the folder that keeps parts played by a cluster until the command ends."""
RETRIES = 5
"""How many times a part is repeated if its worker dies."""


class ClusterError(ConnectionError):
    """A cluster cannot continue; the message says why in one line. Finished parts are kept."""


class Here:
    """Plays parts in this process, one after another, with ``threads`` threads (default: one per processor)."""

    says = ""

    def __init__(self, threads=None):
        self._threads = threads

    def play_parts(self, task, parts):
        """Yield the number and result of each part (shared data, arguments), in any order."""
        for k, (shared, args) in enumerate(parts):
            yield k, task(shared, args, self._threads)


class Cluster:
    """A Ray cluster that this process has joined; each part uses one core."""

    def __init__(self, ray):
        self._ray, self.says = ray, f" on {int(ray.cluster_resources().get('CPU', 0))} cores"

    def play_parts(self, task, parts):
        """Like ``Here.play_parts``. ClusterError if a part is given up or a node runs other software."""
        ray, wanted = self._ray, source()
        sent = {id(shared): ray.put(shared) for shared, _ in parts}
        far = ray.remote(num_cpus=1, max_retries=RETRIES)(_far)
        running = {
            far.remote(task, sent[id(shared)], args, wanted): k for k, (shared, args) in enumerate(parts)
        }
        while running:
            (one,), _ = ray.wait(list(running))
            try:
                result = ray.get(one)
            except ray.exceptions.RayTaskError as error:
                raise error.cause from None  # an error of a player's own code, or of a node
            except ray.exceptions.RayError as error:
                raise ClusterError(f"a part was given up ({' '.join(str(error).split())[:300]})") from None
            yield running.pop(one), result


def _far(task, shared, args, wanted):
    """Run a part on a worker."""
    if source() != wanted:
        raise ClusterError(
            f"the node {socket.gethostname()} has different source code or libraries from this one"
        )
    return task(shared, args, 1)


@cache
def source():
    """A digest of everything that must be equal on all nodes: this source, its weights and the libraries."""
    files = (file for name in ("snooker_env", "agents") for file in sorted((ROOT / name).rglob("*")))
    content = [file.read_bytes() for file in files if file.suffix in (".py", ".npz", ".yml", ".zip")]
    return digest_of([software(), *content])


def digest_of(data):
    """A digest of nested dicts, lists, texts, numbers and bytes."""
    plain = lambda value: hashlib.sha256(value).hexdigest()  # noqa: E731
    return hashlib.sha256(json.dumps(data, sort_keys=True, default=plain).encode()).hexdigest()[:32]


def add_ray(p):
    """Add ``--ray`` to a parser."""
    where = "local (all cores here), auto (RAY_ADDRESS, or this machine's cluster) or HOST:PORT of a head"
    p.add_argument(
        "--ray", metavar="ADDRESS", help=f"play on a Ray cluster: {where}; results do not depend on it"
    )


def checked_ray(address):
    """Raise ValueError unless it is None, local, auto or HOST:PORT."""
    if not re.fullmatch(r"local|auto|[^/\s:]+:\d{1,5}", address or "auto"):
        wanted = "must be local, auto, or HOST:PORT of the head of a Ray cluster that this machine is part of"
        raise refuse("ray", address, wanted)


@contextmanager
def place(address, threads=None):
    """Choose where to play parts: ``Here`` without an address, otherwise a ``Cluster``. Raises ClusterError."""
    if address is None:
        yield Here(threads)
        return
    os.environ.setdefault("RAY_task_oom_retries", str(RETRIES))  # Ray would retry for ever
    import ray  # imported only if requested

    address = os.environ.get("RAY_ADDRESS", address) if address == "auto" else address
    try:
        if ":" in address:  # ray.init would wait for minutes
            host, _, port = address.rpartition(":")
            socket.create_connection((host, int(port)), 10.0).close()
        ray.init(address, log_to_driver=False, logging_level=logging.ERROR)
    except (RuntimeError, OSError, ValueError, AssertionError) as error:
        wanted = f"must be the head of a running Ray cluster ({' '.join(str(error).split())[:300]})"
        raise ClusterError(str(refuse("ray", address, wanted))) from None
    try:
        yield Cluster(ray)
    finally:
        ray.shutdown()


def kept_at(task, parts):
    """The folder of a job; its name is a digest of everything that its results depend on."""
    shared = {id(one): digest_of(one) for one, _ in parts}
    same = [source(), task.__module__, task.__name__]
    return KEPT / digest_of([*same, *([shared[id(one)], args] for one, args in parts)])


def play_and_keep(task, parts, where):
    """Yield the number and result of each part. A cluster's results are kept in one file each until the job's folder is removed,
    so the same job continues from the results of an interrupted one."""
    if isinstance(where, Here):
        yield from where.play_parts(task, parts)
        return
    folder, left = kept_at(task, parts), []
    folder.mkdir(parents=True, exist_ok=True)
    for k in range(len(parts)):
        try:
            yield k, kept_arrays(folder / f"{k}.npz")
        except (OSError, ValueError):  # the file is missing or damaged
            left.append(k)
    for n, result in where.play_parts(task, [parts[k] for k in left]):
        keep_arrays(folder / f"{left[n]}.npz", result)
        yield left[n], result


def in_order(numbered):
    """Yield the results in the order of their numbers, each as soon as all earlier ones are known."""
    early, k = {}, 0
    for number, result in numbered:
        early[number] = result
        while k in early:
            yield early.pop(k)
            k += 1
