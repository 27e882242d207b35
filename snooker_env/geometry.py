"""Where is everything on a table, and how large is it? Beds, pockets, spots, balls as data, for every layer.

Table frame: origin at the centre, +x to the yellow side, +y to the black end; metres. ``parts`` makes the
kernels' arrays of a ``Bed``. Pockets are numbered as in ``POCKETS``.

Sources. Snooker: WPBSA, playing area 3569 x 1778 mm, spots and D as in the rules; the official templates are
secret, ours agree with the quoted openings (3.5 in corner, 4 in middle at the fall: ``python -m
benchmarks.pockets``). Pool: WPA; Alciatore, TP 3.5 and 3.6. UK 8-ball: WEPF. Carom: UMB."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import cos, radians, sin, sqrt
from types import MappingProxyType

import numpy as np

from ._lib.check import number, refuse, truth
from ._lib.types import Floats

__all__ = [
    "AIM_X",
    "AIM_Y",
    "AXIS_X",
    "AXIS_Y",
    "BALL_RADIUS",
    "BAULK_Y",
    "COLOUR_SPOTS",
    "D_RADIUS",
    "HALF_LENGTH",
    "HALF_WIDTH",
    "IS_MIDDLE",
    "POCKETS",
    "POCKET_AIMS",
    "POCKET_PLACES",
    "PRESETS",
    "SIDES",
    "Pocket",
]
POCKETS = ("bottom left", "bottom right", "middle right", "top right", "top left", "middle left")
"""Names of the pockets by index, anticlockwise from (-x, -y): bottom is baulk, right the yellow side."""
SIDES = ((-1, -1), (1, -1), (1, 0), (1, 1), (-1, 1), (-1, 0))
"""The signs of each pocket's x and y; 0 for y at a middle pocket."""
# Snooker's table: the rules, the layouts and the observations use these.
BALL_RADIUS = 0.02625
"""Radius of a snooker ball [m]."""
HALF_WIDTH, HALF_LENGTH = 0.889, 1.7845
"""Half of snooker's playing area [m]: noses at x = -+``HALF_WIDTH``, y = -+``HALF_LENGTH``."""
BAULK_Y = -1.0475
"""The y of the baulk line [m]."""
D_RADIUS = 0.292
"""Radius of the D [m]; its centre is the brown spot, (0, ``BAULK_Y``)."""
_ACROSS, _ALONG = (D_RADIUS, -D_RADIUS, 0.0, 0.0, 0.0, 0.0), (*[BAULK_Y] * 3, 0.0, HALF_LENGTH / 2, 1.4605)
COLOUR_SPOTS = np.column_stack([_ACROSS, _ALONG])
"""The spots of yellow, green, brown, blue, pink and black: float64 (6, 2) [m], read-only."""
POCKET_PLACES = np.array([(sx * HALF_WIDTH, sy * HALF_LENGTH) for sx, sy in SIDES])
"""Nominal places of pockets: float64 (6, 2) [m], read-only: where two nose lines meet, or a middle of one."""
AIM_X, AIM_Y, AXIS_X, AXIS_Y, IS_MIDDLE = range(5)
"""Columns of ``POCKET_AIMS``: aim point [m], the axis as outward unit vector, 1 for a middle pocket."""
# distance from each nose line to the point where the fall meets the pocket's axis [m]
_CORNER_AIM, _MIDDLE_AIM = 0.01524, 0.0016


def _aim(sx, sy):
    if not sy:
        return sx * (HALF_WIDTH - _MIDDLE_AIM), 0.0, sx, 0.0, 1.0
    x, y = sx * (HALF_WIDTH - _CORNER_AIM), sy * (HALF_LENGTH - _CORNER_AIM)
    return x, y, sx * sqrt(0.5), sy * sqrt(0.5), 0.0


POCKET_AIMS = np.array([_aim(sx, sy) for sx, sy in SIDES])
"""The points to aim at, for snooker's pockets: float64 (6, 5), read-only; ``AIM_X`` to ``IS_MIDDLE``."""

for _constant in (COLOUR_SPOTS, POCKET_PLACES, POCKET_AIMS):
    _constant.setflags(write=False)

FLAT = 100.0  # a straight facing is an arc of this radius [m]: 0.013 mm off a line over its 0.1 m


