"""How does an environment show itself? As a picture, as text, or in a window with the moving shot."""

from typing import Any, TypeAlias

import gymnasium
import numpy as np

from .._lib.check import choice
from .._lib.types import Bytes
from ..physics.table import Table
from ..render.table_picture import SIZE as SIZE
from ..render.table_picture import check_size
from ..tasks.played import Played
from ..tasks.tables import Tables

MODES = ("human", "rgb_array", "ansi")
FPS = 30  # of the window's motion

Picture: TypeAlias = Bytes | str | None  # uint8 (H, W, 3) with "rgb_array", str with "ansi", else None


class Pictures:
    """The pictures of one environment, ``size`` [pixels], ``players`` on the bar; a copy has no window."""

    def __init__(
        self, table: Table, mode: str | None, size: Any, players: tuple[str, ...] = (), modes: Any = MODES
    ):
        self.table, self.mode = table, None if mode is None else choice("render_mode", mode, modes)
        self.players: tuple[str, ...] = players
        self.size: tuple[int, int] = check_size(size, "render_size")
        self._window = None

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_window": None}

    def render(self, tables: Tables, k: int, history: list[Played]) -> Picture:
        """Table k with the paths of the last stroke of its ``history``."""
        if self.mode is None:
            how = 'make the environment with render_mode="rgb_array", "ansi" or "human"'
            gymnasium.logger.warn(f"render() without render_mode; {how}")
        if self.mode == "rgb_array":
            from ..render.pygame_view import rgb_array

            return rgb_array(self._scene(tables, k, history), size=self.size)
        if self.mode == "ansi":
            from ..render.ascii_view import ansi

            return ansi(self._scene(tables, k, history))
        return None

    def require_display(self) -> None:
        """RuntimeError if a stroke needs a window and there is no display; a reset needs none."""
        if self.mode == "human":
            from ..render.window import require_display

            require_display()

    def show(self, tables: Tables, history: list[Played], *, played: bool = False) -> None:
        """In a window show the table; with ``played``, first the last stroke in motion."""
        if self.mode != "human":
            return
        from ..render.window import Window, display_missing

        if self._window is None:
            if display_missing():
                return
            self._window = Window(size=None if self.size == SIZE else self.size)
        if played:
            from ..replays.film import film_stroke
            from ..replays.referee_words import bars

            film, _ = film_stroke(self.table, history[-1], *bars(history, self.players)[-1])
            self._window.play(film, FPS)
        self._window.draw(self._scene(tables, 0, history))

    def close(self) -> None:
        """Close the window, if there is one."""
        if self._window is not None:
            self._window.close()
            self._window = None

    def _scene(self, tables, k, history):
        from ..render.scene import UNTURNED, Film, scene
        from ..replays.referee_words import bars, standing_bar

        over: dict[str, Any] = {"turn": UNTURNED}  # spots as in films
        last = None
        if history and np.array_equal(history[-1].positions, tables.positions[k]):  # it led to this table
            shot = history[-1].shot
            end, last = Film(self.table, shot).at(shot.duration), bars(history, self.players)[-1][1]
            over |= {"paths": end.paths, "ghosts": end.ghosts}
            if shot.on_table[0] and np.array_equal(shot.positions[0], tables.positions[k][0]):
                over["turn"] = end.turn  # as the film of the stroke left it
        over |= {"text": tables.text(k), "bar": standing_bar(tables, k, self.players, last)}
        return scene(self.table, tables.positions[k], tables.on_table[k], **over)
