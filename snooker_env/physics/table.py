"""What bounds the balls? Straight noses, jaw arcs and the falls of the six pockets, as arrays for the kernels.

World frame: origin at the table's centre, +x to the yellow side, +y to the black end; metres. The nose lines are x = +-0.889 and
y = +-1.7845 (WPBSA playing area 3569 x 1778 mm). The official pocket templates are secret; this set agrees with the quoted
openings (3.5 in corner, 4 in middle at the fall of the slate: ``python -m benchmarks.pockets`` prints ours). What is behind the arcs needs
no shape: the throat goes on straight, and a ball that touches it there is lost (``pocket.py``).
"""

from dataclasses import dataclass, field
from math import hypot, inf, sqrt

import numpy as np

from .._check import array, choice, refuse, refuse_what
from .._jit import entry

HALF_WIDTH, HALF_LENGTH = 0.889, 1.7845
BALL_RADIUS = 0.02625
"""The ball [m] that the presets' cushions and pockets are made for."""
MOUTH = 0.012
"""How far past the line of the noses [m] a ball may lie still: just so far between the jaw and the fall of a middle pocket."""
POCKETS = ("bottom left", "bottom right", "middle right", "top right", "top left", "middle left")
"""Pocket indices 0..5, anticlockwise from (-x, -y); bottom is the baulk end, right the yellow side."""

_CORNER_JAW, _MIDDLE_JAW = 0.0889, 0.0669  # radii of the jaw arcs
_CORNER_FALL, _MIDDLE_FALL = (0.047625, 0.0889), (0.05159, 0.05319)  # slate circle: offset outward from the pocket's origin, radius
_MIDDLE_ARC = 0.109185  # middle pocket: distance of the arc centres from the pocket's axis
_CORNER_ARC = {"match": 0.0976352, "tight": 0.0934916}  # corner: where the arc leaves the nose, from the corner; throats 86.0 and 80.14 mm

PLAY = 1e-3
"""Facing noses must be at least this much [m] further apart than a ball is wide."""
OVERLAP_ALLOWED = 1e-6
"""Input positions may overlap a ball or cushion by this much [m]: layouts printed to a micrometre. They count as touching."""


