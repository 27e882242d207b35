"""How many threads are worth starting? As many as there are processors that this process may use."""

import os


def processors() -> int:
    """Processors that this process may use: fewer than the machine has, where a scheduler or a container says so."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
