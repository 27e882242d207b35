"""Which environments do ``gymnasium.make`` and ``make_vec`` make for a task? ``Snooker-v0``, options frozen."""

from typing import Any, ClassVar

from ..envs.snooker import SnookerEnv
from ..envs.vector import SnookerVectorEnv
from .tasks import FREE, TASKS

KEYWORDS = ("max_episode_steps", "render_mode", "autoreset_mode", "threads", "render_size")  # not of the game


class TaskEnv(SnookerEnv):
    """One table: keywords of ``SnookerEnv`` and free options; ValueError for a frozen one."""

    TASK: ClassVar[str]

    def __init__(self, **keywords: Any):
        more = {name: keywords.pop(name) for name in ("render_mode", "render_size") if name in keywords}
        super().__init__(TASKS[self.TASK].options(**keywords), **more)


class TaskVectorEnv(SnookerVectorEnv):
    """Many tables: keywords of ``SnookerVectorEnv`` and free options, as ``TaskEnv``."""

    TASK: ClassVar[str]

    def __init__(self, num_envs: int = 1, **keywords: Any):
        more = {name: keywords.pop(name) for name in KEYWORDS if name in keywords}
        super().__init__(num_envs, TASKS[self.TASK].options(**keywords), **more)


def _classes(name: str) -> tuple[type[TaskEnv], type[TaskVectorEnv]]:
    task = TASKS[f"Snooker{name}-v0"]
    about = f"``{task.id}``: {task.title}. Free: {', '.join(FREE)}."
    what = {"TASK": task.id, "__module__": __name__, "__doc__": about}
    return type(f"{name}Env", (TaskEnv,), what), type(f"{name}VectorEnv", (TaskVectorEnv,), what)


BreakEnv, BreakVectorEnv = _classes("Break")
BreakClubEnv, BreakClubVectorEnv = _classes("BreakClub")
EscapeEnv, EscapeVectorEnv = _classes("Escape")
SafetyEnv, SafetyVectorEnv = _classes("Safety")
FrameEnv, FrameVectorEnv = _classes("Frame")
