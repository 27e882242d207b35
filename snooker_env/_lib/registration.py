"""What is loaded by its name at the first use? The environments that Gymnasium knows by id."""

from types import ModuleType
from typing import Any

_TASKS = "snooker_env.benchmark.environments"
_NAMES = ("Break", "BreakClub", "Escape", "Safety", "Frame")
FORMS: dict[str, dict[str, Any]] = {  # of Break, for scripts that take an id alone
    "SnookerBreakDiscrete-v0": {"action": "discrete", "observation": "flat"},
    "SnookerBreakMasked-v0": {"action": "discrete", "observation": "masked"},
    "SnookerBreakTarget-v0": {"aim": "target", "observation": "flat"},
}
ENTRY_POINTS = {  # of each id the environment of one table, and that of many
    "Snooker-v0": ("snooker_env.envs.snooker:SnookerEnv", "snooker_env.envs.vector:SnookerVectorEnv"),
    **{f"Snooker{name}-v0": (f"{_TASKS}:{name}Env", f"{_TASKS}:{name}VectorEnv") for name in _NAMES},
    **dict.fromkeys(FORMS, (f"{_TASKS}:BreakEnv", f"{_TASKS}:BreakVectorEnv")),
}


def register(registration: ModuleType) -> None:
    """Register with Gymnasium's module the ids that it lacks; string entry points keep it light."""
    for name, (one, many) in ENTRY_POINTS.items():
        if name not in registration.registry:
            kwargs = dict(FORMS.get(name, {}))
            registration.register(id=name, entry_point=one, vector_entry_point=many, kwargs=kwargs)
