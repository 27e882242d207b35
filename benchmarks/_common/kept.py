"""Where does a benchmark keep code that it makes once and runs later? In this clone, where no other user of the
machine can write."""

import os
import shutil
import tempfile
from pathlib import Path

BUILD = Path(__file__).parents[2] / "build" / "benchmarks"
"""Git ignores this folder. A known name under /tmp could belong to another user and hold their code."""


def kept_folder(name, make):
    """The folder with this name. If there is none, ``make(folder)`` fills it elsewhere first, so that a second process
    never sees it incomplete."""
    folder = BUILD / name
    if not folder.exists():
        BUILD.mkdir(parents=True, exist_ok=True)
        aside = Path(tempfile.mkdtemp(prefix=f"{name}.", dir=BUILD))
        try:
            make(aside)
            os.replace(aside, folder)
        except OSError:
            if not folder.exists():  # otherwise another process was faster
                raise
        finally:
            shutil.rmtree(aside, ignore_errors=True)
    return folder
