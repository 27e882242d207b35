"""What bounds the balls? A ``Table``: straight noses, jaw arcs and the falls of the pockets, checked, as arrays for the kernels.

World frame as in ``geometry``, which says where everything lies. What is behind the arcs needs no shape: the throat goes on straight,
and a ball that touches it there is lost (``pocket.py``).
"""

from dataclasses import dataclass, field
from math import hypot, inf, sqrt

import numpy as np

from .._check import array, choice, number, refuse, refuse_what
from .._jit import entry
from ..geometry import PRESETS, Bed, Pocket, parts
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
    """

    name: str
    noses: np.ndarray
    """(k, 5) straight noses: axis (0: x, 1: y), side (+-1), level [m], and the range lo, hi [m] along the other axis.
    The ball touches where side * coordinate = level - R."""
    jaws: np.ndarray
    """(k, 6) jaw arcs: centre x, y, radius [m], unit vector to the arc's middle, cosine of its half angle."""
    falls: np.ndarray
    """(k, 3) falls: centre x, y, radius [m] of the slate's edge; a ball whose centre crosses it begins to drop. Index = pocket."""
    ball_radius: float | None = field(default=None, kw_only=True)
    """The ball [m] that it is made for, which ``physics.R`` must then be; None: any ball."""
    pockets: tuple[str, ...] = field(default=(), kw_only=True)
    """The names of its pockets, one a fall, or ()."""
    bounds: np.ndarray = field(init=False, repr=False)
    """(2, 2) [m] between which lines the balls lie: of x and of y the levels of the outermost noses, infinite where there is none."""
    _narrowest: tuple[float, int, int] = field(init=False, repr=False)
    _reaches: dict[float, np.ndarray] = field(init=False, repr=False)

    def __post_init__(self):
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
        if not isinstance(names, tuple) or not all(isinstance(name, str) for name in names) or len(names) not in (0, len(self.falls)):
            raise refuse("table.pockets", names, f"must be a tuple of {len(self.falls)} names, one a fall, or ()")
        bounds = _bounds(self.noses)
        bounds.setflags(write=False)
        object.__setattr__(self, "bounds", bounds)
        object.__setattr__(self, "_narrowest", _narrowest(self.noses))
        object.__setattr__(self, "_reaches", {})

    @classmethod
    def preset(cls, name="match"):
        """A table by its name; each is made for the balls of its game, see ``ball``.

        Snooker: ``"match"`` (throat of the corners 86.0 mm) and ``"tight"`` (80.14 mm), 3.569 x 1.778 m, balls of 52.5 mm. ``"uk8"``: UK
        8-ball pool, 7 ft x 3 ft 6 in, balls of 2 in; its pockets are an estimate. ``"pool9"``: pool, 100 x 50 in, balls of 2 1/4 in.
        ``"carom"``: 2.84 x 1.42 m, no pockets, balls of 61.5 mm. Sources: ``snooker_env.geometry``.
        """
        return _PRESETS[choice("table", name, PRESETS)]

    @classmethod
    def rectangular(cls, length, width, *, pockets=6, corner=None, middle=None, ball_radius=None, name="rectangular"):
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
        _check_fit(bed, ball_radius)
        return cls(name, *parts(bed), ball_radius=ball_radius, pockets=bed.pockets)

    @classmethod
    def of(cls, table):
        """What users may pass as ``table``: a preset's name, a ``Table``, or None for unbounded cloth."""
        if table is None:
            return UNBOUNDED
        if isinstance(table, cls):
            return table
        if isinstance(table, str):
            return cls.preset(table)
        raise refuse("table", table, f"must be {', '.join(map(_quoted, PRESETS))}, a Table, or None for unbounded cloth")

    @property
    def is_preset(self):
        """Is this the preset of its name, and no table of somebody's own that is called so?"""
        return _PRESETS.get(self.name) is self

    @property
    def ball(self):
        """Fields of ``Physics`` for the balls that it is made for, as in ``Physics.preset("match", **table.ball)``; {} for any ball.

        A preset knows R, M and sin_theta (the height of its noses), a table of your own R.
        """
        if self.is_preset:
            return dict(PRESETS[self.name].ball)
        return {} if self.ball_radius is None else {"R": self.ball_radius}

    def __reduce__(self):
        if self.is_preset:
            return Table.preset, (self.name,)
        if self is UNBOUNDED:
            return Table.of, (None,)
        return _again, (self.name, self.noses, self.jaws, self.falls, self.ball_radius, self.pockets)

    def _reach(self, R):
        """(2, 2) the bounds, wider by as much as a ball of radius R may lie past them in a pocket's mouth; kept for each radius."""
        if R not in self._reaches:
            past = max(MOUTH, _deepest(self.jaws, self.falls, self.bounds, R))
            self._reaches[R] = self.bounds + np.array([-past, past])
        return self._reaches[R]

    def unfit(self, positions, R):
        """Which of the layouts (b, n, 2), all balls on the table, are not sound here: their indices, in order."""
        here, found, first = np.ones(positions.shape[:2], bool), [], 0
        while True:
            k, _, fault, _ = _first_fault(positions[first:], here[first:], self._reach(R), self.noses, self.jaws, self.falls, float(R))
            if fault == _SOUND:
                return found
            first += k + 1
            found.append(first - 1)

    def check(self, positions, R, field="positions", on_table=None):
        """Raise ValueError unless every layout is sound: no ball off the table, in a cushion, jaw or other ball, or over a pocket.

        positions (n, 2) or, of many tables at once, (b, n, 2); on_table (n,) or (b, n) bool: balls that do not count are False.
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


def _check_shapes(noses, jaws, falls):
    """Raise ValueError for a nose, jaw or fall that no kernel could make sense of."""
    for k, (axis, side, _, low, high) in enumerate(noses.tolist()):
        if axis not in (0, 1) or side not in (-1, 1) or not low <= high:
            raise refuse(f"table.noses[{k}]", tuple(noses[k].tolist()), "must be axis 0 or 1, side -1 or 1, level, and lo <= hi")
    for k, (_, _, radius, ux, uy, cos_half) in enumerate(jaws.tolist()):
        if radius < 0 or abs(hypot(ux, uy) - 1.0) > 1e-6 or abs(cos_half) > 1:
            allowed = "must be x, y, radius >= 0, a unit vector (to 1e-6), and a cosine"
            raise refuse(f"table.jaws[{k}]", tuple(jaws[k].tolist()), allowed)
    for k, radius in enumerate(falls[:, FALL_RADIUS].tolist()):
        if radius <= 0:
            raise refuse(f"table.falls[{k}]", tuple(falls[k].tolist()), "must be x, y, and a radius > 0")


def _check_fit(bed, ball_radius):
    """Raise ValueError unless a rectangular table's pockets fit its sides and let its ball through."""
    end = bed.corner.start if bed.corner else 0.0
    middle = bed.middle.start if bed.middle else 0.0
    for name, half, taken in (("width", bed.width / 2, end), ("length", bed.length / 2, end + middle)):
        if not half > taken:
            raise refuse(f"table.{name}", 2 * half, f"must be more than {2 * taken:.6g}, which the jaws of the pockets take of that side")
    if ball_radius is None:
        return
    for name, pocket in (("corner", bed.corner), ("middle", bed.middle)):
        if pocket is not None and not pocket.throat > 2 * ball_radius:
            allowed = f"must be less than {pocket.throat / 2:.6g}, half the throat of the {name} pockets"
            raise refuse("table.ball_radius", ball_radius, allowed)


