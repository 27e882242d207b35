"""Where is kept what a job has played? In a folder or under a URL of fsspec (s3://, gs://, memory://), each file whole or not at all.

A result of a part is a dict of NumPy arrays, kept as .npz without pickles: reading it runs no code.
"""

import errno
import io
import json
import os
import shutil
import uuid
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from commands.files import write_atomic
from snooker_env.checks import refuse


def store_of(url, field="keep", only_read=False):
    """The ``Folder`` or the ``Remote`` for a path or URL. Raises ValueError, naming ``field``; ImportError without fsspec."""
    scheme, found, path = url.partition("://")
    if not found:
        return Folder(Path(url), field, only_read)
    return Folder(Path(path), field, only_read) if scheme == "file" else Remote(url, field, only_read)


class Folder:
    """Files in a folder, local or shared by several machines.

    Parameters
    ----------
    path : Path
        The folder; it is made.
    field : str
        Name of the option that gave it.
    only_read : bool
        Neither make the folder nor try to write there.

    Raises
    ------
    ValueError
        If nothing can be written there.
    """

    def __init__(self, path, field="keep", only_read=False):
        self.path = path
        if only_read:
            return
        try:
            path.mkdir(parents=True, exist_ok=True)
            self.write(".tried", b"")
            (path / ".tried").unlink(missing_ok=True)
        except OSError as error:
            raise refuse(field, str(path), f"must be a folder that can be written ({error.strerror})") from None

    def __str__(self):
        return str(self.path)

    def names(self, under):
        """Names of the files in a sub-folder."""
        folder = self.path / under
        return {file.name for file in folder.iterdir() if not file.name.endswith(".tmp")} if folder.is_dir() else set()

    def read(self, name):
        """The content of a file; None if there is none."""
        try:
            return (self.path / name).read_bytes()
        except FileNotFoundError:
            return None

    def write(self, name, data):
        """Write a file, whole or not at all. Two processes that write the same file do not disturb each other."""
        file = self.path / name
        file.parent.mkdir(parents=True, exist_ok=True)
        beside = file.with_name(f"{file.name}.{uuid.uuid4().hex[:12]}.tmp")  # processes of two machines may have the same number
        try:
            write_atomic(beside, data)
            os.replace(beside, file)
        except OSError as error:
            beside.unlink(missing_ok=True)
            error.filename, error.filename2 = str(file), None
            raise

    def remove(self, name):
        """Remove a file, if it is there."""
        (self.path / name).unlink(missing_ok=True)

    def clear(self):
        """Remove the folder and all that is in it."""
        shutil.rmtree(self.path, ignore_errors=True)


class Remote:
    """Files under a URL of fsspec. An object store shows a file only when it is whole.

    Parameters
    ----------
    url : str
        Such as ``s3://bucket/folder``.
    field : str
        Name of the option that gave it.
    only_read : bool
        Do not try to write there.

    Raises
    ------
    ValueError
        If nothing can be written there.
    ImportError
        If fsspec or its driver for this kind of URL is not installed.
    """

    def __init__(self, url, field="keep", only_read=False):
        from fsspec.core import url_to_fs

        self.url = url
        try:
            self._files, self._root = url_to_fs(url)
            if not only_read:
                self.write(".tried", b"")
                self.remove(".tried")
        except ImportError:
            raise
        except Exception as error:  # each driver has its own
            raise refuse(field, url, f"must be a URL that can be written ({type(error).__name__}: {str(error)[:200]})") from None

    def __str__(self):
        return self.url

    def names(self, under):
        """Names of the files in a sub-folder."""
        self._files.invalidate_cache()
        try:
            found = self._files.ls(f"{self._root}/{under}", detail=False)
        except FileNotFoundError:
            return set()
        return {name.rstrip("/").rpartition("/")[2] for name in found if not name.endswith(".tmp")}

    def read(self, name):
        """The content of a file; None if there is none."""
        try:
            return self._files.cat_file(f"{self._root}/{name}")
        except FileNotFoundError:
            return None

    def write(self, name, data):
        """Write a file; an error of the driver becomes an ``OSError`` that names the file."""
        path = f"{self._root}/{name}"
        try:
            self._files.makedirs(path.rpartition("/")[0], exist_ok=True)
            protocols = {self._files.protocol} if isinstance(self._files.protocol, str) else set(self._files.protocol)
            if protocols & {"s3", "gs", "abfs"}:  # there, a file appears when it is whole
                self._files.pipe_file(path, data)
                return
            beside = f"{path}.{os.getpid()}.{uuid.uuid4().hex[:8]}.tmp"
            self._files.pipe_file(beside, data)
            self._files.mv(beside, path)
        except Exception as error:
            if isinstance(error, OSError) and error.errno == errno.ENOSPC:
                raise OSError(errno.ENOSPC, error.strerror, f"{self.url}/{name}") from None
            raise OSError(errno.EIO, f"{type(error).__name__}: {str(error)[:200]}", f"{self.url}/{name}") from None

    def remove(self, name):
        """Remove a file, if it is there."""
        if self._files.exists(f"{self._root}/{name}"):
            self._files.rm_file(f"{self._root}/{name}")


def packed(result):
    """A dict of arrays and numbers as bytes."""
    file = io.BytesIO()
    arrays: Any = {name: np.asarray(value) for name, value in result.items()}
    np.savez(file, **arrays)
    return file.getvalue()


def unpacked(data, where):
    """The inverse of ``packed``; numbers come back as arrays of no dimension. Raises ValueError, naming ``where`` it was read."""
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as found:
            return {name: found[name] for name in found.files}
    except (ValueError, OSError, EOFError, KeyError, zipfile.BadZipFile):
        raise refuse("keep", where, "must be a part as it was written: this one is damaged, delete it to have it played again") from None


def opened(store, job):
    """Make the store one of this ``job`` (a dict of what is played), or go on with it; the names of the parts that it holds.

    Raises ValueError, naming what differs, if it holds parts of another job: they are never mixed.
    """
    before = store.read("job.json")
    if before is None:
        if store.names("parts"):
            raise refuse("keep", str(store), "must be a new folder, or that of the same job: it holds parts and no job.json")
        store.write("job.json", (json.dumps(job, indent=1) + "\n").encode())
        return set()
    try:
        was = json.loads(before)
    except ValueError:
        was = None
    if not isinstance(was, dict):
        raise refuse("keep", str(store), "must hold a job.json as it was written: this one is damaged, give another folder")
    now = json.loads(json.dumps(job))
    for name in {**now, **was}:
        if was.get(name) != now.get(name):
            raise refuse(
                "keep", str(store), f"must be a new folder, or that of the same job: its {name} is {_short(was.get(name))}, "
                f"and {_short(now.get(name))} is asked for",
            )  # fmt: skip
    return store.names("parts")


def _short(value):
    text = json.dumps(value)
    return text if len(text) <= 200 else f"{text[:200]}..."
