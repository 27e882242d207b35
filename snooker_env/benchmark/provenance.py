"""Where do figures come from? The commit, the machine, its load and last bits, and versions."""

import hashlib
import os
import platform
import subprocess
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from ..envs.vector import SnookerVectorEnv

LIBRARIES = ("numpy", "numba", "gymnasium", "torch", "stable_baselines3", "sb3_contrib")  # in a result


def commit() -> str | None:
    """The commit of the checkout that the package is in, with "-dirty" if a tracked file is changed; None without one.
    Pages and kept results do not count: a command that makes several of them changes them on its way."""
    here, made = Path(__file__).resolve().parents[2], (":!results/*/*", ":!docs/*")

    def git(*words: str) -> str:
        command = ["git", "-C", str(here), *words]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()

    try:
        if not (here / ".git").exists():
            return None
        changed = git("status", "--porcelain", "--untracked-files=no", "--", ".", *made)
        return git("rev-parse", "HEAD") + ("-dirty" if changed else "")
    except (OSError, subprocess.CalledProcessError):
        return None


def software() -> dict[str, str | None]:
    """Name -> version of the package, of Python and of libraries that decide results; None: not installed."""
    from .. import __version__

    versions: dict[str, str | None] = {"snooker_env": __version__, "python": platform.python_version()}
    for name in LIBRARIES:
        try:
            versions[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            versions[name] = None
    return versions


@cache
def arithmetic() -> str:
    """How the last bits fall here, a digest of 128 strokes into the pack with execution errors: where it is the same, the
    same strokes end alike. Mathematical libraries differ in the last bit, and many impacts amplify that."""
    tables = SnookerVectorEnv(32, aim="target", layout="break_off", noise="professional")
    seen = hashlib.sha256()
    tables.reset(seed=0)
    for _ in range(4):
        tables.step(np.column_stack([np.linspace(-0.2, 0.2, 32), np.zeros((32, 2)), np.ones(32)]))
        seen.update(tables.tables.positions.tobytes())
    tables.close()
    return seen.hexdigest()[:16]


def machine() -> dict[str, Any]:
    """Platform, processor's name or "unknown", cores, load of the last minute or None: "platform", "cpu", "cores", "load"."""
    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text().splitlines() if cpuinfo.exists() else []
    names = [text.split(":", 1)[1].strip() for text in lines if text.startswith("model name")]
    cpu = names[0] if names else platform.processor() or "unknown"
    load = round(os.getloadavg()[0], 2) if hasattr(os, "getloadavg") else None
    where = f"{platform.system()} {platform.machine()}"
    return {"platform": where, "cpu": cpu, "cores": os.cpu_count() or 1, "load": load}
