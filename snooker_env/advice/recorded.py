"""What is recorded of a stroke, and how is it read from a file? ``Recorded``: what was meant, played and left."""

import base64
import binascii
import json
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import partial
from math import atan2, hypot, pi, radians, remainder
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from .._lib.check import choice, integer, number, refuse, refuse_what, truth
from .._lib.files import MOST_JSON, in_file, read_bytes, strict_json, write_atomic
from .._lib.types import Bools, CueKind, Floats
from ..game.balls import CUE, N_BALLS, BallOn, mask_of_present, next_on
from ..geometry import AIM_X, AIM_Y, POCKET_AIMS, POCKETS
from ..physics import cloth
from ..physics.parameters import Physics, PhysicsLike
from ..physics.table import Table, TableLike
from ..planning import Position, pots
from ..players.cue_stroke import CueStroke
from ..replays.encode import physics_data, table_data, table_from
from ..simulation.impacts import strike
from ..tasks.box_actions import MAX_SPEED, MIN_SPEED
from ..tasks.options import CUES, Options

FORMAT, REPLAY = "snooker-strokes", "snooker-replay"
VERSIONS = {FORMAT: 1, REPLAY: 2}  # of files that are read
T = TypeVar("T")
PLAYED_ON = ("cue", "physics", "table")  # without these no error can be estimated: they are never assumed
CALLED = radians(2.0)  # how far a stroke may be from its guessed pot: 4 sigma of a club player's hard one
CUE_PARTS = ("speed", "side", "top", "aim", "elevation")
MOST_PENALTY, MOST_POINTS = 7, 16
FASTEST_CUE = 100.0  # [m/s]; under the law of errors a beginner's hardest stroke reaches 30 in a lapse
_AIMS = POCKET_AIMS[:, [AIM_X, AIM_Y]]
_JSON: dict[str, Callable[[Any], Any]] = {
    "position": Position.to_dict,
    "intended": CueStroke.to_dict,
    "after": Position.to_dict,
    "pocket": POCKETS.__getitem__,
    "scores": list,
    "physics": physics_data,
    "table": table_data,
}
"""What turns fields of ``Recorded`` into JSON types."""
_DATA = re.compile(r'<script type="application/json" id="data">(.*?)</script>', re.DOTALL)


