"""What is one stroke? ``CueStroke``: speed, tip, aim, elevation and place; and as the fields of a request ask for it, in the
language of ``POST api/stroke`` (docs/play/protocol.md), which programs speak too."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, replace
from functools import partial
from math import hypot
from typing import Any, TypeAlias

import numpy as np

from .._lib.check import array, choice, number, refuse, refuse_what
from .._lib.files import strict_json
from .._lib.types import Floats, Place
from ..game.balls import COLOUR_NAMES, NAMES, colour
from ..game.in_hand import within_d
from ..geometry import POCKET_AIMS, POCKETS
from ..planning import Planner, Positions, Strokes
from ..planning.stroke_columns import FARTHEST, LEAST, MOST
from ..planning.stroke_columns import NAMES as COLUMNS

STROKE = ("speed", "side", "top", "aim", "aim_at", "elevation", "place")  # fields that define a stroke


@dataclass(frozen=True, kw_only=True)
class CueStroke:
    """One stroke as a player intends it, immutable; ValueError for a number not finite or out of range.

    Parameters
    ----------
    speed, aim : float
        Cue speed [m/s], in [0.2, 7]; direction in which the cue ball leaves the tip [rad], anticlockwise from +x. Squirt is
        compensated, what the cloth does to the ball of a raised cue is not.
    side, top, elevation : float
        Tip offsets to the right and upwards over R, within a disc of radius 0.5; elevation of the butt [rad], to 30 degrees.
    place : (float, float), optional
        Where in the D a cue ball in hand is placed first [m]. Default None: it is played from where it lies.

    Examples
    --------
    >>> from snooker_env.advice import CueStroke
    >>> CueStroke(speed=1.8, aim=0.5, top=-0.2).to_dict()["top"]
    -0.2
    """

    speed: float
    aim: float
    side: float = 0.0
    top: float = 0.0
    elevation: float = 0.0
    place: Place | None = None

    def __post_init__(self) -> None:
        put = partial(object.__setattr__, self)
        for name, least, most in zip(COLUMNS, LEAST, MOST, strict=True):
            put(name, number(name, getattr(self, name), least, most))
        if hypot(self.side, self.top) > FARTHEST + 1e-9:
            allowed = f"must lie within the disc of radius {FARTHEST}"
            raise refuse_what("side, top", f"({self.side:g}, {self.top:g})", allowed)
        if self.place is not None:
            put("place", tuple(array("place", self.place, (2,)).tolist()))
            if not within_d(*self.place):
                place = f"({self.place[0]:g}, {self.place[1]:g})"
                raise refuse_what("place", place, "must be on or within the lines of the D")

    @classmethod
    def of(cls, stroke: "StrokeLike") -> "CueStroke":
        """Convert a dict of fields, or an object with such attributes; ValueError for one unknown, missing or out of range."""
        if isinstance(stroke, cls):
            return stroke
        names = [f.name for f in fields(cls)]
        if isinstance(stroke, Mapping):
            for key in stroke:
                choice("field of the stroke", key, names)
            values = dict(stroke)
        else:
            values = {name: getattr(stroke, name) for name in names if hasattr(stroke, name)}
        for name in ("speed", "aim"):
            if name not in values:
                what = f"a {type(stroke).__name__} without {name!r}"
                raise refuse_what("stroke", what, "must be a CueStroke or a dict of its fields")
        return cls(**values)

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as JSON types; ``CueStroke(**fields)`` makes the stroke again."""
        return asdict(self) | {"place": self.place and list(self.place)}

    def numbers(self) -> Floats:
        """Return float64 (5,): speed [m/s], side, top, aim [rad], elevation [rad]."""
        return np.array([self.speed, self.side, self.top, self.aim, self.elevation])

    def strokes(self) -> Strokes:
        """Return the stroke as ``Strokes`` of one row; their ``actions(env.options, position)`` is what an environment reads."""
        return Strokes(self.numbers()[None], np.array([self.place or (np.nan, np.nan)]))


