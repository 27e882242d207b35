"""Where do figures come from? From the commit of the checkout, the machine and the versions of software."""

from snooker_env.benchmark.provenance import commit, software
from snooker_env.benchmark.provenance import machine as computer

__all__ = ["commit", "line", "machine", "provenance", "software"]


def machine():
    """Platform, processor, cores, load and versions: a dict for JSON files."""
    return computer() | software()


def line(m=None):
    """The same on one line. ``m`` is a kept dict of ``machine``, or None for this machine."""
    m = m or machine()
    load = "" if m["load"] is None else f", load {m['load']:.1f}"
    return f"{m['cpu']}, {m['cores']} cores{load}, {m['platform']}, Python {m['python']}, numba {m['numba']}"


def provenance():
    """The origin of a report's figures: version, commit, machine in words, and versions."""
    m = machine()
    words = f"{m['cpu']}, {m['cores']} cores, {m['platform']}"
    return {
        "version": m["snooker_env"],
        "commit": commit() or "unknown",
        "machine": words,
        "python": m["python"],
        "numpy": m["numpy"],
    }
