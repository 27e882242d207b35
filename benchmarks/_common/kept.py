"""Where does a benchmark keep what it makes once and runs later? In this clone, where no other user of the
machine could have put it."""

import os
import shutil
import tempfile
from pathlib import Path

BUILD = Path(__file__).parents[2] / "build" / "benchmarks"
"""Git ignores it. A known name under /tmp could be another user's, with code of his own."""


def kept_folder(name, make):
    """The folder of that name; if there is none, ``make(folder)`` fills it, aside: a second process never
    sees half of it."""
    folder = BUILD / name
    if not folder.exists():
        BUILD.mkdir(parents=True, exist_ok=True)
        aside = Path(tempfile.mkdtemp(prefix=f"{name}.", dir=BUILD))
        try:
            make(aside)
            os.replace(aside, folder)
        except OSError:
            if not folder.exists():  # else another process was faster
                raise
        finally:
            shutil.rmtree(aside, ignore_errors=True)
    return folder
