"""How are files written so that no reader ever sees half of one, and how are JSON and arrays of others read?"""

import hashlib
import io
import json
import math
import os
import re
import sys
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

import numpy as np

from .check import refuse

MOST_JSON, MOST_NPZ = 2**26, 2**27  # bytes: many times the longest of this repository
CHECKSUM = "sha256"  # the key of a checksum
MOST_INTEGER, DEPTH = 2**128, 32  # in JSON: the state of a random generator; objects in objects
UNFINISHED = re.compile(r"\..+\.[0-9a-f]{16}\.tmp(\.\w+)?")  # temporary files: a killed process leaves one


def write_atomic(path: str | Path, content: bytes | str | Callable[[Path], object]) -> None:
    """Write a file so that ``path`` holds the old or the new content, complete, whenever the machine stops.

    ``content`` may be a function that writes a file at a path with the same suffix. An OSError names ``path``, and nothing
    is left behind. A device or a pipe is written directly."""
    target, data = Path(os.path.realpath(path)), content.encode() if isinstance(content, str) else content
    write = data if callable(data) else lambda file: file.write_bytes(data)
    if target.exists() and not target.is_file():
        try:
            write(target)
        except OSError as error:
            error.filename = error.filename or str(path)
            raise
        return
    name = f".{target.stem}.{os.urandom(8).hex()}.tmp{target.suffix}"  # that no machine uses twice
    temporary = target.with_name(name)
    try:
        write(temporary)
        with temporary.open("rb+") as file:
            os.fsync(file.fileno())
        os.replace(temporary, target)
    except BaseException as error:
        temporary.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.filename in (None, str(temporary)):
            error.filename = str(path)  # the file that the caller named
            del error.filename2
        raise


def read_bytes(path: str | Path, most: int) -> bytes:
    """What a file holds; ValueError if that is more than ``most`` bytes. A device may have no end, and no size."""
    data = bytearray()
    with open(path, "rb") as file:
        while part := file.read(2**20):
            data += part
            if len(data) > most:
                raise ValueError(f"it has more than {most:,} bytes")
    return bytes(data)


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    made: dict[str, Any] = {}
    for name, value in pairs:
        if name in made:
            raise ValueError(f"the key {name!r} stands there twice")
        made[name] = value
    return made


def _sound(text: str) -> Any:
    """The number that a text of JSON stands for; ``json`` itself makes 1e999 infinite, and integers of any size."""
    whole = text.lstrip("-").isdigit()
    value = int(text) if whole and len(text) < 99 else float(text)
    if not abs(value) <= (MOST_INTEGER if whole else sys.float_info.max):  # NaN neither
        few = text if len(text) < 30 else f"{text[:27]}..."
        raise ValueError(f"{few} is no number between -{MOST_INTEGER:.2g} and {MOST_INTEGER:.2g}")
    return value


def strict_json(text: str | bytes) -> Any:
    """What JSON in UTF-8 holds; ValueError for NaN, 1e999, an integer beyond ``MOST_INTEGER``, a key twice, over ``DEPTH`` levels."""
    if isinstance(text, bytes):
        text = text.decode("utf-8")
    numbers = dict.fromkeys(("parse_constant", "parse_int", "parse_float"), _sound)
    try:
        read = json.loads(text, **numbers, object_pairs_hook=_once)
    except RecursionError:
        raise ValueError(f"it is nested deeper than {DEPTH}") from None
    inner = [read]
    for _ in range(DEPTH + 1):
        inner = [one for one in inner if isinstance(one, dict | list)]
        inner = [part for one in inner for part in (one.values() if isinstance(one, dict) else one)]
    if inner:
        raise ValueError(f"it is nested deeper than {DEPTH}")
    return read


def _checksum(content: dict[str, Any]) -> str:
    plain = json.loads(json.dumps(content))  # what a reader makes of it: keys are texts, tuples lists
    return hashlib.sha256(json.dumps(plain, sort_keys=True).encode()).hexdigest()


def with_checksum(content: dict[str, Any]) -> dict[str, Any]:
    """The content of a file of JSON that a command goes on with, and its checksum."""
    return content | {CHECKSUM: _checksum(content)}


def without_checksum(content: dict[str, Any]) -> dict[str, Any]:
    """The content without its checksum; ValueError if it has none, or another."""
    rest = {name: value for name, value in dict(content).items() if name != CHECKSUM}
    if content.get(CHECKSUM) != _checksum(rest):
        raise ValueError(f"it is damaged: its {CHECKSUM} does not match its content")
    return rest


def read_json(
    path: str | Path, field: str = "path", wanted: str = "must be JSON", *, checked: bool = False
) -> Any:
    """``strict_json`` of a file of at most ``MOST_JSON`` bytes, without its checksum, which must be there if ``checked``.
    ValueError names ``field``, the file, what is ``wanted`` and the fault; OSError if the file cannot be read."""
    try:
        read = strict_json(read_bytes(path, MOST_JSON))
        found = isinstance(read, dict) and (checked or CHECKSUM in read)
        return without_checksum(read) if found else read
    except ValueError as error:
        raise refuse(field, str(path), f"{wanted} ({error})") from None


@contextmanager
def in_file(path: str | Path) -> Iterator[None]:
    """A ValueError about what is in a file names the file, too."""
    try:
        yield
    except ValueError as error:
        if str(path) in str(error):
            raise
        raise ValueError(f"{path}: {error}") from None


def unzip(file: zipfile.ZipFile, part: zipfile.ZipInfo) -> bytes:
    """One part of a zip. Never more than its directory says is unpacked: it may lie, and bzip2 would not stop."""
    if part.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise ValueError(f"{part.filename} is neither stored nor deflated")
    with file.open(part) as packed:
        data = packed.read(part.file_size + 1)
    if len(data) != part.file_size:
        raise ValueError(f"{part.filename} has not the {part.file_size:,} bytes that its directory says")
    return data


def _array(data: bytes) -> np.ndarray:
    """The array of an ``.npy``, whose header may ask for more than there is."""
    file = io.BytesIO(data)
    version = np.lib.format.read_magic(file)
    readers = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
    if version not in readers:
        raise ValueError(f"{version} is an unknown version of .npy")
    shape, columns, kind = readers[version](file)
    size = len(data) - file.tell()
    if kind.hasobject or not kind.itemsize or math.prod(shape) * kind.itemsize != size:
        raise ValueError(f"{size:,} bytes are not an array of {kind} and shape {shape}")
    order: Literal["F", "C"] = "F" if columns else "C"
    return np.ndarray(shape, kind, data, file.tell(), order=order).copy(order)


def arrays_in(data: bytes) -> dict[str, np.ndarray]:
    """The arrays of an ``.npz``, no pickles; ValueError for anything else, and if it says that it holds over ``MOST_NPZ`` bytes."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as file:
            parts, most = file.infolist(), max(MOST_NPZ, len(data))
            if sum(part.file_size for part in parts) > most:
                raise ValueError(f"it unpacks to more than {most:,} bytes")
            found = _once([(part.filename.removesuffix(".npy"), part) for part in parts])
            return {name: _array(unzip(file, part)) for name, part in found.items()}
    except Exception as error:  # zip and NumPy raise many kinds for damaged files
        raise ValueError(str(error).strip() or type(error).__name__) from None


def read_npz(path: str | Path) -> dict[str, np.ndarray]:
    """``arrays_in`` a file of at most ``MOST_NPZ`` bytes; errors as those of ``read_json``."""
    try:
        return arrays_in(read_bytes(path, MOST_NPZ))
    except ValueError as error:
        raise refuse("path", str(path), f"must be an .npz of arrays ({error})") from None
