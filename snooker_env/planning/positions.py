"""Which positions are strokes tried on? ``Positions``: arrays with one row for each."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, TypeAlias, overload

import numpy as np
from numpy.typing import NDArray

from .._lib.check import array, integer, refuse, refuse_what
from .._lib.jit import entry
from .._lib.types import Batches, Bools, Environment, FlagRows, Floats, Integers, Ints, Singles, Vectors
from ..game import frame_columns as columns
from ..game.balls import CUE, N_BALLS, BallOn, bits, mask_of_present
from ..game.frame import MOST_BREAK
from ..physics.conditions import COLUMNS as CONDITIONS
from ..physics.cue_room import EDGE
from ..physics.table import Table
from ..tasks.observations import FLAT, SIZE
from ..tasks.options import Rules
from ..tasks.tables import Tables
from ..tasks.visit import observe
from .position import Position, check_playable


@entry
def _balls_on(on_table, game, out):
    for k in range(len(out)):
        on = columns.strikeable(game[k], bits(on_table[k]))
        for i in range(N_BALLS):
            out[k, i] = (on >> i) & 1


def _flag(column: int, about: str, value: int | None = None) -> Any:
    """A property of ``Positions``: whether a column of the game has this value, or any but 0; without the column never."""

    def read(self: "Positions") -> Bools:
        if column >= self.game.shape[1]:
            return np.zeros(len(self), np.bool_)
        return self.game[:, column] != 0 if value is None else self.game[:, column] == value

    never = "; in visits never." if column >= columns.VISIT_COLUMNS else ""
    return property(read, doc=f"{about}, bool (m,){never}")


class Positions:
    """m positions, each with a stroke to play in a visit or in a frame, as arrays.

    Positions of frames are seen by the striker, who is player 0 in them. ``positions[3]`` is one ``Position``. Any other
    NumPy index (a slice, a mask, a list of rows) gives ``Positions``: a view for a slice, else a copy. ValueError if an
    array has the wrong shape or type, or a number is not finite; overlaps are refused when played.

    Parameters
    ----------
    positions, on_table : array_like
        float (m, 22, 2), centres [m] by id: 0 the cue ball, 1 to 15 the reds, 16 to 21 yellow to black; bool (m, 22).
    game : array_like
        int (m, 5), of visits: the ball on (a ``BallOn``), whether the cue ball is in hand, points of the
        visit, whether it is over, strokes so far. Or int (m, 33), of frames: ``snooker_env.game.frame_columns``.
    saved, conditions : optional
        Of frames: the balls before the last foul, ``Layouts``, which "replace" restores; float (m, 8), the constants of each
        table with ``conditions="drawn"``, in the order of ``physics.conditions.RANGES``.

    Examples
    --------
    >>> from snooker_env.planning import Position, Positions
    >>> position = Position(cue=(0.0, 0.0), reds=[(0.5, 0.5)])
    >>> batch = Positions.of([position, Position(cue=(0.0, 0.0), blue=(0.3, 0.3))])
    >>> len(batch), batch.ball_on.tolist(), batch[1].blue
    (2, [1, 5], (0.3, 0.3))
    """

    __slots__ = ("conditions", "game", "on_table", "positions", "saved")

    def __init__(
        self,
        positions: Batches,
        on_table: FlagRows,
        game: Sequence[Integers] | NDArray[np.integer[Any]],
        saved: columns.Layouts | None = None,
        conditions: Vectors | None = None,
    ):
        self.positions: Floats = _floats("positions", positions, (-1, N_BALLS, 2))
        m = len(self.positions)
        present, held = np.asarray(on_table), np.asarray(game)
        if present.shape != (m, N_BALLS) or present.dtype != np.bool_:
            allowed = f"must be bool of shape {(m, N_BALLS)}"
            raise refuse_what("on_table", f"{present.dtype} array of shape {present.shape}", allowed)
        visits, frames = (m, columns.VISIT_COLUMNS), (m, columns.COLUMNS)
        if held.shape not in (visits, frames) or held.dtype.kind not in "iu":
            allowed = f"must be integers of shape {visits}, or {frames} of frames"
            raise refuse_what("game", f"{held.dtype} array of shape {held.shape}", allowed)
        self.on_table: Bools = np.ascontiguousarray(present)
        self.game: Ints = np.ascontiguousarray(held, np.int64)
        self.saved: columns.Layouts | None = saved
        own = None if conditions is None else array("conditions", conditions, (m, CONDITIONS))
        self.conditions: Floats | None = own

    @classmethod
    def of(cls, source: "PositionsLike") -> "Positions":
        """Collect the positions that an object holds, as a copy; a ``Positions`` is returned as it is.

        An environment, of one table or many, wrapped or not, gives all current tables. Or a ``Position``, a visit's state,
        a dict of ``to_dict()``, or a list of these."""
        if isinstance(source, Positions):
            return source
        if isinstance(source, Position | Mapping):
            source = [source]
        some = source if isinstance(source, list | tuple) else ()
        if len(some) and all(isinstance(one, Position | Mapping) for one in some):
            positions, on_table, game = zip(*map(_arrays, some), strict=True)
            return cls(np.stack(positions), np.stack(on_table), np.stack(game))
        tables = getattr(bare(source), "tables", None)
        if isinstance(tables, Tables):
            return of_tables(tables)
        allowed = "must be Positions, a Position, a state, a list of these, or an environment"
        raise refuse_what("positions", f"a {type(source).__name__}", allowed)

    def __len__(self) -> int:
        return len(self.game)

    def __iter__(self) -> Iterator[Position]:
        return (self[k] for k in range(len(self)))

    @overload
    def __getitem__(self, rows: int) -> Position: ...

    @overload
    def __getitem__(self, rows: slice | list[int] | NDArray[Any]) -> "Positions": ...

    def __getitem__(self, rows: Any) -> "Position | Positions":
        if isinstance(rows, int | np.integer):
            one = self[[int(rows)]].as_visits()
            return Position.of_arrays(one.positions[0], one.on_table[0], one.game[0])
        taken = object.__new__(Positions)
        for name in ("positions", "on_table", "game"):
            # the kernels are compiled for contiguous arrays
            setattr(taken, name, np.ascontiguousarray(getattr(self, name)[rows]))
        saved, own = self.saved, self.conditions
        held: Any = saved and (np.ascontiguousarray(each[rows]) for each in saved)
        taken.saved = saved and columns.Layouts(*held)
        taken.conditions = None if own is None else np.ascontiguousarray(own[rows])
        return taken

    def __repr__(self) -> str:
        return f"Positions({len(self)} rows)"

    def copy(self) -> "Positions":
        """Return a copy with arrays of its own."""
        saved = None if self.saved is None else columns.Layouts(*(each.copy() for each in self.saved))
        own = self.positions.copy(), self.on_table.copy(), self.game.copy()
        return Positions(*own, saved, self.conditions)

    def as_visits(self) -> "Positions":
        """Return positions of visits, with ``game`` (m, 5), that share the balls' places; visits as they are.

        With a free ball any colour is on, which is right in all but what it scores. A cue ball that may stand anywhere is
        played from where it lies."""
        if not self.of_frames:
            return self
        game = columns.as_visits(self.game)[:, : columns.VISIT_COLUMNS]
        game[:, columns.STEPS] = 0
        return Positions(self.positions, self.on_table, game, None, self.conditions)

    def known_to(self, rules: Rules) -> "Positions":
        """Return them with the constants of the tables where these rules draw them; else without, for the nominal ones."""
        if rules.drawn or self.conditions is None:
            return self
        return Positions(self.positions, self.on_table, self.game, self.saved)

    @property
    def of_frames(self) -> bool:
        """Whether these are positions of frames, not of visits, a bool."""
        return self.game.shape[1] == columns.COLUMNS

    free_ball: Bools = _flag(columns.FREE_BALL, "Whether the striker has a free ball")
    anywhere: Bools = _flag(columns.ANYWHERE, "Whether the cue ball in hand may be placed anywhere")
    choice: Bools = _flag(columns.PHASE, "Whether the striker may choose what follows a foul", columns.CHOICE)
    lot: Bools = _flag(columns.PHASE, "Whether the striker may choose who begins, by lot", columns.LOT)
    miss_called: Bools = _flag(columns.MISS_CALLED, "Whether the opponent's foul was called a miss")
    respotted_black: Bools = _flag(columns.RESPOTTED_BLACK, "Whether the re-spotted black decides the frame")
    in_hand: Bools = _flag(columns.IN_HAND, "Whether the cue ball is in hand")
    over: Bools = _flag(columns.OVER, "Whether the visit has ended")

    @property
    def scores(self) -> Ints:
        """Scores of the striker and of the opponent, int64 (m, 2); in visits 0."""
        which = [columns.SCORE_0, columns.SCORE_1]
        return self.game[:, which] if self.of_frames else np.zeros((len(self), 2), np.int64)

    @property
    def ball_on(self) -> Ints:
        """What must be struck first, a ``BallOn``, without regard to a free ball: int64 (m,), a view."""
        return self.game[:, columns.BALL_ON]

    @property
    def points(self) -> Ints:
        """Points of each visit so far, int64 (m,); a view."""
        return self.game[:, columns.POINTS]

    @property
    def balls_on(self) -> Bools:
        """Which balls may be struck first, bool (m, 22); with a free ball all colours, too."""
        out = np.empty((len(self), N_BALLS), np.bool_)
        _balls_on(self.on_table, self.game, out)
        return out

    def observations(self) -> Singles:
        """The flat observation of each position, as ``observation="flat"`` of a visit: float32 (m, 121)."""
        out, game = np.empty((len(self), SIZE), np.float32), self.as_visits().game
        observe(np.arange(len(self)), self.positions, self.on_table, game, FLAT, out)
        return out


def _floats(field: str, values: object, shape: tuple[int, ...]) -> Floats:
    """``check.array``, but without a copy of an array that is valid already."""
    a = np.asarray(values)
    right = a.dtype == np.float64 and a.ndim == len(shape) and a.shape[1:] == shape[1:]
    plain = a.flags.c_contiguous and not isinstance(values, np.ma.MaskedArray)
    return a if right and plain and np.isfinite(a).all() else array(field, values, shape)


def _arrays(one: Any) -> tuple[Floats, Bools, Ints]:
    """The three arrays of a ``Position`` or a state."""
    if isinstance(one, Position):
        return one.arrays()
    names = ("positions", "on_table", "ball_on", "in_hand", "points", "over")
    if {"cue", "reds", "on"} & one.keys() and "positions" not in one:
        return Position.from_dict(one).arrays()
    if missing := [name for name in names if name not in one]:
        raise refuse_what("state", f"a dict without {missing}", "must be a state of get_state() of a visit")
    game = np.array([*(int(one[name]) for name in names[2:]), 0], np.int64)
    return np.asarray(one["positions"], np.float64), np.asarray(one["on_table"], np.bool_), game


def bare(env: object) -> Any:
    """The environment of this package inside all wrappers of Gymnasium, PettingZoo or Stable-Baselines3."""
    env = getattr(env, "unwrapped", env)
    inner = getattr(env, "tables", None)
    # SnookerVecEnv holds a SnookerVectorEnv
    return env if inner is None or isinstance(inner, Tables) else inner


def of_tables(tables: Tables) -> Positions:
    """The positions of an environment's tables, those of frames as their strikers see them."""
    game, own = tables.game.copy(), tables.conditions if tables.rules.drawn else None
    saved: columns.Layouts | None = getattr(tables, "layouts_before", None)
    if saved is None:
        game[:, columns.STEPS] = 0
        return Positions(tables.positions.copy(), tables.on_table.copy(), game, None, own)
    layouts = columns.Layouts(*(each.copy() for each in saved))
    return Positions(
        tables.positions.copy(), tables.on_table.copy(), columns.strikers_own(game), layouts, own
    )


