"""How is a file written completely or not at all?"""

import io
import os
import tempfile
from pathlib import Path


def write_atomic(path, data):
    """Write bytes so that ``path`` holds either the old or the new content, complete, whenever the process or the machine stops.

    On failure nothing is left behind, and the OSError names ``path``. A device or a pipe is written directly.
    """
    path = Path(os.path.realpath(path))
    if path.exists() and not path.is_file():
        path.write_bytes(data)
        return
    temporary = path.with_name(f"{path.name}.{os.getpid()}.tmp")  # a name of this process alone
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


def writable(name, file):
    """Make the folders of an output; ValueError if it could not be written there. Tested by writing: access bits are wrong for root."""
    if file is None:
        return
    from snooker_env.checks import refuse  # here: a missing library is reported only after this module is loaded

    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        with file.open("a") if file.exists() else tempfile.TemporaryFile(dir=file.parent):
            pass
    except OSError as error:
        raise refuse(name, str(file), f"must be a file that can be written ({error.strerror})") from None


def save_figure(figure, file, **options):
    """Write a matplotlib figure, in the format of the file's suffix, completely or not at all."""
    drawn = io.BytesIO()
    figure.savefig(drawn, format=file.suffix[1:], **options)
    write_atomic(file, drawn.getvalue())
