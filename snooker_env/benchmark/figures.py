"""Which figures follow from the rows alone? The same label draws the same bootstrap samples: ``check`` compares."""

import zlib
from typing import Any

import numpy as np

from .._types import Floats
from .playing import COLUMNS
from .statistics import RESAMPLES, Resamples, figure, iqm, unseen
from .tasks import Task


def matrix(rows: list[list[int]]) -> dict[str, Floats] | None:
    """The columns, (runs, episodes); None unless every run has played the same tables in order."""
    table = np.array(rows, np.float64).reshape(-1, len(COLUMNS))
    runs = [table[table[:, 0] == run] for run in np.unique(table[:, 0])]
    if not runs or any(not np.array_equal(one[:, 1], runs[0][:, 1]) for one in runs):
        return None
    return dict(zip(COLUMNS, np.moveaxis(np.stack(runs), 2, 0), strict=True))


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
        "score", "iqm" (for points only), "profile" (a list of {"at_least", and a figure}), "by_run", "best",
        "points", "pots", "strokes", "fouls" and "cleared". A figure is {"value", "low", "high", "exact"}.
        None if the runs are not complete.

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
    score, counted = columns["score"], task.counts
    samples = Resamples(len(score), score.shape[1], RESAMPLES, zlib.crc32(label.encode()))
    count = samples.sums(np.ones(score.shape))

    def mean(values: Floats, *, share: bool = False) -> dict[str, Any]:
        """The figure of a mean; of a share with its exact bound where it was never or always seen."""
        return _figure(float(values.mean()), samples.sums(values) / count, score.shape[1] if share else 0)

    profile = [t for t in task.thresholds if t <= task.most]
    return {
        "score": mean(score, share=not counted),
        "iqm": _figure(iqm(score), samples.iqms(score), 0) if counted else None,
        "profile": [{"at_least": t} | mean((score >= t).astype(float), share=True) for t in profile],
        "by_run": score.mean(axis=1).tolist(),
        "best": int(score.max()),
        **{name: mean(columns[name]) for name in ("points", "pots", "strokes")},
        "fouls": mean(columns["fouls"], share=not task.frame),
        "cleared": mean(columns["cleared"], share=True),
    }


def _figure(value: float, samples: Floats, trials: int) -> dict[str, Any]:
    """A figure; of a share never or always seen in so many ``trials`` with the exact one-sided bound."""
    made = figure(value, samples) | {"exact": False}
    if made["low"] is None and trials and value in (0.0, 1.0):
        most = unseen(trials)
        low, high = (0.0, most) if value == 0.0 else (1.0 - most, 1.0)
        made |= {"low": low, "high": high, "exact": True}
    return made