@dataclass(frozen=True, kw_only=True)
class Pocket:
    """The shape of one kind of pocket, the same at all four corners or at both middles.

    ``Pocket.corner`` and ``Pocket.middle`` make one from published sizes. A jaw leaves the nose at ``start``,
    turns away on an arc and goes on straight (its facing), if the arc does not end over the fall. ValueError if a
    size is out of range, if the jaws leave no opening, or if a ball could pass beside the fall.

    Parameters
    ----------
    is_middle : bool
        True for the middles of the long sides, False for the corners.
    start : float
        Where the jaws leave the nose [m], in (0, 1]: from where the nose lines meet, or from the middle.
    jaw_radius : float
        Radius of the arc [m], in [0, 1]; 0 is a sharp point, as in pool.
    turn : float
        Angle [degrees] by which a jaw turns from the nose, in (0, 45] at a corner and (0, 90] in the middle;
        the largest makes the two facings parallel.
    fall_depth, fall_radius : float
        From the nose line (at a corner, from each) to the centre of the slate's circle, in [-1, 1], and its
        radius [m], in (0, 1]. A ball begins to drop where its centre crosses the circle.

    Examples
    --------
    >>> from snooker_env import Pocket
    >>> pocket = Pocket.corner(mouth=0.115, shelf=0.03, fall_radius=0.07, cut=142.0)
    >>> round(pocket.mouth, 3), round(pocket.shelf, 3)
    (0.115, 0.03)
    """

    is_middle: bool
    start: float
    jaw_radius: float
    turn: float
    fall_depth: float
    fall_radius: float

    def __post_init__(self) -> None:
        name = "pocket." + ("middle" if truth("pocket.is_middle", self.is_middle) else "corner")
        most = {"turn": 90.0 if self.is_middle else 45.0}
        for field in _SIZES:
            low, open_low = -1 if field == "fall_depth" else 0, field in ("start", "turn", "fall_radius")
            size = number(f"{name}.{field}", getattr(self, field), low, most.get(field, 1), open_low=open_low)
            object.__setattr__(self, field, size)
        if not self.throat > 0.0:
            allowed = "must leave an opening between its jaws: a wider mouth, less turn, a smaller jaw_radius"
            raise refuse(name, self, allowed)
        centre = self.shelf + self.mouth_depth + self.fall_radius
        if centre <= self._arc_end[1] and not self._ends_over_the_fall:
            allowed = "must have the centre of its fall behind the ends of its jaws' arcs, or those ends over the fall"
            raise refuse(name, self, allowed)
        if self.fall_radius < self.throat / 2:
            allowed = "must have a fall at least as wide as the throat, so that no ball passes beside it"
            raise refuse(name, self, allowed)

    @classmethod
    def corner(
        cls, *, mouth: float, shelf: float, fall_radius: float, cut: float = 135.0, jaw_radius: float = 0.0
    ) -> "Pocket":
        """Make a corner pocket from its published sizes; ValueError as for ``Pocket``.

        ``mouth``: from jaw to jaw where they leave the noses [m], in (0, 1]. ``shelf``: from the middle of
        the mouth to the slate's edge [m], in [-1, 1]; negative where the hole begins before the mouth.
        ``fall_radius``: of the slate's circle [m], in (0, 1]. ``cut``: angle between nose and facing
        [degrees], in [135, 180): 135 makes the facings parallel, the WPA's is 142. ``jaw_radius``: of the arc
        on which a jaw leaves the nose [m], in [0, 1]; 0 is a sharp point."""
        mouth, shelf, fall_radius = _sizes("pocket.corner", mouth, shelf, fall_radius)
        depth = (fall_radius + shelf) / sqrt(2.0) - mouth / (2.0 * sqrt(2.0))
        turn = 180.0 - number("pocket.corner.cut", cut, 135, 180)
        return _pocket(False, mouth / sqrt(2.0), jaw_radius, turn, depth, fall_radius)

    @classmethod
    def middle(
        cls, *, mouth: float, shelf: float, fall_radius: float, cut: float = 90.0, jaw_radius: float = 0.0
    ) -> "Pocket":
        """Make a middle pocket as ``Pocket.corner``; ``cut`` in [90, 180): 90 is parallel, the WPA's 104."""
        mouth, shelf, fall_radius = _sizes("pocket.middle", mouth, shelf, fall_radius)
        turn = 180.0 - number("pocket.middle.cut", cut, 90, 180)
        return _pocket(True, mouth / 2.0, jaw_radius, turn, fall_radius + shelf, fall_radius)

    # from the corner, or the middle on the nose line: depth outwards along the axis, offset across it

    @property
    def mouth(self) -> float:
        """Distance from jaw to jaw where they leave the noses [m]."""
        return 2.0 * self.start if self.is_middle else sqrt(2.0) * self.start

    @property
    def mouth_depth(self) -> float:
        """Depth of the line of the mouth [m]: 0 in the middle, negative (before the corner) at a corner."""
        return 0.0 if self.is_middle else -self.start / sqrt(2.0)

    @property
    def shelf(self) -> float:
        """From the middle of the mouth to the slate's edge [m]; negative: the hole begins before it."""
        depth = self.fall_depth if self.is_middle else sqrt(2.0) * self.fall_depth
        return depth - self.fall_radius - self.mouth_depth

    @property
    def taper(self) -> float:
        """Angle between a facing and the pocket's axis [rad]; 0 if the facings are parallel."""
        return radians((90.0 if self.is_middle else 45.0) - self.turn)

    @property
    def _arc_end(self) -> tuple[float, float]:
        """Offset and depth of the end of a jaw's arc [m]."""
        angle = radians(self.turn)
        # along the nose, and away from its line
        on, in_ = self.jaw_radius * sin(angle), self.jaw_radius * (1.0 - cos(angle))
        if self.is_middle:
            return self.start - on, in_
        return (self.start - on + in_) / sqrt(2.0), (in_ - self.start + on) / sqrt(2.0)

    @property
    def _ends_over_the_fall(self) -> bool:
        offset, depth = self._arc_end
        behind = depth - self.mouth_depth - self.shelf - self.fall_radius
        return offset**2 + behind**2 < self.fall_radius**2

    @property
    def facing(self) -> float:
        """Length of a facing [m], down to the fall's centre; 0 where the arc ends over the fall."""
        if self._ends_over_the_fall:
            return 0.0
        return (self.mouth_depth + self.shelf + self.fall_radius - self._arc_end[1]) / cos(self.taper)

    @property
    def throat(self) -> float:
        """Least distance between the two jaws [m]."""
        return 2.0 * (self._arc_end[0] - self.facing * sin(self.taper))