_One: TypeAlias = Position | Mapping[str, Any]
PositionsLike: TypeAlias = Environment | Positions | _One | Sequence[_One]
"""The types that arguments called ``positions`` accept, see ``Positions.of``."""


def integers(field: str, values: Integers, low: int, high: int, n: int | None = None) -> Ints:
    """``values`` as int64 (n,); ValueError names the first that is not in [low, high]."""
    a = np.asarray(values)
    if a.ndim != 1 or (a.size and a.dtype.kind not in "iu") or (n is not None and len(a) != n):
        allowed = f"must be integers of shape ({'n' if n is None else n},)"
        raise refuse_what(field, f"{a.dtype} array of shape {a.shape}", allowed)
    for k in np.flatnonzero((a < low) | (a > high))[:1].tolist():
        integer(f"{field}[{k}]", int(a[k]), low, high)
    return np.ascontiguousarray(a, np.int64)


def check_rails(rails: Floats) -> Floats:
    """A copy of ``rails``, which kernels may take; ValueError unless they are those of ``Rules.rails``."""
    a = np.asarray(rails)
    if a.ndim != 1 or a.dtype != np.float64 or len(a) % EDGE or not np.isfinite(a).all():
        allowed = "must be Planner.rules.rails, or left out"
        raise refuse_what("rails", f"{a.dtype} array of shape {a.shape}", allowed)
    return a.copy()


