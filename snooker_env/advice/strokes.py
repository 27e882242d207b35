"""What is one stroke? ``CueStroke``: speed, tip, aim, elevation and place; validated, and as an action."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from functools import partial
from math import hypot
from typing import Any, TypeAlias, overload

import numpy as np

from .._lib.check import array, choice, number, refuse_what
from .._lib.types import Floats, Place
from ..game.in_hand import within_d
from ..planning import Position, Positions
from ..planning.stroke_columns import FARTHEST, LEAST, MOST, NAMES
from ..planning.strokes import Strokes
from ..replays.words import errors_words
from .room import Room


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


@dataclass(frozen=True, kw_only=True)
class Suggestion(CueStroke):
    """A stroke, what it does when played as intended, and its outcomes under execution errors.

    Attributes
    ----------
    speed, aim, side, top, elevation, place
        As in ``CueStroke``.
    room : Room
        How the cue finds room for it: ``cue="real"`` may raise it and move its tip.
    kind : {"pot", "contact", "safety", "escape", "in-off", "foul"}
        What the stroke does without errors. "pot": it scores. "contact": it hits a ball on fairly and scores nothing;
        "safety" in a frame, where that is judged; "escape" where no straight path leads to a ball on. "in-off": it loses
        the cue ball. "foul": any other foul.
    ball, pocket, first : int
        Id of the ball that it pots without errors or, if none, strikes first or plays away from, and its pocket, an
        index into ``snooker_env.POCKETS``; id of the ball that it strikes first. -1 if none.
    chance : float
        Of a pot: the share of the samples in which that ball went into that pocket without a foul; of another stroke, the
        share without a foul.
    chance_interval : (float, float)
        Wilson's 95 % interval of the chance; without noise, the chance itself twice.
    points, points_interval : float, (float, float)
        Expected points of the visit from this stroke on, continued by the fast player of
        ``snooker_env.advice.visits``, and the 95 % interval of that mean by the sampling error.
    foul, in_off : float
        Shares of the samples with a foul, and in which the cue ball was potted.
    stops : (float, float) or None
        Mean stopping point of the cue ball [m] where it stayed on the table; None if it never did.
    spread : float or None
        Root of the mean square distance from that point [m].
    win, win_interval, against, replies, leaves, snookers : float, (float, float), float, float, float, float or None
        Of a frame, else None, see docs/play/advice.md: the chance to win it and the 95 % interval by the sampling error; of the first
        stroke the chance to win of the best one of the other sort; where the opponent comes to the table, the share of its
        next visits in which it pots, their mean points, and how often it is snookered (None if it never comes).
    words : str
        All this in one line of text.

    Examples
    --------
    >>> import snooker_env as sn
    >>> position = sn.Position(cue=(0.3, 1.1), black=(0.0, 1.4605))
    >>> suggestion = sn.advise(position, agent="search", noise="none", n=1)[0]
    >>> suggestion.kind, suggestion.chance
    ('pot', 1.0)
    >>> print(suggestion)  # doctest: +ELLIPSIS
    black, top left, ... m/s, ..., pot 100 %, 7 points expected
    """

    room: Room
    kind: str
    ball: int
    pocket: int
    first: int
    chance: float
    chance_interval: tuple[float, float]
    points: float
    points_interval: tuple[float, float]
    foul: float
    in_off: float
    stops: Place | None
    spread: float | None
    words: str
    win: float | None = None
    win_interval: tuple[float, float] | None = None
    against: float | None = None
    replies: float | None = None
    leaves: float | None = None
    snookers: float | None = None

    @property
    def figure(self) -> float:
        """What it is ordered by: in a frame the chance to win, else a pot's points, or the share without a foul."""
        return self.win if self.win is not None else self.points if self.kind == "pot" else self.chance

    @property
    def stroke(self) -> CueStroke:
        """The stroke alone, a ``CueStroke``."""
        return CueStroke.of({field.name: getattr(self, field.name) for field in fields(CueStroke)})

    def to_dict(self) -> dict[str, Any]:
        """Return all attributes by name as JSON types; pairs as lists."""
        kept = {name: list(x) if isinstance(x, tuple) else x for name, x in asdict(self).items()}
        return kept | {"room": self.room.to_dict()}

    def __str__(self) -> str:
        return self.words


@dataclass(frozen=True, kw_only=True)
class Advice(Sequence[Suggestion]):
    """The strokes that an agent would play in a position, best first: a sequence of ``Suggestion``.

    Attributes
    ----------
    suggestions : tuple of Suggestion
        The strokes.
    position : Position
        The position.
    scores : (int, int) or None
        Of a frame: the scores of the striker and of the other.
    agent : str
        Name of the agent.
    own : bool
        Whether the strokes are the agent's own; False where none is fair, so that others were judged, too.
    noise : str or dict
        Execution errors: a level's name, or the fields of ``Noise``.
    samples, visits, seed : int
        As in ``advise``.

    Examples
    --------
    >>> import snooker_env as sn
    >>> position = sn.Position(cue=(0.3, 1.1), black=(0.0, 1.4605))
    >>> advice = sn.advise(position, agent="search", noise="none", n=1)
    >>> len(advice), advice.agent
    (1, 'search')
    >>> print(advice)  # doctest: +ELLIPSIS
    Pots by points expected, without errors:
    1. black, top left, ... m/s, ..., pot 100 %, 7 points expected
    """

    suggestions: tuple[Suggestion, ...]
    position: Position
    scores: tuple[int, int] | None
    agent: str
    own: bool
    noise: str | dict[str, float]
    samples: int
    visits: int
    seed: int

    def __len__(self) -> int:
        return len(self.suggestions)

    @overload
    def __getitem__(self, index: int) -> Suggestion: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[Suggestion, ...]: ...

    def __getitem__(self, index: int | slice) -> Suggestion | tuple[Suggestion, ...]:
        return self.suggestions[index]

    @property
    def order(self) -> str:
        """Whose strokes these are if not the agent's own, by what they are ordered, and with whose errors, in words."""
        whose = "" if self.own else f"{self.agent} has no fair stroke here; these are not its own. "
        errors = errors_words(self.noise)
        if self.scores is not None:
            return f"{whose}By chance to win, {errors}:"
        by = {True: "pots by points expected", False: "strokes without a pot by how often they are fair"}
        parts = ", then ".join(by[pot] for pot in dict.fromkeys(one.kind == "pot" for one in self))
        return f"{whose}{parts.capitalize()}, {errors}:"

    def to_dict(self) -> dict[str, Any]:
        """Return all attributes by name as JSON types; the position and the suggestions as dicts."""
        names = ("agent", "own", "order", "noise", "samples", "visits", "seed")
        kept = {"position": self.position.to_dict(), **{name: getattr(self, name) for name in names}}
        kept["scores"] = self.scores and list(self.scores)
        return {**kept, "suggestions": [one.to_dict() for one in self]}

    def __str__(self) -> str:
        return "\n".join([self.order, *(f"{k}. {one.words}" for k, one in enumerate(self, 1))])
