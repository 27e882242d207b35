"""How do recorders get films of strokes? They request one picture a step, and receive all pictures of the
motion, one by one.

``gymnasium.wrappers.RecordVideo``, ``gymnasium.wrappers.vector.RecordVideo`` and Stable-Baselines3's
``VecVideoRecorder`` call ``render()`` once after each step, in a method named ``_capture_frame``, and append
the result to their film. A step here is a whole shot, so a visit would become a film of a fifth of a second,
and none of the recorders accepts a list of pictures. So when ``render()`` is called by such a method, it
calls that method back once for each picture of the motion. The recorder's own call then returns the last
picture.

Several tables of ``SyncVectorEnv`` or ``DummyVecEnv`` are filmed one after the other; those of
``SnookerVectorEnv`` together.
"""

import sys
from collections.abc import Callable, Iterator
from typing import Any

_CAPTURE = "_capture_frame"


def recorder_asking() -> Any:
    """The recorder that is requesting a picture; None if there is none, or if it is receiving a film
    already."""
    found, frame = [], sys._getframe(1)
    while frame is not None:
        if frame.f_code.co_name == _CAPTURE and hasattr(frame.f_locals.get("self"), "recorded_frames"):
            found.append(frame.f_locals["self"])
        frame = frame.f_back
    return found[0] if len(found) == 1 else None


class PictureSource:
    """The pictures of one environment: the current one or, for a recorder, first those of the motion."""

    def __init__(self) -> None:
        self._current: Any = None

    def picture(self, motion: Callable[[], Iterator[Any]], still: Callable[[], Any]) -> Any:
        """The result of ``render()``; ``motion()`` yields the pictures of the last strokes, ``still()``
        returns the current one."""
        if self._current is not None:
            return self._current
        recorder = recorder_asking()
        if recorder is not None:
            try:
                for self._current in motion():
                    recorder._capture_frame()
            finally:
                self._current = None
        return still()
