"""How does an environment show itself? One picture for "rgb_array", text for "ansi", a window with the moving shot for "human"."""

from typing import Any, TypeAlias

import gymnasium
import numpy as np
from numpy.typing import NDArray

from .._types import Bools, Floats
from ..physics.table import Table
from ..simulation import Shot

MODES = ("human", "rgb_array", "ansi")
FPS = 30


Picture: TypeAlias = NDArray[np.uint8] | str | None
"""uint8 (H, W, 3) with "rgb_array", str with "ansi", else None."""


class Pictures:
    """The pictures of one environment on a ``Table``; a window belongs to one process and is left behind in a copy."""

    table: Table
    mode: str | None

    def __init__(self, table: Table, mode: str | None):
        self.table, self.mode = table, mode
        self._window = None

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_window": None}

    def render(self, positions: Floats, on_table: Bools, shot: Shot | None, text: str) -> Picture:
        """The table with the cue ball's last path: uint8 (H, W, 3) for "rgb_array", str for "ansi", None otherwise."""
        if self.mode is None:
            gymnasium.logger.warn('render() without render_mode; make the environment with render_mode="rgb_array", "ansi" or "human"')
        if self.mode == "rgb_array":
            from ..render.pygame_view import rgb_array

            return rgb_array(self._scene(positions, on_table, shot, text))
        if self.mode == "ansi":
            from ..render.ascii_view import ansi

            return ansi(self._scene(positions, on_table, shot, text))
        return None

    def show(self, positions: Floats, on_table: Bools, shot: Shot | None, text: str, *, film: bool) -> None:
        """Show the table in the window; ``film``: first the shot that led there, at twice its speed."""
        from ..render.pygame_view import Window
        from ..render.scene import shot_scenes

        if self._window is None:
            self._window = Window()
        if film and shot is not None:
            self._window.play(shot_scenes(self.table, shot, fps=FPS, speed=2.0, text=text), FPS)
        self._window.draw(self._scene(positions, on_table, shot, text))

    def close(self) -> None:
        """Close the window, if there is one."""
        if self._window is not None:
            self._window.close()
            self._window = None

    def _scene(self, positions, on_table, shot, text):
        from ..render.scene import ball_paths, scene

        # the paths of the cue ball and of what it potted
        paths = None if shot is None else ball_paths(shot, (0, *(np.flatnonzero(shot.potted[1:] >= 0) + 1).tolist()))
        return scene(self.table, positions, on_table, paths=paths, text=text)
