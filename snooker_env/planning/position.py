"""How is a position written down? ``Position``: balls by name, the ball on; the kernels' arrays."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import InitVar, asdict, dataclass, fields
from functools import partial, wraps
from pathlib import Path
from typing import Any

import numpy as np

from .._lib.check import array, choice, integer, refuse, refuse_what, truth
from .._lib.files import in_file, read_json, write_atomic
from .._lib.types import Bools, Flags, Floats, Integers, Ints, Place, Vectors
from ..game.balls import COLOUR_NAMES, CUE, N_REDS, SPOTS, BallOn, check_ball_on, mask_of_present, next_on
from ..game.frame import MOST_BREAK
from ..game.in_hand import place_cue, within_d
from ..geometry import BALL_RADIUS
from ..physics.table import Table, TableLike

ON = tuple(ball.name.lower() for ball in BallOn)  # the names of all values of "on"


@dataclass(frozen=True, kw_only=True)
class Position:
    """The balls on a table in the middle of a visit, by name: validated when it is made, and immutable. ValueError if a
    ball is off the table, in a cushion or over a pocket, if balls overlap, or the ball on is wrong.

    Parameters
    ----------
    cue : (float, float), optional
        Centre of the cue ball [m] from the table's centre, +x to the yellow side, +y to the black end. Left
        out with ``in_hand=True``, it lies at the free place of the D nearest to (0.18, -1.0475).
    reds : sequence of (float, float), optional
        Up to 15 centres [m], which get the ids 1, 2, ... in this order.
    yellow, green, brown, blue, pink, black : (float, float), optional
        Centres [m]. A ball that is left out is off the table.
    on : str, optional
        What must be struck first: "red", "any_colour" (a red was just potted), or the name of a colour.
        Default: "red" while there is a red, else the lowest colour.
    in_hand, over, points : bool, bool, int, optional
        Whether the cue ball may be placed in the D before the stroke; whether the visit has ended: then
        anything may be on, and the cue ball may be missing; points of the visit so far, in [0, 155].
    table : str, Table or None, optional
        The table that the balls must fit on, not stored; None: unbounded cloth.

    Examples
    --------
    >>> from snooker_env.planning import Position
    >>> Position(cue=(0.0, -0.6), reds=[(0.3, 0.5)], black=(0.0, 1.4605)).on
    'red'
    """

    cue: Place | None = None
    reds: Sequence[Place] = ()
    yellow: Place | None = None
    green: Place | None = None
    brown: Place | None = None
    blue: Place | None = None
    pink: Place | None = None
    black: Place | None = None
    on: str | None = None
    in_hand: bool = False
    points: int = 0
    over: bool = False
    table: InitVar[TableLike] = "match"

    def __post_init__(self, table: TableLike) -> None:
        put = partial(object.__setattr__, self)
        put("in_hand", truth("in_hand", self.in_hand))
        put("over", truth("over", self.over))
        put("points", integer("points", self.points, 0, MOST_BREAK))
        for name in ("cue", *COLOUR_NAMES):
            if getattr(self, name) is not None:
                put(name, tuple(array(name, getattr(self, name), (2,)).tolist()))
        none = isinstance(self.reds, Sequence | np.ndarray) and not len(self.reds)
        reds = np.empty((0, 2)) if none else array("reds", self.reds, (-1, 2))
        if len(reds) > N_REDS:
            raise refuse_what("reds", f"{len(reds)} places", f"must be at most {N_REDS}")
        put("reds", tuple(map(tuple, reds.tolist())))
        positions, on_table = self._layout()
        if not (self.over or self.on or on_table[1:].any()):
            raise refuse_what("reds and colours", "no ball", "must hold at least one, unless over=True")
        if self.cue is None and self.in_hand and not self.over:
            on_table[CUE] = True
            positions[CUE] = place_cue(positions, on_table, *SPOTS[CUE].tolist())
            put("cue", tuple(positions[CUE].tolist()))
        _check_layout(positions, on_table, Table.of(table))
        put("on", _name_on(self.on, mask_of_present(on_table)))
        if not self.over:
            on = BallOn[str(self.on).upper()]
            check_playable(on_table, on, on="on", cue="cue", balls="the balls given")
            x, y = positions[CUE]
            if self.in_hand and not within_d(x, y):
                what = f"must be False with the cue ball at ({x:g}, {y:g}), outside the D"
                raise refuse("in_hand", True, what)

    def _layout(self) -> tuple[Floats, Bools]:
        positions, on_table = np.zeros(SPOTS.shape), np.zeros(len(SPOTS), np.bool_)
        colours = [getattr(self, name) for name in COLOUR_NAMES]
        spare = [None] * (N_REDS - len(self.reds))
        for ball, place in enumerate([self.cue, *self.reds, *spare, *colours]):
            if place is not None:
                positions[ball], on_table[ball] = place, True
        return positions, on_table

    def arrays(self) -> tuple[Floats, Bools, Ints]:
        """Return its rows of the arrays of a ``Positions``: positions (22, 2), on_table (22,) and game (5,)."""
        game = np.array([BallOn[str(self.on).upper()], self.in_hand, self.points, self.over, 0], np.int64)
        return *self._layout(), game

    @classmethod
    def of_arrays(cls, positions: Vectors, on_table: Flags, game: Integers) -> "Position":
        """Make the ``Position`` of one table's arrays, see ``arrays``; reds are numbered anew."""
        places, present = np.asarray(positions, np.float64).tolist(), np.asarray(on_table, np.bool_).tolist()
        ball_on, in_hand, points, over = np.asarray(game).tolist()[:4]
        balls: dict[str, Any] = {_name(i): tuple(places[i]) for i in (CUE, *_COLOURS) if present[i]}
        balls["reds"] = tuple(tuple(places[i]) for i in range(1, N_REDS + 1) if present[i])
        visit = {"in_hand": bool(in_hand), "points": points, "over": bool(over)}
        return cls(**balls, on=BallOn(ball_on).name.lower(), **visit, table=None)

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as JSON types, without balls off the table; ``from_dict`` reads them."""
        kept = asdict(self) | {"reds": [list(place) for place in self.reds]}
        for name in ("cue", *COLOUR_NAMES):
            kept[name] = kept[name] and list(kept[name])
        return {name: value for name, value in kept.items() if value is not None}

    @classmethod
    def from_dict(cls, kept: Mapping[str, Any], *, table: TableLike = "match") -> "Position":
        """Make the position that a dict of ``to_dict`` describes; ValueError for an unknown key."""
        return cls(**_check(kept), table=table)

    def save(self, path: str | Path) -> None:
        """Write the position as JSON. An existing file is replaced in one step: it is never half written."""
        write_atomic(path, json.dumps(self.to_dict()) + "\n")

    @classmethod
    def load(cls, path: str | Path, *, table: TableLike = "match") -> "Position":
        """Read a file of ``save``, or one written by hand; ValueError names what is wrong in it."""
        with in_file(path):
            return cls(**_check(read_json(path), str(path)), table=table)


_NAMES = tuple(f.name for f in fields(Position))  # keys that a position in JSON may have
_COLOURS = range(N_REDS + 1, len(SPOTS))
_MADE = Position.__init__


@wraps(_MADE)
def _init(self: Position, *args: Any, **fields_: Any) -> None:
    """``Position.__init__`` whose TypeError says that the reds are one list."""
    for name in fields_:
        if name not in (*_NAMES, "table"):
            hint = "; the reds are one list, reds=[(x, y), ...]" if name.startswith("red") else ""
            raise TypeError(f"Position got an unexpected keyword argument {name!r}{hint}")
    _MADE(self, *args, **fields_)


Position.__init__ = _init


def _name_on(on: object, balls: int) -> str:
    if on is None:
        return BallOn(next_on(balls)).name.lower()
    if isinstance(on, BallOn):
        return on.name.lower()
    return choice("on", on.strip().lower().replace(" ", "_") if isinstance(on, str) else on, ON)


def _name(ball: int) -> str:
    if ball == CUE:
        return "cue"
    return f"reds[{ball - 1}]" if ball <= N_REDS else COLOUR_NAMES[ball - N_REDS - 1]


def _check_layout(positions: Floats, on_table: Bools, table: Table) -> None:
    """Raise ValueError, naming the ball, unless the balls fit on the table."""
    for ball in np.flatnonzero(on_table).tolist():
        try:
            table.check(positions[ball : ball + 1], BALL_RADIUS, _name(ball))
        except ValueError as error:
            raise ValueError(str(error).replace(f"{_name(ball)}[0] = ", f"{_name(ball)} = ", 1)) from None
        others = np.flatnonzero(on_table[:ball])
        apart = np.hypot(*(positions[others] - positions[ball]).T)
        if len(others) and 2 * BALL_RADIUS - apart.min() > 1e-6:
            other, place = int(others[apart.argmin()]), tuple(positions[ball].tolist())
            at, much = tuple(positions[other].tolist()), 2 * BALL_RADIUS - apart.min()
            what = f"overlaps {_name(other)} at {at} by {much:.3g} m, at most 1e-06 is allowed"
            raise refuse(_name(ball), place, what)


def check_playable(on_table: Bools, ball_on: BallOn, *, on: str, cue: str, balls: str) -> None:
    """Raise ValueError, with these names of fields, unless there is a stroke to play."""
    present = mask_of_present(on_table)
    if not present & 1:
        raise refuse(cue, None, "must be on the table while the visit goes on")
    check_ball_on(on, ball_on, present, balls)


def _check(raw: object, field: str = "position") -> Mapping[str, Any]:
    """A dict of JSON types that has keys of ``names`` only and no truth values where numbers belong."""
    if not isinstance(raw, Mapping):
        allowed = f"must be a dict with keys of {', '.join(_NAMES)}"
        raise refuse_what(field, f"a {type(raw).__name__}", allowed)
    for key in raw:
        choice(f"key of {field}", key, _NAMES)
    for key, value in raw.items():
        one = value if isinstance(value, list | tuple) else ()
        places = [part for part in one if isinstance(part, list | tuple)] or [one]
        if any(isinstance(x, bool) for place in places for x in place):  # NumPy converts them to 0 and 1
            raise refuse(key, value, "must be two real numbers" + (" for each ball" if key == "reds" else ""))
    return raw
