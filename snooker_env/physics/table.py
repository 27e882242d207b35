"""What bounds the balls? A ``Table``: straight noses, jaw arcs and falls, checked, as arrays for the kernels.

Frame, places and sizes: ``geometry``. Behind the arcs the throat goes on straight; a ball there is lost."""

from dataclasses import dataclass, field
from functools import cached_property, partial
from math import acos, cos, hypot, inf, pi, sqrt
from typing import Any, Literal, TypeAlias

import numpy as np

from .._lib.check import array, choice, flags, number, refuse, refuse_what
from .._lib.types import Batches, FlagRows, Flags, Floats, TableName, Vectors
from ..geometry import PRESETS, Bed, Pocket, parts
from .columns import FALL_RADIUS, JAW_X, JAW_Y, NOSE_AXIS, NOSE_LEVEL, NOSE_SIDE
from .placement import IN_JAW, IN_NOSE, OFF, OVER_POCKET, OVERLAP_ALLOWED, SOUND, first_fault

MOUTH = 0.012
"""How far past the noses a ball can lie at rest [m], or deeper if pockets let it: in snooker's middle pocket, from jaw to fall."""
PLAY = 1e-3  # facing noses must be at least this much further apart than a ball is wide [m]
_PAST_THE_END = 5e-3
"""So much of a jaw's circle beyond its arc's end counts [m]: an arc may end before the fall's edge, at the mouth of a middle
pocket that is narrower than a ball by 4 mm."""
SAME_BALL = 1e-9  # a ball's radius may differ by this much from the one that a table is made for [m]


def deepest(jaws: Floats, falls: Floats, bounds: Floats, R: float) -> float:
    """How far past the noses a ball of radius R can lie between a jaw and the fall, plus 0.5 mm [m]."""
    deepest = 0.0
    for x, y, edge in falls:
        for jx, jy, radius, ux, uy, cos_half in jaws:
            # the ball's centre on the fall's edge and the ball at the jaw: the crossing of two circles
            dx, dy, reach, half = jx - x, jy - y, radius + R, acos(min(max(cos_half, -1.0), 1.0))
            far = hypot(dx, dy)
            if not abs(reach - edge) < far < reach + edge:
                continue
            along = (far * far + edge * edge - reach * reach) / (2.0 * far)
            off = sqrt(edge * edge - along * along)
            for side in (-1.0, 1.0):
                px, py = x + (along * dx - side * off * dy) / far, y + (along * dy + side * off * dx) / far
                on_arc = (px - jx) * ux + (py - jy) * uy >= reach * cos(min(half + _PAST_THE_END / reach, pi))
                if on_arc and not _in_a_jaw(px, py, jaws, R):
                    past = max(bounds[0, 0] - px, px - bounds[0, 1], bounds[1, 0] - py, py - bounds[1, 1])
                    deepest = max(deepest, past + 5e-4)
    return deepest


def _in_a_jaw(x, y, jaws, R):
    """As ``placement.in_jaw``, for all jaws."""
    jaw_x, jaw_y, radius, ux, uy, cos_half = jaws.T
    dx, dy = x - jaw_x, y - jaw_y
    far, width = np.hypot(dx, dy), 2.0 * radius * np.where(cos_half > 0.0, np.sqrt(1.0 - cos_half**2), 1.0)
    deep = (far < radius + R - 1e-6) & (far > radius - R - width)
    return bool(np.any(deep & (dx * ux + dy * uy >= cos_half * far)))


def _check_shapes(noses: Floats, jaws: Floats, falls: Floats) -> None:
    """Raise ValueError for a nose, jaw or fall that is not valid."""
    for k, (axis, side, _, low, high) in enumerate(noses.tolist()):
        if axis not in (0, 1) or side not in (-1, 1) or not low <= high:
            allowed = "must be axis 0 or 1, side -1 or 1, level, and lo <= hi"
            raise refuse(f"table.noses[{k}]", tuple(noses[k].tolist()), allowed)
    for k, (_, _, radius, ux, uy, cos_half) in enumerate(jaws.tolist()):
        if radius < 0 or abs(hypot(ux, uy) - 1.0) > 1e-6 or abs(cos_half) > 1:
            allowed = "must be x, y, radius >= 0, a unit vector (to 1e-6), and a cosine"
            raise refuse(f"table.jaws[{k}]", tuple(jaws[k].tolist()), allowed)
    for k, radius in enumerate(falls[:, FALL_RADIUS].tolist()):
        if radius <= 0:
            raise refuse(f"table.falls[{k}]", tuple(falls[k].tolist()), "must be x, y, and a radius > 0")


