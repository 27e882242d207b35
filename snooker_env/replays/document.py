"""What is a replay? Strokes in their order, as data, as a page that any browser plays from disk, and as a film."""

import html
import json
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._check import choice, refuse, refuse_what
from .._files import write_whole
from ..physics.table import Table, TableLike
from ..render.scene import scene_data
from ..simulation import Shot
from ..tasks.played import Played
from .encode import encoded_stroke

WEB = Path(__file__).resolve().parent.parent / "web"
"""Where the module that draws in a browser is."""
FORMAT, VERSION = "snooker-replay", 1
SUFFIXES = (".html", ".json", ".mp4", ".gif")


class Replay:
    """Strokes to look at: ``html()`` and ``save`` give a file that any browser opens, a notebook shows the replay itself.

    Made by ``snooker_env.replay``, which says what its arguments are.

    Attributes
    ----------
    strokes : tuple of Shot or Played
        In the order in which they were played.
    title : str
    players : tuple of str
        Names: none for bare shots, one for a visit, two for a frame.
    table : Table
        What they were played on.
    """

    def __init__(self, strokes: Iterable[Shot | Played], *, title: str = "", players: Iterable[str] = (), table: TableLike = None):
        self.strokes = tuple(strokes)
        for k, stroke in enumerate(self.strokes):
            if not isinstance(stroke, Shot | Played):
                raise refuse_what(f"strokes[{k}]", f"a {type(stroke).__name__}", "must be a Shot, or a stroke of env.history")
        if not self.strokes:
            raise refuse("strokes", [], "must hold at least one stroke")
        self.title, names = checked_text("title", title), checked_players(players)
        usual = self._usual_players()
        if names and len(names) != len(usual):
            allowed = "must be two names for a frame, one for a visit, none for bare shots"
            raise refuse_what("players", f"{len(names)} names", allowed)
        self.players = names or usual
        for k, shot in enumerate(self.shots):
            if (shot.physics.R, shot.physics.spin_decel) != (self.shots[0].physics.R, self.shots[0].physics.spin_decel):
                raise refuse_what(f"strokes[{k}]", "a shot in another world", "must have the R and the spin_decel of the first")
        tables = [shot.table for shot in self.shots if shot.table is not None]
        if table is not None:
            self.table = Table.of(table)
        else:
            self.table = tables[0] if tables else Table.preset("match")
            for k, other in enumerate(tables):
                if not _same(other, self.table):
                    raise refuse_what(f"strokes[{k}]", "a shot on another table", "must be on the table of the first, or pass table=...")
        self._data: dict[str, Any] | None = None

    def _usual_players(self) -> tuple[str, ...]:
        judged = [stroke for stroke in self.strokes if isinstance(stroke, Played)]
        return ("Player 1", "Player 2") if judged and len(judged[0].scores) == 2 else ("Player",) if judged else ()

    @property
    def shots(self) -> list[Shot]:
        """The shots of the strokes."""
        return [stroke if isinstance(stroke, Shot) else stroke.shot for stroke in self.strokes]

    def __len__(self) -> int:
        return len(self.strokes)

    def __repr__(self) -> str:
        return f"Replay({len(self)} strokes, {self.title!r})"

    def to_dict(self) -> dict[str, Any]:
        """The replay as JSON types, as docs/replay.md describes them.

        Returns
        -------
        dict
            Fresh at the top; treat what is inside as read-only.
        """
        if self._data is None:
            strokes = [encoded_stroke(stroke, self.players) for stroke in self.strokes]
            physics = self.shots[0].physics
            self._data = {
                "format": FORMAT, "version": VERSION, "title": self.title, "players": list(self.players), "scene": scene_data(self.table),
                "R": physics.R, "spin_decel": physics.spin_decel, "strokes": strokes,
            }  # fmt: skip
        return dict(self._data)

    def html(self) -> str:
        """The replay as one HTML page that needs nothing else, no network either.

        Returns
        -------
        str
        """
        data = json.dumps(self.to_dict(), separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
        parts = {"title": html.escape(self.title or "Snooker replay"), "module": (WEB / "table.js").read_text("utf-8"), "data": data}
        page = (WEB / "replay.html").read_text("utf-8")
        return re.sub(r"\{\{(title|module|data)\}\}", lambda place: parts[place[1]], page)

    def _repr_html_(self) -> str:
        """In a notebook: the page in a frame of its own."""
        return (
            f'<iframe srcdoc="{html.escape(self.html(), quote=True)}" sandbox="allow-scripts" title="snooker replay" '
            'style="width: 100%; aspect-ratio: 16 / 10; border: 0"></iframe>'
        )

    def frames(self, *, fps: float = 30.0, speed: float = 1.0, size: tuple[int, int] = (1920, 1080)) -> Iterator[NDArray[np.uint8]]:
        """The pictures of the film, one after the other.

        Parameters
        ----------
        fps : float
            Pictures a second.
        speed : float
            Of the film over that of the strokes.
        size : (int, int)
            Width and height [pixels].

        Returns
        -------
        iterator of uint8 (height, width, 3)
            To be read only: where nothing moves the same array comes again.
        """
        from .film import frames

        return frames(self, fps, speed, size)

    def save(self, path: str | Path, **film: Any) -> Path:
        """Write the replay to a file: its suffix says as what.

        Parameters
        ----------
        path : str or Path
            ``.html``: the page; ``.json``: the data; ``.mp4``, ``.gif``: a film, which needs the extra ``render``. It is written whole or
            not at all.
        **film
            ``fps``, ``speed``, ``size`` of a film, as ``frames`` takes them; a .gif is 640 x 360 at 15 pictures a second unless told.

        Returns
        -------
        Path
            Where it is.

        Raises
        ------
        ValueError
            For another suffix.
        OSError
            If the file cannot be written.
        """
        target = Path(path)
        suffix = choice("suffix", target.suffix.lower(), SUFFIXES)
        if suffix in (".mp4", ".gif"):
            from .film import write_film

            write_film(self, target, **film)
            return target
        if film:
            raise refuse("path", str(path), f"must end in .mp4 or .gif with {', '.join(film)}")
        text = self.html() if suffix == ".html" else json.dumps(self.to_dict(), allow_nan=False)
        write_whole(target, lambda temporary: temporary.write_text(text, "utf-8"))
        return target


def checked_text(field: str, text: Any) -> str:
    """A text that a file can hold."""
    if not isinstance(text, str) or any(0xD800 <= ord(letter) < 0xE000 for letter in text):
        raise refuse(field, text, "must be a str, without halves of surrogate pairs")
    return text


def checked_players(players: Any) -> tuple[str, ...]:
    """Names of players: one alone may be a str."""
    names = (players,) if isinstance(players, str) else tuple(players)
    if len(names) > 2:
        raise refuse("players", players, "must be at most two names")
    return tuple(checked_text("players", name) for name in names)


def _same(a: Table, b: Table) -> bool:
    return a is b or all(np.array_equal(x, y) for x, y in ((a.noses, b.noses), (a.jaws, b.jaws), (a.falls, b.falls)))