@dataclass(frozen=True, eq=False)
class Table:
    """A table's shape. ``Table.preset("match")`` or ``"tight"`` (narrower corner pockets), or one of your own from the arrays below.

    A preset is the one object of its name, also after pickling and copying; a table of your own stays what it is whatever it is called.
    """

    name: str
    noses: np.ndarray
    """(k, 5) straight noses: axis (0: x, 1: y), side (+-1), level [m], and the range lo, hi [m] along the other axis.
    The ball touches where side * coordinate = level - R."""
    jaws: np.ndarray
    """(k, 6) jaw arcs: centre x, y, radius [m], unit vector to the arc's middle, cosine of its half angle."""
    falls: np.ndarray
    """(k, 3) falls: centre x, y, radius [m] of the slate's edge; a ball whose centre crosses it begins to drop. Index = pocket, see
    ``POCKETS``."""
    _narrowest: tuple[float, int, int] = field(init=False, repr=False)
    _bed: np.ndarray = field(init=False, repr=False)

    def __post_init__(self):
        if not isinstance(self.name, str):
            raise refuse("table.name", self.name, "must be a str")
        for name, columns in (("noses", 5), ("jaws", 6), ("falls", 3)):
            a = array(f"table.{name}", getattr(self, name), (-1, columns))
            a.setflags(write=False)
            object.__setattr__(self, name, a)
        _check_shapes(self.noses, self.jaws, self.falls)
        object.__setattr__(self, "_narrowest", _narrowest(self.noses))
        object.__setattr__(self, "_bed", _bed(self.noses))

    @classmethod
    def preset(cls, name="match"):
        """``"match"`` (throat of the corners 86.0 mm) or ``"tight"`` (80.14 mm)."""
        return _PRESETS[choice("table", name, _CORNER_ARC)]

    @classmethod
    def of(cls, table):
        """What users may pass as ``table``: a preset's name, a ``Table``, or None for unbounded cloth."""
        if table is None:
            return UNBOUNDED
        if isinstance(table, cls):
            return table
        if isinstance(table, str):
            return cls.preset(table)
        raise refuse("table", table, 'must be "match", "tight", a Table, or None for unbounded cloth')

    @property
    def is_preset(self):
        """Is this the preset of its name, and no table of somebody's own that is called so?"""
        return _PRESETS.get(self.name) is self

    def __reduce__(self):
        if self.is_preset:
            return Table.preset, (self.name,)
        return (Table.of, (None,)) if self is UNBOUNDED else (Table, (self.name, self.noses, self.jaws, self.falls))

    def unfit(self, positions, R):
        """Which of the layouts (b, n, 2), all balls on the table, are not sound here: their indices, in order."""
        here, found, first = np.ones(positions.shape[:2], bool), [], 0
        while True:
            k, _, fault, _ = _first_fault(positions[first:], here[first:], self._bed, self.noses, self.jaws, self.falls, float(R))
            if fault == _SOUND:
                return found
            first += k + 1
            found.append(first - 1)

    def check(self, positions, R, field="positions", on_table=None):
        """Raise ValueError unless every layout is sound: no ball off the table, in a cushion, jaw or other ball, or over a pocket.

        positions (n, 2) or, of many tables at once, (b, n, 2); on_table (n,) or (b, n) bool: balls that do not count are False.
        """
        if self.is_preset and abs(R - BALL_RADIUS) > 1e-9:
            raise refuse("physics.R", R, f'must be {BALL_RADIUS} on table "{self.name}", which is made for it; give a Table of your own')
        positions = np.array(positions, np.float64, order="C")
        many = positions.ndim == 3
        places = positions if many else positions[None]
        here = np.ones(places.shape[:2], bool) if on_table is None else np.array(on_table, np.bool_, order="C", ndmin=2)
        width, *pair = self._narrowest
        if width - 2 * R < PLAY:  # it would bounce between them without end in no time
            what = f"must leave a ball of radius {R:g} m at least {PLAY:g} m of play (they leave {width - 2 * R:.3g})"
            raise refuse_what("table.noses", f"{pair[0]} and {pair[1]}", what)
        k, i, fault, j = _first_fault(places, here, self._bed, self.noses, self.jaws, self.falls, float(R))
        if fault == _SOUND:
            return
        field = f"{field}[{k}]" if many else field
        place = f"{field}[{i}]", (float(places[k, i, 0]), float(places[k, i, 1]))
        if fault == _OFF:
            ranges = [_range(name, low + R, high - R) for name, (low, high) in zip("xy", self._bed.tolist(), strict=True)]
            raise refuse(*place, f"must be on the table, {', '.join(filter(None, ranges))} away from pockets")
        if fault == _IN_NOSE:
            axis, side, level = self.noses[j, :3]
            raise refuse(*place, f"overlaps the cushion at {'xy'[int(axis)]} = {side * level:g}")
        if fault == _OVER_POCKET:
            raise refuse(*place, "is over a pocket")
        if fault == _IN_JAW:
            raise refuse(*place, f"overlaps jaw {j} at ({self.jaws[j, 0]:.4f}, {self.jaws[j, 1]:.4f})")
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
    for k, radius in enumerate(falls[:, 2].tolist()):
        if radius <= 0:
            raise refuse(f"table.falls[{k}]", tuple(falls[k].tolist()), "must be x, y, and a radius > 0")


