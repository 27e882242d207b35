"""What bounds the balls? A ``Table``: straight noses, jaw arcs and the falls of the pockets, checked, as arrays for the kernels.

World frame as in ``geometry``, which says where everything lies. What is behind the arcs needs no shape: the throat goes on straight,
and a ball that touches it there is lost (``pocket.py``).
"""

from dataclasses import dataclass, field
from math import hypot, inf, sqrt
from typing import Any, Literal, TypeAlias

import numpy as np

from .._check import array, choice, number, refuse, refuse_what
from .._jit import entry
from .._types import Batches, FlagRows, Flags, Floats, TableName, Vectors
from ..geometry import PRESETS, Bed, Pocket, parts
from .bounds import bounds_of, deepest, narrowest
from .columns import (
    FALL_RADIUS,
    FALL_X,
    FALL_Y,
    JAW_COS,
    JAW_RADIUS,
    JAW_UX,
    JAW_UY,
    JAW_X,
    JAW_Y,
    NOSE_AXIS,
    NOSE_HIGH,
    NOSE_LEVEL,
    NOSE_LOW,
    NOSE_SIDE,
)
from .shapes import check_fit, check_shapes

MOUTH = 0.012
"""How far past the line of the noses [m] a ball may lie still, unless a table's pockets let it lie deeper: just so far between the jaw and
the fall of a middle pocket of snooker."""
PLAY = 1e-3
"""Facing noses must be at least this much [m] further apart than a ball is wide."""
OVERLAP_ALLOWED = 1e-6
"""Input positions may overlap a ball or cushion by this much [m]: layouts printed to a micrometre. They count as touching."""
SAME_BALL = 1e-9
"""A ball's radius may differ by this much [m] from the one that a table is made for."""


