"""How does an environment show itself? One picture for "rgb_array", text for "ansi", a window with the moving shot for "human"."""

from collections.abc import Iterator
from itertools import zip_longest
from typing import Any, TypeAlias

import gymnasium
import numpy as np
from numpy.typing import NDArray

from ..physics.table import Table
from ..simulation import Shot
from ..tasks.played import Played
from ..tasks.tables import Tables
from .films import PictureSource

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
        self._window, self._film = None, PictureSource()

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_window": None, "_film": PictureSource()}

    def render(self, tables: Tables, k: int, shot: Shot | None, recent: list[Played]) -> Picture:
        """Table k with the paths of its last ``shot``: uint8 (H, W, 3) for "rgb_array", str for "ansi", None otherwise.

        A recorder gets the motion of the ``recent`` strokes first, see ``films``.
        """
        if self.mode is None:
            gymnasium.logger.warn('render() without render_mode; make the environment with render_mode="rgb_array", "ansi" or "human"')
        if self.mode == "rgb_array":
            return self._film.picture(lambda: self._motion(recent), lambda: self._still(tables, k, shot))
        if self.mode == "ansi":
            from ..render.ascii_view import ansi

            return ansi(self._scene(tables, k, shot))
        return None

    def render_all(self, tables: Tables, recent: list[list[Played]]) -> tuple[Picture, ...]:
        """``render`` of many tables at once; they move at the same time, and wait for the one that moves longest."""
        shots = [strokes[-1].shot if strokes else None for strokes in recent]
        if self.mode != "rgb_array":
            return tuple(self.render(tables, k, shots[k], []) for k in range(tables.n))

        def still():
            return tuple(self._still(tables, k, shots[k]) for k in range(tables.n))

        def motion():
            last = list(still())
            for pictures in zip_longest(*map(self._motion, recent)):
                last = [new if new is not None else old for new, old in zip(pictures, last, strict=True)]
                yield tuple(last)

        return self._film.picture(motion, still)

    def show(self, tables: Tables, shot: Shot | None, played: Played | None = None) -> None:
        """Show the table in the window; first, at twice its speed, the stroke that was just ``played``."""
        from ..render.pygame_view import Window
        from ..render.scene import shot_scenes

        if self._window is None:
            self._window = Window()
        if played is not None:
            self._window.play(shot_scenes(self.table, played.shot, fps=FPS, speed=2.0, text=tables.text(0)), FPS)
        self._window.draw(self._scene(tables, 0, shot))

    def close(self) -> None:
        """Close the window, if there is one."""
        if self._window is not None:
            self._window.close()
            self._window = None

    def _motion(self, strokes: list[Played]) -> Iterator[NDArray[np.uint8]]:
        from ..render.pygame_view import rgb_array
        from ..render.scene import shot_scenes

        for played in strokes:
            for scene in shot_scenes(self.table, played.shot, fps=FPS):
                yield rgb_array(scene)

    def _still(self, tables, k, shot):
        from ..render.pygame_view import rgb_array

        return rgb_array(self._scene(tables, k, shot))

    def _scene(self, tables, k, shot):
        from ..render.scene import ball_paths, scene

        # the paths of the cue ball and of what it potted
        paths = None if shot is None else ball_paths(shot, (0, *(np.flatnonzero(shot.potted[1:] >= 0) + 1).tolist()))
        return scene(self.table, tables.positions[k], tables.on_table[k], paths=paths, text=tables.text(k))