def _again(name, noses, jaws, falls, ball_radius, pockets):
    """A table of one's own as it was: what pickling and copying call."""
    return Table(name, noses, jaws, falls, ball_radius=ball_radius, pockets=pockets)


def _quoted(name):
    return f'"{name}"'


def _bounds(noses):
    """``Table.bounds`` of its noses."""
    bounds = np.full((2, 2), inf)
    for axis in (0, 1):
        for end, side in enumerate((-1, 1)):
            levels = noses[(noses[:, NOSE_AXIS] == axis) & (noses[:, NOSE_SIDE] == side), NOSE_LEVEL]
            bounds[axis, end] = side * max(levels, default=inf)
    return bounds


def _deepest(jaws, falls, bounds, R):
    """How far past the line of the noses [m] a ball of radius R can lie between a jaw and the fall, and a little more."""
    deepest = 0.0
    for x, y, edge in falls:
        for jx, jy, radius, ux, uy, cos_half in jaws:
            # where the ball's centre is on the fall's edge and the ball at the jaw: two circles cross
            dx, dy, reach = jx - x, jy - y, radius + R
            far = hypot(dx, dy)
            if not abs(reach - edge) < far < reach + edge:
                continue
            along = (far * far + edge * edge - reach * reach) / (2.0 * far)
            off = sqrt(edge * edge - along * along)
            for side in (-1.0, 1.0):
                px, py = x + (along * dx - side * off * dy) / far, y + (along * dy + side * off * dx) / far
                on_arc = (px - jx) * ux + (py - jy) * uy >= cos_half * reach
                if on_arc and not _in_a_jaw(px, py, jaws, R):
                    past = max(bounds[0, 0] - px, px - bounds[0, 1], bounds[1, 0] - py, py - bounds[1, 1])
                    deepest = max(deepest, past + 5e-4)
    return deepest


def _in_a_jaw(x, y, jaws, R):
    dx, dy = x - jaws[:, JAW_X], y - jaws[:, JAW_Y]
    far = np.hypot(dx, dy)
    return bool(np.any((far < jaws[:, JAW_RADIUS] + R - 1e-6) & (dx * jaws[:, JAW_UX] + dy * jaws[:, JAW_UY] >= jaws[:, JAW_COS] * far)))


def _range(name, low, high):
    """A range in words; None of one without ends."""
    if low == -inf and high == inf:
        return None
    return f"|{name}| <= {high:.6g}" if low == -high else f"{low:.6g} <= {name} <= {high:.6g}"


def _narrowest(noses):
    """The least distance [m] of two facing noses that a ball can touch both at once, and which they are."""
    found = (np.inf, -1, -1)
    for a, (axis, side, level, low, high) in enumerate(noses):
        for b, (other_axis, other_side, other_level, other_low, other_high) in enumerate(noses):
            if a < b and axis == other_axis and side != other_side and low <= other_high and other_low <= high:
                found = min(found, (float(level + other_level), a, b))
    return found


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


_PRESETS = {name: _preset(name) for name in PRESETS}
UNBOUNDED = Table("unbounded", np.zeros((0, 5)), np.zeros((0, 6)), np.zeros((0, 3)))
