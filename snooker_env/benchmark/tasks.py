"""What are the tasks? Ids with a version, the options that they freeze, and how an agent is judged on each.
Only how an agent sees and acts stays free. docs/benchmark.md holds the rules."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import lru_cache
from types import MappingProxyType
from typing import Any

import numpy as np

from .._lib.check import choice, integer, refuse, refuse_what
from ..game.layouts import HELD_OUT, plan_of
from ..game.layouts import layout as deal
from ..tasks.options import Options

HELD_OUT_SEED = 1_000_000
"""Seed of the first judged table. A million seeds from it on are for judging alone, not for training."""
FREE = ("action", "aim", "observation", "elevation", "placement", "speeds", "says")
"""Options that an agent may choose in every task: its observation, and how its actions are read."""


@dataclass(frozen=True, kw_only=True)
class Task:
    """One task of the benchmark.

    Attributes
    ----------
    id, title : str
        The Gymnasium id with its version; the aim of the task in a few words.
    changes, judged_layout : mapping, str
        Options that differ from the defaults of ``Snooker-v0``; the layout on which agents are judged.
    observation : str
        The default observation.
    score, measure : str
        What an episode scores: "points", "legal", "lead" or "won"; the name of the mean score.
    episodes, thresholds : int, tuple of int
        Episodes that an official result has for each training seed; scores for which a result gives the share of
        episodes that reach them.

    Examples
    --------
    >>> from snooker_env.benchmark import TASKS
    >>> task = TASKS["SnookerBreak-v0"]
    >>> task.score, task.episodes, task.judged_layout
    ('points', 500, 'held_out')
    """

    id: str
    title: str
    changes: Mapping[str, Any]
    judged_layout: str
    score: str
    measure: str
    episodes: int
    thresholds: tuple[int, ...] = (1,)
    observation: str = "pots"

    def options(self, **free: object) -> Options:
        """Return the options for training: the frozen ones, and any of ``FREE``. Others raise an error that names them."""
        frees = ", ".join(FREE)
        for name in (name for name in free if name not in FREE):
            if name == "options":
                why = f"{self.id} makes its own; give the free options themselves ({frees})"
                raise refuse_what("options", f"a {type(free[name]).__name__}", f"must be left out: {why}")
            if name not in _USUAL:
                what = f"got an unexpected keyword argument {name!r}"
                raise TypeError(f"{what}; the free options of {self.id} are {frees}")
            why = f"{self.id} freezes it at {self.frozen_options[name]!r}; only Snooker-v0 lets you choose it"
            raise refuse(name, free[name], f"must be left out: {why}")
        return Options(**{**self.changes, **_FORM, "observation": self.observation, **free})

    def judged_options(self, **free: object) -> Options:
        """Return the options for judging: ``options(**free)`` on the judged layout."""
        return self.options(**free).but(layout=self.judged_layout)

    @property
    def frozen_options(self) -> dict[str, Any]:
        """Every option that the task freezes, with its value."""
        return {name: self.changes.get(name, value) for name, value in _USUAL.items() if name not in FREE}

    @property
    def counts(self) -> bool:
        """Whether the score of an episode is a number of points; else it is 0 or 1, the mean a share."""
        return self.score in ("points", "lead")

    @property
    def frame(self) -> bool:
        """Whether an episode is a frame, or a stroke and a visit of one."""
        return self.changes.get("task") == "frame"

    def seeds(self, n: int) -> list[int]:
        """Return the seeds of the first n judged tables; in whole frames, those of the errors. ValueError if n is too large."""
        integer("episodes", n, 1, 2**20)
        first, alike = HELD_OUT_SEED, plan_of(self.judged_layout).in_hand
        return list(range(first, first + n) if alike else tables_of(self.judged_layout, n))


_FORM = {"action": "box", "aim": "pot"}
"""How an agent acts unless it chooses otherwise: with ``observation`` all of the form, whatever ``Snooker-v0`` has."""
_USUAL = {f.name: f.default for f in fields(Options) if f.init}
_BREAK = (1, 10, 25, 50, 75, 100, 147)
_LEAD = (-60, -40, -20, -10, -4, 0, 1)
_MEASURES = {"points": ("points a visit", 500)}
_MEASURES |= {"legal": ("share of escapes", 500), "won": ("share of frames won", 200)}
_MEASURES |= {"lead": ("points of lead gained", 500)}  # of each score: the name of its mean, its episodes


def _task(name: str, title: str, layout: str, score: str, judged: str = "", **more: Any) -> Task:
    """A task with a real cue and a professional's errors, judged on its own layout, unless it is said otherwise."""
    usual = {"layout": layout, "noise": "professional", "cue": "real"}
    changes = MappingProxyType(usual | more.pop("changes", {}))
    measure, episodes = _MEASURES[score]
    more |= {"judged_layout": judged or layout, "measure": measure, "episodes": episodes, "changes": changes}
    return Task(id=f"Snooker{name}-v0", title=title, score=score, **more)


_BALLS: dict[str, Any] = {"observation": "flat"}  # where there may be no pots to see
_LEGAL: dict[str, Any] = _BALLS | {"changes": {"reward": "legal", "one_stroke": True}}
_FRAME = {"task": "frame", "opponent": "planner", "miss": "clear_path"}
_CLUB = {"changes": {"noise": "club"}, "thresholds": _BREAK}
_SAFE: dict[str, Any] = _BALLS | {"changes": _FRAME | {"one_stroke": True}, "thresholds": _LEAD}
_FOUR = "best_pot,search,planner,tactician"  # one of them sits opposite in each frame
_WIN: dict[str, Any] = _BALLS | {"changes": _FRAME | {"opponent": _FOUR, "reward": "win"}}
_ALL = (
    _task("Break", "build a break on an opened table", "opened", "points", "held_out", thresholds=_BREAK),
    _task("BreakClub", "the same with a club player's errors", "opened", "points", "held_out", **_CLUB),
    _task("Escape", "one stroke out of a snooker, no foul", "escape", "legal", "held_out_escape", **_LEGAL),
    _task("Safety", "one fair stroke where no pot is on", "safety", "lead", "held_out_safety", **_SAFE),
    _task("Frame", "win a frame against one of four", "break_off", "won", **_WIN),
)
TASKS: dict[str, Task] = {task.id: task for task in _ALL}
"""The tasks of the benchmark by id."""


def task_of(name: object) -> Task:
    return TASKS[choice("task", name, tuple(TASKS))]


@lru_cache(maxsize=32)
def tables_of(layout: str, n: int) -> tuple[int, ...]:
    """Seeds of n tables for judging, from ``HELD_OUT_SEED``: no two are alike, mirrored or not."""
    plan, seeds, known = plan_of(layout), [], set()
    for seed in range(HELD_OUT_SEED, HELD_OUT_SEED + n + 20 * min(n, HELD_OUT)):  # brings all of a bank
        positions, _ = deal(plan, np.random.default_rng(seed))
        table = np.sort(np.abs(positions[:, 0])).round(9).tobytes()
        if table not in known:
            known.add(table)
            seeds.append(seed)
            if len(seeds) == n:
                return tuple(seeds)
    raise refuse("visits", n, f"must be at most {len(seeds)} on layout {layout!r}: it has no more tables")
