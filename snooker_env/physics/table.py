"""What bounds the balls? Straight noses, jaw arcs and the falls of the six pockets, as arrays for the kernels.

World frame: origin at the table's centre, +x to the yellow side, +y to the black end; metres. The nose lines are x = +-0.889 and
y = +-1.7845 (WPBSA playing area 3569 x 1778 mm). The official pocket templates are secret; this set agrees with the quoted
openings (3.5 in corner, 4 in middle at the fall of the slate). Straight facings behind the arcs are left out: a ball's centre
crosses the fall before it could touch one.
"""

from dataclasses import dataclass
from math import hypot, sqrt

import numpy as np

from .._check import array, choice, refuse

HALF_WIDTH, HALF_LENGTH = 0.889, 1.7845
MOUTH = 0.012
"""How far past the line of the noses [m] a ball may lie still: just so far between the jaw and the fall of a middle pocket."""
POCKETS = ("bottom left", "bottom right", "middle right", "top right", "top left", "middle left")
"""Pocket indices 0..5, anticlockwise from (-x, -y); bottom is the baulk end, right the yellow side."""

_CORNER_JAW, _MIDDLE_JAW = 0.0889, 0.0669  # radii of the jaw arcs
_CORNER_FALL, _MIDDLE_FALL = (0.047625, 0.0889), (0.05159, 0.05319)  # slate circle: offset outward from the pocket's origin, radius
_MIDDLE_ARC = 0.109185  # middle pocket: distance of the arc centres from the pocket's axis
_CORNER_ARC = {"match": 0.0976352, "tight": 0.0934916}  # corner: where the arc leaves the nose, from the corner; throats 86.0 and 80.14 mm

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

    def __post_init__(self):
        for name, columns in (("noses", 5), ("jaws", 6), ("falls", 3)):
            a = array(f"table.{name}", getattr(self, name), (-1, columns))
            a.setflags(write=False)
            object.__setattr__(self, name, a)

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
        """Raise ValueError if a ball's centre is off the table, in a cushion or jaw, or over a pocket."""
        for i, (x, y) in enumerate(positions):
            if on_table is not None and not on_table[i]:
                continue
            place = f"{field}[{i}]", (float(x), float(y))
            if self.noses.size and not (abs(x) < HALF_WIDTH + MOUTH and abs(y) < HALF_LENGTH + MOUTH):
                raise refuse(*place, f"must be on the table, |x| <= {HALF_WIDTH - R:.6g}, |y| <= {HALF_LENGTH - R:.6g} away from pockets")
            for axis, side, level, low, high in self.noses:
                along, across = (y, x) if axis == 0 else (x, y)
                if low <= along <= high and level - R - side * across < -OVERLAP_ALLOWED:
                    raise refuse(*place, f"overlaps the cushion at {'xy'[int(axis)]} = {side * level:g}")
            for cx, cy, radius in self.falls:
                if hypot(x - cx, y - cy) < radius:
                    raise refuse(*place, "is over a pocket")
            for k, (cx, cy, radius, ux, uy, cos_half) in enumerate(self.jaws):
                dx, dy = x - cx, y - cy
                d = hypot(dx, dy)
                if d < radius + R - OVERLAP_ALLOWED and dx * ux + dy * uy >= cos_half * d:
                    raise refuse(*place, f"overlaps jaw {k} at ({cx:.4f}, {cy:.4f})")


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
