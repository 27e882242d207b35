"""How is a file written so that it is whole or not there at all?"""

import os
from pathlib import Path


def write_atomic(path, data):
    """Write bytes so that ``path`` holds either the old or the new content, whole, whenever the process or the machine dies.

    If it fails nothing is left behind, and the OSError names ``path``. What is no plain file (a device, a pipe) is written as it is.
    """
    path = Path(os.path.realpath(path))
    if path.exists() and not path.is_file():
        path.write_bytes(data)
        return
    temporary = path.with_name(f"{path.name}.{os.getpid()}.tmp")  # of this process alone
    try:
        with open(temporary, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except BaseException as error:
        temporary.unlink(missing_ok=True)
        if isinstance(error, OSError):
            error.filename, error.filename2 = str(path), None
        raise
