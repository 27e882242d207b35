"""Which ids does Gymnasium know? Read by the package, or alone by ``_autoregister.py``; imports nothing."""

from typing import Any

ID = "Snooker-v0"
ENTRY_POINT = "snooker_env.envs.snooker:SnookerEnv"
VECTOR_ENTRY_POINT = "snooker_env.envs.vector:SnookerVectorEnv"

_TASKS = "snooker_env.benchmark.environments"
ENTRY_POINTS = {
    ID: (ENTRY_POINT, VECTOR_ENTRY_POINT),
    "SnookerBreak-v0": (f"{_TASKS}:BreakEnv", f"{_TASKS}:BreakVectorEnv"),
    "SnookerBreakClub-v0": (f"{_TASKS}:BreakClubEnv", f"{_TASKS}:BreakClubVectorEnv"),
    "SnookerLineUp-v0": (f"{_TASKS}:LineUpEnv", f"{_TASKS}:LineUpVectorEnv"),
    "SnookerColours-v0": (f"{_TASKS}:ColoursEnv", f"{_TASKS}:ColoursVectorEnv"),
    "SnookerPotHard-v0": (f"{_TASKS}:PotHardEnv", f"{_TASKS}:PotHardVectorEnv"),
    "SnookerEscape-v0": (f"{_TASKS}:EscapeEnv", f"{_TASKS}:EscapeVectorEnv"),
    "SnookerFrame-v0": (f"{_TASKS}:FrameEnv", f"{_TASKS}:FrameVectorEnv"),
}
"""Of each id the environment of one table, and that of many."""


def register(registration: Any) -> None:
    """Register with Gymnasium's module the ids that it lacks; string entry points keep it light."""
    for name, (one, many) in ENTRY_POINTS.items():
        if name not in registration.registry:
            registration.register(id=name, entry_point=one, vector_entry_point=many)