@dataclass(frozen=True, eq=False)
class Table:
    """A table's shape: one with a name, ``Table.preset("match")``, a rectangular one, ``Table.rectangular``, or any from the arrays below.

    A preset is the one object of its name, also after pickling and copying; a table of your own stays what it is whatever it is called.

    Parameters
    ----------
    name : str
        What it is called in messages.
    noses : float64 (k, 5)
        Straight noses: axis (0: x, 1: y), side (+-1), level [m], and the range lo, hi [m] along the other axis. The ball touches where
        side * coordinate = level - R.
    jaws : float64 (k, 6)
        Jaw arcs: centre x, y, radius [m], unit vector to the arc's middle, cosine of its half angle.
    falls : float64 (k, 3)
        Falls: centre x, y, radius [m] of the slate's edge; a ball whose centre crosses it begins to drop. Index = pocket.
    ball_radius : float, optional
        The ball [m] that it is made for, which ``physics.R`` must then be; None: any ball.
    pockets : tuple of str
        The names of its pockets, one a fall, or ().

    Attributes
    ----------
    bounds : float64 (2, 2)
        Between which lines [m] the balls lie: of x and of y the levels of the outermost noses, infinite where there is none.

    Raises
    ------
    ValueError
        If an array has another shape, or holds a nose, jaw or fall that makes no sense.

    Examples
    --------
    >>> import numpy as np
    >>> import snooker_env as sn
    >>> wall = sn.Table("wall", np.array([(0, 1, 0.5, -1.0, 1.0)]), np.empty((0, 6)), np.empty((0, 3)))  # a nose at x = 0.5
    >>> bool(sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], [(0.0, 0.0, 0.0)], wall).positions[0, 0] < 0.47)
    True
    """

    name: str
    noses: Floats
    jaws: Floats
    falls: Floats
    ball_radius: float | None = field(default=None, kw_only=True)
    pockets: tuple[str, ...] = field(default=(), kw_only=True)
    bounds: Floats = field(init=False, repr=False)
    _narrowest: tuple[float, int, int] = field(init=False, repr=False)
    _reaches: dict[float, Floats] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if not isinstance(self.name, str):
            raise refuse("table.name", self.name, "must be a str")
        for name, columns in (("noses", 5), ("jaws", 6), ("falls", 3)):
            a = array(f"table.{name}", getattr(self, name), (-1, columns))
            a.setflags(write=False)
            object.__setattr__(self, name, a)
        check_shapes(self.noses, self.jaws, self.falls)
        if self.ball_radius is not None:
            object.__setattr__(self, "ball_radius", number("table.ball_radius", self.ball_radius, 1e-3, 1))
        names = self.pockets
        if not isinstance(names, tuple) or not all(isinstance(name, str) for name in names) or len(names) not in (0, len(self.falls)):
            raise refuse("table.pockets", names, f"must be a tuple of {len(self.falls)} names, one a fall, or ()")
        bounds = bounds_of(self.noses)
        bounds.setflags(write=False)
        object.__setattr__(self, "bounds", bounds)
        object.__setattr__(self, "_narrowest", narrowest(self.noses))
        object.__setattr__(self, "_reaches", {})

    @classmethod
    def preset(cls, name: TableName = "match") -> "Table":
        """A table by its name. Each is made for the balls of its game, see ``ball``.

        Parameters
        ----------
        name : {"match", "tight", "uk8", "pool9", "carom"}
            Snooker: "match" (throat of the corners 86.0 mm) and "tight" (80.14 mm), 3.569 x 1.778 m, balls of 52.5 mm. "uk8": UK 8-ball
            pool, 7 ft x 3 ft 6 in, balls of 2 in; its pockets are an estimate. "pool9": pool, 100 x 50 in, balls of 2 1/4 in. "carom":
            2.84 x 1.42 m, no pockets, balls of 61.5 mm. Sources: ``snooker_env.geometry``.

        Returns
        -------
        Table

        Raises
        ------
        ValueError
            For an unknown name.

        Examples
        --------
        >>> import snooker_env as sn
        >>> sn.Table.preset("pool9").pockets[0]
        'bottom left'
        """
        return _PRESETS[choice("table", name, PRESETS)]

    @classmethod
    def rectangular(
        cls, length: float, width: float, *, pockets: Literal[6, 4, 0] = 6, corner: Pocket | None = None, middle: Pocket | None = None,
        ball_radius: float | None = None, name: str = "rectangular",
    ) -> "Table":  # fmt: skip
        """A rectangular table of your own with straight noses on its four sides.

        Parameters
        ----------
        length, width : float
            Between facing noses [m], in (0, 100]: ``length`` along y, ``width`` along x. The origin is in the middle.
        pockets : {6, 4, 0}
            Four corners and the middles of the sides along y, corners only, or none. They are numbered anticlockwise from (-x, -y);
            ``Table.pockets`` has their names.
        corner, middle : Pocket, optional
            Their shapes: ``Pocket.corner(...)``, ``Pocket.middle(...)``. None: those of snooker's match table.
        ball_radius : float, optional
            The ball [m] that it is made for, in [0.001, 1]: shots with another ``physics.R`` are refused. None: any ball.
        name : str
            What it is called in messages.

        Returns
        -------
        Table

        Raises
        ------
        ValueError
            Where sizes do not fit together: jaws that overlap along a rail, a pocket narrower than the ball.

        Examples
        --------
        >>> import snooker_env as sn
        >>> table = sn.Table.rectangular(2.0, 1.0, pockets=4, ball_radius=0.025)
        >>> sn.simulate([(0.0, 0.0)], [(1.0, 0.5)], [(0.0, 0.0, 0.0)], table, {"R": 0.025}).potted
        array([-1])
        """
        length = number("table.length", length, 0, 100, open_low=True)
        width = number("table.width", width, 0, 100, open_low=True)
        if not isinstance(pockets, (int, np.integer)) or pockets not in (6, 4, 0):
            raise refuse("table.pockets", pockets, "must be 6, 4 or 0")
        shapes = []
        for field_name, shape, is_middle, there in (("corner", corner, False, pockets > 0), ("middle", middle, True, pockets == 6)):
            if shape is not None and not there:
                raise refuse(f"table.{field_name}", shape, f"must be None on a table with {pockets} pockets")
            if shape is not None and (not isinstance(shape, Pocket) or shape.is_middle != is_middle):
                raise refuse(f"table.{field_name}", shape, f"must be a Pocket made by Pocket.{field_name}, or None for snooker's")
            shapes.append((shape or getattr(PRESETS["match"], field_name)) if there else None)
        if ball_radius is not None:
            ball_radius = number("table.ball_radius", ball_radius, 1e-3, 1)
        bed = Bed(length=length, width=width, corner=shapes[0], middle=shapes[1], ball={})
        check_fit(bed, ball_radius)
        return cls(name, *parts(bed), ball_radius=ball_radius, pockets=bed.pockets)

    @classmethod
    def of(cls, table: "TableLike") -> "Table":
        """What users may pass as ``table``.

        Parameters
        ----------
        table : str, Table or None
            A preset's name, a table, or None: unbounded cloth.

        Returns
        -------
        Table

        Raises
        ------
        ValueError
            For anything else.
        """
        if table is None:
            return UNBOUNDED
        if isinstance(table, cls):
            return table
        if isinstance(table, str):
            return cls.preset(table)
        raise refuse("table", table, f"must be {', '.join(map(_quoted, PRESETS))}, a Table, or None for unbounded cloth")

    @property
    def is_preset(self) -> bool:
        """Is this the preset of its name, and no table of somebody's own that is called so?"""
        return _PRESETS.get(self.name) is self

    @property
    def ball(self) -> dict[str, float]:
        """Fields of ``Physics`` for the balls that it is made for, as in ``Physics.preset("match", **table.ball)``; {} for any ball.

        A preset knows R, M and sin_theta (the height of its noses), a table of your own R.

        Returns
        -------
        dict of str to float
        """
        if self.is_preset:
            return dict(PRESETS[self.name].ball)
        return {} if self.ball_radius is None else {"R": self.ball_radius}

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]:
        if self.is_preset:
            return Table.preset, (self.name,)
        if self is UNBOUNDED:
            return Table.of, (None,)
        return _again, (self.name, self.noses, self.jaws, self.falls, self.ball_radius, self.pockets)

    def _reach(self, R):
        """(2, 2) the bounds, wider by as much as a ball of radius R may lie past them in a pocket's mouth; kept for each radius."""
        if R not in self._reaches:
            past = max(MOUTH, deepest(self.jaws, self.falls, self.bounds, R))
            self._reaches[R] = self.bounds + np.array([-past, past])
        return self._reaches[R]

    def unfit(self, positions: Floats, R: float) -> list[int]:
        """Which layouts are not sound here.

        Parameters
        ----------
        positions : float64 (b, n, 2)
            Places [m]; all balls are on the table.
        R : float
            Radius of the balls [m].

        Returns
        -------
        list of int
            Their indices, in order.
        """
        here, found, first = np.ones(positions.shape[:2], bool), [], 0
        while True:
            k, _, fault, _ = _first_fault(positions[first:], here[first:], self._reach(R), self.noses, self.jaws, self.falls, float(R))
            if fault == _SOUND:
                return found
            first += k + 1
            found.append(first - 1)

    def check(self, positions: Batches | Vectors, R: float, field: str = "positions", on_table: FlagRows | Flags | None = None) -> None:
        """Check that layouts are sound: no ball off the table, in a cushion, jaw or other ball, or over a pocket.

        Parameters
        ----------
        positions : array_like, float (n, 2) or (b, n, 2)
            Places [m] of one layout, or of b.
        R : float
            Radius of the balls [m].
        field : str
            What messages call the positions.
        on_table : array_like, bool (n,) or (b, n), optional
            Balls that do not count are False.

        Returns
        -------
        None

        Raises
        ------
        ValueError
            That says which ball of which layout is wrong, and why.
        """
        own = self.ball_radius
        if own is not None and abs(R - own) > SAME_BALL:
            allowed = (
                f'must be {own} on table "{self.name}", which is made for it: write physics={{"R": {own}}}, or give a Table of your own'
            )
            raise refuse("physics.R", R, allowed)
        positions = np.array(positions, np.float64, order="C")
        many = positions.ndim == 3
        places = positions if many else positions[None]
        here = np.ones(places.shape[:2], bool) if on_table is None else np.array(on_table, np.bool_, order="C", ndmin=2)
        width, *pair = self._narrowest
        if width - 2 * R < PLAY:  # it would bounce between them without end in no time
            what = f"must leave a ball of radius {R:g} m at least {PLAY:g} m of play (they leave {width - 2 * R:.3g})"
            raise refuse_what("table.noses", f"{pair[0]} and {pair[1]}", what)
        k, i, fault, j = _first_fault(places, here, self._reach(R), self.noses, self.jaws, self.falls, float(R))
        if fault == _SOUND:
            return
        field = f"{field}[{k}]" if many else field
        place = f"{field}[{i}]", (float(places[k, i, 0]), float(places[k, i, 1]))
        if fault == _OFF:
            ranges = [_range(name, low + R, high - R) for name, (low, high) in zip("xy", self.bounds.tolist(), strict=True)]
            raise refuse(*place, f"must be on the table, {', '.join(filter(None, ranges))} away from pockets")
        if fault == _IN_NOSE:
            axis, side, level = self.noses[j, [NOSE_AXIS, NOSE_SIDE, NOSE_LEVEL]]
            raise refuse(*place, f"overlaps the cushion at {'xy'[int(axis)]} = {side * level:g}")
        if fault == _OVER_POCKET:
            raise refuse(*place, "is over a pocket")
        if fault == _IN_JAW:
            raise refuse(*place, f"overlaps jaw {j} at ({self.jaws[j, JAW_X]:.4f}, {self.jaws[j, JAW_Y]:.4f})")
        depth = 2 * R - float(hypot(*(places[k, i] - places[k, j])))
        raise refuse_what(field, f"balls {i} and {j}", f"overlap by {depth:.3g} m, at most {OVERLAP_ALLOWED:g} is allowed")