def _check_fit(bed: Bed, ball_radius: float | None) -> None:
    """Raise ValueError unless a rectangular table's pockets fit its sides and let its ball through."""
    end = bed.corner.start if bed.corner else 0.0
    middle = bed.middle.start if bed.middle else 0.0
    for name, half, taken in (("width", bed.width / 2, end), ("length", bed.length / 2, end + middle)):
        if not half > taken:
            allowed = f"must be more than {2 * taken:.6g}, the length that the pockets take on that side"
            raise refuse(f"table.{name}", 2 * half, allowed)
    if ball_radius is None:
        return
    for name, pocket in (("corner", bed.corner), ("middle", bed.middle)):
        if pocket is not None and not pocket.throat > 2 * ball_radius:
            allowed = f"must be less than {pocket.throat / 2:.6g}, half the throat of the {name} pockets"
            raise refuse("table.ball_radius", ball_radius, allowed)


@dataclass(frozen=True, eq=False)
class Table:
    """The shape of a table: straight noses, jaw arcs and falls.

    ``Table.preset("match")`` is a table with a name, ``Table.rectangular`` makes a rectangular one, the
    constructor any from arrays, which are copied and read-only; ValueError if one is not valid. A preset is one object,
    also after pickling and copying.

    Parameters
    ----------
    name : str
        Name of the table in messages.
    noses : array_like, float (k, 5)
        Axis (0: x, 1: y), side (-1 or 1), level [m], and range lo, hi [m] along the other axis. A ball
        touches the nose where side * coordinate = level - R.
    jaws : array_like, float (m, 6)
        Arcs: x, y of the centre [m], radius [m], unit vector from the centre to the arc's middle, cosine of
        half its angle.
    falls : array_like, float (p, 3)
        Slate's edges: x, y of the centre, radius [m]. A ball whose centre crosses one begins to drop. The
        index is the pocket.
    ball_radius : float, optional
        Radius of the balls it is made for [m], in [0.001, 1]; ``physics.R`` must equal it. None: any.
    pockets : tuple of str
        Names of the pockets, one for each fall, or ().

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
    _reaches: dict[float, Floats] = field(init=False, repr=False, default_factory=dict)

    def __post_init__(self) -> None:
        if not isinstance(self.name, str):
            raise refuse("table.name", self.name, "must be a str")
        for name, columns in (("noses", 5), ("jaws", 6), ("falls", 3)):
            a = array(f"table.{name}", getattr(self, name), (-1, columns))
            a.setflags(write=False)
            object.__setattr__(self, name, a)
        _check_shapes(self.noses, self.jaws, self.falls)
        if self.ball_radius is not None:
            object.__setattr__(self, "ball_radius", number("table.ball_radius", self.ball_radius, 1e-3, 1))
        names = self.pockets
        named = isinstance(names, tuple) and all(isinstance(name, str) for name in names)
        if not named or len(names) not in (0, len(self.falls)):
            allowed = f"must be a tuple of {len(self.falls)} names, one a fall, or ()"
            raise refuse("table.pockets", names, allowed)

    @cached_property
    def bounds(self) -> Floats:
        """Lowest and highest x, then y, of the outermost noses [m]: float64 (2, 2), read-only; infinite without one."""
        bounds, (axes, sides, levels, _, _) = np.full((2, 2), inf), self.noses.T
        for axis in (0, 1):
            for end, side in enumerate((-1, 1)):
                bounds[axis, end] = side * max(levels[(axes == axis) & (sides == side)], default=inf)
        bounds.setflags(write=False)
        return bounds

    @cached_property
    def _narrowest(self) -> tuple[float, int, int]:
        """The least distance of two facing noses that a ball can touch together [m], and their indices."""
        least = (inf, -1, -1)
        for a, (axis, side, level, low, high) in enumerate(self.noses):
            for b, (other_axis, other_side, other_level, other_low, other_high) in enumerate(self.noses):
                faces = a < b and axis == other_axis and side != other_side
                if faces and low <= other_high and other_low <= high:
                    least = min(least, (float(level + other_level), a, b))
        return least

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
        """A table of your own with straight noses on its four sides, its origin in the middle.

        ``length`` (along y) and ``width`` (along x): between facing noses [m], in (0, 100]. ``pockets``: 6;
        4: the corners; 0: none; anticlockwise from (-x, -y), names in ``Table.pockets``. ``corner``,
        ``middle``: ``Pocket.corner(...)``, ``Pocket.middle(...)``; None: those of snooker's match table.
        ``ball_radius``: of the balls it is made for [m], in [0.001, 1]; None: any. ValueError if a size is
        out of range or sizes do not fit: jaws that overlap along a rail, a pocket narrower than the ball.
        """
        length = number("table.length", length, 0, 100, open_low=True)
        width = number("table.width", width, 0, 100, open_low=True)
        whole = isinstance(pockets, int | np.integer) and not isinstance(pockets, bool)
        if not whole or pockets not in (6, 4, 0):
            raise refuse("table.pockets", pockets, "must be 6, 4 or 0")
        shapes = []
        kinds = ("corner", corner, False, pockets > 0), ("middle", middle, True, pockets == 6)
        for field_name, shape, is_middle, needed in kinds:
            if shape is not None and not needed:
                raise refuse(f"table.{field_name}", shape, f"must be None on a table with {pockets} pockets")
            if shape is not None and (not isinstance(shape, Pocket) or shape.is_middle != is_middle):
                allowed = f"must be a Pocket made by Pocket.{field_name}, or None for snooker's"
                raise refuse(f"table.{field_name}", shape, allowed)
            shapes.append((shape or getattr(PRESETS["match"], field_name)) if needed else None)
        if ball_radius is not None:
            ball_radius = number("table.ball_radius", ball_radius, 1e-3, 1)
        bed = Bed(length=length, width=width, corner=shapes[0], middle=shapes[1], ball={})
        _check_fit(bed, ball_radius)
        return cls(name, *parts(bed), ball_radius=ball_radius, pockets=bed.pockets)

    @classmethod
    def of(cls, table: "TableLike") -> "Table":
        """The table of an argument: a preset's name, a ``Table``, None for unbounded cloth; or ValueError."""
        if table is None:
            return UNBOUNDED
        if isinstance(table, cls):
            return table
        if isinstance(table, str):
            return cls.preset(table)
        names = ", ".join(f'"{name}"' for name in PRESETS)
        raise refuse("table", table, f"must be {names}, a Table, or None for unbounded cloth")

    @property
    def is_preset(self) -> bool:
        """Whether this is a preset, and not another table with the name of one."""
        return _PRESETS.get(self.name) is self

    @property
    def ball(self) -> dict[str, float]:
        """Fields for ``Physics.preset("match", **table.ball)`` of the balls that the table is made for: R [m], M [kg] and
        sin_theta (nose height) of a preset, R of your own table, none of a table for any ball."""
        if self.is_preset:
            return dict(PRESETS[self.name].ball)
        return {} if self.ball_radius is None else {"R": self.ball_radius}

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]:
        if self.is_preset:
            return Table.preset, (self.name,)
        if self is UNBOUNDED:
            return Table.of, (None,)
        own = partial(Table, ball_radius=self.ball_radius, pockets=self.pockets)
        return own, (self.name, self.noses, self.jaws, self.falls)

    def _reach(self, R):
        """The bounds (2, 2), widened by how far a ball can lie past them in a pocket's mouth (nowhere without pockets), and
        beside them the places of balls that touch the noses; kept per R."""
        if R not in self._reaches:
            has_mouths = len(self.jaws) + len(self.falls) > 0
            past = max(MOUTH, deepest(self.jaws, self.falls, self.bounds, R)) if has_mouths else 0.0
            self._reaches[R] = np.tile(self.bounds, 2) + np.array([-past, past, R, -R])
        return self._reaches[R]

    def _first_fault(self, positions, here, R):
        """``placement.first_fault`` on this table, of balls of radius ``R``."""
        return first_fault(positions, here, self._reach(R), self.noses, self.jaws, self.falls, float(R))

    def unfit(self, positions: Floats, R: float) -> list[int]:
        """The indices of the layouts that ``check`` would refuse. ``positions`` (b, n, 2) [m], NaN for a ball off the table."""
        here, each = ~np.isnan(positions[..., 0]), [slice(k, k + 1) for k in range(len(positions))]
        return [one.start for one in each if self._first_fault(positions[one], here[one], R)[2] != SOUND]

    def check_ball(self, R: float) -> None:
        """ValueError if the table is made for other balls than ``R`` [m], or too narrow for them."""
        radius = self.ball_radius
        if radius is not None and abs(R - radius) > SAME_BALL:
            made = f'must be {radius} on table "{self.name}", which is made for it'
            allowed = f'{made}: write physics={{"R": {radius}}}, or give a Table of your own'
            raise refuse("physics.R", R, allowed)
        width, *pair = self._narrowest
        if width - 2 * R < PLAY:  # it would bounce between them infinitely often in a finite time
            what = f"must leave a ball of radius {R:g} m at least {PLAY:g} m of play (they leave {width - 2 * R:.3g})"
            raise refuse_what("table.noses", f"{pair[0]} and {pair[1]}", what)

    def check(
        self,
        positions: Batches | Vectors,
        R: float,
        field: str = "positions",
        on_table: FlagRows | Flags | None = None,
    ) -> None:
        """ValueError if a ball is off the table, in a cushion, jaw or other ball, or over a pocket, or if the table is made for
        other balls than ``R`` [m]. ``positions``: centres [m], (n, 2) or (b, n, 2), called ``field`` in messages;
        ``on_table``: False for places to leave out, None: all count."""
        self.check_ball(R)
        positions = np.ascontiguousarray(positions, np.float64)
        many = positions.ndim == 3
        if positions.ndim not in (2, 3) or positions.shape[-1] != 2:
            allowed = "must have shape (n, 2) or (b, n, 2)"
            raise refuse_what(field, f"array of shape {positions.shape}", allowed)
        places, shape = positions if many else positions[None], positions.shape[:-1]
        here = np.ones(shape, bool) if on_table is None else flags("on_table", on_table, shape)
        k, i, fault, j = self._first_fault(places, here.reshape(places.shape[:2]), R)
        if fault == SOUND:
            return
        field = f"{field}[{k}]" if many else field
        place = f"{field}[{i}]", (float(places[k, i, 0]), float(places[k, i, 1]))
        if fault == OFF:
            ends = zip("xy", self.bounds.tolist(), strict=True)
            ranges = ", ".join(filter(None, (_range(name, low + R, high - R) for name, (low, high) in ends)))
            raise refuse(*place, f"must be on the table, {ranges} away from pockets")
        if fault == IN_NOSE:
            axis, side, level = self.noses[j, [NOSE_AXIS, NOSE_SIDE, NOSE_LEVEL]]
            raise refuse(*place, f"overlaps the cushion at {'xy'[int(axis)]} = {side * level:g}")
        if fault == OVER_POCKET:
            raise refuse(*place, "is over a pocket")
        if fault == IN_JAW:
            at = f"({self.jaws[j, JAW_X]:.4f}, {self.jaws[j, JAW_Y]:.4f})"
            raise refuse(*place, f"overlaps jaw {j} at {at}")
        depth = 2 * R - float(hypot(*(places[k, i] - places[k, j])))
        allowed = f"overlap by {depth:.3g} m, at most {OVERLAP_ALLOWED:g} is allowed"
        raise refuse_what(field, f"balls {i} and {j}", allowed)


TableLike: TypeAlias = Table | TableName | None  # the type of an argument ``table``


def _range(name: str, low: float, high: float) -> str | None:
    """A range as text; None for an infinite one."""
    if low == -inf and high == inf:
        return None
    return f"|{name}| <= {high:.6g}" if low == -high else f"{low:.6g} <= {name} <= {high:.6g}"


_PRESETS: dict[str, Table] = {
    name: Table(name, *parts(bed), ball_radius=bed.ball["R"], pockets=bed.pockets)
    for name, bed in PRESETS.items()
}
UNBOUNDED: Table = Table("unbounded", np.zeros((0, 5)), np.zeros((0, 6)), np.zeros((0, 3)))