_SIZES = ("start", "jaw_radius", "turn", "fall_depth", "fall_radius")


def _pocket(is_middle, *sizes):
    """The ``Pocket`` of these ``_SIZES``."""
    return Pocket(is_middle=is_middle, **dict(zip(_SIZES, sizes, strict=True)))


def _sizes(name, mouth, shelf, fall_radius):
    mouth = number(f"{name}.mouth", mouth, 0, 1, open_low=True)
    shelf = number(f"{name}.shelf", shelf, -1, 1)
    return mouth, shelf, number(f"{name}.fall_radius", fall_radius, 0, 1, open_low=True)


@dataclass(frozen=True, kw_only=True)
class Bed:
    """A rectangular table as data: its size, its pockets and its balls."""

    length: float  # distance between facing noses along y, and the next along x [m]
    width: float
    corner: Pocket | None  # None: there are none
    middle: Pocket | None  # in the middles of the sides along y
    ball: Mapping[str, float]  # fields of ``Physics`` of the game's balls and noses; empty: any ball

    @property
    def pockets(self) -> tuple[str, ...]:
        """Names of its pockets by index: those of ``POCKETS`` that the table has, in that order."""
        shapes = [self.corner if sy else self.middle for _, sy in SIDES]
        return tuple(name for name, shape in zip(POCKETS, shapes, strict=True) if shape)


def parts(bed: Bed) -> tuple[Floats, Floats, Floats]:
    """Noses (k, 5), jaws (m, 6), falls (p, 3) of a ``Bed``, as in ``Table``; a fall's index is its pocket."""
    X, Y = bed.width / 2, bed.length / 2
    end = bed.corner.start if bed.corner else 0.0
    noses = []
    for side in (-1, 1):
        if bed.middle:
            noses += [(0, side, X, -Y + end, -bed.middle.start), (0, side, X, bed.middle.start, Y - end)]
        else:
            noses += [(0, side, X, -Y + end, Y - end)]
    noses += [(1, side, Y, -X + end, X - end) for side in (-1, 1)]
    jaws, falls = [], []
    for sx, sy in SIDES:
        pocket = bed.corner if sy else bed.middle
        if pocket is None:
            continue
        a, depth = pocket.start, pocket.fall_depth
        if sy:  # one jaw on the short rail, one on the long rail
            jaws += _jaw(pocket, (sx * (X - a), sy * Y), (sx, 0), (0, sy))
            jaws += _jaw(pocket, (sx * X, sy * (Y - a)), (0, sy), (sx, 0))
            falls.append((sx * (X + depth), sy * (Y + depth), pocket.fall_radius))
        else:
            for way in (-1, 1):
                jaws += _jaw(pocket, (sx * X, way * a), (0, -way), (sx, 0))
            falls.append((sx * (X + depth), 0.0, pocket.fall_radius))
    arcs, circles = np.array(jaws, np.float64).reshape(-1, 6), np.array(falls, np.float64).reshape(-1, 3)
    return np.array(noses, np.float64), arcs, circles


