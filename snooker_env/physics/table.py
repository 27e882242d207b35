"""What bounds the balls? A ``Table``: straight noses, jaw arcs and the falls of the pockets, checked, as
arrays for the kernels.

Table frame as in ``geometry``, where the places and sizes are. Behind the arcs no shape is needed: the throat
goes on straight, and a ball that touches it there is lost (``pocket.py``).
"""

from dataclasses import dataclass, field
from math import hypot, inf
from typing import Any, Literal, TypeAlias

import numpy as np

from .._check import array, choice, flags, number, refuse, refuse_what
from .._types import Batches, FlagRows, Flags, Floats, TableName, Vectors
from ..geometry import PRESETS, Bed, Pocket, parts
from .bounds import bounds_of, deepest, narrowest
from .columns import JAW_X, JAW_Y, NOSE_AXIS, NOSE_LEVEL, NOSE_SIDE
from .placement import IN_JAW, IN_NOSE, OFF, OVER_POCKET, OVERLAP_ALLOWED, SOUND, first_fault
from .shapes import check_fit, check_shapes

MOUTH = 0.012
"""How far past the line of the noses a ball can lie at rest [m], unless the pockets of a table let it lie
deeper. This is the depth between the jaw and the fall of a middle pocket of snooker."""
PLAY = 1e-3
"""Facing noses must be at least this much further apart than a ball is wide [m]."""
SAME_BALL = 1e-9
"""A ball's radius may differ by this much from the one that a table is made for [m]."""


