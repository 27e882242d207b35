"""The benchmark, ``python -m snooker_env.benchmark``: tasks with frozen options, how agents are judged."""

from ..players.program import AgentError
from ..simulation import count_shots
from .agents import Agent
from .checking import faults
from .playing import COLUMNS
from .results import read_result, write_result
from .rollouts import CENTURY, FIGURES, MAXIMUM, PlayedStrokes, play_visits, summary
from .run import judge
from .tasks import HELD_OUT_SEED, TASKS, Task

__all__ = [
    "CENTURY",
    "COLUMNS",
    "FIGURES",
    "HELD_OUT_SEED",
    "MAXIMUM",
    "TASKS",
    "Agent",
    "AgentError",
    "PlayedStrokes",
    "Task",
    "count_shots",
    "faults",
    "judge",
    "play_visits",
    "read_result",
    "summary",
    "write_result",
]