@dataclass(frozen=True, kw_only=True)
class Recorded:
    """One recorded stroke of a player; ValueError for a field that is out of range. None means not known.

    Parameters
    ----------
    position : Position
        The balls before the stroke, and the ball on.
    intended, played : CueStroke, dict of str to float, optional
        The stroke as it was meant; as it was played, like ``Played.cue``: "speed" [m/s], "side", "top" (over R), "aim" and
        "elevation" [rad], where "aim" is the direction of the cue itself, without squirt.
    speed : float, optional
        Roughly how hard the ball was struck [m/s], in [0.2, 7], if neither stroke is known.
    ball, pocket : int, optional
        The pot that was meant: id of the ball and index into ``snooker_env.POCKETS``. Both None: a safety or an escape.
    potted, guessed : bool, optional
        Whether that ball went into that pocket without a foul; whether the pot was only guessed from the line of the stroke,
        which may have been a safety (default False).
    points, penalty : int
        Points scored, in [0, 16], and given away, in [0, 7].
    after : Position, optional
        The balls for the next stroke; ``over=True`` if there is none.
    scores : (int, int)
        In a frame, the scores of the player and of the opponent before the stroke. Default (0, 0).
    cue, physics, table : {"free", "real"}, str, dict or Physics, str or Table, optional
        Where it was played: whether rails and balls were in the way of the cue, the constants, the cushions and pockets.

    Examples
    --------
    >>> import snooker_env as sn
    >>> from snooker_env.advice import Recorded
    >>> at = sn.Position(cue=(0.0, 0.9), black=(0.4, 1.3))
    >>> Recorded(position=at, ball=21, pocket=3, potted=True, points=7).goes_on
    True
    """

    position: Position
    intended: CueStroke | None = None
    played: dict[str, float] | None = None
    speed: float | None = None
    ball: int | None = None
    pocket: int | None = None
    potted: bool | None = None
    guessed: bool = False
    points: int = 0
    penalty: int = 0
    after: Position | None = None
    scores: tuple[int, int] = (0, 0)
    cue: CueKind | None = None
    physics: PhysicsLike = None
    table: TableLike = None

    def __post_init__(self) -> None:
        put = partial(object.__setattr__, self)
        for name in ("position", "after"):
            here = getattr(self, name)
            if not isinstance(here, Position) and (name == "position" or here is not None):
                raise refuse_what(name, f"a {type(here).__name__}", "must be a Position")
        if self.position.over:
            raise refuse("position.over", True, "must be False: a stroke was played")
        if self.intended is not None:
            put("intended", CueStroke.of(self.intended))
        if self.played is not None:
            put("played", _check_cue(self.played))
        if self.speed is not None:
            put("speed", number("speed", self.speed, MIN_SPEED, MAX_SPEED))
        if (self.ball is None) != (self.pocket is None):
            missing = "ball" if self.ball is None else "pocket"
            raise refuse(missing, None, "must be given: a pot has a ball and a pocket")
        if self.ball is not None:
            put("ball", integer("ball", self.ball, 1, N_BALLS - 1))
            put("pocket", integer("pocket", self.pocket, 0, len(POCKETS) - 1))
            if not self.position.arrays()[1][self.ball]:
                raise refuse("ball", self.ball, "must be on the table of the position")
        if self.potted is not None:
            put("potted", truth("potted", self.potted))
            if self.ball is None:
                raise refuse("potted", self.potted, "must be left out: no pot was meant")
        put("guessed", truth("guessed", self.guessed))
        if self.guessed and (self.ball is None or self.played is None or self.intended is not None):
            allowed = "must be False with intended, and without a pot or the stroke played"
            raise refuse("guessed", True, allowed)
        put("points", integer("points", self.points, 0, MOST_POINTS))
        put("penalty", integer("penalty", self.penalty, 0, MOST_PENALTY))
        if not isinstance(self.scores, list | tuple) or len(self.scores) != 2:
            raise refuse("scores", self.scores, "must be two integers: of the player and of the opponent")
        put("scores", tuple(integer(f"scores[{k}]", one, 0, 1000) for k, one in enumerate(self.scores)))
        if self.cue is not None:
            choice("cue", self.cue, CUES)
        if self.physics is not None:
            put("physics", Physics.of(self.physics))
        if self.table is not None:
            put("table", Table.of(self.table))

    @property
    def goes_on(self) -> bool:
        """Whether the visit goes on after the stroke."""
        return self.points > 0 and self.penalty == 0 and not (self.after is not None and self.after.over)

    def to_dict(self) -> dict[str, Any]:
        """Return what is known of the stroke as JSON types; ``from_dict`` reads it."""
        known = {name: value for name, value in vars(self).items() if value is not None}
        return {name: _JSON[name](value) if name in _JSON else value for name, value in known.items()}

    @classmethod
    def from_dict(cls, kept: Mapping[str, Any]) -> "Recorded":
        """Make a stroke of a dict of ``to_dict``; ValueError for an unknown key."""
        if not isinstance(kept, Mapping):
            allowed = "must be a dict of the fields of Recorded"
            raise refuse_what("stroke", f"a {type(kept).__name__}", allowed)
        names = [f.name for f in fields(cls)]
        for key in kept:
            choice("field of the stroke", key, names)
        made = dict(kept)
        if "position" not in made:
            raise refuse_what("stroke", "a dict without 'position'", "must have one")
        for name in ("position", "after"):
            if made.get(name) is not None:
                made[name] = Position.from_dict(made[name])
        made["table"] = made.get("table") and table_from(made["table"])
        if isinstance(made.get("pocket"), str):
            made["pocket"] = POCKETS.index(choice("pocket", made["pocket"], POCKETS))
        return cls(**made)


