"""Where do figures come from? The commit of the checkout, the machine, and the versions that affect speed."""

import os
import platform

import numba
import numpy as np

from snooker_env.benchmark import commit, processor

__all__ = ["commit", "line", "machine", "processor"]


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


def line(m=None):
    """The same as one line for the head of a table; ``m``: a dict of ``machine`` that was kept, None for this machine."""
    m = m or machine()
    load = "" if m["load"] is None else f", load {m['load']:.1f}"
    return f"{m['cpu']}, {m['cores']} cores{load}, {m['platform']}, Python {m['python']}, numba {m['numba']}"
