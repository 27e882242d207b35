"""Does a policy that looks at nothing win a task? Those of ``players.degenerate`` play, beside players that look."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..players.degenerate import MODULE, SILLY, Constant
from ..tasks.discrete_actions import SIZE, STROKES
from .agents import Agent
from .playing import COLUMNS, play_episodes
from .results import read_result
from .run import judge
from .tasks import TASKS, Task

ABOVE = ("planner", "search", "stroke_value", "tactician")
"""Who must stand above every degenerate policy, on every task."""
FIRST_ROUND, FINALISTS = 8, 3
"""Of the search for a constant: episodes of each choice in the first round, and how many are never left out."""
_SCORE = COLUMNS.index("score")


def best_constant(task: Task, threads: int | None = None) -> int:
    """Find the choice with the best mean on training tables: after each round the best third plays twice as many episodes.
    In frames, whose opponents take long to decide, only choices at the widest pot (or the first line without one) are tried."""
    training = replace(task, judged_layout=task.changes["layout"])
    lines = 1 if task.frame else SIZE // STROKES
    left, first, episodes = list(range(lines * STROKES)), 0, FIRST_ROUND
    while True:
        seeds, scores = list(range(first, first + episodes)), []
        for choice in left:
            played = play_episodes(training, Constant(choice), seeds, 0, threads, lucky=False)
            scores.append(np.mean([row[_SCORE] for row in played.rows]))
        order = np.argsort(-np.array(scores), kind="stable")
        if len(left) == FINALISTS:
            return left[order[0]]
        left = [left[k] for k in order[: max(FINALISTS, len(left) // 3)]]
        first, episodes = first + episodes, 2 * episodes


def results(task: Task, folder: Path, threads: int | None = None) -> Iterator[dict[str, Any]]:
    """Yield the results of a task: those of all degenerate policies, kept in the folder as ``TASK.NAME.json``, then those of
    ``random`` and ``ABOVE``. Results in the folder are not played again."""
    # no constant wins a frame: there it is that of visits
    like = TASKS["SnookerBreak-v0"] if task.score == "won" else task
    file = folder / f"{like.id}.constant.json"
    if file.exists():
        (found,) = read_result(file)["agent"]["sources"]
    else:
        found = f"{MODULE}constant_{best_constant(like, threads)}"
    for label, source in {"constant": found, **{name: MODULE + name for name in SILLY}}.items():
        if task.frame or label != "play_again":  # in a visit nobody has that choice
            agent, out = Agent.of(source, label=label), folder / f"{task.id}.{label}.json"
            words = f"python -m snooker_env.benchmark degenerate {task.id} --out {folder}"
            yield judge(task, agent, out=out, resume=True, threads=threads, command=words)
    for name in ("random", *ABOVE):
        file = folder / f"{task.id}.{name}.json"
        yield read_result(file) if file.exists() else judge(task, Agent.of(name), threads=threads)


def winners(some: list[dict[str, Any]]) -> list[str]:
    """List which degenerate policies, ``random`` among them, score above which player in the results of one task."""
    means = {one["agent"]["label"]: one["figures"]["score"]["value"] for one in some}
    wins = [(one, other) for one in means if one not in ABOVE for other in ABOVE if means[one] > means[other]]
    task = some[0]["task"]
    return [
        f"{task}: {one} ({means[one]:.4g}) stands above {other} ({means[other]:.4g})" for one, other in wins
    ]