def _check_cue(played: object) -> dict[str, float]:
    """``Recorded.played`` as five numbers; tip and elevation are 0 if they are left out."""
    if not isinstance(played, Mapping) or not {"speed", "aim"} <= set(played):
        what = f"a {type(played).__name__} without speed and aim"
        raise refuse_what("played", what, f"must be a dict with {list(CUE_PARTS)}")
    for key in played:
        choice("field of played", key, CUE_PARTS)
    ends = {"speed": (0.0, FASTEST_CUE), "side": (-1.0, 1.0), "top": (-1.0, 1.0), "elevation": (0.0, pi / 2)}
    return {name: number(f"played.{name}", played.get(name, 0.0), *ends.get(name, ())) for name in CUE_PARTS}


def write_strokes(path: str | Path, strokes: Iterable[Recorded]) -> None:
    """Write strokes as JSON, whole or not at all; ``read_strokes`` reads them.

    Parameters
    ----------
    path : str or Path
        The file. OSError if it cannot be written.
    strokes : iterable of Recorded
        The strokes of one player, in order.

    Examples
    --------
    >>> import tempfile
    >>> import snooker_env as sn
    >>> from snooker_env.advice import Recorded, write_strokes
    >>> at = sn.Position(cue=(0.1, 0.2), black=(-0.3, 1.0))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_strokes(f"{folder}/mine.json", [Recorded(position=at, ball=21, pocket=4, potted=True)])
    """
    kept = {"format": FORMAT, "version": VERSIONS[FORMAT], "strokes": [one.to_dict() for one in strokes]}
    write_atomic(path, json.dumps(kept, allow_nan=False) + "\n")


def read_strokes(path: str | Path, *, player: int | None = None) -> list[Recorded]:
    """Read the strokes of one player from a file of strokes (docs/play/coach.md), or from a replay, JSON or page.

    Parameters
    ----------
    path : str or Path
        A ``.json`` file of strokes or of ``snooker_env.replay``, or the ``.html`` file of a replay.
    player : int, optional
        In a replay of a frame, whose strokes to read, 0 or 1. Default None: all are of one player.

    Returns
    -------
    list of Recorded
        At least one stroke. ValueError names what is wrong in the file; OSError if it cannot be read.

    Examples
    --------
    >>> import tempfile
    >>> import snooker_env as sn
    >>> from snooker_env.advice import read_strokes
    >>> env = sn.SnookerEnv(action="discrete")
    >>> env.keep_history = True
    >>> _ = env.reset(seed=1), env.step(67)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = sn.replay(env).save(f"{folder}/visit.json")
    ...     read_strokes(path)[0].played is not None
    True
    """
    if player is not None:
        integer("player", player, 0, 1)
    readers = {FORMAT: partial(_from_file, player=player), REPLAY: partial(strokes_of, player=player)}
    strokes = read_document(path, readers)
    if not strokes:
        raise refuse("path", str(path), "must hold at least one stroke of the player")
    return strokes


def read_document(path: str | Path, readers: Mapping[str, Callable[[dict[str, Any]], T]]) -> T:
    """What the reader of its format makes of a file, JSON or the page of a replay; ValueError, OSError as ``read_strokes``."""
    allowed = f"must have the format {' or '.join(map(repr, readers))}"
    try:
        text = read_bytes(path, MOST_JSON).decode("utf-8")
        page = _DATA.search(text)
        kept = strict_json(page[1] if page else text)
    except ValueError as error:
        raise refuse("path", str(path), f"{allowed} ({error})") from None
    form = kept.get("format") if isinstance(kept, dict) else None
    if not isinstance(form, str) or form not in readers:
        raise refuse("path", str(path), allowed)
    if kept.get("version") != VERSIONS[form] or kept["version"] is True:
        raise refuse(f"version of {path}", kept.get("version"), f"must be {VERSIONS[form]}")
    if not isinstance(kept.get("strokes"), list):
        raise refuse_what(f"strokes of {path}", f"a {type(kept.get('strokes')).__name__}", "must be a list")
    try:
        with in_file(path):
            return readers[form](kept)
    except (KeyError, TypeError, IndexError, AttributeError, binascii.Error) as error:
        what = f"a damaged file ({type(error).__name__}: {error})"
        raise refuse_what(str(path), what, f"must be a whole {form!r}") from None


