"""The benchmark, ``python -m snooker_env.benchmark``: tasks with frozen options, how agents are judged."""

from .._shots import simulated
from ..play.program import AgentError, ProgramPlayer
from .agents import Agent
from .checking import afresh, faults, replayed
from .leaderboard import page
from .playing import COLUMNS, PlayedEpisodes, play_episodes
from .provenance import arithmetic, commit, machine, processor, software
from .results import budget_of, figures_of, read_result, write_result
from .rollouts import CENTURY, FIGURES, MAXIMUM, Strokes, counts, play_visits, summary
from .run import judge
from .schema import faults_of_fields
from .statistics import RESAMPLES, Resamples, figure, interval, iqm, unseen
from .tasks import FREE, HELD_OUT_SEED, TASKS, Task, most_points, tables_of, task_of

__all__ = [
    "CENTURY",
    "COLUMNS",
    "FIGURES",
    "FREE",
    "HELD_OUT_SEED",
    "MAXIMUM",
    "RESAMPLES",
    "TASKS",
    "Agent",
    "AgentError",
    "PlayedEpisodes",
    "ProgramPlayer",
    "Resamples",
    "Strokes",
    "Task",
    "afresh",
    "arithmetic",
    "budget_of",
    "commit",
    "counts",
    "faults",
    "faults_of_fields",
    "figure",
    "figures_of",
    "interval",
    "iqm",
    "judge",
    "machine",
    "most_points",
    "page",
    "play_episodes",
    "play_visits",
    "processor",
    "read_result",
    "replayed",
    "simulated",
    "software",
    "summary",
    "tables_of",
    "task_of",
    "unseen",
    "write_result",
]
