"""Which options do commands share that play on a cluster? ``--ray`` says where, ``--keep`` where what was played is kept."""

from contextlib import contextmanager
from pathlib import Path

from commands.lock import Lock
from snooker_env.checks import refuse

from .faults import split_address
from .job import Here, digest_of
from .store import Folder, store_of

KEPT = Path("runs/kept")
"""Folder of what jobs on a cluster keep where ``--keep`` does not say it."""


def add_ray(p):
    """Add ``--ray`` to a parser."""
    p.add_argument(
        "--ray", metavar="ADDRESS", help="play on a Ray cluster: local (all cores of this machine, one part each), or HOST:PORT of a head; "
        "results do not depend on it"
    )  # fmt: skip


def add_keep(p):
    """Add ``--keep`` to a parser."""
    p.add_argument(
        "--keep", metavar="URL", help=f"keep each part that was played in this folder or fsspec URL: after an interruption the same "
        f"command goes on there [with --ray: a folder in {KEPT}, until the job is complete]"
    )  # fmt: skip


def checked_ray(address):
    """Raise ValueError unless it is None, local or HOST:PORT."""
    if address is not None and address != "local":
        split_address(address)


@contextmanager
def place(address, threads=None):
    """Where parts are played, as a context: ``Here`` without an address, else the ``Cluster``. Raises ClusterError."""
    if address is None:
        yield Here(threads)
        return
    from .ray_cluster import connected

    found = connected(address)
    try:
        yield found
    finally:
        found.close()


class Keep:
    """Where the parts of a job are kept: at ``--keep``; with ``--ray`` alone in a folder named after the job, until it is complete.

    As a context: that folder belongs to one job at a time, since the one that ends removes it.

    Parameters
    ----------
    url : str, optional
        As given by ``--keep``.
    address : str, optional
        As given by ``--ray``.
    about : dict
        What is played.

    Attributes
    ----------
    store : Folder, Remote or None
        None: nothing is kept.

    Raises
    ------
    ValueError
        If nothing can be written there, or another process plays the same job and has no ``--keep`` either.
    """

    def __init__(self, url, address, about):
        self.about, self.store, self._lock = about, None, None
        if url is not None:
            self.store = store_of(url)
        elif address is not None:
            folder = KEPT / f"{about['command']}-{digest_of(about)[:12]}"
            try:
                KEPT.mkdir(parents=True, exist_ok=True)
                self._lock = Lock(folder, "keep", folder.with_name(f"{folder.name}.lock"))  # beside it: the folder is removed
            except OSError as error:
                raise refuse("keep", str(folder), f"must be a folder that can be written ({error.strerror})") from None
            try:
                self.store = store_of(str(folder))
            except BaseException:
                self._lock.release()
                raise

    def __enter__(self):
        return self

    def __exit__(self, *error) -> None:
        if self._lock is not None:
            self._lock.release()

    def ends(self, complete):
        """What becomes of the parts that were not used, in words; ``complete``: whether any part of the result is there."""
        if self.store is not None:
            return f"what was played is kept in {self.store}, the same command goes on"
        return "the others are lost" if complete else "nothing is kept"

    def done(self):
        """The job is complete, its results are written: a folder of its own goes."""
        if self._lock is not None and isinstance(self.store, Folder):
            self.store.clear()