TableLike: TypeAlias = Table | TableName | None  # what users may pass as ``table``


def _again(name, noses, jaws, falls, ball_radius, pockets):
    """A table of one's own as it was: what pickling and copying call."""
    return Table(name, noses, jaws, falls, ball_radius=ball_radius, pockets=pockets)


def _quoted(name):
    return f'"{name}"'


def _range(name: str, low: float, high: float) -> str | None:
    """A range in words; None of one without ends."""
    if low == -inf and high == inf:
        return None
    return f"|{name}| <= {high:.6g}" if low == -high else f"{low:.6g} <= {name} <= {high:.6g}"


_SOUND, _OFF, _IN_NOSE, _OVER_POCKET, _IN_JAW, _IN_BALL = range(6)


@entry
def _first_fault(positions, on_table, reach, noses, jaws, falls, R):
    """The first unsound place of positions (b, n, 2): table, ball, what is wrong, and with which nose, fall, jaw or ball."""
    for k in range(positions.shape[0]):
        for i in range(positions.shape[1]):
            if not on_table[k, i]:
                continue
            x, y = positions[k, i, 0], positions[k, i, 1]
            if not (reach[0, 0] < x < reach[0, 1] and reach[1, 0] < y < reach[1, 1]):
                return k, i, _OFF, -1
            for j in range(noses.shape[0]):
                along, across = (y, x) if noses[j, NOSE_AXIS] == 0.0 else (x, y)
                if (
                    noses[j, NOSE_LOW] <= along <= noses[j, NOSE_HIGH]
                    and noses[j, NOSE_LEVEL] - R - noses[j, NOSE_SIDE] * across < -OVERLAP_ALLOWED
                ):
                    return k, i, _IN_NOSE, j
            for j in range(falls.shape[0]):
                dx, dy = x - falls[j, FALL_X], y - falls[j, FALL_Y]
                if dx * dx + dy * dy < falls[j, FALL_RADIUS] * falls[j, FALL_RADIUS]:
                    return k, i, _OVER_POCKET, j
            for j in range(jaws.shape[0]):
                dx, dy = x - jaws[j, JAW_X], y - jaws[j, JAW_Y]
                d2, least = dx * dx + dy * dy, jaws[j, JAW_RADIUS] + R - OVERLAP_ALLOWED
                if d2 < least * least and dx * jaws[j, JAW_UX] + dy * jaws[j, JAW_UY] >= jaws[j, JAW_COS] * sqrt(d2):
                    return k, i, _IN_JAW, j
        least = 2.0 * R - OVERLAP_ALLOWED
        for i in range(positions.shape[1]):
            for j in range(i + 1, positions.shape[1]):
                dx, dy = positions[k, j, 0] - positions[k, i, 0], positions[k, j, 1] - positions[k, i, 1]
                if dx * dx + dy * dy < least * least and on_table[k, i] and on_table[k, j]:
                    return k, i, _IN_BALL, j
    return -1, -1, _SOUND, -1


def _preset(name):
    bed = PRESETS[name]
    return Table(name, *parts(bed), ball_radius=bed.ball["R"], pockets=bed.pockets)


_PRESETS: dict[str, Table] = {name: _preset(name) for name in PRESETS}
UNBOUNDED: Table = Table("unbounded", np.zeros((0, 5)), np.zeros((0, 6)), np.zeros((0, 3)))
