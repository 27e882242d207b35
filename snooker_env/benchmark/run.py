"""How is an agent judged? Batch after batch of episodes; what was played is kept, whatever stops it."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from .._lib.check import refuse
from ..players.program import AgentError
from .agents import Agent, seat
from .checking import faults
from .playing import BATCH, PlayedEpisodes, play_episodes
from .provenance import machine
from .results import read_result, result_of, strokes_of, write_result
from .tasks import Task

ONE_TABLE = 20  # decisions at least that are timed on one table alone
SAVED = 60.0  # seconds between two files while it plays


def judge(
    task: Task,
    agent: Agent,
    *,
    episodes: int | None = None,
    out: str | Path | None = None,
    resume: bool = False,
    command: str = "",
    threads: int | None = None,
    tick: Callable[[int, int], None] = lambda played, total: None,
) -> dict[str, Any]:
    """Play the episodes of a task and compute the result.

    Parameters
    ----------
    task, agent : Task, Agent
        The task, and the agent that plays it.
    episodes : int, optional
        Number of episodes for each training seed; None: the number of the protocol.
    out, resume : str or Path, bool
        File for the result, written once a minute and at the end, or None; whether to continue an incomplete
        result in that file. A complete result is left as it is.
    command : str
        The command line, which is stored in the result.
    threads : int, optional
        As in ``SnookerVectorEnv``.
    tick : callable, optional
        Called at the start and after each batch as ``tick(episodes played, episodes in all)``.

    Returns
    -------
    dict
        The result. After Ctrl-C or the failure of a program it holds the complete batches, and "incomplete"
        says why. ValueError if the agent cannot play the task, or ``out`` holds the result of another run. Errors of
        a player's own code are passed on (``SystemExit`` as RuntimeError); ``out`` then holds the complete batches.

    Examples
    --------
    >>> from snooker_env.benchmark import TASKS, Agent, judge
    >>> result = judge(TASKS["SnookerEscape-v0"], Agent.of("random"), episodes=2)
    >>> len(result["rows"]), result["protocol"]["official"]
    (2, False)
    """
    seeds = task.seeds(task.episodes if episodes is None else episodes)
    many, alone, why = len(seeds), PlayedEpisodes([]), None
    total = many * len(agent.sources)
    kept, played = read_earlier(out if resume else None, task, agent, many)
    if kept is not None and kept["incomplete"] is None:
        return kept
    about, saved = {"command": command, "load": machine()}, time.monotonic()

    def kept_as(why: str | None) -> dict[str, Any]:
        """The result so far, written to its file."""
        result = result_of(task, agent, many, played, alone, about | {"incomplete": why})
        if out is not None and (played.rows or why is None):
            write_result(out, result)
        return result

    def after_batch() -> None:
        nonlocal saved
        tick(len(played.rows), total)
        if time.monotonic() - saved > SAVED:
            kept_as("it was still running")
            saved = time.monotonic()

    tick(len(played.rows), total)
    try:
        for run in range(len(agent.sources)):
            _play_run(task, agent, run, seeds, played, alone, threads, after_batch)
    except KeyboardInterrupt:
        why = f"interrupted after {len(played.rows)} of {total} episodes"
    except AgentError as error:
        why = f"{error} (after {len(played.rows)} of {total} episodes)"
    except (Exception, SystemExit) as error:  # of the agent's own code: what was played is kept
        kept_as(f"{type(error).__name__}: {error} (after {len(played.rows)} of {total} episodes)")
        if isinstance(error, SystemExit):
            raise RuntimeError(f"the agent ended the program: SystemExit({error})") from error
        raise
    return kept_as(why)


def _play_run(task, agent, run, seeds, played, alone, threads, after_batch):
    """Play the episodes of one training seed in batches; the first player is also timed on one table."""
    batch = 1 if agent.program else BATCH
    with seat(agent, task, run) as player:
        while len(played.rows) < (run + 1) * len(seeds):
            first = len(played.rows) - run * len(seeds)
            played.add(play_episodes(task, player, seeds[first : first + batch], run, threads))
            after_batch()
        for seed in seeds if run == 0 else ():
            if alone.decisions < ONE_TABLE:
                alone.add(play_episodes(task, player, [seed], run, threads, lucky=False))


def read_earlier(
    path: str | Path | None, task: Task, agent: Agent, episodes: int
) -> tuple[dict[str, Any] | None, PlayedEpisodes]:
    """Read the file of the same run and what was played for it; None and no episodes if there is no file."""
    if path is None or not Path(path).exists():
        return None, PlayedEpisodes([])
    result = read_result(path)
    if wrong := faults(result, asking=False):  # what a known player says again is for ``check``
        raise refuse("out", str(path), f"must be a sound result to go on with ({wrong[0]})")
    same = result["task"], *(result["agent"][name] for name in ("label", "sources"))
    if (*same, result["protocol"]["episodes"]) != (task.id, agent.label, agent.texts, episodes):
        what = f"{agent.label} on {task.id} with {episodes} episodes"
        raise refuse("out", str(path), f"must be a result of {what} to go on with")
    strokes, timing = strokes_of(result), result["timing"]
    cost = sum(map(len, strokes)), timing["seconds"], timing["simulated_shots"]
    return result, PlayedEpisodes(result["rows"], strokes, *cost, result["agent"]["foresees"])
