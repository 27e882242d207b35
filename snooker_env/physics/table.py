"""What bounds the balls? Straight noses, jaw arcs and the falls of the six pockets, as arrays for the kernels.

World frame: origin at the table's centre, +x to the yellow side, +y to the black end; metres. The nose lines are x = +-0.889 and
y = +-1.7845 (WPBSA playing area 3569 x 1778 mm). The official pocket templates are secret; this set agrees with the quoted
openings (3.5 in corner, 4 in middle at the fall of the slate). Straight facings behind the arcs are left out: a ball's centre
crosses the fall before it could touch one.
"""

from dataclasses import dataclass, field
from math import hypot, sqrt

import numpy as np

from .._check import array, choice, refuse, refuse_what
from .._jit import entry

HALF_WIDTH, HALF_LENGTH = 0.889, 1.7845
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
    """A table's shape. ``Table.preset("match")`` or ``"tight"`` (narrower corner pockets)."""

    name: str
    noses: np.ndarray
    """(k, 5) straight noses: axis (0: x, 1: y), side (+-1), level [m], and the range lo, hi [m] along the other axis.
    The ball touches where side * coordinate = level - R."""
    jaws: np.ndarray
    """(k, 6) jaw arcs: centre x, y, radius [m], unit vector to the arc's middle, cosine of its half angle."""
    falls: np.ndarray
    """(k, 3) falls: centre x, y, radius [m]; a ball drops when its centre crosses the circle. Index = pocket, see ``POCKETS``."""
    _narrowest: tuple[float, int, int] = field(init=False, repr=False)

    def __post_init__(self):
        for name, columns in (("noses", 5), ("jaws", 6), ("falls", 3)):
            a = array(f"table.{name}", getattr(self, name), (-1, columns))
            a.setflags(write=False)
            object.__setattr__(self, name, a)
        object.__setattr__(self, "_narrowest", _narrowest(self.noses))

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

    def __reduce__(self):
        return (Table._rebuild, (self.name, self.noses, self.jaws, self.falls))

    @classmethod
    def _rebuild(cls, name, noses, jaws, falls):
        return _PRESETS[name] if name in _PRESETS else cls(name, noses, jaws, falls)

    def check(self, positions, R, field="positions", on_table=None):
        """Raise ValueError unless every layout is sound: no ball off the table, in a cushion, jaw or other ball, or over a pocket.

        positions (n, 2) or, of many tables at once, (b, n, 2); on_table (n,) or (b, n) bool: balls that do not count are False.
        """
        positions = np.array(positions, np.float64, order="C")
        many = positions.ndim == 3
        places = positions if many else positions[None]
        here = np.ones(places.shape[:2], bool) if on_table is None else np.array(on_table, np.bool_, order="C", ndmin=2)
        width, *pair = self._narrowest
        if width - 2 * R < PLAY:  # it would bounce between them without end in no time
            what = f"must leave a ball of radius {R:g} m at least {PLAY:g} m of play (they leave {width - 2 * R:.3g})"
            raise refuse_what("table.noses", f"{pair[0]} and {pair[1]}", what)
        k, i, fault, j = _first_fault(places, here, self.noses, self.jaws, self.falls, float(R))
        if fault == _SOUND:
            return
        field = f"{field}[{k}]" if many else field
        place = f"{field}[{i}]", (float(places[k, i, 0]), float(places[k, i, 1]))
        if fault == _OFF:
            raise refuse(*place, f"must be on the table, |x| <= {HALF_WIDTH - R:.6g}, |y| <= {HALF_LENGTH - R:.6g} away from pockets")
        if fault == _IN_NOSE:
            axis, side, level = self.noses[j, :3]
            raise refuse(*place, f"overlaps the cushion at {'xy'[int(axis)]} = {side * level:g}")
        if fault == _OVER_POCKET:
            raise refuse(*place, "is over a pocket")
        if fault == _IN_JAW:
            raise refuse(*place, f"overlaps jaw {j} at ({self.jaws[j, 0]:.4f}, {self.jaws[j, 1]:.4f})")
        depth = 2 * R - float(hypot(*(places[k, i] - places[k, j])))
        raise refuse_what(field, f"balls {i} and {j}", f"overlap by {depth:.3g} m, at most {OVERLAP_ALLOWED:g} is allowed")


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
def _first_fault(positions, on_table, noses, jaws, falls, R):
    """The first unsound place of positions (b, n, 2): table, ball, what is wrong, and with which nose, fall, jaw or ball."""
    for k in range(positions.shape[0]):
        for i in range(positions.shape[1]):
            if not on_table[k, i]:
                continue
            x, y = positions[k, i, 0], positions[k, i, 1]
            if noses.shape[0] > 0 and not (abs(x) < HALF_WIDTH + MOUTH and abs(y) < HALF_LENGTH + MOUTH):
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
