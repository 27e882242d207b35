"""Which environments play the tasks of the benchmark? One class for each id and one for many tables: ``Snooker-v0`` with frozen options.

They are what ``gymnasium.make("SnookerBreak-v0")`` and ``gymnasium.make_vec("SnookerBreak-v0", vectorization_mode="vector_entry_point")``
make. Everything that is not an option of the game works as in ``SnookerEnv`` and ``SnookerVectorEnv``.
"""

from collections.abc import Sequence
from typing import Any, ClassVar, Literal

from gymnasium.vector import AutoresetMode

from .._types import RenderMode
from ..envs.pictures import SIZE
from ..envs.snooker import SnookerEnv
from ..envs.vector import SnookerVectorEnv
from .tasks import TASKS


class TaskEnv(SnookerEnv):
    """One table of a task.

    Parameters
    ----------
    render_mode : {"human", "rgb_array", "ansi"}, optional
    render_size : (int, int)
        Width and height of pictures [pixels].
    **free
        Options that the task leaves free: ``snooker_env.benchmark.FREE``.

    Raises
    ------
    ValueError, TypeError
        For an option that the task freezes, for an unknown one.
    """

    TASK: ClassVar[str]

    def __init__(self, *, render_mode: RenderMode | None = None, render_size: Sequence[int] = SIZE, **free: Any):
        super().__init__(TASKS[self.TASK].options(**free), render_mode=render_mode, render_size=render_size)


class TaskVectorEnv(SnookerVectorEnv):
    """Many tables of a task.

    Parameters
    ----------
    num_envs, max_episode_steps, render_mode, autoreset_mode, threads, render_size
        As of ``SnookerVectorEnv``.
    **free
        Options that the task leaves free: ``snooker_env.benchmark.FREE``.

    Raises
    ------
    ValueError, TypeError
        For an option that the task freezes, for an unknown one.
    """

    TASK: ClassVar[str]

    def __init__(
        self, num_envs: int = 1, *, max_episode_steps: int | None = None, render_mode: Literal["rgb_array", "ansi"] | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP, threads: int | None = None, render_size: Sequence[int] = SIZE,
        **free: Any,
    ):  # fmt: skip
        super().__init__(
            num_envs, TASKS[self.TASK].options(**free), max_episode_steps=max_episode_steps, render_mode=render_mode,
            autoreset_mode=autoreset_mode, threads=threads, render_size=render_size,
        )  # fmt: skip


class BreakEnv(TaskEnv):
    """``SnookerBreak-v0``: build a break on an opened table, with a professional's errors."""

    TASK: ClassVar[str] = "SnookerBreak-v0"


class BreakVectorEnv(TaskVectorEnv):
    """``SnookerBreak-v0`` on many tables."""

    TASK: ClassVar[str] = "SnookerBreak-v0"


class BreakClubEnv(TaskEnv):
    """``SnookerBreakClub-v0``: build a break on an opened table, with a club player's errors."""

    TASK: ClassVar[str] = "SnookerBreakClub-v0"


class BreakClubVectorEnv(TaskVectorEnv):
    """``SnookerBreakClub-v0`` on many tables."""

    TASK: ClassVar[str] = "SnookerBreakClub-v0"


class LineUpEnv(TaskEnv):
    """``SnookerLineUp-v0``: clear the line-up, with a professional's errors."""

    TASK: ClassVar[str] = "SnookerLineUp-v0"


class LineUpVectorEnv(TaskVectorEnv):
    """``SnookerLineUp-v0`` on many tables."""

    TASK: ClassVar[str] = "SnookerLineUp-v0"


class ColoursEnv(TaskEnv):
    """``SnookerColours-v0``: clear the six colours from their spots, with a professional's errors."""

    TASK: ClassVar[str] = "SnookerColours-v0"


class ColoursVectorEnv(TaskVectorEnv):
    """``SnookerColours-v0`` on many tables."""

    TASK: ClassVar[str] = "SnookerColours-v0"


class PotHardEnv(TaskEnv):
    """``SnookerPotHard-v0``: pot one red from a hard place, with a professional's errors."""

    TASK: ClassVar[str] = "SnookerPotHard-v0"


class PotHardVectorEnv(TaskVectorEnv):
    """``SnookerPotHard-v0`` on many tables."""

    TASK: ClassVar[str] = "SnookerPotHard-v0"


class EscapeEnv(TaskEnv):
    """``SnookerEscape-v0``: one stroke out of a snooker, reward 1 if it is no foul, with a professional's errors."""

    TASK: ClassVar[str] = "SnookerEscape-v0"


class EscapeVectorEnv(TaskVectorEnv):
    """``SnookerEscape-v0`` on many tables."""

    TASK: ClassVar[str] = "SnookerEscape-v0"


class FrameEnv(TaskEnv):
    """``SnookerFrame-v0``: a whole frame against ghost_ball, reward 1 for the frame won and -1 for the frame lost."""

    TASK: ClassVar[str] = "SnookerFrame-v0"


class FrameVectorEnv(TaskVectorEnv):
    """``SnookerFrame-v0`` on many tables."""

    TASK: ClassVar[str] = "SnookerFrame-v0"
