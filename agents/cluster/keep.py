"""Where is kept what a job has played? In a folder or at a URL of fsspec, without pickles."""

import errno
import hashlib
import io
import json
import uuid
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from commands.files import (
    arrays_in,
    sealed,
    strict_json,
    unsealed,
    with_checksum,
    without_checksum,
    write_atomic,
)
from commands.lock import Lock
from snooker_env.checks import refuse

KEPT = Path("runs/kept")
"""Folder of what jobs on a cluster keep where ``--keep`` does not say it."""


class Store:
    """Files in a folder or at a URL (s3://, gs://), each whole or not at all. ValueError names ``field``."""

    def __init__(self, url, field="keep", only_read=False):
        from fsspec.core import url_to_fs

        self.url, self._field = str(url), field
        try:
            self._files, self._root = url_to_fs(self.url)
            if not only_read:
                self.write(".tried", b"")
                self._files.rm_file(f"{self._root}/.tried")
        except ImportError:
            raise
        except Exception as error:  # each kind of store has its own errors
            raise self._refused(f"be a folder or URL that can be written ({_why(error)})") from None

    def __str__(self):
        return self.url

    def names(self, under):
        """Names of the files in a sub-folder."""
        self._files.invalidate_cache()
        try:
            paths = self._files.ls(f"{self._root}/{under}", detail=False)
        except FileNotFoundError:
            return set()
        return {name for path in paths if ".tmp" not in (name := path.rstrip("/").rpartition("/")[2])}

    def read(self, name):
        """The content of a file; None if there is none."""
        try:
            return self._files.cat_file(f"{self._root}/{name}")
        except FileNotFoundError:
            return None

    def write(self, name, data):
        """Write a file, whole or not at all; an error of any store is an OSError that names the file."""
        path = f"{self._root}/{name}"
        try:
            self._files.makedirs(path.rpartition("/")[0], exist_ok=True)
            if "file" in self._files.protocol:
                write_atomic(path, data)
                return
            beside = f"{path}.{uuid.uuid4().hex}.tmp"
            self._files.pipe_file(beside, data)
            self._files.mv(beside, path)
        except Exception as error:
            number = getattr(error, "errno", None) or errno.EIO
            raise OSError(number, _why(error), f"{self.url}/{name}") from None

    def clear(self):
        """Remove the folder and all that is in it."""
        self._files.rm(self._root, recursive=True)

    def part(self, key):
        """The result of the part of this name; None if it is not kept, or damaged."""
        data = self.read(f"parts/{key}.npz")
        with suppress(ValueError):
            return None if data is None else arrays_in(unsealed(data, key))

    def keep_part(self, key, result):
        """Keep the result of the part of this name."""
        self.write(f"parts/{key}.npz", sealed(packed(result), key))

    def read_json(self, name):
        """The object in a file, {} if there is none. Raises ValueError if it is damaged."""
        data = self.read(name)
        try:
            return {} if data is None else without_checksum(strict_json(data))
        except (ValueError, TypeError, AttributeError) as error:
            raise self._refused(f"hold a {name} as it was written: this one is damaged ({error})") from None

    def write_json(self, name, content):
        """Write an object, with its checksum."""
        self.write(name, (json.dumps(with_checksum(content), indent=1) + "\n").encode())

    def join(self, job):
        """Make this the store of a ``job``, a dict. ValueError that says what differs if it is another's."""
        if "job.json" not in self.names(""):
            if self.names("parts"):
                same = "be a new folder, or that of the same job"
                raise self._refused(f"{same}: it holds parts and no job.json")
            self.write_json("job.json", job)
            return
        was, now = self.read_json("job.json"), json.loads(json.dumps(job))
        for name in {**now, **was}:
            if was.get(name) != now.get(name):
                before, asked = (f"{json.dumps(one.get(name)):.200}" for one in (was, now))
                differs = f"its {name} is {before}, and {asked} is asked for"
                raise self._refused(f"be a new folder, or that of the same job: {differs}")

    def _refused(self, wanted):
        return refuse(self._field, self.url, f"must {wanted}")


def _why(error):
    return getattr(error, "strerror", None) or f"{type(error).__name__}: {str(error)[:200]}"


def packed(result):
    """A dict of arrays and numbers as bytes."""
    file = io.BytesIO()
    arrays: Any = {name: np.asarray(value) for name, value in result.items()}
    np.savez(file, **arrays)
    return file.getvalue()


def keep_arrays(file, result):
    """Write a dict of arrays and numbers, from which the same command goes on."""
    write_atomic(file, sealed(packed(result), file.name))


def kept_arrays(file):
    """What ``keep_arrays`` wrote; numbers come back as arrays of no dimension. ValueError if it is damaged."""
    try:
        return arrays_in(unsealed(file.read_bytes(), file.name))
    except ValueError as error:
        wanted = f"must be as it was written ({error}): remove it, and the same command plays it again"
        raise refuse("out", str(file), wanted) from None


def digest_of(data):
    """A digest of data of dicts, lists, texts, numbers and bytes."""
    plain = lambda value: hashlib.sha256(value).hexdigest()  # noqa: E731
    return hashlib.sha256(json.dumps(data, sort_keys=True, default=plain).encode()).hexdigest()[:32]


class Keep:
    """Where the parts of a job are kept: at ``--keep``; with ``--ray`` alone in a folder until it is done.

    That folder belongs to one process at a time. ``store`` is None if nothing is kept. Raises ValueError.
    """

    def __init__(self, url, address, about):
        self.store, self._lock = None if url is None else Store(url), None
        if url is None and address is not None:
            folder = KEPT / f"{about['command']}-{digest_of(about)[:12]}"
            self.store = Store(folder)
            self._lock = Lock(folder, "keep")
        if self.store is not None:
            self.store.join(about)

    def __enter__(self):
        return self

    def __exit__(self, *error) -> None:
        if self._lock is not None:
            self._lock.release()

    @property
    def ends(self):
        """What becomes of the parts that were not used, in words."""
        if self.store is None:
            return "the others are lost"
        return f"what was played is kept in {self.store}, the same command goes on"

    def done(self):
        """The job is complete, its results are written: a folder of its own goes."""
        if self._lock is not None and self.store is not None:
            self.store.clear()
