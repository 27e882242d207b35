"""Which environments play the tasks of the benchmark? One class for each id and one for many tables:
``Snooker-v0`` with frozen options.

They are what ``gymnasium.make("SnookerBreak-v0")`` and ``gymnasium.make_vec("SnookerBreak-v0",
vectorization_mode="vector_entry_point")`` make. Everything that is not an option of the game works as in
``SnookerEnv`` and ``SnookerVectorEnv``.
"""

from typing import Any, ClassVar

from ..envs.pictures import SIZE
from ..envs.snooker import SnookerEnv
from ..envs.vector import SnookerVectorEnv
from .tasks import FREE, TASKS

OWN = ("max_episode_steps", "render_mode", "autoreset_mode", "threads", "render_size")
"""Keywords of ``SnookerVectorEnv`` that are no options of the game."""


class TaskEnv(SnookerEnv):
    """One table of a task: keywords of ``SnookerEnv``, and the options that the task leaves free.

    ValueError for an option that the task freezes, TypeError for an unknown one.
    """

    TASK: ClassVar[str]

    def __init__(self, *, render_mode: Any = None, render_size: Any = SIZE, **free: Any):
        super().__init__(TASKS[self.TASK].options(**free), render_mode=render_mode, render_size=render_size)


class TaskVectorEnv(SnookerVectorEnv):
    """Many tables of a task: keywords of ``SnookerVectorEnv``, and the options that the task leaves free, as
    ``TaskEnv``."""

    TASK: ClassVar[str]

    def __init__(self, num_envs: int = 1, **keywords: Any):
        own = {name: keywords.pop(name) for name in OWN if name in keywords}
        super().__init__(num_envs, TASKS[self.TASK].options(**keywords), **own)


def _classes(name: str) -> tuple[type[TaskEnv], type[TaskVectorEnv]]:
    """The two classes of a task."""
    task = TASKS[f"Snooker{name}-v0"]
    what = {
        "TASK": task.id,
        "__module__": __name__,
        "__doc__": f"``{task.id}``: {task.title}. Free: {', '.join(FREE)}.",
    }
    return type(f"{name}Env", (TaskEnv,), what), type(f"{name}VectorEnv", (TaskVectorEnv,), what)


BreakEnv, BreakVectorEnv = _classes("Break")
BreakClubEnv, BreakClubVectorEnv = _classes("BreakClub")
LineUpEnv, LineUpVectorEnv = _classes("LineUp")
ColoursEnv, ColoursVectorEnv = _classes("Colours")
PotHardEnv, PotHardVectorEnv = _classes("PotHard")
EscapeEnv, EscapeVectorEnv = _classes("Escape")
FrameEnv, FrameVectorEnv = _classes("Frame")
