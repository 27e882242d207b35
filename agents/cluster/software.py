"""Do all machines hold the same software? Versions of what computes results, and a digest of the source."""

import hashlib
import importlib.metadata
import platform
from functools import cache
from pathlib import Path

from .faults import ClusterError

PACKAGES = ("numpy", "numba", "llvmlite", "gymnasium", "torch", "stable-baselines3", "sb3-contrib")
"""Libraries whose version may change a result."""
ROOT = Path(__file__).parents[2]


@cache
def source():
    """Digest of what computes results: the code of snooker_env, agents and commands, and the models in agents/pretrained."""
    digest = hashlib.sha256()
    for folder in ("snooker_env", "agents", "commands"):
        for file in sorted((ROOT / folder).rglob("*")):
            if file.suffix in (".py", ".npz", ".yml", ".zip"):
                content = file.read_bytes()
                digest.update(f"{file.relative_to(ROOT).as_posix()} {len(content)}\n".encode() + content)
    return digest.hexdigest()[:16]


@cache
def software():
    """Name -> version of everything that has to be the same on all machines; None: not installed.

    Examples
    --------
    >>> from agents.cluster.software import software
    >>> sorted(software())[:3]
    ['gymnasium', 'llvmlite', 'numba']
    """
    found: dict[str, str | None] = {"python": platform.python_version()}
    for name in PACKAGES:
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            found[name] = None
    import snooker_env

    return found | {"snooker_env": snooker_env.__version__, "source of snooker_env": source()}


def difference(wanted, found):
    """What differs between the software of two machines, in words; "" if nothing does.

    Examples
    --------
    >>> from agents.cluster.software import difference
    >>> difference({"numpy": "2.4.6", "torch": "2.13.0"}, {"numpy": "2.3.0", "torch": None})
    'numpy is 2.3.0 there and 2.4.6 here, torch is not installed there and 2.13.0 here'
    """
    said = lambda version: "not installed" if version is None else version  # noqa: E731
    return ", ".join(
        f"{name} is {said(found.get(name))} there and {said(version)} here"
        for name, version in wanted.items() if found.get(name) != version
    )  # fmt: skip


def check(wanted, node):
    """Raise a ``ClusterError`` unless this machine, the ``node``, holds the software ``wanted``."""
    differs = difference(wanted, software())
    if differs:
        raise ClusterError(f"the node {node} holds other software: {differs}. Install the same on every node")
