"""How many shots has this process simulated? One counter, which ``snooker_env.benchmark`` reads before and
after a decision.

A shot is counted where the engine is started for it: strokes of environments and of ``Planner`` in
``tasks.stroke.run``, those of ``simulate`` and ``simulate_batch`` in ``simulation``. A shot that is simulated
again because its log was too short counts once. Single impacts (``collide_balls``, the computed aim of a pot)
are not counted.
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
