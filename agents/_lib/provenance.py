"""Where do figures come from? The commit of the checkout, the machine, and the versions that matter."""

from snooker_env.benchmark.provenance import commit, software
from snooker_env.benchmark.provenance import machine as computer

__all__ = ["commit", "line", "machine", "provenance", "software"]


def machine():
    """Platform, processor, cores, load and versions: a dict for JSON files."""
    return computer() | software()


def line(m=None):
    """The same as one line; ``m``: a dict of ``machine`` that was kept, None for this machine."""
    m = m or machine()
    load = "" if m["load"] is None else f", load {m['load']:.1f}"
    return f"{m['cpu']}, {m['cores']} cores{load}, {m['platform']}, Python {m['python']}, numba {m['numba']}"


def provenance():
    """What computed the figures of a report: version, commit, machine in words, and versions."""
    m = machine()
    words = f"{m['cpu']}, {m['cores']} cores, {m['platform']}"
    return {
        "version": m["snooker_env"],
        "commit": commit() or "unknown",
        "machine": words,
        "python": m["python"],
        "numpy": m["numpy"],
    }