def _from_file(kept: Mapping[str, Any], player: int | None) -> list[Recorded]:
    if player is not None:
        raise refuse("player", player, "must be left out: a file of strokes is of one player")
    made = []
    for k, one in enumerate(kept["strokes"]):
        with in_file(f"strokes[{k}]"):
            made.append(Recorded.from_dict(one))
    return made


def strokes_of(kept: Mapping[str, Any], player: int | None) -> list[Recorded]:
    """The strokes of a ``player`` (None: there is one alone) in the data of a replay."""
    made = []
    if player is None and len({one["player"] for one in kept["strokes"]}) > 1:
        raise refuse("player", None, "must be 0 or 1: the replay is of two players")
    before, table = (0, 0), kept.get("table")
    where = {"physics": kept.get("physics"), "table": table and table_from(table)}
    for k, one in enumerate(kept["strokes"]):
        if one["player"] is None or one["cue"] is None or one["n"] != N_BALLS:
            raise refuse_what(f"strokes[{k}]", "a bare shot", "must be of a visit or a frame, with a referee")
        who, scores = integer(f"strokes[{k}].player", one["player"], 0, 1), before
        before = tuple((*one["score"], 0)[:2])
        if player is None or who == player:
            with in_file(f"strokes[{k}]"):
                made.append(_of_replay(one, (scores[who], scores[1 - who]), where))
    return made


def _of_replay(one: Mapping[str, Any], scores: tuple[int, int], where: dict[str, Any]) -> Recorded:
    """A stroke of a replay, played on the table ``where``; the pot that was meant is guessed from the line of the stroke."""
    (start, here), (rest, left), fell = read_balls(one)
    word = one["ball_on"].replace(" ", "_")
    position = _position(start, here, None if word == "free_ball" else word)
    scored = one["points"] > 0 and not one["penalty"]
    red = word == "red" or (word == "free_ball" and here[1:16].any())  # that a free ball stood for
    colour = scored and red and bool(left[16:].any())
    if left[1:].any() and left[CUE]:
        after: Position | None = _position(rest, left, "any_colour" if colour else None)
    else:
        after = None if left[1:].any() else Position(over=True)
    played = {name: one["cue"][name] for name in CUE_PARTS}
    line = direction_of(played, Physics.of(where["physics"]))
    meant = None if word == "free_ball" else call_pot(position, line)
    ids = np.flatnonzero(here).tolist()
    # a position numbers its reds anew
    reds = {ball: 1 + k for k, ball in enumerate(ball for ball in ids if 1 <= ball <= 15)}
    down = {(reds.get(ball, ball), into) for ball, into in fell.items()}
    ball, pocket = (None, None) if meant is None else meant
    pot = {"ball": ball, "pocket": pocket, "guessed": ball is not None}
    pot["potted"] = None if ball is None else (ball, pocket) in down and not one["penalty"]
    came = {"points": one["points"], "penalty": one["penalty"], "after": after, "scores": scores}
    came |= {**where, "cue": one.get("cue_kind")}
    return Recorded(position=position, played=played, **pot, **came)


def read_balls(one: Mapping[str, Any]) -> tuple[tuple[Floats, Bools], tuple[Floats, Bools], dict[int, int]]:
    """The balls (22, 2), (22,) before and after a stroke of a replay, and the pockets of those potted."""
    start, here = _numbers(one["start"], "f8", 2), _present(one["on_table"])
    which, states = _numbers(one["paths"]["u1"], "u1", 2).astype(int).T
    rest, left = start.copy(), here.copy()
    for ball, state, row in zip(which, states, _numbers(one["paths"]["f8"], "f8", 7), strict=True):
        rest[ball], left[ball] = row[1:3], state != cloth.GONE
    # the pocket nearest to where it fell
    fell = {ball: int(np.hypot(*(_AIMS - rest[ball]).T).argmin()) for ball in one["pots"]}
    if one["after"] is not None:
        rest, left = _numbers(one["after"]["places"], "f8", 2), _present(one["after"]["on_table"])
    return (start, here), (rest, left), fell


