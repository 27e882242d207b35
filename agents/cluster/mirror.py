"""How does a training outlive its machine? Checkpoints are copied to where any machine can go on.

One process writes there: whoever resumes takes over, and a run that still lives elsewhere stops at its next
save.
"""

import hashlib
import json
import os
import platform
import time
import uuid

from commands.files import read_json, with_checksum, write_atomic, write_json
from snooker_env.checks import refuse

from .job import ClusterError
from .keep import Store

CHECKPOINT, OWNER, RUN, SAVES = "checkpoint.pkl", "owner.json", "run.json", "mirror.json"
"""``SAVES``, here and in the run's folder: number of checkpoints that were copied, digest of the last one."""
TRIES, PAUSE = 4, 2.0
"""How often a copy is tried, and the seconds before the second time, doubled each time."""
_mirrors = {}
"""Run folder -> its ``Mirror``, in this process."""


class Mirror:
    """The copy of a run's checkpoint in a folder or at an fsspec URL for it alone. Raises ValueError."""

    def __init__(self, url):
        self.store, self._mine = Store(url, "mirror"), uuid.uuid4().hex

    def fetch(self, out):
        """Write the checkpoint into the run's folder if its own is older. ValueError if both went on."""
        saves, local = self.store.read_json(SAVES), out / CHECKPOINT
        if local.is_file():
            known = (
                read_json("out", out / SAVES, "must be whole", checked=True)
                if (out / SAVES).is_file()
                else {}
            )
            if saves.get("count", 0) <= known.get("count", 0):
                return
            if hashlib.sha256(local.read_bytes()).hexdigest() != known.get("digest"):
                both = f"was gone on with by another machine, and so was {out}"
                raise refuse("mirror", str(self.store), f"{both}: remove {local} to go on from the mirror")
        data = self.store.read(CHECKPOINT)
        if data is None:
            raise refuse("mirror", str(self.store), "holds no checkpoint: start the run without --resume")
        out.mkdir(parents=True, exist_ok=True)
        write_atomic(local, data)
        write_json(out / SAVES, with_checksum(saves))

    def claim(self, out, settings, resume):
        """Become the one that writes, for the run in ``out``. ValueError if another run is kept here."""
        now, was = json.loads(json.dumps(settings)), self.store.read_json(RUN)
        if CHECKPOINT in self.store.names(""):
            if not resume:
                why = "holds a run: --resume continues it, another --mirror keeps a new one"
                raise refuse("mirror", str(self.store), why)
            for name in {**now, **was}:
                if was.get(name) != now.get(name):
                    differs = f"its {name} is {was.get(name)!r}, not {now.get(name)!r}"
                    raise refuse("mirror", str(self.store), f"must be that of the same run: {differs}")
        owner = {"token": self._mine, "process": os.getpid(), "machine": platform.node()}
        owner["since"] = time.strftime("%Y-%m-%d %H:%M:%S")
        self.store.write_json(RUN, now)
        self.store.write_json(OWNER, owner)
        _mirrors[out.resolve()] = self

    def save(self, data, name=CHECKPOINT):
        """Copy a file, with patience for a network. ClusterError if it fails on, or if another took over."""
        for k in range(TRIES):
            try:
                owner = self.store.read_json(OWNER)
                if owner.get("token") == self._mine:
                    self.store.write(name, data)
                    return
            except Exception as error:  # each kind of store has its own errors
                if k + 1 == TRIES:
                    why = getattr(error, "strerror", None) or error
                    raise ClusterError(f"the mirror {self.store} cannot be written: {why}") from None
                time.sleep(PAUSE * 2**k)
                continue
            who = f"process {owner.get('process')} on {owner.get('machine')} since {owner.get('since')}"
            raise ClusterError(f"the run at {self.store} was taken over by {who}: this one stops")


def copied(out, data, name=CHECKPOINT):
    """Copy a file of the run in ``out`` to its mirror, if it has one."""
    mirror = _mirrors.get(out.resolve())
    if mirror is None:
        return
    mirror.save(data, name)
    if name == CHECKPOINT:
        count = mirror.store.read_json(SAVES).get("count", 0) + 1
        saves = with_checksum({"count": count, "digest": hashlib.sha256(data).hexdigest()})
        mirror.save(json.dumps(saves).encode(), SAVES)
        out.mkdir(parents=True, exist_ok=True)
        write_json(out / SAVES, saves)


def left(out):
    """The run in ``out`` ends: forget its mirror."""
    _mirrors.pop(out.resolve(), None)