def _jaw(pocket, start, onward, outward):
    """The arcs of one jaw from ``start``; unit vectors ``onward`` (along the nose) and ``outward``."""
    (x, y), (tx, ty), (ox, oy), radius = start, onward, outward, pocket.jaw_radius
    turn = radians(pocket.turn)
    # at 45 degrees sine and cosine are equal, but rounding would make them differ
    away, toward = (sqrt(0.5), sqrt(0.5)) if pocket.turn == 90.0 else (cos(turn / 2), sin(turn / 2))
    cx, cy = x + radius * ox, y + radius * oy
    # a point: a whole circle
    arcs = [(cx, cy, radius, -ox * away + tx * toward, -oy * away + ty * toward, away if radius else -1.0)]
    if length := pocket.facing:
        # from the facing into the rubber
        nx, ny = ox * cos(turn) - tx * sin(turn), oy * cos(turn) - ty * sin(turn)
        fx, fy = tx * cos(turn) + ox * sin(turn), ty * cos(turn) + oy * sin(turn)  # along it, into the pocket
        rise = sqrt(FLAT**2 - length**2 / 4)
        mx, my = cx - radius * nx + length / 2 * fx, cy - radius * ny + length / 2 * fy
        arcs.append((mx + rise * nx, my + rise * ny, FLAT, -nx, -ny, rise / FLAT))
    return arcs


def _bed(length, width, corner, middle, **ball):
    return Bed(length=length, width=width, corner=corner, middle=middle, ball=MappingProxyType(ball))


_INCH = 0.0254
_CORNER = _pocket(False, 0.0976352, 0.0889, 45.0, 0.047625, 0.0889)
_TIGHT = _pocket(False, 0.0934916, 0.0889, 45.0, 0.047625, 0.0889)
_MIDDLE = _pocket(True, 0.109185, 0.0669, 90.0, 0.05159, 0.05319)


_POOL_CORNER = Pocket.corner(mouth=4.5875 * _INCH, shelf=1.125 * _INCH, fall_radius=2.75 * _INCH, cut=142.0)
_POOL_MIDDLE = Pocket.middle(mouth=5.0625 * _INCH, shelf=0.1875 * _INCH, fall_radius=3.0 * _INCH, cut=104.0)
_UK_CORNER, _UK_MIDDLE = (
    replace(one, **{size: getattr(one, size) * (_INCH / BALL_RADIUS) for size in _SIZES if size != "turn"})
    for one in (_CORNER, _MIDDLE)
)
_POOL_BALL = {"M": 0.163, "sin_theta": 0.27}
_BEDS = {
    # throats of the corners 86.0 and 80.14 mm
    "match": _bed(2 * HALF_LENGTH, 2 * HALF_WIDTH, _CORNER, _MIDDLE, R=BALL_RADIUS, M=0.1406, sin_theta=0.4),
    "tight": _bed(2 * HALF_LENGTH, 2 * HALF_WIDTH, _TIGHT, _MIDDLE, R=BALL_RADIUS, M=0.1406, sin_theta=0.4),
    # WEPF: at most 7 ft x 3 ft 6 in, balls of 2 in and 116 g (not the cue ball's 1 7/8 in: all equal).
    # Templates are not published; makers say that pockets are to the balls as in snooker: an estimate, scaled
    # by the balls, with snooker's nose height.
    "uk8": _bed(84 * _INCH, 42 * _INCH, _UK_CORNER, _UK_MIDDLE, R=_INCH, M=0.116, sin_theta=0.4),
    # WPA: 100 x 50 in, balls of 2 1/4 in and 5.5 to 6 oz, noses at 63.5 % of the ball, corner mouths 4.5 to
    # 4.625 in at 142 degrees, side 5 to 5.125 at 104, shelves 1 to 2.25 and 0 to 0.375 in. In them: mouths
    # and shelves of Alciatore's TP 3.6 and 3.5; the fall radii too, which the WPA leaves open.
    "pool9": _bed(100 * _INCH, 50 * _INCH, _POOL_CORNER, _POOL_MIDDLE, R=1.125 * _INCH, **_POOL_BALL),
    # UMB: 2.84 x 1.42 m, balls of 61 to 61.5 mm and 205 to 220 g, noses 37 mm high.
    "carom": _bed(2.84, 1.42, None, None, R=0.03075, M=0.2125, sin_theta=37.0 / 30.75 - 1.0),
}
PRESETS = MappingProxyType(_BEDS)
"""The preset tables by name: "match", "tight", "uk8", "pool9" and "carom". Each has ``length`` and ``width`` [m], the
``corner`` and ``middle`` pocket, a ``Pocket`` or None, and of ``ball`` R [m], M [kg] and sin_theta. Read-only."""