StrokeLike: TypeAlias = CueStroke | Mapping[str, Any] | Any  # what ``CueStroke.of`` takes


def cue_strokes(strokes: Strokes, at: Positions) -> list[CueStroke]:
    """A player's strokes in the one position ``at``, with a place if the cue ball is in hand in the D."""
    in_hand, (here, *_) = bool(at.in_hand[0] & ~at.anywhere[0]), at.positions[0].tolist()
    out = []
    for (speed, side, top, aim, elevation), place in zip(strokes.values.tolist(), strokes.place, strict=True):
        shrink = max(1.0, hypot(side, top) / FARTHEST)  # as the strike itself keeps the tip on the disc
        put = None if not in_hand else tuple(here) if np.isnan(place).any() else tuple(place.tolist())
        tip = {"side": side / shrink, "top": top / shrink}
        out.append(CueStroke(speed=speed, aim=aim, **tip, elevation=elevation, place=put))
    return out


def read_object(raw: bytes) -> dict[str, Any]:
    """The JSON object in a body or a line; ValueError for others, NaN, Infinity and repeated names."""
    try:
        fields = strict_json(raw or b"{}")
    except ValueError as error:
        raise ValueError(f"the body must be JSON in UTF-8 ({error})") from None
    if not isinstance(fields, dict):
        raise ValueError("the body must be a JSON object")
    return fields


def read_stroke(fields: dict[str, Any], at: Positions, options: Any) -> CueStroke:
    """The stroke in a request from the one position ``at``, where the cue ball has been placed; ``aim_at`` is solved."""
    for name in ("speed",) if "aim_at" in fields else ("speed", "aim"):
        if name not in fields:
            form = '{"speed": m/s, "aim": rad, "side": 0, "top": 0, "elevation": 0}'
            raise refuse(name, None, f"must be given: {form}")
    if "aim_at" in fields and "aim" in fields:
        raise refuse("aim", fields["aim"], "must be left out with aim_at")
    aim = number("aim", fields.get("aim", 0.0), -1e6, 1e6)
    parts = {name: fields[name] for name in ("speed", "side", "top", "elevation") if name in fields}
    stroke = CueStroke(aim=aim, **parts)
    if "aim_at" not in fields:
        return stroke
    ball, pocket = _read_pot(fields["aim_at"], at)
    aims = Planner(options).pot_aim(at, [0], [ball], POCKET_AIMS[[pocket], :2], [stroke.numbers()])
    return replace(stroke, aim=float(aims[0]))


def _read_pot(asked: object, at: Positions) -> tuple[int, int]:
    """Ball and pocket of {"pot": [ball, pocket]}."""
    pair = asked.get("pot") if isinstance(asked, dict) and set(asked) == {"pot"} else None
    if not isinstance(pair, list) or len(pair) != 2:
        raise refuse("aim_at", asked, 'must be {"pot": [ball, pocket]}, as {"pot": ["blue", "middle right"]}')
    ball = NAMES.index(choice("aim_at.pot[0]", pair[0], NAMES[1:]))
    if not at.on_table[0, ball]:
        raise refuse("aim_at.pot[0]", NAMES[ball], "must be on the table")
    words = sorted(pair[1].lower().split()) if isinstance(pair[1], str) else None
    for pocket, name in enumerate(POCKETS):  # "right middle" is "middle right"
        if words == sorted(name.split()):
            return ball, pocket
    raise refuse("aim_at.pot[1]", pair[1], "must be one of " + ", ".join(map(repr, POCKETS)))


def read_place(field: str, value: object) -> tuple[float, float]:
    """Two numbers [m]; ValueError for anything else."""
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise refuse(field, value, "must be [x, y] in metres")
    return number(f"{field}[0]", value[0], -10, 10), number(f"{field}[1]", value[1], -10, 10)


def read_colour(field: str, value: object) -> int:
    return colour(choice(field, value, COLOUR_NAMES))