def _bed(noses):
    """Between which lines the balls lie: (2, 2), of x and y the levels of the outermost noses, infinite where there is none."""
    bed = np.full((2, 2), inf)
    for axis in (0, 1):
        for end, side in enumerate((-1, 1)):
            levels = noses[(noses[:, 0] == axis) & (noses[:, 1] == side), 2]
            bed[axis, end] = side * max(levels, default=inf)
    return bed


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
def _first_fault(positions, on_table, bed, noses, jaws, falls, R):
    """The first unsound place of positions (b, n, 2): table, ball, what is wrong, and with which nose, fall, jaw or ball."""
    for k in range(positions.shape[0]):
        for i in range(positions.shape[1]):
            if not on_table[k, i]:
                continue
            x, y = positions[k, i, 0], positions[k, i, 1]
            if not (bed[0, 0] - MOUTH < x < bed[0, 1] + MOUTH and bed[1, 0] - MOUTH < y < bed[1, 1] + MOUTH):
                return k, i, _OFF, -1
            for j in range(noses.shape[0]):
                along, across = (y, x) if noses[j, 0] == 0.0 else (x, y)
                if noses[j, 3] <= along <= noses[j, 4] and noses[j, 2] - R - noses[j, 1] * across < -OVERLAP_ALLOWED:
                    return k, i, _IN_NOSE, j
            for j in range(falls.shape[0]):
                dx, dy = x - falls[j, 0], y - falls[j, 1]
                if dx * dx + dy * dy < falls[j, 2] * falls[j, 2]:
                    return k, i, _OVER_POCKET, j
            for j in range(jaws.shape[0]):
                dx, dy = x - jaws[j, 0], y - jaws[j, 1]
                d2, least = dx * dx + dy * dy, jaws[j, 2] + R - OVERLAP_ALLOWED
                if d2 < least * least and dx * jaws[j, 3] + dy * jaws[j, 4] >= jaws[j, 5] * sqrt(d2):
                    return k, i, _IN_JAW, j
        least = 2.0 * R - OVERLAP_ALLOWED
        for i in range(positions.shape[1]):
            for j in range(i + 1, positions.shape[1]):
                dx, dy = positions[k, j, 0] - positions[k, i, 0], positions[k, j, 1] - positions[k, i, 1]
                if dx * dx + dy * dy < least * least and on_table[k, i] and on_table[k, j]:
                    return k, i, _IN_BALL, j
    return -1, -1, _SOUND, -1


def _build(name):
    arc = _CORNER_ARC[name]
    X, Y = HALF_WIDTH, HALF_LENGTH
    noses = np.array([
        (0, -1, X, -Y + arc, -_MIDDLE_ARC), (0, -1, X, _MIDDLE_ARC, Y - arc),
        (0, 1, X, -Y + arc, -_MIDDLE_ARC), (0, 1, X, _MIDDLE_ARC, Y - arc),
        (1, -1, Y, -X + arc, X - arc), (1, 1, Y, -X + arc, X - arc),
    ])  # fmt: skip
    jaws, falls = [], np.zeros((6, 3))
    h = sqrt(0.5)
    away = np.cos(np.pi / 8)
    toward = np.sin(np.pi / 8)
    for pocket, (sx, sy) in enumerate([(-1, -1), (1, -1), (1, 0), (1, 1), (-1, 1), (-1, 0)]):
        if sy:
            # one arc on the short rail (its nose normal along y), one on the long rail; each turns 45 deg from the nose to the throat
            jaws.append((sx * (X - arc), sy * (Y + _CORNER_JAW), _CORNER_JAW, sx * toward, -sy * away, np.cos(np.pi / 8)))
            jaws.append((sx * (X + _CORNER_JAW), sy * (Y - arc), _CORNER_JAW, -sx * away, sy * toward, np.cos(np.pi / 8)))
            offset, radius = _CORNER_FALL
            falls[pocket] = sx * (X + offset), sy * (Y + offset), radius
        else:
            for end in (-1, 1):  # a quarter circle each, from the nose into the throat
                jaws.append((sx * (X + _MIDDLE_JAW), end * _MIDDLE_ARC, _MIDDLE_JAW, -sx * h, -end * h, h))
            offset, radius = _MIDDLE_FALL
            falls[pocket] = sx * (X + offset), 0.0, radius
    return Table(name, noses, np.array(jaws), falls)


_PRESETS = {name: _build(name) for name in _CORNER_ARC}
UNBOUNDED = Table("unbounded", np.zeros((0, 5)), np.zeros((0, 6)), np.zeros((0, 3)))
