"""On what machine were these figures taken? Platform, processor, cores and the versions that decide speed."""

import os
import platform
from pathlib import Path

import numba
import numpy as np


def machine():
    """A dict for the JSON files."""
    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text().splitlines() if cpuinfo.exists() else []
    models = [text.split(":", 1)[1].strip() for text in lines if text.startswith("model name")]
    return {
        "platform": f"{platform.system()} {platform.machine()}",
        "cpu": models[0] if models else platform.processor() or "unknown",
        "cores": os.cpu_count(),
        "load": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
        "python": platform.python_version(),
        "numba": numba.__version__,
        "numpy": np.__version__,
    }


def line():
    """One line for the head of a table."""
    m = machine()
    load = "" if m["load"] is None else f", load {m['load']:.1f}"
    return f"{m['cpu']}, {m['cores']} cores{load}, {m['platform']}, Python {m['python']}, numba {m['numba']}"
