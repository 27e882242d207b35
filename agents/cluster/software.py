"""Do all machines hold the same software? Versions of what computes results, and a digest of the source."""

import hashlib
from functools import cache
from pathlib import Path

from snooker_env.benchmark import software as versions

ROOT = Path(__file__).parents[2]


@cache
def software():
    """Name -> version of everything that has to be the same on all machines; None: not installed."""
    digest = hashlib.sha256()
    for folder in ("snooker_env", "agents", "commands"):
        for file in sorted((ROOT / folder).rglob("*")):
            if file.suffix in (".py", ".npz", ".yml", ".zip"):
                content = file.read_bytes()
                digest.update(f"{file.relative_to(ROOT).as_posix()} {len(content)}\n".encode() + content)
    return versions() | {"source of snooker_env": digest.hexdigest()[:16]}


def difference(wanted):
    """What this machine holds in another version than ``wanted``, in words; "" if nothing."""
    return ", ".join(
        f"{name} is {software().get(name) or 'not installed'} there and {version or 'not installed'} here"
        for name, version in wanted.items()
        if software().get(name) != version
    )
