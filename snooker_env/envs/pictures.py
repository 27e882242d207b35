"""How does an environment show itself? As a picture, as text, or in a window with the moving shot."""

import sys
from collections.abc import Callable, Iterator
from itertools import chain, zip_longest
from typing import Any, TypeAlias

import gymnasium
import numpy as np

from .._lib.types import Bytes
from ..physics.table import Table
from ..render.table_picture import SIZE as SIZE
from ..render.table_picture import check_size
from ..tasks.played import Played
from ..tasks.tables import Tables

MODES = ("human", "rgb_array", "ansi")
FPS = 30
HOLD = 15  # pictures of the table after each stroke of a film, with the referee's words


Picture: TypeAlias = Bytes | str | None  # uint8 (H, W, 3) with "rgb_array", str with "ansi", else None


def recorder_asking() -> Any:
    """The recorder that is requesting a picture; None without, or if it is receiving a film already."""
    recorders, frame = [], sys._getframe(1)
    while frame is not None:
        caller = frame.f_locals.get("self") if frame.f_code.co_name == "_capture_frame" else None
        if hasattr(caller, "recorded_frames"):
            recorders.append(caller)
        frame = frame.f_back
    return recorders[0] if len(recorders) == 1 else None


class PictureSource:
    """The pictures of one environment: the current one or, for a recorder, first those of the motion. A recorder calls
    ``render()`` once after each step, in ``_capture_frame``, and accepts no list: so it is called back."""

    def __init__(self) -> None:
        self._current: Any = None

    def picture(self, motion: Callable[[], Iterator[Any]], still: Callable[[], Any]) -> Any:
        """The result of ``render()``: ``still()``; a recorder is first sent the pictures of ``motion()``."""
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


class Pictures:
    """The pictures of one environment, ``size`` [pixels], ``players`` on the bar; a copy has no window."""

    def __init__(self, table: Table, mode: str | None, size: Any = SIZE, players: tuple[str, ...] = ()):
        self.table, self.mode = table, mode
        self.players: tuple[str, ...] = players
        self.size: tuple[int, int] = check_size(size, "render_size")
        self._window, self._source = None, PictureSource()

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_window": None, "_source": PictureSource()}

    def render(
        self, tables: Tables, k: int, history: list[Played], recent: list[tuple[list[Played], int]]
    ) -> Picture:
        """Table k with the paths of the last stroke of its ``history``; ``recent``: of each episode strokes, and how many."""
        if self.mode is None:
            how = 'make the environment with render_mode="rgb_array", "ansi" or "human"'
            gymnasium.logger.warn(f"render() without render_mode; {how}")
        if self.mode == "rgb_array":
            motion = lambda: chain.from_iterable(self._motion(*some) for some in recent)  # noqa: E731
            return self._source.picture(motion, lambda: self._still(tables, k, history))
        if self.mode == "ansi":
            from ..render.ascii_view import ansi

            return ansi(self._scene(tables, k, history))
        return None

    def render_all(self, tables: Tables, recent: list[list[Played]]) -> tuple[Picture, ...]:
        """``render`` for many tables: they move at the same time and wait for the longest motion."""
        if self.mode != "rgb_array":
            return tuple(self.render(tables, k, strokes, []) for k, strokes in enumerate(recent))

        def still():
            return tuple(self._still(tables, k, strokes) for k, strokes in enumerate(recent))

        def motion():
            last = list(still())
            for pictures in zip_longest(*(self._motion(strokes, len(strokes)) for strokes in recent)):
                last = [new if new is not None else old for new, old in zip(pictures, last, strict=True)]
                yield tuple(last)

        return self._source.picture(motion, still)

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
            film, _ = next(self._films(history, 1))
            self._window.play(film, FPS)
        self._window.draw(self._scene(tables, 0, history))

    def close(self) -> None:
        """Close the window, if there is one."""
        if self._window is not None:
            self._window.close()
            self._window = None

    def _films(self, history: list[Played], recent: int) -> Iterator[Any]:
        """The last strokes: each as a film, and the table after it."""
        from ..replays.film import film_stroke
        from ..replays.referee_words import bars

        shown = bars(history, self.players)
        for k in range(len(history) - recent, len(history)):
            yield film_stroke(self.table, history[k], *shown[k])

    def _motion(self, history: list[Played], recent: int) -> Iterator[Bytes]:
        for film, after in self._films(history, recent):
            yield from map(self._picture, film.scenes(FPS))
            yield from [self._picture(after)] * HOLD

    def _still(self, tables, k, history):
        return self._picture(self._scene(tables, k, history))

    def _picture(self, scene):
        from ..render.pygame_view import rgb_array

        return rgb_array(scene, size=self.size)

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