@dataclass(frozen=True, eq=False)
class Table:
    """The shape of a table: straight noses, jaw arcs and falls.

    ``Table.preset("match")`` is a table with a name, ``Table.rectangular`` makes a rectangular one, and the
    constructor makes any table from arrays. There is one object for each preset, also after pickling and
    copying. Arrays are copied and read-only.

    Parameters
    ----------
    name : str
        Name of the table in messages.
    noses : array_like, float (k, 5)
        Straight noses: axis (0: x, 1: y), side (-1 or 1), level [m], and the range lo, hi [m] along the other
        axis. A ball touches the nose where side * coordinate = level - R.
    jaws : array_like, float (m, 6)
        Jaw arcs: x and y of the centre [m], radius [m], unit vector from the centre to the middle of the arc,
        cosine of half its angle.
    falls : array_like, float (p, 3)
        Falls: x and y of the centre and radius of the slate's edge [m]. A ball whose centre crosses the edge
        begins to drop. The index of a fall is its pocket.
    ball_radius : float, optional
        Radius of the balls that the table is made for [m], in [0.001, 1]; ``physics.R`` must equal it. None:
        any ball.
    pockets : tuple of str
        Names of the pockets, one for each fall, or ().

    Attributes
    ----------
    bounds : float64 (2, 2)
        Lowest and highest x, lowest and highest y of the outermost noses [m]; infinite where there is no
        nose.

    Raises
    ------
    ValueError
        If an array has the wrong shape, or a nose, jaw or fall is not valid.

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
        if (
            not isinstance(names, tuple)
            or not all(isinstance(name, str) for name in names)
            or len(names) not in (0, len(self.falls))
        ):
            raise refuse(
                "table.pockets", names, f"must be a tuple of {len(self.falls)} names, one a fall, or ()"
            )
        bounds = bounds_of(self.noses)
        bounds.setflags(write=False)
        object.__setattr__(self, "bounds", bounds)
        object.__setattr__(self, "_narrowest", narrowest(self.noses))
        object.__setattr__(self, "_reaches", {})

    @classmethod
    def preset(cls, name: TableName = "match") -> "Table":
        """A table by its name. Each is made for the balls of its game, see ``ball``."""
        return _PRESETS[choice("table", name, PRESETS)]

    @classmethod
    def rectangular(
        cls,
        length: float,
        width: float,
        *,
        pockets: Literal[6, 4, 0] = 6,
        corner: Pocket | None = None,
        middle: Pocket | None = None,
        ball_radius: float | None = None,
        name: str = "rectangular",
    ) -> "Table":
        """A rectangular table of your own with straight noses on its four sides.

        Parameters
        ----------
        length, width : float
            Distance between facing noses [m], in (0, 100]: ``length`` along y, ``width`` along x. The origin
            is in the middle.
        pockets : {6, 4, 0}
            6: four corners and the middles of the sides along y; 4: the corners; 0: none. They are numbered
            anticlockwise from (-x, -y); ``Table.pockets`` has their names.
        corner, middle : Pocket, optional
            Shapes of the pockets: ``Pocket.corner(...)``, ``Pocket.middle(...)``. None: those of snooker's
            match table.
        ball_radius : float, optional
            Radius of the balls that the table is made for [m], in [0.001, 1]; a shot with another
            ``physics.R`` raises ValueError. None: any ball.
        name : str
            Name of the table in messages.

        Returns
        -------
        Table
            A new table.

        Raises
        ------
        ValueError
            If a size is out of range, or the sizes do not fit together: jaws that overlap along a rail, a
            pocket narrower than the ball.

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
        kinds = ("corner", corner, False, pockets > 0), ("middle", middle, True, pockets == 6)
        for field_name, shape, is_middle, needed in kinds:
            if shape is not None and not needed:
                raise refuse(f"table.{field_name}", shape, f"must be None on a table with {pockets} pockets")
            if shape is not None and (not isinstance(shape, Pocket) or shape.is_middle != is_middle):
                raise refuse(
                    f"table.{field_name}",
                    shape,
                    f"must be a Pocket made by Pocket.{field_name}, or None for snooker's",
                )
            shapes.append((shape or getattr(PRESETS["match"], field_name)) if needed else None)
        if ball_radius is not None:
            ball_radius = number("table.ball_radius", ball_radius, 1e-3, 1)
        bed = Bed(length=length, width=width, corner=shapes[0], middle=shapes[1], ball={})
        check_fit(bed, ball_radius)
        return cls(name, *parts(bed), ball_radius=ball_radius, pockets=bed.pockets)

    @classmethod
    def of(cls, table: "TableLike") -> "Table":
        """The table that an argument ``table`` stands for.

        ``table``: name of a preset, a table, or None for unbounded cloth. Returns the table; a ``Table`` is
        returned as it is. ValueError for anything else.
        """
        if table is None:
            return UNBOUNDED
        if isinstance(table, cls):
            return table
        if isinstance(table, str):
            return cls.preset(table)
        raise refuse(
            "table",
            table,
            f"must be {', '.join(map(_quoted, PRESETS))}, a Table, or None for unbounded cloth",
        )

    @property
    def is_preset(self) -> bool:
        """Whether this is a preset, and not another table with the name of one."""
        return _PRESETS.get(self.name) is self

    @property
    def ball(self) -> dict[str, float]:
        """Fields of ``Physics`` for the balls that the table is made for, for
        ``Physics.preset("match", **table.ball)``.

        A preset has R [m], M [kg] and sin_theta (the height of its noses), a table of your own has R, and a
        table for any ball nothing.
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
        """The bounds (2, 2), widened by how far a ball of radius R can lie past them in the mouth of a
        pocket. Kept for each radius."""
        if R not in self._reaches:
            past = max(MOUTH, deepest(self.jaws, self.falls, self.bounds, R))
            self._reaches[R] = self.bounds + np.array([-past, past])
        return self._reaches[R]

    def unfit(self, positions: Floats, R: float) -> list[int]:
        """The layouts that are not sound on this table.

        ``positions``: float64 (b, n, 2), centres of the balls [m]; all balls are on the table. ``R``: radius
        of the balls [m]. Returns indices of the layouts in which a ball is off the table, in a cushion, jaw
        or other ball, or over a pocket; in order.
        """
        here, unfit, first = np.ones(positions.shape[:2], bool), [], 0
        while True:
            k, _, fault, _ = first_fault(
                positions[first:], here[first:], self._reach(R), self.noses, self.jaws, self.falls, float(R)
            )
            if fault == SOUND:
                return unfit
            first += k + 1
            unfit.append(first - 1)

    def check(
        self,
        positions: Batches | Vectors,
        R: float,
        field: str = "positions",
        on_table: FlagRows | Flags | None = None,
    ) -> None:
        """Check that layouts are sound: no ball off the table, in a cushion, jaw or other ball, or over a
        pocket.

        ``positions``: float (n, 2), centres of the balls of one layout, or of b layouts [m]. ``R``: radius of
        the balls [m]. ``field``: name of the positions in messages. ``on_table``: bool (n,), False for the
        balls to leave out, one for each place; None: all are on the table. ValueError if a layout is not
        sound, or the table is made for other balls; the message names the layout, the ball and the reason.
        Also if an array has another shape.
        """
        radius = self.ball_radius
        if radius is not None and abs(R - radius) > SAME_BALL:
            made = f'must be {radius} on table "{self.name}", which is made for it'
            raise refuse(
                "physics.R", R, f'{made}: write physics={{"R": {radius}}}, or give a Table of your own'
            )
        positions = np.ascontiguousarray(positions, np.float64)
        many = positions.ndim == 3
        if positions.ndim not in (2, 3) or positions.shape[-1] != 2:
            raise refuse_what(
                field, f"array of shape {positions.shape}", "must have shape (n, 2) or (b, n, 2)"
            )
        places, shape = positions if many else positions[None], positions.shape[:-1]
        here = (np.ones(shape, bool) if on_table is None else flags("on_table", on_table, shape)).reshape(
            places.shape[:2]
        )
        width, *pair = self._narrowest
        if width - 2 * R < PLAY:  # it would bounce between them infinitely often in a finite time
            what = f"must leave a ball of radius {R:g} m at least {PLAY:g} m of play (they leave {width - 2 * R:.3g})"
            raise refuse_what("table.noses", f"{pair[0]} and {pair[1]}", what)
        k, i, fault, j = first_fault(
            places, here, self._reach(R), self.noses, self.jaws, self.falls, float(R)
        )
        if fault == SOUND:
            return
        field = f"{field}[{k}]" if many else field
        place = f"{field}[{i}]", (float(places[k, i, 0]), float(places[k, i, 1]))
        if fault == OFF:
            ranges = [
                _range(name, low + R, high - R)
                for name, (low, high) in zip("xy", self.bounds.tolist(), strict=True)
            ]
            raise refuse(*place, f"must be on the table, {', '.join(filter(None, ranges))} away from pockets")
        if fault == IN_NOSE:
            axis, side, level = self.noses[j, [NOSE_AXIS, NOSE_SIDE, NOSE_LEVEL]]
            raise refuse(*place, f"overlaps the cushion at {'xy'[int(axis)]} = {side * level:g}")
        if fault == OVER_POCKET:
            raise refuse(*place, "is over a pocket")
        if fault == IN_JAW:
            raise refuse(
                *place, f"overlaps jaw {j} at ({self.jaws[j, JAW_X]:.4f}, {self.jaws[j, JAW_Y]:.4f})"
            )
        depth = 2 * R - float(hypot(*(places[k, i] - places[k, j])))
        raise refuse_what(
            field, f"balls {i} and {j}", f"overlap by {depth:.3g} m, at most {OVERLAP_ALLOWED:g} is allowed"
        )


TableLike: TypeAlias = Table | TableName | None  # the type of an argument ``table``


def _again(name, noses, jaws, falls, ball_radius, pockets):
    """A table that is no preset; pickling and copying call it."""
    return Table(name, noses, jaws, falls, ball_radius=ball_radius, pockets=pockets)


def _quoted(name):
    return f'"{name}"'


def _range(name: str, low: float, high: float) -> str | None:
    """A range as text; None for an infinite one."""
    if low == -inf and high == inf:
        return None
    return f"|{name}| <= {high:.6g}" if low == -high else f"{low:.6g} <= {name} <= {high:.6g}"


def _preset(name):
    bed = PRESETS[name]
    return Table(name, *parts(bed), ball_radius=bed.ball["R"], pockets=bed.pockets)


_PRESETS: dict[str, Table] = {name: _preset(name) for name in PRESETS}
UNBOUNDED: Table = Table("unbounded", np.zeros((0, 5)), np.zeros((0, 6)), np.zeros((0, 3)))
