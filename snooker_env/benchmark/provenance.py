"""Where do figures come from? The commit of the checkout, the machine and its load, and the versions of what was running."""

import os
import platform
import subprocess
from importlib import metadata
from pathlib import Path
from typing import Any

LIBRARIES = {
    "numpy": "numpy", "numba": "numba", "gymnasium": "gymnasium", "torch": "torch", "stable_baselines3": "stable-baselines3",
    "sb3_contrib": "sb3-contrib",
}  # fmt: skip
"""Libraries whose versions a result file holds -> their distributions."""


def commit() -> str | None:
    """The commit of the checkout that the package is in.

    Returns
    -------
    str or None
        The hash, with "-dirty" if files are changed; None without a checkout or without git.

    Examples
    --------
    >>> from snooker_env.benchmark import commit
    >>> found = commit()
    >>> found is None or len(found.removesuffix("-dirty")) == 40
    True
    """
    here = Path(__file__).resolve().parents[2]
    git = ["git", "-C", str(here), "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*"]
    try:
        if not (here / ".git").exists():
            return None
        return subprocess.run(git, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return None


def processor() -> str:
    """The name of the processor, as the operating system reports it.

    Returns
    -------
    str
        The name, or "unknown".

    Examples
    --------
    >>> from snooker_env.benchmark import processor
    >>> len(processor()) > 0
    True
    """
    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text().splitlines() if cpuinfo.exists() else []
    names = [text.split(":", 1)[1].strip() for text in lines if text.startswith("model name")]
    return names[0] if names else platform.processor() or "unknown"


def software() -> dict[str, str | None]:
    """Versions of this package, of Python and of the libraries that decide results; None for one that is not installed.

    Returns
    -------
    dict
        Name -> version.

    Examples
    --------
    >>> from snooker_env.benchmark import software
    >>> "numpy" in software()
    True
    """
    from .. import __version__

    found: dict[str, str | None] = {"snooker_env": __version__, "python": platform.python_version()}
    for name, distribution in LIBRARIES.items():
        try:
            found[name] = metadata.version(distribution)
        except metadata.PackageNotFoundError:
            found[name] = None
    return found


def machine() -> dict[str, Any]:
    """Platform, processor, cores, and the load average of the last minute (None where the system gives none).

    Returns
    -------
    dict
        "platform", "cpu", "cores" and "load".

    Examples
    --------
    >>> from snooker_env.benchmark import machine
    >>> machine()["cores"] >= 1
    True
    """
    return {
        "platform": f"{platform.system()} {platform.machine()}", "cpu": processor(), "cores": os.cpu_count() or 1,
        "load": round(os.getloadavg()[0], 2) if hasattr(os, "getloadavg") else None,
    }  # fmt: skip
