"""What is a replay? Strokes in their order, as a page for any browser, as data, and as a film."""

import html
import json
import re
from collections.abc import Iterable, Iterator, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Protocol, TypeAlias, runtime_checkable

import numpy as np

from .._lib.check import choice, refuse, refuse_what
from .._lib.files import write_atomic
from .._lib.types import Bytes, Environment
from ..physics.table import Table, TableLike
from ..planning import Position
from ..render.scene import scene_data
from ..simulation import Shot, simulate
from ..tasks.played import Played
from .chances import ChanceJudge, check_judge, check_luck, standings_of, win_chances
from .encode import encode_stroke, physics_data, table_data
from .web import WEB, table_js

FORMAT, VERSION = "snooker-replay", 2
SUFFIXES = (".html", ".json", ".mp4", ".gif")
_PARTS = ("noses", "jaws", "falls")  # of a table


class Replay:
    """A sequence of strokes, of ``snooker_env.replay``, shown as a page, in a notebook, or as a film.

    Parameters
    ----------
    strokes : iterable of Shot or Played
        The strokes in the order in which they were played; at least one, each with its path. ValueError if
        they differ in ball radius, spin deceleration or table.
    title : str, optional
        Title of the page.
    players : iterable of str, optional
        Two names for a frame, one for a visit; default: "Player 1" and "Player 2", or "Player".
    table : str, Table or None, optional
        The table of the strokes; default: that of the shots, or "match".
    judge : object with ``chance_to_win``, optional
        Of a frame: who says how likely each player wins, as ``snooker_env.player("tactician").at(env)``, with
        the errors of ``env``. ValueError with strokes that are of no frame. None (default): nobody says it.
    luck : sequence of float, optional
        Beside a judge: how much luck each stroke had, in [-1, 1], in its player's chance to win. Strokes alone do
        not tell it: they hold what was struck, not what was meant. None (default): it is not known.

    Attributes
    ----------
    strokes, title, players, table
        As tuples of Shot or Played and of names, the latter empty for bare shots, str and ``Table``.
    win_chance : tuple of float or None
        How likely the first player wins: before the first stroke, and after each. None without a judge.
    luck : tuple of float or None
        As given.

    Examples
    --------
    >>> import snooker_env as sn
    >>> shot = sn.simulate([(0.0, -1.0), (0.0, 0.5)], [(0.0, 3.0), (0.0, 0.0)], [(0.0, 0.0, 0.0)] * 2)
    >>> film = sn.Replay([shot, shot], title="twice")
    >>> film, film.players, film.table.name
    (Replay(2 strokes, 'twice'), (), 'match')
    """

    def __init__(
        self,
        strokes: Iterable[Shot | Played],
        *,
        title: str = "",
        players: Iterable[str] | None = None,
        table: TableLike = None,
        judge: ChanceJudge | None = None,
        luck: Sequence[float] | None = None,
    ):
        if not isinstance(strokes, Iterable):
            raise refuse("strokes", strokes, "must be strokes, one after the other")
        self.strokes: tuple[Shot | Played, ...] = tuple(strokes)
        for k, stroke in enumerate(self.strokes):
            if not isinstance(stroke, Shot | Played):
                allowed = "must be a Shot, or a stroke of env.history"
                raise refuse_what(f"strokes[{k}]", f"a {type(stroke).__name__}", allowed)
        if not self.strokes:
            raise refuse("strokes", [], "must hold at least one stroke")
        self.title: str = check_text("title", title)
        names = check_players(players)
        judged = next((stroke for stroke in self.strokes if isinstance(stroke, Played)), None)
        frame = judged is not None and len(judged.scores) == 2
        usual = ("Player 1", "Player 2") if frame else ("Player",) * (judged is not None)
        if names and len(names) != len(usual):
            allowed = "must be two names for a frame, one for a visit, none for bare shots"
            raise refuse_what("players", f"{len(names)} names", allowed)
        self.players: tuple[str, ...] = names or usual
        constants = [(shot.physics.R, shot.physics.spin_decel) for shot in self.shots]
        for k, these in enumerate(constants):
            if these != constants[0]:
                allowed = "must have the R and the spin_decel of the first"
                raise refuse_what(f"strokes[{k}]", "a shot with other physics", allowed)
        tables = [shot.table for shot in self.shots if shot.table is not None]
        if table is not None:
            self.table: Table = Table.of(table)
        else:
            self.table = tables[0] if tables else Table.preset("match")
            for k, other in enumerate(tables):
                parts = ((getattr(one, name) for one in (other, self.table)) for name in _PARTS)
                if other is not self.table and not all(np.array_equal(*pair) for pair in parts):
                    allowed = "must be on the table of the first, or pass table=..."
                    raise refuse_what(f"strokes[{k}]", "a shot on another table", allowed)
        self.win_chance: tuple[float, ...] | None = None
        if (asked := check_judge(judge)) is not None:
            self.win_chance = tuple(win_chances(asked, standings_of(self.strokes)))
        self.luck: tuple[float, ...] | None = check_luck(luck, len(self.strokes), asked is not None)
        self._data: dict[str, Any] | None = None

    @property
    def shots(self) -> list[Shot]:
        """The ``Shot`` of each stroke, a list."""
        return [stroke if isinstance(stroke, Shot) else stroke.shot for stroke in self.strokes]

    def __len__(self) -> int:
        return len(self.strokes)

    def __repr__(self) -> str:
        return f"Replay({len(self)} strokes, {self.title!r})"

    def to_dict(self) -> dict[str, Any]:
        """The replay as JSON types, see docs/play/replay.md; treat what is inside as read-only.

        ValueError if a shot has no path, or more than 22 balls."""
        if self._data is None:
            strokes = [encode_stroke(stroke, self.players) for stroke in self.strokes]
            physics, *others = (shot.physics for shot in self.shots)
            # shots of several kinds of balls and cloth may be shown
            same = all(one == physics for one in others)
            self._data = {"format": FORMAT, "version": VERSION, "title": self.title}
            self._data |= {"players": list(self.players), "scene": scene_data(self.table)}
            self._data |= {
                "table": table_data(self.table),
                "physics": physics_data(physics) if same else None,
            }
            self._data |= {"R": physics.R, "spin_decel": physics.spin_decel, "strokes": strokes}
            self._data |= {"win_chance": self.win_chance and list(self.win_chance)}
            self._data |= {"luck": self.luck and list(self.luck)}
        return dict(self._data)

    def html(self) -> str:
        """The replay as one HTML page that needs no other file and no network; errors as in ``to_dict``."""
        data = json.dumps(self.to_dict(), separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
        parts = {"title": html.escape(self.title or "Snooker replay"), "module": table_js(), "data": data}
        page = (WEB / "replay.html").read_text("utf-8")
        return re.sub(r"\{\{(title|module|data)\}\}", lambda place: parts[place[1]], page)

    def _repr_html_(self) -> str:
        return (
            f'<iframe srcdoc="{html.escape(self.html(), quote=True)}" '
            'sandbox="allow-scripts" title="snooker replay" '
            'style="width: 100%; aspect-ratio: 16 / 10; border: 0"></iframe>'
        )

    def frames(
        self, *, fps: float = 30.0, speed: float = 1.0, size: tuple[int, int] = (1920, 1080)
    ) -> Iterator[Bytes]:
        """The pictures of the film, each uint8 (height, width, 3): treat them as read-only.

        ``fps`` and ``speed`` (over that of the strokes) in (0, 1000], else ValueError; ``size``: width and
        height [pixels]. Without pygame ImportError."""
        from .film import film_strokes, frames

        return frames(film_strokes(self), fps, speed, size)

    def save(self, path: str | Path, **film: Any) -> Path:
        """Write the replay, whole or not at all, in the format of the suffix; returns the path.

        ``.html``: the page. ``.json``: the data. ``.mp4`` or ``.gif``: a film, which needs the extra
        ``render``; ``film`` are ``fps``, ``speed`` and ``size`` as in ``frames`` (a GIF: 15, 640 x 360).
        ValueError for another suffix, OSError if the file cannot be written, ImportError without the extra."""
        target = read_path("path", path)
        suffix = choice("suffix", target.suffix.lower(), SUFFIXES)
        if suffix in (".mp4", ".gif"):
            from .film import write_film

            write_film(self.frames, target, **film)
            return target
        if film:
            raise refuse("path", str(path), f"must end in .mp4 or .gif with {', '.join(film)}")
        text = self.html() if suffix == ".html" else json.dumps(self.to_dict(), allow_nan=False)
        write_atomic(target, text)
        return target


def read_path(field: str, path: object) -> Path:
    """``path`` as a Path, else ValueError."""
    if not isinstance(path, str | PathLike):
        raise refuse(field, path, "must be a str or a Path")
    return Path(path)


def check_text(field: str, text: object) -> str:
    """``text`` if a file can hold it, else ValueError."""
    if not isinstance(text, str) or any(0xD800 <= ord(letter) < 0xE000 for letter in text):
        raise refuse(field, text, "must be a str, without halves of surrogate pairs")
    return text


def check_players(players: object) -> tuple[str, ...]:
    """Names of players as a tuple; a single name may be a str."""
    if players is not None and not isinstance(players, Iterable):
        raise refuse("players", players, "must be None, or names")
    names = (players,) if isinstance(players, str) else tuple(players or ())
    if len(names) > 2:
        raise refuse("players", players, "must be at most two names")
    return tuple(check_text("players", name) for name in names)


@runtime_checkable
class KeepsHistory(Protocol):
    """An environment that may keep what was played, as ``SnookerEnv`` and matches do."""

    history: list[Played]
    keep_history: bool


Source: TypeAlias = Replay | Shot | Played | Sequence[Shot | Played] | Position | Environment
"""What can be shown as a replay."""


def replay(
    source: Source,
    path: str | Path | None = None,
    *,
    title: str = "",
    players: Iterable[str] | None = None,
    table: TableLike = None,
    judge: ChanceJudge | None = None,
) -> Replay:
    """Make a replay of what was played, and write it to a file if ``path`` is given.

    Parameters
    ----------
    source : Shot, Played, sequence of Shot or Played, Position, Replay, or environment
        * A ``Shot`` of ``sn.simulate``, or several in the order in which they were played.
        * The strokes of an episode: ``env.history`` of ``SnookerEnv`` or of a match; or the environment
          itself, wrapped or not, if it has a render mode or its ``keep_history`` was set to True.
        * A ``Position`` is shown as it stands.
        * A ``Replay`` is copied, with the other arguments applied.
    path : str or Path, optional
        A file that ends in ``.html``, ``.json``, ``.mp4`` or ``.gif``, see ``Replay.save``.
    title, players, table, judge
        As in ``Replay``. A copied ``Replay`` keeps what a judge has said of it.

    Returns
    -------
    Replay
        ValueError if there is nothing to show, a shot has no path, or an argument is invalid; OSError if the
        file cannot be written.

    Examples
    --------
    >>> import snooker_env as sn
    >>> env = sn.SnookerEnv(action="discrete")
    >>> env.keep_history = True
    >>> _ = env.reset(seed=1)
    >>> _ = env.step(67)
    >>> sn.replay(env, title="one stroke")
    Replay(1 strokes, 'one stroke')
    """
    if isinstance(source, Replay):
        title, players, table = title or source.title, players or source.players, table or source.table
    strokes = source.strokes if isinstance(source, Replay) else _strokes(source, table)
    made = Replay(strokes, title=title, players=players, table=table, judge=judge)
    if isinstance(source, Replay) and judge is None:
        made.win_chance, made.luck = source.win_chance, source.luck
    if path is not None:
        made.save(path)
    return made


def _strokes(source: Source, table: TableLike) -> list[Shot | Played]:
    if isinstance(source, Shot | Played):
        return [source]
    if isinstance(source, list | tuple):
        return list(source)
    if isinstance(source, Position):  # the shot in which nothing moves
        places, on_table, _ = source.arrays()
        nothing, table = np.zeros((len(places), 3)), Table.of("match" if table is None else table)
        return [simulate(places, nothing[:, :2], nothing, table, on_table=on_table)]
    env = getattr(source, "unwrapped", source)
    if not isinstance(env, KeepsHistory):
        allowed = "must be a Shot, a list of shots or of strokes of env.history, a Position, a Replay"
        allowed += ", or an environment that keeps its history"
        raise refuse_what("source", f"a {type(source).__name__}", allowed)
    if not env.keep_history:
        words = "must have env.unwrapped.keep_history = True set before it plays, or be wrapped in "
        raise refuse_what("source", "an environment that keeps no history", f"{words}sn.RecordReplay")
    if not env.history:
        what = "an environment without a stroke since its reset"
        raise refuse_what("source", what, "must have played at least one")
    return [*env.history]
