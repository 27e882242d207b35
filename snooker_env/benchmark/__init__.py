"""The benchmark, ``python -m snooker_env.benchmark``: tasks with frozen options, how agents are judged."""

from ..players.program import AgentError
from ..simulation import count_shots
from .agents import Agent
from .checking import faults
from .playing import COLUMNS, play_visits
from .run import judge
from .tasks import HELD_OUT_SEED, TASKS, Task

__all__ = [
    "COLUMNS",
    "HELD_OUT_SEED",
    "TASKS",
    "Agent",
    "AgentError",
    "Task",
    "count_shots",
    "faults",
    "judge",
    "play_visits",
]
