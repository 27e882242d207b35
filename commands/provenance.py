"""Where do figures come from? The commit of the checkout, the machine, and the versions that decide speed."""

import os
import platform
import subprocess
from pathlib import Path

import numba
import numpy as np


def commit():
    """The checkout's commit, with "-dirty" if files are changed; None where there is no git."""
    git = ["git", "-C", str(Path(__file__).resolve().parent), "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*"]
    try:
        return subprocess.run(git, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return None


def processor():
    """The processor's name as the system gives it."""
    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text().splitlines() if cpuinfo.exists() else []
    names = [text.split(":", 1)[1].strip() for text in lines if text.startswith("model name")]
    return names[0] if names else platform.processor() or "unknown"


def machine():
    """Platform, processor, cores, load and versions: a dict for JSON files."""
    return {
        "platform": f"{platform.system()} {platform.machine()}",
        "cpu": processor(),
        "cores": os.cpu_count(),
        "load": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
        "python": platform.python_version(),
        "numba": numba.__version__,
        "numpy": np.__version__,
    }


def line():
    """The same as one line for the head of a table."""
    m = machine()
    load = "" if m["load"] is None else f", load {m['load']:.1f}"
    return f"{m['cpu']}, {m['cores']} cores{load}, {m['platform']}, Python {m['python']}, numba {m['numba']}"
