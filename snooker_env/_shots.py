"""How many shots has this process simulated? One counter, read before and after a decision.

A shot is counted where the engine is started for it (``tasks.stroke.run``, ``simulation``), once if it is
simulated again because its log was too short. Single impacts are not counted.
"""

import threading

_LOCK = threading.Lock()
_SHOTS = 0


def count(shots: int) -> None:
    """Add a number of shots; safe in any thread."""
    global _SHOTS
    with _LOCK:
        _SHOTS += shots


def simulated() -> int:
    """Number of shots that this process has simulated so far."""
    return _SHOTS