def _numbers(text: str, kind: str, columns: int) -> Floats:
    """Numbers (n, columns) of base64, little-endian."""
    raw = base64.b64decode(text, validate=True)
    return np.frombuffer(raw, np.dtype(kind).newbyteorder("<")).reshape(-1, columns).astype(np.float64)


def _present(ids: Sequence[int]) -> Any:
    here = np.zeros(N_BALLS, np.bool_)
    here[[integer("on_table", ball, 0, N_BALLS - 1) for ball in ids]] = True
    return here


def _position(places: Floats, here: Any, on: str | None) -> Position:
    """A position of arrays; ``on`` None: the lowest ball."""
    lowest = next_on(mask_of_present(here))
    code = lowest if on is None else BallOn[choice("ball_on", on.upper(), BallOn.__members__)]
    return Position.of_arrays(places, here, np.array([code, 0, 0, 0, 0]))


def direction_of(played: Mapping[str, float], physics: Physics) -> float:
    """The direction in which the cue ball leaves a level cue [rad]: that of the cue, plus squirt."""
    return played["aim"] + squirt(played["side"], physics)


def squirt(side: float, physics: Physics) -> float:
    """The squirt of a tip that is off to the side [rad]."""
    inside = min(physics.max_offset, max(-physics.max_offset, side))
    (vx, vy, _), _ = strike(1.0, 0.0, inside, 0.0, 0.0, physics)
    return atan2(vy, vx)


def agree_options(strokes: Sequence[Recorded], options: object) -> Any:
    """``options`` completed by the strokes with where they were played; ValueError if they contradict, or none says it."""
    if not (options is None or isinstance(options, Options | Mapping)):
        allowed = f"must be None, an Options, or a dict with keys as {PLAYED_ON}"
        raise refuse_what("options", f"a {type(options).__name__}", allowed)
    of_options = isinstance(options, Options)
    kept: Any = {name: getattr(options, name) for name in PLAYED_ON} if of_options else dict(options or {})
    for name in PLAYED_ON:
        said = [getattr(one, name) for one in strokes]
        if name not in kept and None in said:
            allowed = f"must be given (options={{{name!r}: ...}}, --{name}): the strokes do not hold it"
            raise refuse(name, None, allowed)
        whose = "options say" if name in kept else "the first stroke says"
        usual = _data(name, kept.setdefault(name, said[0]))
        for k, one in enumerate(said):
            if one is not None and (data := _data(name, one)) != usual:
                own, other = (d.get("name", d) if isinstance(d, dict) else d for d in (data, usual))
                raise refuse(f"strokes[{k}].{name}", own, f"must be {other!r}, as {whose}")
    return options if of_options else kept


def _data(name: str, value: Any) -> Any:
    """A value of ``PLAYED_ON`` as JSON types, to be compared."""
    if name == "cue":
        return value
    return physics_data(Physics.of(value)) if name == "physics" else table_data(Table.of(value))


def call_pot(position: Position, direction: float, within: float = CALLED) -> tuple[int, int] | None:
    """Ball and pocket of the direct pot with the line nearest to a direction [rad]; None if none is ``within`` [rad]."""
    direct = pots(position, 16)
    x, y = position.cue or (0.0, 0.0)
    aside = [
        abs(remainder(atan2(gy - y, gx - x) - direction, 2.0 * pi)) if ball > 0 and hypot(gx, gy) else pi
        for ball, (gx, gy) in zip(direct.ball[0].tolist(), direct.ghost[0].tolist(), strict=True)
    ]
    k = int(np.argmin(aside))
    return (int(direct.ball[0, k]), int(direct.pocket[0, k])) if aside[k] <= within else None
