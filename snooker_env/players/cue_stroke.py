"""What is one stroke? ``CueStroke``: speed, tip, aim, elevation and place; validated, and as an action."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from functools import partial
from math import hypot
from typing import Any, TypeAlias

import numpy as np

from .._lib.check import array, choice, number, refuse_what
from .._lib.types import Floats, Place
from ..game.in_hand import within_d
from ..planning import Positions
from ..planning.stroke_columns import FARTHEST, LEAST, MOST, NAMES
from ..planning.strokes import Strokes


@dataclass(frozen=True, kw_only=True)
class CueStroke:
    """One stroke as a player intends it, immutable; ValueError for a number not finite or out of range.

    Parameters
    ----------
    speed : float
        Cue speed [m/s], in [0.2, 7].
    aim : float
        Direction in which the cue ball leaves the tip [rad], anticlockwise from +x, as ``aim="absolute"`` of
        an action. Squirt is compensated: with side, the cue points in a slightly different direction. What
        the cloth does to the ball of a raised cue is not.
    side, top : float
        Tip offsets to the right and upwards over R, as the player sees it, within a disc of radius 0.5.
    elevation : float
        Elevation of the butt [rad], from 0 to 30 degrees.
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
        for name, least, most in zip(NAMES, LEAST, MOST, strict=True):
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
        """Convert a dict with fields of ``CueStroke``, or an object with such attributes, to a ``CueStroke``.

        ValueError if a field is unknown, missing or out of range."""
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
        return Strokes(
            self.numbers()[None], np.array([(np.nan, np.nan) if self.place is None else self.place])
        )


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
