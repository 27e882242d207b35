"""How is an agent judged on a task? Batch after batch of the protocol's episodes; what was played is kept, whatever stops it."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from .._check import refuse
from .agents import Agent
from .checking import faults, strokes_of
from .playing import BATCH, PlayedEpisodes, begin, one_table, play_episodes
from .program import AgentError
from .provenance import machine
from .results import read_result, result_of, write_result
from .tasks import Task

ONE_TABLE = 20
"""Decisions that are timed on one table alone."""
SAVED = 60.0
"""Seconds between two files while it plays."""
Tick = Callable[[int, int], None]


def judge(
    task: Task, agent: Agent, *, episodes: int | None = None, out: str | Path | None = None, resume: bool = False, command: str = "",
    threads: int | None = None, tick: Tick | None = None,
) -> dict[str, Any]:  # fmt: skip
    """Play the episodes of a task and compute the result.

    Parameters
    ----------
    task : Task
        The task.
    agent : Agent
        The agent.
    episodes : int, optional
        Number of episodes for each training seed; None: the number of the protocol.
    out : str or Path, optional
        File for the result, also written once a minute; None: no file.
    resume : bool
        Whether to continue an incomplete result in ``out``; a complete one is left as it is.
    command : str
        The command line, which is stored in the result.
    threads : int, optional
        As in ``SnookerVectorEnv``.
    tick : callable, optional
        Called at the start and after each batch as ``tick(episodes played, episodes in all)``.

    Returns
    -------
    dict
        The result. After Ctrl-C, or when a program that plays fails, it holds the complete batches, and "incomplete" has the reason.

    Raises
    ------
    ValueError
        If the agent cannot play the task, or ``out`` holds a result of another run.
    Exception
        What the code of a player raises; ``out`` then holds the complete batches. ``SystemExit`` becomes RuntimeError.

    Examples
    --------
    >>> from snooker_env.benchmark import TASKS, Agent, judge
    >>> found = judge(TASKS["SnookerPotHard-v0"], Agent.of("random"), episodes=2)
    >>> len(found["rows"]), found["protocol"]["official"]
    (2, False)
    """
    episodes = task.episodes if episodes is None else episodes
    seeds = task.seeds(episodes)
    played, why, timed, options = PlayedEpisodes([]), None, None, None
    batch, total = agent.tables_at_once or BATCH, episodes * len(agent.sources)
    parts = [(run, first, min(first + batch, episodes)) for run in range(len(agent.sources)) for first in range(0, episodes, batch)]
    if resume and out is not None and Path(out).exists():
        kept, played = _kept(Path(out), task, agent, episodes, {0, *(run * episodes + end for run, _, end in parts)})
        if kept["incomplete"] is None:
            return kept
        options = kept["agent"]["options"] if kept["rows"] else None
    load, saved = machine(), time.monotonic()
    if tick is not None:
        tick(len(played.rows), total)

    def result(why):
        return result_of(task, agent, episodes, played, command=command, options=options or {}, load=load, one_table=timed, incomplete=why)

    try:
        for run in range(len(agent.sources)):
            player = agent.player(task, run)
            try:
                if options not in (None, dict(player.options)):
                    raise refuse("options", dict(player.options), f"must be those of all training seeds: {options}")
                options = dict(player.options)
                for of, first, end in parts:
                    if of != run or run * episodes + end <= len(played.rows):
                        continue
                    begin(player, first // batch)
                    played.add(play_episodes(task, player, seeds[first:end], run, threads))
                    if tick is not None:
                        tick(len(played.rows), total)
                    if out is not None and time.monotonic() - saved > SAVED:
                        write_result(out, result("it was still running"))
                        saved = time.monotonic()
                if run == 0:
                    begin(player, 0)
                    timed = one_table(task, player, seeds, ONE_TABLE)
            finally:
                if callable(getattr(player, "close", None)):
                    player.close()
    except KeyboardInterrupt:
        why = f"interrupted after {len(played.rows)} of {total} episodes"
    except AgentError as error:
        why = f"{error} (after {len(played.rows)} of {total} episodes)"
    except (Exception, SystemExit) as error:  # of the agent's own code: its traceback is for its author, what was played is kept
        if out is not None and played.rows:
            write_result(out, result(f"{type(error).__name__}: {error} (after {len(played.rows)} of {total} episodes)"))
        if isinstance(error, SystemExit):
            raise RuntimeError(f"the agent ended the program: SystemExit({error})") from error
        raise
    found = result(why)
    if out is not None and (played.rows or why is None):
        write_result(out, found)
    return found


def _kept(path, task, agent, episodes, ends):
    """A file of the same run, and what was played for it."""
    found = read_result(path)
    said = faults(found)
    if said:
        raise refuse("out", str(path), f"must be a sound result to go on with ({said[0]})")
    same = (found["task"], found["agent"]["label"], found["agent"]["sources"], found["protocol"]["episodes"])
    if same != (task.id, agent.label, list(agent.sources), episodes):
        raise refuse("out", str(path), f"must be a result of {agent.label} on {task.id} with {episodes} episodes to go on with")
    if len(found["rows"]) not in ends:
        raise refuse("out", str(path), f"must hold whole batches to go on with, not {len(found['rows'])} episodes")
    strokes = strokes_of(found)
    timing, decisions = found["timing"], sum(map(len, strokes))
    return found, PlayedEpisodes(found["rows"], strokes, decisions, timing["seconds"], timing["simulated_shots"])
