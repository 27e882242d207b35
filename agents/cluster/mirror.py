"""How does a training outlive its machine? Each checkpoint is copied to a shared folder or fsspec URL, from which any machine goes on.

One process writes there: whoever resumes takes over, and a run that still lives elsewhere stops at its next save. Between the check and
the write of one save two processes may cross; what is there is a complete checkpoint of the same run all the same.
"""

import hashlib
import json
import os
import platform
import time
import uuid

from commands.files import write_atomic
from snooker_env.checks import refuse

from .faults import ClusterError
from .store import store_of

CHECKPOINT, OWNER, RUN, SAVES = "checkpoint.pkl", "owner.json", "run.json", "mirror.json"
"""``SAVES``, here and in the run's folder: how many checkpoints were copied, and the digest of the last one."""
TRIES, PAUSE = 4, 2.0
"""How often a copy is tried, and the seconds before the second time, doubled each time."""
_mirrors = {}
"""Run folder -> its ``Mirror``, in this process."""


class Mirror:
    """The copy of a run's checkpoint.

    Parameters
    ----------
    url : str
        A folder or fsspec URL for this run alone.

    Raises
    ------
    ValueError
        If nothing can be written there.
    """

    def __init__(self, url):
        self.store, self._mine = store_of(url, "mirror"), uuid.uuid4().hex

    def fetch(self, out):
        """Write the checkpoint into the run's folder ``out``, if it holds none or an older one.

        Raises ValueError if there is none here, either, or if both have gone on from the last checkpoint that they shared.
        """
        saves = json.loads(self.store.read(SAVES) or b"{}")
        if (out / CHECKPOINT).is_file():
            known = json.loads((out / SAVES).read_bytes()) if (out / SAVES).is_file() else {}
            if saves.get("count", 0) <= known.get("count", 0):
                return
            if hashlib.sha256((out / CHECKPOINT).read_bytes()).hexdigest() != known.get("digest"):
                wanted = f"was gone on with by another machine, and so was {out}: remove {out / CHECKPOINT} to go on from the mirror"
                raise refuse("mirror", str(self.store), wanted)
        data = self.store.read(CHECKPOINT)
        if data is None:
            raise refuse("mirror", str(self.store), "holds no checkpoint: start the run without --resume")
        out.mkdir(parents=True, exist_ok=True)
        write_atomic(out / CHECKPOINT, data)
        write_atomic(out / SAVES, json.dumps(saves).encode())

    def claim(self, out, settings, resume):
        """Become the one that writes, for the run in ``out``. Raises ValueError if another run is kept here.

        ``settings``: what makes it that run, a dict.
        """
        now = json.loads(json.dumps(settings))
        if CHECKPOINT in self.store.names(""):
            if not resume:
                raise refuse("mirror", str(self.store), "holds a run: --resume continues it, another --mirror keeps a new one")
            was = json.loads(self.store.read(RUN) or b"{}")
            differs = [name for name in {**now, **was} if was.get(name) != now.get(name)]
            if differs:
                name = differs[0]
                raise refuse(
                    "mirror", str(self.store), f"must be that of the same run: its {name} is {was.get(name)!r}, not {now.get(name)!r}"
                )
        owner = {"token": self._mine, "process": os.getpid(), "machine": platform.node(), "since": time.strftime("%Y-%m-%d %H:%M:%S")}
        self.store.write(RUN, json.dumps(now, indent=1).encode())
        self.store.write(OWNER, json.dumps(owner, indent=1).encode())
        _mirrors[out.resolve()] = self

    def save(self, data, name=CHECKPOINT):
        """Copy a checkpoint, with patience for a network that fails. Raises ClusterError if it does not end, or if another process has
        taken over the run."""
        for k in range(TRIES):
            try:
                owner = json.loads(self.store.read(OWNER) or b"{}")
                if owner.get("token") != self._mine:
                    who = f"process {owner.get('process')} on {owner.get('machine')} since {owner.get('since')}"
                    raise ClusterError(f"the run at {self.store} was taken over by {who}: this one stops")
                self.store.write(name, data)
                return
            except ClusterError:
                raise
            except Exception as error:  # each kind of store has its own errors
                if k + 1 == TRIES:
                    raise ClusterError(f"the mirror {self.store} cannot be written: {getattr(error, 'strerror', None) or error}") from None
                time.sleep(PAUSE * 2**k)


def copied(out, data, name=CHECKPOINT):
    """Copy a file of the run in ``out`` to its mirror, if it has one."""
    mirror = _mirrors.get(out.resolve())
    if mirror is not None:
        mirror.save(data, name)
        if name == CHECKPOINT:
            count = json.loads(mirror.store.read(SAVES) or b"{}").get("count", 0) + 1
            saves = json.dumps({"count": count, "digest": hashlib.sha256(data).hexdigest()}).encode()
            mirror.save(saves, SAVES)
            out.mkdir(parents=True, exist_ok=True)
            write_atomic(out / SAVES, saves)


def left(out):
    """The run in ``out`` ends: forget its mirror."""
    _mirrors.pop(out.resolve(), None)
