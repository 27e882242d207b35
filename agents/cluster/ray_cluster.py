"""How are parts played by a Ray cluster? The one file that imports Ray, and only when it is asked for.

Each part is a task of one core. Ray plays a task again if its worker or node dies (``RETRIES``); here it stays one reference, whose result
is taken once. Shared data are put into the object store once. The driver, which takes the results, runs on a node of the cluster.
"""

import contextlib
import os
import subprocess
import sys
import time

from commands.lifecycle import installs
from snooker_env.checks import refuse
from snooker_env.planning import processors

from .faults import ANSWER, ClusterError, answers, of_part, out_of_memory
from .job import run
from .software import check, difference, software
from .witness import Witness

RETRIES = 5
"""How often a part is played again because its worker died."""
QUEUED = 2
"""Parts that are sent for each core: one is played, the next waits at hand."""
PATIENCE = 30.0
"""Seconds without any answer of the head after which it is given up."""
LOCAL_STORE = 2**28
"""Bytes of the object store of a cluster on this machine alone: weights and results are small."""


def ray_of():
    """The module ``ray``. Raises ImportError with the line that installs it."""
    os.environ.setdefault("RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO", "0")  # spares a warning
    os.environ.setdefault("RAY_task_oom_retries", str(RETRIES))  # Ray would try for ever what takes too much memory
    try:
        import ray
    except ImportError:
        raise ImportError(f"Ray is missing; in a clone of the repository:  {installs('cluster')}") from None
    return ray


def connected(address, cores=None):
    """The ``Cluster`` at an address, "local" (with so many cores, default all) or HOST:PORT. Raises ClusterError."""
    ray = ray_of()
    quiet = {"log_to_driver": False, "logging_level": "ERROR", "configure_logging": True}
    if address == "local":
        ray.init("local", num_cpus=cores or processors(), include_dashboard=False, object_store_memory=LOCAL_STORE, **quiet)
    else:
        why = answers(address)
        if why:
            wanted = (
                f"must be the head of a Ray cluster that runs ({why}): start one with  ray start --head --port={address.rpartition(':')[2]}"
            )
            raise ClusterError(str(refuse("ray", address, wanted)))
        _is_head(address)
        try:
            ray.init(address=address, **quiet)
        except (RuntimeError, ConnectionError, ValueError, TimeoutError, AssertionError) as error:
            with contextlib.suppress(Exception):
                ray.shutdown()
            raise _unfit(address, error) from None
    found = Cluster(ray, address)
    try:
        found.check_nodes()
    except BaseException:
        found.close()
        raise
    return found


def _is_head(address):
    """Raise ClusterError unless what answers there is the head of a Ray cluster: ``ray.init`` would wait for it for minutes."""
    command = [sys.executable, "-m", "ray.scripts.scripts", "health-check", "--skip-version-check", "--address", address]
    try:
        fine = subprocess.run(command, capture_output=True, timeout=6 * ANSWER, check=False).returncode == 0
    except subprocess.TimeoutExpired:
        fine = False
    if not fine:
        raise ClusterError(str(refuse("ray", address, "must be the head of a Ray cluster: what answers there is none")))


def _unfit(address, error):
    """The ``ClusterError`` for what Ray says when it refuses to join a cluster."""
    said = " ".join(str(error).split())
    if "ersion" in said:
        import platform

        here = f"this machine has Ray {ray_of().__version__} and Python {platform.python_version()}"
        return ClusterError(f"the cluster at {address} runs other versions, {here}: install the same on every node ({said[:300]})")
    if "oken" in said or "nauthenticated" in said:
        return ClusterError(f"the cluster at {address} asks for another token: copy its ~/.ray/auth_token to this machine")
    return ClusterError(f"the cluster at {address} cannot be joined: run this command on one of its nodes ({said[:300]})")


