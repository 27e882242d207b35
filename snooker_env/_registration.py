"""Under which name does Gymnasium know the environment? Read by the package, and without it by ``_autoregister.py``; it imports nothing."""

from typing import Any

ID = "Snooker-v0"
ENTRY_POINT = "snooker_env.envs.snooker:SnookerEnv"
VECTOR_ENTRY_POINT = "snooker_env.envs.vector:SnookerVectorEnv"


def register(registration: Any) -> None:
    """Register the id with Gymnasium's module ``registration``, unless it is there already: a second import stays silent.

    String entry points keep the import light and the spec JSON-able.
    """
    if ID not in registration.registry:
        registration.register(id=ID, entry_point=ENTRY_POINT, vector_entry_point=VECTOR_ENTRY_POINT)
