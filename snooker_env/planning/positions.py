"""Which positions are strokes tried on? ``Positions``: arrays with one row for each, taken from environments, states or ``Position``."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, TypeAlias, overload

import numpy as np
from numpy.typing import NDArray

from .._check import array, refuse, refuse_what
from .._jit import entry
from .._types import Batches, Environment, FlagRows, Integers
from ..game.balls import CUE, N_BALLS, BallOn, balls_on_kernel, bits, mask_of_present
from ..game.frame import MOST_BREAK
from ..game.frame_columns import ANYWHERE, BALL_ON, FREE_BALL, IN_HAND, OVER, POINTS, STEPS, VISIT_COLUMNS
from ..physics.table import Table
from ..tasks.observations import SIZE
from ..tasks.tables import Tables
from ..tasks.visit import observe
from .position import Position, check_playable


@entry
def _balls_on(on_table, game, out):
    for k in range(len(out)):
        on = balls_on_kernel(game[k, BALL_ON], bits(on_table[k]))
        for i in range(N_BALLS):
            out[k, i] = (on >> i) & 1


class Positions:
    """m positions, each in the middle of a visit, as arrays.

    ``positions[3]`` is one ``Position``. Any other NumPy index (a slice, a mask, a list of rows) gives ``Positions``: a view for a
    slice, else a copy.

    Parameters
    ----------
    positions : array_like
        float (m, 22, 2). Centres of the balls [m], by id: 0 the cue ball, 1 to 15 the reds, 16 to 21 yellow to black.
    on_table : array_like
        bool (m, 22). Which balls are on the table.
    game : array_like
        int (m, 5). The ball on (a ``BallOn``), whether the cue ball is in hand, points of the visit, whether it is over, strokes so far.

    Raises
    ------
    ValueError
        If an array has the wrong shape or type, or a number is not finite. Overlapping balls are found when a position is played.

    Examples
    --------
    >>> from snooker_env.planning import Position, Positions
    >>> batch = Positions.of([Position(cue=(0.0, 0.0), reds=[(0.5, 0.5)]), Position(cue=(0.0, 0.0), blue=(0.3, 0.3))])
    >>> len(batch), batch.ball_on.tolist(), batch[1].blue
    (2, [1, 5], (0.3, 0.3))
    """

    __slots__ = ("game", "on_table", "positions")

    def __init__(self, positions: Batches, on_table: FlagRows, game: Sequence[Integers] | NDArray[np.integer[Any]]):
        self.positions: NDArray[np.float64] = _floats("positions", positions, (-1, N_BALLS, 2))
        m = len(self.positions)
        there, columns = np.asarray(on_table), np.asarray(game)
        if there.shape != (m, N_BALLS) or there.dtype != np.bool_:
            raise refuse_what("on_table", f"{there.dtype} array of shape {there.shape}", f"must be bool of shape {(m, N_BALLS)}")
        if columns.shape != (m, VISIT_COLUMNS) or columns.dtype.kind not in "iu":
            raise refuse_what("game", f"{columns.dtype} array of shape {columns.shape}", f"must be integers of shape {(m, VISIT_COLUMNS)}")
        self.on_table: NDArray[np.bool_] = np.ascontiguousarray(there)
        self.game: NDArray[np.int64] = np.ascontiguousarray(columns, np.int64)

    @classmethod
    def of(cls, source: "PositionsLike") -> "Positions":
        """Collect the positions that an object holds, as a copy; a ``Positions`` is returned as it is.

        Parameters
        ----------
        source : Env, VectorEnv, AECEnv, Positions, Position, dict, or sequence of Position and dict
            An environment, of one table or many, wrapped or not, gives its current tables, also those whose visit has ended. In an
            environment that plays whole frames or matches, the next stroke is treated as one of a visit. A dict is a state of a visit
            from ``get_state()``, or the result of ``Position.to_dict()``.

        Returns
        -------
        Positions
            One row for each table, position or state.

        Raises
        ------
        ValueError
            If the object holds no positions, or if the striker of a frame has a free ball, which visits do not have.

        Examples
        --------
        >>> import snooker_env as sn
        >>> env = sn.SnookerEnv()
        >>> _ = env.reset(seed=1)
        >>> at = sn.Positions.of(env)
        >>> len(at), bool((at.positions[0] == env.positions).all())
        (1, True)
        """
        if isinstance(source, Positions):
            return source
        if isinstance(source, Position | Mapping):
            source = [source]
        if isinstance(source, list | tuple) and source and all(isinstance(one, Position | Mapping) for one in source):
            positions, on_table, game = zip(*map(_arrays, source), strict=True)
            return cls(np.stack(positions), np.stack(on_table), np.stack(game))
        tables = getattr(bare(source), "tables", None)
        if isinstance(tables, Tables):
            return _of_tables(tables)
        raise refuse_what(
            "positions", f"a {type(source).__name__}", "must be Positions, a Position, a state, a list of these, or an environment"
        )

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
            return Position.of_arrays(self.positions[rows], self.on_table[rows], self.game[rows])
        taken = object.__new__(Positions)
        for name in self.__slots__:
            setattr(taken, name, np.ascontiguousarray(getattr(self, name)[rows]))  # the kernels are compiled for contiguous arrays
        return taken

    def __repr__(self) -> str:
        return f"Positions({len(self)} rows)"

    def copy(self) -> "Positions":
        """Return a copy with arrays of its own.

        Returns
        -------
        Positions
            The copy.

        Examples
        --------
        >>> from snooker_env.planning import Position, Positions
        >>> at = Positions.of(Position(cue=(0.0, 0.0), black=(0.0, 1.4605)))
        >>> at.copy().positions is at.positions
        False
        """
        return Positions(self.positions.copy(), self.on_table.copy(), self.game.copy())

    @property
    def ball_on(self) -> NDArray[np.int64]:
        """What must be struck first, int64 (m,): a ``BallOn`` for each row; a view."""
        return self.game[:, BALL_ON]

    @property
    def in_hand(self) -> NDArray[np.bool_]:
        """Whether the cue ball is in hand, bool (m,)."""
        return self.game[:, IN_HAND] != 0

    @property
    def points(self) -> NDArray[np.int64]:
        """Points of each visit so far, int64 (m,); a view."""
        return self.game[:, POINTS]

    @property
    def over(self) -> NDArray[np.bool_]:
        """Whether the visit has ended, bool (m,)."""
        return self.game[:, OVER] != 0

    @property
    def balls_on(self) -> NDArray[np.bool_]:
        """Which balls may be struck first, bool (m, 22)."""
        out = np.empty((len(self), N_BALLS), np.bool_)
        _balls_on(self.on_table, self.game, out)
        return out

    def observations(self) -> NDArray[np.float32]:
        """Return the flat observation of each position, as ``Snooker-v0`` returns it with ``task="visit"``.

        Returns
        -------
        numpy.ndarray
            float32 (m, 121).

        Examples
        --------
        >>> import snooker_env as sn
        >>> env = sn.SnookerEnv()
        >>> observation, _ = env.reset(seed=1)
        >>> bool((sn.Positions.of(env).observations()[0] == observation).all())
        True
        """
        out = np.empty((len(self), SIZE), np.float32)
        observe(np.arange(len(self)), self.positions, self.on_table, self.game, out)
        return out


def _floats(field: str, values: Any, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """``_check.array``, but without a copy of an array that is valid already."""
    a = np.asarray(values)
    sound = a.dtype == np.float64 and a.ndim == len(shape) and a.shape[1:] == shape[1:] and a.flags.c_contiguous and np.isfinite(a).all()
    return a if sound and not isinstance(values, np.ma.MaskedArray) else array(field, values, shape)


def _arrays(one: Any) -> tuple[NDArray[np.float64], NDArray[np.bool_], NDArray[np.int64]]:
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


def bare(env: Any) -> Any:
    """The environment of this package inside all wrappers of Gymnasium, PettingZoo or Stable-Baselines3."""
    env = getattr(env, "unwrapped", env)
    inner = getattr(env, "tables", None)
    return env if inner is None or isinstance(inner, Tables) else inner  # SnookerVecEnv holds a SnookerVectorEnv


def _of_tables(tables: Tables) -> Positions:
    """The positions of an environment's tables; in a frame the next stroke is treated as one of a visit.

    A cue ball that may be placed anywhere on the table is played from where it lies: a visit has no ball in hand outside the D.
    """
    game = tables.game[:, :VISIT_COLUMNS].copy()
    game[:, STEPS] = 0
    if tables.game.shape[1] > FREE_BALL:
        if (free := tables.game[:, FREE_BALL] != 0).any():
            field = f"free ball on table {int(np.argmax(free))}"
            raise refuse(field, True, "must be False: a planned stroke is judged as one of a visit, which has no free ball")
        game[tables.game[:, ANYWHERE] != 0, IN_HAND] = 0
    return Positions(tables.positions.copy(), tables.on_table.copy(), game)


PositionsLike: TypeAlias = Environment | Positions | Position | Mapping[str, Any] | Sequence[Position | Mapping[str, Any]]
"""The types that arguments called ``positions`` accept, see ``Positions.of``."""


def rows_of(at: Positions, rows: Integers, n: int | None = None) -> NDArray[np.int64]:
    """``rows`` as an int64 array (n,). ValueError unless each is a row of the positions."""
    a = np.asarray(rows)
    if a.size == 0:
        a = a.astype(np.int64)
    if a.ndim != 1 or a.dtype.kind not in "iu" or (n is not None and len(a) != n):
        want = "(n,)" if n is None else f"({n},)"
        raise refuse_what("rows", f"{a.dtype} array of shape {a.shape}", f"must be integers of shape {want}")
    wrong = (a < 0) | (a >= len(at))
    if wrong.any():
        i = int(np.argmax(wrong))
        raise refuse(f"rows[{i}]", int(a[i]), f"must be in [0, {len(at)}): a row of the positions")
    return np.ascontiguousarray(a, np.int64)


def check_played(at: Positions, rows: NDArray[np.int64], table: Table, radius: float) -> None:
    """Raise ValueError unless every position named in ``rows`` (n,) is valid on the table and has a stroke to play."""
    used = np.unique(rows)
    some = at if len(used) == len(at) else at[used]
    on, there = some.ball_on, some.on_table
    colours = there[:, 16:]
    reds = there[:, 1:16].any(axis=1)
    lowest = np.where(reds, int(BallOn.RED), 2 + colours.argmax(axis=1))
    fine = there[:, CUE] & ~some.over & np.isfinite(some.positions).all(axis=(1, 2))
    fine &= np.where(on == int(BallOn.ANY_COLOUR), colours.any(axis=1), (on == lowest) & (reds | colours.any(axis=1)))
    fine &= (some.points >= 0) & (some.points <= MOST_BREAK)
    if not fine.all():
        k = int(used[np.argmin(fine)])
        _refuse_row(at, k)
    try:
        table.check(some.positions, radius, "positions", there)
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
