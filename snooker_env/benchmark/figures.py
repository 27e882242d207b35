"""Which figures follow from the rows of a result? Mean score, inter-quartile mean and performance profile, each with its interval.

Everything is computed again from the rows alone, with the same bootstrap samples for the same label: ``check`` compares.
"""

import zlib
from typing import Any

import numpy as np

from .._types import Floats
from .playing import COLUMNS
from .statistics import RESAMPLES, Resamples, interval, iqm, unseen
from .tasks import Task


def matrix(rows: list[list[int]]) -> dict[str, Floats] | None:
    """The columns of the rows as arrays (runs, episodes); None unless every run has played the same tables in the same order.

    Parameters
    ----------
    rows : list of list of int

    Returns
    -------
    dict of float (runs, episodes), or None
    """
    table = np.array(rows, np.float64).reshape(-1, len(COLUMNS))
    runs = [table[table[:, 0] == run] for run in sorted(set(table[:, 0].tolist()))]
    if not runs or any(len(one) != len(runs[0]) or not np.array_equal(one[:, 1], runs[0][:, 1]) for one in runs):
        return None
    return {name: np.stack([one[:, c] for one in runs]) for c, name in enumerate(COLUMNS)}


def figures_of(task: Task, label: str, rows: list[list[int]]) -> dict[str, Any] | None:
    """All figures of an agent's rows.

    Parameters
    ----------
    task : Task
        The task.
    label : str
        Label of the agent; the bootstrap samples of its runs depend on it.
    rows : list of list of int
        One row for each episode, columns ``COLUMNS``.

    Returns
    -------
    dict or None
        "score", "iqm" (for points only), "profile" (a list of {"at_least", and a figure}), "by_run", "best", "points", "pots", "strokes",
        "fouls" and "cleared". A figure is {"value", "low", "high", "exact"}. None if the runs are not complete.

    Examples
    --------
    >>> from snooker_env.benchmark import TASKS, figures_of
    >>> rows = [[0, 1000000, 1, 1, 1, 1, 0, 1, 0, 1], [0, 1000001, 0, 1, 0, 0, 0, 0, 0, 1]]
    >>> figures_of(TASKS["SnookerPotHard-v0"], "mine", rows)["score"]["value"]
    0.5
    """
    columns = matrix(rows)
    if columns is None:
        return None
    runs, episodes = columns["score"].shape
    samples = Resamples(runs, episodes, RESAMPLES, zlib.crc32(label.encode()))
    count = samples.sums(np.ones((runs, episodes)))

    def mean(values, *, share=False):
        return _figure(float(values.mean()), samples.sums(values) / count, episodes if share else 0)

    score, counted = columns["score"], task.counts
    middle = _figure(iqm(score), samples.iqms(score), 0) if counted else None
    profile = [{"at_least": t} | mean((score >= t).astype(float), share=True) for t in task.thresholds if t <= task.most]
    return {
        "score": mean(score, share=not counted), "iqm": middle, "profile": profile, "by_run": score.mean(axis=1).tolist(),
        "best": int(score.max()), "points": mean(columns["points"]), "pots": mean(columns["pots"]), "strokes": mean(columns["strokes"]),
        "fouls": mean(columns["fouls"], share=not task.frame), "cleared": mean(columns["cleared"], share=True),
    }  # fmt: skip


def _figure(value, samples, trials):
    """A figure with its 95 % interval; of a share that was never or always seen the exact one-sided bound of so many ``trials``."""
    low, high = interval(samples)
    if np.isfinite(low):
        return {"value": value, "low": low, "high": high, "exact": False}
    if trials and value in (0.0, 1.0):
        most = unseen(trials)
        return {"value": value, "low": 0.0 if value == 0.0 else 1.0 - most, "high": most if value == 0.0 else 1.0, "exact": True}
    return {"value": value, "low": None, "high": None, "exact": False}
