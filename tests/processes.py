"""How does a test use a fresh process? It runs Python on a copy of the package or on this one."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import snooker_env as sn

ROOT = Path(sn.__file__).resolve().parents[1]
CACHE = ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME", "NUMBA_DISABLE_JIT")
"""Variables that decide where machine code is kept, or if there is any."""


def python(code, *, at=ROOT, warn="error::UserWarning", **variables):
    """What a fresh interpreter prints; ``at``: the package's folder; variables that are None are unset."""
    usual = {"PYTHONPATH": str(at), "PYTHONWARNINGS": warn}
    usual |= {"PYTHONDONTWRITEBYTECODE": "1", "SNOOKER_ENV_QUIET": "1"}
    env = {k: v for k, v in (os.environ | usual | variables).items() if v is not None}
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, cwd=at, env=env, capture_output=True, text=True, timeout=280)
    assert done.returncode == 0, done.stderr[-3000:]
    return done.stdout, done.stderr


def copy_of_package(to):
    shutil.copytree(ROOT / "snooker_env", to / "snooker_env", ignore=shutil.ignore_patterns("__pycache__"))
    return to


def replace(path, old, new, times=1):
    """Put ``new`` in the place of ``old``, which the file holds so many times."""
    text = path.read_text()
    assert text.count(old) == times, f"{path.name} holds {old!r} {text.count(old)} times"
    path.write_text(text.replace(old, new))
