"""What is a replay? Strokes in order, as a page for any browser, as data, and as a film."""

import html
import json
import re
from collections.abc import Iterable, Iterator, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from .._lib.check import choice, number, refuse, refuse_what
from .._lib.files import write_atomic
from .._lib.types import Bytes, Environment
from ..physics.table import Table
from ..planning import Position
from ..render.scene import scene_data
from ..simulation import Shot, simulate
from ..tasks.played import Played
from .chances import ChanceJudge, standings_of, win_chances
from .encode import encode_stroke, physics_data, table_data
from .web import WEB, table_js

FORMAT, VERSION = "snooker-replay", 2
FILMS = (".mp4", ".gif")
SUFFIXES = (".html", ".json", *FILMS)
USUAL = ((), ("Player",), ("Player 1", "Player 2"))  # names for bare shots, a visit and a frame


class Replay:
    """A sequence of strokes that is shown as a page, in a notebook, or as a film; ``snooker_env.replay`` makes one.

    Parameters
    ----------
    strokes : iterable of Shot or Played
        At least one stroke, in the order played, each with its path. ValueError if the strokes differ in ball radius, spin
        deceleration or table.
    title : str, optional
        Title of the page.
    players : iterable of str, optional
        Two names for a frame, one for a visit; default: "Player 1" and "Player 2", or "Player".
    judge : object with ``chance_to_win``, optional
        Estimates each player's chance to win a frame, as ``snooker_env.player("tactician").at(env)`` does, with the errors
        of ``env``. ValueError if the strokes are not of a frame. Default None: no chances are shown.
    luck : sequence of float, optional
        With a judge: the luck of each stroke, in [-1, 1], in its player's chance to win. Default None: not known.

    Attributes
    ----------
    strokes, title, players, luck, table
        As given, sequences as tuples (``players`` is empty for bare shots); the ``Table`` of the shots or "match".
    win_chance : tuple of float or None
        The first player's chance to win, before the first stroke and after each. None without a judge.

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
        judge: ChanceJudge | None = None,
        luck: Sequence[float] | None = None,
    ):
        if not isinstance(strokes, Iterable):
            raise refuse("strokes", strokes, "must be strokes in the order played")
        self.strokes: tuple[Shot | Played, ...] = tuple(strokes)
        for k, stroke in enumerate(self.strokes):
            if not isinstance(stroke, Shot | Played):
                allowed = "must be a Shot, or a stroke of env.history"
                raise refuse_what(f"strokes[{k}]", f"a {type(stroke).__name__}", allowed)
        if not self.strokes:
            raise refuse("strokes", [], "must hold at least one stroke")
        self.title: str = check_text("title", title)
        judged = next((stroke for stroke in self.strokes if isinstance(stroke, Played)), None)
        many = 0 if judged is None else len(judged.scores)
        self.players: tuple[str, ...] = check_players(players, many) or USUAL[many]
        first = self.shots[0].physics
        tables = [shot.table for shot in self.shots if shot.table is not None]
        self.table: Table = tables[0] if tables else Table.preset("match")
        for k, shot in enumerate(self.shots):
            if (shot.physics.R, shot.physics.spin_decel) != (first.R, first.spin_decel):
                allowed = "must have the R and the spin_decel of the first"
                raise refuse_what(f"strokes[{k}]", "a shot with other physics", allowed)
            own, ours = shot.table, self.table
            if own is None or own is ours:
                continue
            for part in ("noses", "jaws", "falls"):
                if not np.array_equal(getattr(own, part), getattr(ours, part)):
                    allowed = "must be on the table of the first"
                    raise refuse_what(f"strokes[{k}]", "a shot on another table", allowed)
        if judge is not None and not isinstance(judge, ChanceJudge):
            allowed = 'must have chance_to_win(positions), as snooker_env.player("tactician").at(env) has'
            raise refuse_what("judge", f"a {type(judge).__name__}", allowed)
        self.win_chance: tuple[float, ...] | None = None
        if judge is not None:
            self.win_chance = tuple(win_chances(judge, standings_of(self.strokes)))
        self.luck: tuple[float, ...] | None = None
        if luck is not None:
            if judge is None:
                raise refuse("luck", luck, "must be None: without a judge a replay holds no chances to win")
            if not isinstance(luck, list | tuple) or len(luck) != len(self):
                raise refuse("luck", luck, f"must be {len(self)} numbers, one for each stroke")
            self.luck = tuple(number(f"luck[{k}]", one, -1.0, 1.0) for k, one in enumerate(luck))

    @property
    def shots(self) -> list[Shot]:
        """The ``Shot`` of each stroke, a list."""
        return [stroke if isinstance(stroke, Shot) else stroke.shot for stroke in self.strokes]

    def __len__(self) -> int:
        return len(self.strokes)

    def __repr__(self) -> str:
        return f"Replay({len(self)} strokes, {self.title!r})"

    def to_dict(self) -> dict[str, Any]:
        """The replay as JSON types (docs/play/replay.md); ValueError if a shot has no path or more than 22 balls."""
        physics, *others = (shot.physics for shot in self.shots)
        same = all(one == physics for one in others)  # shots on several kinds of cloth may be shown
        return {
            "format": FORMAT,
            "version": VERSION,
            "title": self.title,
            "players": list(self.players),
            "scene": scene_data(self.table),
            "table": table_data(self.table),
            "physics": physics_data(physics) if same else None,
            "R": physics.R,
            "spin_decel": physics.spin_decel,
            "strokes": [encode_stroke(stroke, self.players) for stroke in self.strokes],
            "win_chance": self.win_chance and list(self.win_chance),
            "luck": self.luck and list(self.luck),
        }

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
        """The pictures of the film, each uint8 (height, width, 3), to be treated as read-only. ValueError unless ``fps`` and
        ``speed`` (a multiple of real time) lie in (0, 1000]; ``size``: width, height [pixels]. ImportError without pygame."""
        from .film import frames

        return frames(self, fps, speed, size)

    def save(self, path: str | Path, **film: Any) -> Path:
        """Write the replay, whole or not at all, as a page (``.html``), data (``.json``) or a film (``.mp4``, ``.gif``).

        Returns the path. ``film`` holds ``fps``, ``speed`` and ``size`` as in ``frames`` (a GIF has 12 and 640 x 360 by default).
        ValueError for another suffix, OSError if the file cannot be written, ImportError without the extra ``render``."""
        if not isinstance(path, str | PathLike):
            raise refuse("path", path, "must be a str or a Path")
        target = Path(path)
        suffix = choice("suffix", target.suffix.lower(), SUFFIXES)
        if suffix in FILMS:
            from .film import write_film

            write_film(self, target, **film)
            return target
        if film:
            raise refuse("path", str(path), f"must end in .mp4 or .gif with {', '.join(film)}")
        text = self.html() if suffix == ".html" else json.dumps(self.to_dict(), allow_nan=False)
        write_atomic(target, text)
        return target


def check_text(field: str, text: object) -> str:
    """``text`` if a file can hold it, else ValueError."""
    if not isinstance(text, str) or any(0xD800 <= ord(letter) < 0xE000 for letter in text):
        raise refuse(field, text, "must be a str, without halves of surrogate pairs")
    return text


def check_players(players: object, many: int) -> tuple[str, ...]:
    """No names, or as many as there are players; a single name may be a str."""
    if players is not None and not isinstance(players, Iterable):
        raise refuse("players", players, "must be None, or names")
    names = (players,) if isinstance(players, str) else tuple(players or ())
    if len(names) not in (0, many):
        allowed = "must be two names for a frame, one for a visit, none for bare shots"
        raise refuse("players", players, allowed)
    return tuple(check_text("players", name) for name in names)


def replay(
    source: Shot | Played | Sequence[Shot | Played] | Position | Environment,
    path: str | Path | None = None,
    *,
    title: str = "",
    players: Iterable[str] | None = None,
    judge: ChanceJudge | None = None,
) -> Replay:
    """Make a replay of what was played, and write it to a file if ``path`` is given.

    Parameters
    ----------
    source : Shot, Played, sequence of Shot or Played, Position, or environment
        Shots of ``sn.simulate`` in the order played; the strokes of an episode, ``env.history``; the environment itself,
        wrapped or not, if it has a render mode or ``keep_history`` was set to True; or a position on the table "match".
    path, title, players, judge
        A file as of ``Replay.save``; and as in ``Replay``.

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
    made = Replay(_strokes(source), title=title, players=players, judge=judge)
    if path is not None:
        made.save(path)
    return made


def _strokes(source: Any) -> list[Shot | Played]:
    if isinstance(source, Shot | Played):
        return [source]
    if isinstance(source, list | tuple):
        return list(source)
    if isinstance(source, Position):  # the shot in which nothing moves
        places, on_table, _ = source.arrays()
        nothing = np.zeros((len(places), 3))
        return [simulate(places, nothing[:, :2], nothing, "match", on_table=on_table)]
    env: Any = getattr(source, "unwrapped", source)
    if not (hasattr(env, "history") and hasattr(env, "keep_history")):
        allowed = "must be a Shot, a list of shots or of strokes of env.history, a Position"
        allowed += ", or an environment that keeps its history"
        raise refuse_what("source", f"a {type(source).__name__}", allowed)
    if not env.keep_history:
        words = "must have env.unwrapped.keep_history = True set before it plays"
        raise refuse_what("source", "an environment that keeps no history", words)
    if not env.history:
        what = "an environment without a stroke since its reset"
        raise refuse_what("source", what, "must have played at least one")
    return list(env.history)
