"""How do recorders get films of strokes? They ask for one picture a step; they are handed all pictures of the strokes, one by one.

``gymnasium.wrappers.RecordVideo``, ``gymnasium.wrappers.vector.RecordVideo`` and Stable-Baselines3's ``VecVideoRecorder`` call ``render()``
once after each step, in a method named ``_capture_frame``, and append what comes back to their film. A step here is a whole shot, so
that a visit would be a film of a fifth of a second. None of them takes a list of pictures. So when ``render()`` is asked by such a method,
it asks back: the method is called once for each picture of the motion, and gets the last one when it goes on itself.

Several tables of ``SyncVectorEnv`` or ``DummyVecEnv`` are filmed one after the other; those of ``SnookerVectorEnv`` together.
"""

import sys
from collections.abc import Callable, Iterator
from typing import Any

_CAPTURE = "_capture_frame"


def recorder_asking() -> Any:
    """The recorder that asks for a picture at this moment; None if nobody does, or if it is already being handed a film."""
    found, frame = [], sys._getframe(1)
    while frame is not None:
        if frame.f_code.co_name == _CAPTURE and hasattr(frame.f_locals.get("self"), "recorded_frames"):
            found.append(frame.f_locals["self"])
        frame = frame.f_back
    return found[0] if len(found) == 1 else None


class PictureSource:
    """What one environment shows to whoever asks: the picture of now or, to a recorder, first those of the motion."""

    def __init__(self) -> None:
        self._current: Any = None

    def picture(self, motion: Callable[[], Iterator[Any]], still: Callable[[], Any]) -> Any:
        """What ``render()`` returns; ``motion()``: the pictures of what was just played, ``still()``: that of now."""
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