def seeds_of(seeds: Integers, n: int) -> Ints:
    """The last 32 bits of ``seeds``, one for each of n positions: int64 (n,)."""
    return integers("seeds", seeds, -(2**63), 2**64 - 1, n) & 0xFFFFFFFF


def check_has_stroke(at: Positions, rows: Ints, table: Table, radius: float) -> None:
    """Raise ValueError unless each position in ``rows`` (n,) is valid and has a stroke to play."""
    used = np.unique(rows)
    some = at if len(used) == len(at) else at[used]
    on, present = some.ball_on, some.on_table
    reds, colours = present[:, 1:16].any(axis=1), present[:, 16:].any(axis=1)
    lowest = np.where(reds, int(BallOn.RED), 2 + present[:, 16:].argmax(axis=1))
    fine = present[:, CUE] & ~some.over & np.isfinite(some.positions).all(axis=(1, 2))
    fine &= np.where(on == int(BallOn.ANY_COLOUR), colours, (on == lowest) & (reds | colours))
    fine &= (some.points >= 0) & (some.points <= MOST_BREAK)
    if not fine.all():
        _refuse_row(at, int(used[np.argmin(fine)]))
    try:
        table.check(some.positions, radius, "positions", present)
    except ValueError:
        for k in used.tolist():  # for a message that names the row
            table.check(at.positions[k], radius, f"positions[{k}]", at.on_table[k])
        raise


def _refuse_row(at: Positions, k: int) -> None:
    """Raise the ValueError that says why there is no stroke to play from position k."""
    at_k = f"positions[{k}]"
    if at.over[k]:
        raise refuse(f"{at_k}.over", True, "must be False: the visit has ended, there is no stroke to play")
    if not np.isfinite(at.positions[k]).all():
        ball = int(np.argmin(np.isfinite(at.positions[k]).all(axis=1)))
        raise refuse(f"{at_k}, ball {ball}", at.positions[k, ball].tolist(), "must be finite")
    ball_on = int(at.ball_on[k])
    if not BallOn.NOTHING <= ball_on <= BallOn.BLACK:
        raise refuse(f"{at_k}.ball_on", ball_on, f"must be in [{int(BallOn.NOTHING)}, {int(BallOn.BLACK)}]")
    balls = f"mask {mask_of_present(at.on_table[k]):#x} of {at_k}.on_table"
    check_playable(at.on_table[k], BallOn(ball_on), on=f"{at_k}.ball_on", cue=f"{at_k}.cue", balls=balls)
    raise refuse(f"{at_k}.points", int(at.points[k]), f"must be in [0, {MOST_BREAK}]")