class Cluster:
    """A Ray cluster that this process has joined, in the place of ``job.Here``.

    Parameters
    ----------
    ray : module
        Ray, after ``ray.init``.
    address : str
        "local" or HOST:PORT.
    """

    here = False

    def __init__(self, ray, address):
        self._ray, self.address = ray, address
        self._head = ray.get_runtime_context().gcs_address
        self._task = ray.remote(num_cpus=1, max_retries=RETRIES)(_run)
        self._wanted = ray.put(software())
        self._cores, self._looked = 0, 0.0
        self._witness = Witness(
            f"Ray has ended this process, or it was killed: if the head of the cluster at {self._head} is gone, start it again; the same "
            "command (train.py and agents.tournament: with --resume) goes on from what was kept"
        )  # fmt: skip

    @property
    def cores(self):
        """Cores of all nodes that live, as seen a few seconds ago."""
        if time.monotonic() - self._looked > 5.0:
            self._cores, self._looked = int(self._ray.cluster_resources().get("CPU", 0)), time.monotonic()
        return self._cores

    @property
    def says(self):
        """Where it plays, for a bar of progress."""
        return f" on {self.cores} cores"

    @property
    def width(self):
        """Parts that may be under way."""
        return max(1, QUEUED * self.cores)

    def check_nodes(self):
        """Raise ClusterError if a node lacks the package or holds other versions. Different processors are reported on stderr."""
        from ray.util.scheduling_strategies import NodeAffinitySchedulingStrategy as Affinity

        nodes = {node["NodeID"]: node["NodeManagerAddress"] for node in self._ray.nodes() if node["Alive"]}
        probe = self._ray.remote(num_cpus=0, max_retries=1)(_probe())
        asked = {probe.options(scheduling_strategy=Affinity(node, soft=False)).remote(): where for node, where in nodes.items()}
        late, kinds = list(asked), set()
        while late:
            ended = self.wait(late)
            for ref in ended:
                what = self.get(ref)
                if "missing" in what:
                    raise ClusterError(
                        f"the node {asked[ref]} has no {what['missing']}: install the same clone on every node ({installs('cluster')})"
                    )
                differs = difference(software(), what["software"])
                if differs:
                    raise ClusterError(f"the node {asked[ref]} holds other software: {differs}. Install the same on every node")
                kinds.add(what["processor"])
            late = [ref for ref in late if ref not in ended]
        if len(kinds) > 1:
            differ = "the last bits of a network's results may differ from those of one machine"
            print(f"the nodes have different processors ({', '.join(sorted(kinds))}): {differ}", file=sys.stderr)

    def put(self, shared):
        """Put shared data into the object store, once for all parts."""
        return self._ray.put(shared)

    def submit(self, task, shared, given):
        """Send a part."""
        return self._task.remote(task, shared, given, self._wanted)

    def wait(self, submitted):
        """Those that have ended, at least one. Raises ClusterError if the head is gone."""
        silent = None
        while True:
            ended, _ = self._ray.wait(submitted, num_returns=1, timeout=2.0)
            if ended:
                return ended
            why = answers(self._head, 2.0)
            silent = None if why is None else silent or time.monotonic()
            if silent is not None and time.monotonic() - silent > PATIENCE:
                raise ClusterError(f"the head of the cluster at {self._head} is gone ({why}): start it again")

    def finished(self, submitted):
        """Those that have ended by now."""
        return self._ray.wait(submitted, num_returns=len(submitted), timeout=0)[0] if submitted else []

    def get(self, one):
        """The result of a part that has ended. Raises ClusterError for what befell its machine, else the part's own error."""
        exceptions = self._ray.exceptions
        try:
            return self._ray.get(one)
        except exceptions.RayTaskError as error:
            fault = of_part(error.cause)
            raise (error.cause if fault is None else fault) from None
        except exceptions.OutOfMemoryError:
            raise out_of_memory() from None
        except exceptions.OutOfDiskError as error:
            raise ClusterError(f"the disk of a node is full: free space there ({' '.join(str(error).split())[:200]})") from None
        except exceptions.ObjectStoreFullError:
            raise ClusterError("the object store is full: start the nodes with more (ray start --object-store-memory)") from None
        except (exceptions.LocalRayletDiedError, exceptions.OwnerDiedError):
            raise ClusterError("Ray has ended on this machine, or the head of the cluster is gone: start it again") from None
        except exceptions.RayError as error:
            said = " ".join(str(error).split())[:200]
            raise ClusterError(f"a part was given up, its worker died {RETRIES + 1} times ({type(error).__name__}: {said})") from None

    def map(self, task, shared, many):
        """The results of a task for many arguments, in their order."""
        sent = self.put(shared)
        refs = [self.submit(task, sent, given) for given in many]
        left = set(refs)
        while left:
            left -= set(self.wait(list(left)))
        return [self.get(ref) for ref in refs]

    def close(self):
        """Leave the cluster; one on this machine alone ends."""
        self._ray.shutdown()
        self._witness.done()


def _run(task, shared, given, wanted):
    """What a worker does: play a part with its one core."""
    import ray

    here = ray.util.get_node_ip_address()
    check(wanted, here)
    try:
        return run(task, shared, given, 1)
    except Exception as error:
        fault = of_part(error, here)
        if fault is None:
            raise
        raise fault from None


def _probe():
    """A function that says what a node holds. Made inside another, it is sent as code: the node may lack this package."""

    def probe():
        try:
            import agents.cluster.software as found
            from commands.provenance import processor

            return {"software": found.software(), "processor": processor()}
        except ImportError as error:
            return {"missing": error.name or str(error)}

    return probe
