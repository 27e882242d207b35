"""How do commands write their files? They test them before the work and write each completely or not at all."""

import io
import json
import tempfile
from typing import Any

import numpy as np

from snooker_env._lib import files
from snooker_env._lib.files import (
    MOST_NPZ,
    UNFINISHED,
    arrays_in,
    read_bytes,
    strict_json,
    with_checksum,
    without_checksum,
    write_atomic,
)
from snooker_env._lib.seal import seal, unseal
from snooker_env.checks import refuse

__all__ = [
    "MOST_NPZ",
    "UNFINISHED",
    "arrays_in",
    "keep_arrays",
    "kept_arrays",
    "packed_arrays",
    "read_bytes",
    "read_json",
    "save_figure",
    "seal",
    "strict_json",
    "unseal",
    "with_checksum",
    "without_checksum",
    "writable",
    "write_atomic",
    "write_json",
]


def writable(name, file):
    """Make the folders of an output. ValueError if it cannot be written. The test writes, because access bits are wrong for
    root."""
    if file is None:
        return
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        with file.open("a") if file.exists() else tempfile.TemporaryFile(dir=file.parent):
            pass
    except OSError as error:
        raise refuse(name, str(file), f"must be a file that can be written ({error.strerror})") from None


def read_json(name, file, wanted, checked=False):
    """Read a JSON file, with its checksum if ``checked``. If it cannot be read, the ValueError says what is ``wanted``."""
    try:
        return files.read_json(file, name, wanted, checked=checked)
    except OSError as error:
        raise refuse(name, str(file), f"{wanted} ({error.strerror})") from None


def write_json(file, content):
    """Write JSON data, completely or not at all."""
    write_atomic(file, json.dumps(content, indent=1) + "\n")


def packed_arrays(arrays):
    """Convert a dict of arrays and numbers to the bytes of an ``.npz``."""
    file = io.BytesIO()
    made: Any = {name: np.asarray(value) for name, value in arrays.items()}
    np.savez(file, **made)
    return file.getvalue()


def keep_arrays(file, arrays):
    """Write a dict of arrays and numbers, from which the same command can continue."""
    write_atomic(file, seal(packed_arrays(arrays), file.name))


def kept_arrays(file):
    """Read what ``keep_arrays`` wrote; numbers return as arrays without dimensions. ValueError if the file is damaged."""
    try:
        return arrays_in(unseal(file.read_bytes(), file.name))
    except ValueError as error:
        wanted = f"must be undamaged ({error}): remove it, and the same command makes it again"
        raise refuse("out", str(file), wanted) from None


def save_figure(figure, file, **options):
    """Write a matplotlib figure in the format of the file's suffix, completely or not at all."""
    drawn = io.BytesIO()
    figure.savefig(drawn, format=file.suffix[1:], **options)
    write_atomic(file, drawn.getvalue())
