"""The benchmark, ``python -m snooker_env.benchmark``: tasks with frozen options, how agents are judged."""

from .._shots import simulated
from ..play.program import AgentError, ProgramPlayer
from .agents import Agent
from .checking import faults
from .leaderboard import page
from .playing import COLUMNS
from .provenance import commit as commit
from .provenance import machine as machine
from .provenance import processor as processor
from .provenance import software as software
from .results import read_result, write_result
from .rollouts import CENTURY, FIGURES, MAXIMUM, Strokes, play_visits, summary
from .rollouts import counts as counts
from .run import judge
from .schema import faults_of_fields as faults_of_fields
from .statistics import RESAMPLES as RESAMPLES
from .statistics import Resamples as Resamples
from .statistics import figure as figure
from .statistics import interval, iqm
from .statistics import unseen as unseen
from .tasks import HELD_OUT_SEED, TASKS, Task
from .tasks import most_points as most_points
from .tasks import tables_of as tables_of
from .tasks import task_of as task_of

__all__ = [
    "CENTURY",
    "COLUMNS",
    "FIGURES",
    "HELD_OUT_SEED",
    "MAXIMUM",
    "TASKS",
    "Agent",
    "AgentError",
    "ProgramPlayer",
    "Strokes",
    "Task",
    "faults",
    "interval",
    "iqm",
    "judge",
    "page",
    "play_visits",
    "read_result",
    "simulated",
    "summary",
    "write_result",
]
