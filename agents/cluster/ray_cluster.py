"""How are parts played by a Ray cluster? The one file that imports Ray, and only when ``--ray`` asks for it.

Each part is a task of one core. Ray itself queues them, keeps shared data on each node, and plays a part
again whose worker or node died.
"""

import hashlib
import os
import re
import socket
import subprocess
import sys
from contextlib import contextmanager
from functools import cache
from pathlib import Path

from commands.lifecycle import DISK, installs
from snooker_env.benchmark.provenance import software as versions
from snooker_env.checks import refuse
from snooker_env.planning import processors

from .job import ClusterError, Here
from .keep import KEPT

ROOT = Path(__file__).parents[2]
RETRIES = 5
"""How often a part is played again because its worker died."""
ANSWER = 60.0
"""Seconds in which the head of a cluster has to answer."""
LOCAL_STORE = 2**28
"""Bytes of the object store of a cluster on this machine alone: weights and results are small."""


@cache
def software():
    """Name -> version of everything that has to be the same on all machines; None: not installed."""
    digest = hashlib.sha256()
    for folder in ("snooker_env", "agents", "commands"):
        for file in sorted((ROOT / folder).rglob("*")):
            if file.suffix in (".py", ".npz", ".yml", ".zip"):
                content = file.read_bytes()
                digest.update(f"{file.relative_to(ROOT).as_posix()} {len(content)}\n".encode() + content)
    return versions() | {"source of snooker_env": digest.hexdigest()[:16]}


def difference(wanted):
    """What this machine holds in another version than ``wanted``, in words; "" if nothing."""
    return ", ".join(
        f"{name} is {software().get(name) or 'not installed'} there and {version or 'not installed'} here"
        for name, version in wanted.items()
        if software().get(name) != version
    )


def add_ray(p, keep=False):
    """Add ``--ray`` to a parser, and ``--keep``."""
    where = (
        "local (all cores here), auto (RAY_ADDRESS, or the cluster of this machine), or HOST:PORT of a head"
    )
    text = f"play on a Ray cluster: {where}; results are the same"
    p.add_argument("--ray", metavar="ADDRESS", help=text)
    if keep:
        text = "keep each part in this folder or fsspec URL: the same command goes on after an interruption"
        usual = f"[with --ray: a folder in {KEPT}, until the job is complete]"
        p.add_argument("--keep", metavar="URL", help=f"{text} {usual}")


def checked_ray(address):
    """Raise ValueError unless it is None, local, auto or HOST:PORT."""
    port = re.fullmatch(r"[^/\s]+:(\d{1,5})", address or "head:6379")
    if address not in ("local", "auto") and (port is None or not 0 < int(port[1]) < 2**16):
        wanted = "must be local, auto, or HOST:PORT of the head of a Ray cluster that this machine is part of"
        raise refuse("ray", address, wanted)


@contextmanager
def place(address, threads=None):
    """Where parts are played: ``Here`` without an address, else a ``Cluster``. Raises ClusterError."""
    if address is None:
        yield Here(threads)
        return
    cluster = connected(address)
    try:
        yield cluster
    finally:
        cluster.close()


def ray_of():
    """The module ``ray``. Raises ImportError with the line that installs it."""
    os.environ.setdefault("RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO", "0")  # spares a warning
    os.environ.setdefault("RAY_task_oom_retries", str(RETRIES))  # Ray tries for ever
    try:
        import ray
    except ImportError:
        raise ImportError(f"Ray is missing; in a clone of the repository:  {installs('cluster')}") from None
    return ray


def connected(address, cores=None):
    """The ``Cluster`` at "local" (with so many cores, default all), "auto" or HOST:PORT. Raises ClusterError."""
    ray = ray_of()
    quiet = {"log_to_driver": False, "logging_level": "ERROR", "configure_logging": True}
    if address == "local":
        small = {"include_dashboard": False, "object_store_memory": LOCAL_STORE}
        ray.init("local", num_cpus=cores or processors(), **small, **quiet)
        return Cluster(ray)
    if address == "auto":  # KubeRay and others set it where a cluster's programs run
        address = os.environ.get("RAY_ADDRESS") or address
    if address != "auto" and not _is_head(address):  # ray.init would wait for minutes
        start = f"start one with  ray start --head --port={address.rpartition(':')[2]}"
        wanted = f"must be the head of a Ray cluster that runs: {start}"
        raise ClusterError(str(refuse("ray", address, wanted)))
    try:
        ray.init(address=address, **quiet)
    except (RuntimeError, ConnectionError, ValueError, TimeoutError, AssertionError) as error:
        ray.shutdown()
        how = "run this command on one of its nodes, with the same Python, Ray and ~/.ray/auth_token"
        raise ClusterError(f"the cluster at {address} cannot be joined: {how} ({_line(error)})") from None
    return Cluster(ray)


