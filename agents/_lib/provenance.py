"""Where do figures come from? The command, the commit of the checkout, the seed, the machine, and the versions that matter."""

from typing import Any

from snooker_env.benchmark.provenance import commit, machine, software

__all__ = ["line", "provenance", "software"]


def provenance(command: str, seed: int | list[int] | None) -> dict[str, Any]:
    """What every file of results says of itself; ``seed`` is None where nothing is drawn at random."""
    m = machine()
    return {
        "command": command,
        "commit": commit() or "unknown",
        "seed": seed,
        "machine": f"{m['cpu']}, {m['cores']} cores, {m['platform']}",
        "load": m["load"],
        "software": software(),
    }


def line(made: dict[str, Any]) -> str:
    """Machine, load and versions of what ``provenance`` returned, as one line."""
    load, of = "" if made["load"] is None else f", load {made['load']:.1f}", made["software"]
    return f"{made['machine']}{load}, Python {of['python']}, numba {of['numba']}"