def _is_head(address):
    asks = ["health-check", "--skip-version-check", "--address", address]
    command = [sys.executable, "-m", "ray.scripts.scripts", *asks]
    host, _, port = address.rpartition(":")
    try:
        socket.create_connection((host, int(port)), ANSWER / 6).close()
        return subprocess.run(command, capture_output=True, timeout=ANSWER, check=False).returncode == 0
    except (OSError, ValueError, subprocess.TimeoutExpired):  # ValueError: a RAY_ADDRESS that names no port
        return False


def _line(error):
    return " ".join(str(error).split())[:300]


class Cluster(Here):
    """A Ray cluster that this process has joined, in the place of ``job.Here``."""

    here = False

    def __init__(self, ray):
        self._ray, self._software, self._processors = ray, software(), set()
        self._task = ray.remote(num_cpus=1, max_retries=RETRIES)(_task())

    @property
    def cores(self):
        """Cores of all nodes that live."""
        return int(self._ray.cluster_resources().get("CPU", 0))

    @property
    def says(self):
        """Where it plays, for a bar of progress."""
        return f" on {self.cores} cores"

    def played(self, parts):
        """Yield the number and the result of each (task, shared data, arguments) as it ends."""
        each = {id(shared): shared for _, shared, _ in parts}
        sent = {name: self._ray.put(shared) for name, shared in each.items()}
        running = {}
        for k, (task, shared, args) in enumerate(parts):
            running[self._task.remote(task, sent[id(shared)], args, self._software)] = k
        while running:
            (one,), _ = self._ray.wait(list(running))
            yield running.pop(one), self._result(one)

    def _result(self, one):
        """The result of a part. ClusterError for what befell its machine, else the part's own error."""
        exceptions = self._ray.exceptions
        try:
            result, processor = self._ray.get(one)
        except exceptions.RayTaskError as error:
            where = re.search(r"\bip=([^,)\s]+)", str(error))
            raise fault_of(error.cause, where[1] if where else "another machine") from None
        except exceptions.RayError as error:
            died = f"its worker died {RETRIES + 1} times"
            raise ClusterError(f"a part was given up, {died} ({_line(error)})") from None
        if self._processors and processor not in self._processors:
            several = f"the nodes have different processors ({processor}, {', '.join(self._processors)})"
            differ = "the last bits of a network's results may differ from those of one machine"
            print(f"{several}: {differ}", file=sys.stderr)
        self._processors.add(processor)
        return result

    def close(self):
        """Leave the cluster; one on this machine alone ends."""
        self._ray.shutdown()


def fault_of(cause, node):
    """The ``ClusterError`` for an error of a part if it is one of its machine, else the error itself."""
    if isinstance(cause, ClusterError):
        return ClusterError(f"the node {node}: {cause}")
    if isinstance(cause, MemoryError):
        help_it = "give the node fewer workers (ray start --num-cpus) or more memory"
        return ClusterError(f"a worker on {node} ran out of memory: {help_it}")
    if isinstance(cause, ImportError):
        help_it = f"install the same clone on every node ({installs('cluster')})"
        return ClusterError(f"the node {node} has no {cause.name or cause}: {help_it}")
    if isinstance(cause, OSError) and cause.errno in DISK:
        where = cause.filename or "its temporary folder"
        return ClusterError(f"the disk of a worker on {node} is full ({where}): free space there")
    return cause


def _task():
    """What a worker does. As an inner function it is sent as code: the node may lack this package."""

    def play(task, shared, args, wanted):
        from agents.cluster.job import ClusterError, run
        from agents.cluster.ray_cluster import difference
        from snooker_env.benchmark.provenance import processor

        differs = difference(wanted)
        if differs:
            raise ClusterError(f"it holds other software: {differs}. Install the same on every node")
        return run(task, shared, args, 1), processor()

    return play
