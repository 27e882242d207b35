"""Where may the cue ball in hand stand? At the free place nearest to a point, in the D or anywhere; exact.
The centre must be on or within the lines of the D; anywhere on the table, within the rectangle that leaves a
gap to the cushions, off pockets."""

import numpy as np

from .._lib.check import number, refuse
from .._lib.jit import entry, kernel
from .._lib.types import Flags, Place, Vectors
from ..geometry import BALL_RADIUS, BAULK_Y, D_RADIUS, HALF_LENGTH, HALF_WIDTH, POCKET_PLACES
from .balls import CLEARANCE, N_BALLS, REFEREE_TOUCH, check_table
from .spotting import touches

POCKET_REACH, ROUNDING = 0.15, 1e-12
"""Least distance from a pocket's nominal place, clear of the jaws; tolerance on the lines of the D [m]."""
D_STEP, BED_STEP = 0.005, 0.05
"""Distances between neighbouring places that are tried in the D, and on the whole bed [m]."""


def _places_in_d():
    """(n, 2) [m]: the D's straight line's ends and the brown spot, then a grid of ``D_STEP`` with the arc."""
    places = [(side * D_RADIUS, BAULK_Y) for side in (-1, 0, 1)]
    rows = int(np.ceil(D_RADIUS / D_STEP))
    for row in range(rows + 1):
        depth = D_RADIUS * row / rows
        half = float(np.sqrt(max(0.0, D_RADIUS * D_RADIUS - depth * depth)))
        n = int(np.ceil(half / D_STEP))
        places += [(half * k / n if n else 0.0, BAULK_Y - depth) for k in range(-n, n + 1)]
    return np.array(places)


def _places_on_bed():
    """A grid of ``BED_STEP`` over all places where the cue ball may stand anywhere: (n, 2) [m]."""
    room = np.array([HALF_WIDTH, HALF_LENGTH]) - BALL_RADIUS - CLEARANCE
    lines = [np.linspace(-far, far, 1 + int(np.ceil(2.0 * far / BED_STEP))) for far in room]
    places = np.stack(np.meshgrid(*lines), axis=-1).reshape(-1, 2)
    return places[np.hypot(*(places[:, None] - POCKET_PLACES).transpose(2, 0, 1)).min(axis=1) >= POCKET_REACH]


PLACES_IN_D, PLACES_ON_BED = _places_in_d(), _places_on_bed()
"""Places that are tried for what the cue ball in hand could do: float64 (n, 2) [m], read-only."""
for _places in (PLACES_IN_D, PLACES_ON_BED):
    _places.setflags(write=False)


def within_d(x: float, y: float) -> bool:
    """Whether (x, y) [m] is on or within the lines of the D."""
    return y <= BAULK_Y + ROUNDING and np.hypot(x, y - BAULK_Y) <= D_RADIUS + ROUNDING


in_d = kernel(within_d)


@kernel
def _into_d(x, y):
    """The point of the D nearest to (x, y) [m]."""
    depth = max(0.0, BAULK_Y - y)
    far = np.hypot(x, depth)
    if far <= D_RADIUS:
        return x, BAULK_Y - depth
    if depth == 0.0:
        return min(D_RADIUS, max(-D_RADIUS, x)), BAULK_Y
    return x * D_RADIUS / far, BAULK_Y - depth * D_RADIUS / far


@kernel
def _meet(ax, ay, a, bx, by, b, sign):
    """One of the two points (``sign`` +1, -1) where the circles about a and b cross; NaN if they do not."""
    dx, dy = bx - ax, by - ay
    d2 = dx * dx + dy * dy
    along = 0.5 * (1.0 + (a * a - b * b) / d2)
    across = sign * np.sqrt(a * a / d2 - along * along)
    return ax + along * dx - across * dy, ay + along * dy + across * dx


@kernel
def on_bed(x, y, radius):
    """Whether cushions and pockets let a cue ball in hand stand at (x, y) [m]."""
    room = radius + CLEARANCE
    if abs(x) > HALF_WIDTH - room + ROUNDING or abs(y) > HALF_LENGTH - room + ROUNDING:
        return False
    nearest = np.inf
    for k in range(POCKET_PLACES.shape[0]):
        nearest = min(nearest, np.hypot(POCKET_PLACES[k, 0] - x, POCKET_PLACES[k, 1] - y))
    return nearest >= POCKET_REACH - ROUNDING


@kernel
def _better(positions, on_table, wish, p, best, anywhere, radius):
    """The better of a candidate p and the ``best`` place: (x, y, distance from the wish) [m]; never a NaN."""
    far = np.hypot(p[0] - wish[0], p[1] - wish[1])
    if not far < best[2] or not (on_bed(p[0], p[1], radius) if anywhere else in_d(p[0], p[1])):
        return best
    if touches(positions, on_table, p[0], p[1], 2.0 * radius + REFEREE_TOUCH):
        return best
    return p[0], p[1], far


@kernel
def _disc(positions, on_table, i, reach):
    """Disc i that bars places, of ball i or pocket i - 22: (x, y, radius); radius 0 for an absent ball."""
    if i >= N_BALLS:
        return POCKET_PLACES[i - N_BALLS, 0], POCKET_PLACES[i - N_BALLS, 1], POCKET_REACH
    return positions[i, 0], positions[i, 1], reach if on_table[i] else 0.0


@kernel
def nearest_place(positions, on_table, x, y, radius, anywhere):
    """The free place in the D, or on the bed, nearest to (x, y) [m]: (x, y, whether there is one); on_table[0] False. Balls
    and, on the bed, pockets bar discs; tried are the wish itself, the nearest points of circles, and all crossings."""
    wide, high = HALF_WIDTH - radius - CLEARANCE, HALF_LENGTH - radius - CLEARANCE
    if anywhere:
        wish = x, y = min(wide, max(-wide, x)), min(high, max(-high, y))
    else:
        wish = x, y = _into_d(x, y)
    place = _better(positions, on_table, wish, wish, (x, y, np.inf), anywhere, radius)
    if place[2] == 0.0:
        return x, y, True
    for sign in (-1.0, 1.0):
        if not anywhere:
            place = _better(positions, on_table, wish, (sign * D_RADIUS, BAULK_Y), place, anywhere, radius)
    reach = 2.0 * radius + CLEARANCE
    for i in range(N_BALLS + POCKET_PLACES.shape[0] if anywhere else N_BALLS):
        bx, by, b = _disc(positions, on_table, i, reach)
        if b == 0.0:
            continue
        away = np.hypot(x - bx, y - by)
        ux, uy = (0.0, -1.0) if away == 0.0 else ((x - bx) / away, (y - by) / away)
        place = _better(positions, on_table, wish, (bx + b * ux, by + b * uy), place, anywhere, radius)
        for sign in (-1.0, 1.0):
            for side in (-1.0, 1.0):  # the edges of the bed; or the lines of the D
                if anywhere:
                    p = side * wide, by + sign * np.sqrt(b * b - (side * wide - bx) ** 2)
                    place = _better(positions, on_table, wish, p, place, anywhere, radius)
                    p = bx + sign * np.sqrt(b * b - (side * high - by) ** 2), side * high
                elif side < 0.0:
                    p = bx + sign * np.sqrt(b * b - (by - BAULK_Y) ** 2), BAULK_Y
                else:
                    p = _meet(0.0, BAULK_Y, D_RADIUS, bx, by, b, sign)
                place = _better(positions, on_table, wish, p, place, anywhere, radius)
            for j in range(i):
                ox, oy, o = _disc(positions, on_table, j, reach)
                if o > 0.0:
                    p = _meet(bx, by, b, ox, oy, o, sign)
                    place = _better(positions, on_table, wish, p, place, anywhere, radius)
    return place[0], place[1], place[2] < np.inf


_nearest_place = entry(nearest_place)


def place_cue(positions: Vectors, on_table: Flags, x: float, y: float, *, anywhere: bool = False) -> Place:
    """The free place in the D (or on the bed) nearest to (x, y) [m]; ValueError if there is none."""
    placed, present = check_table(positions, on_table)
    present[0] = False
    x, y = number("x", x), number("y", y)
    px, py, free = _nearest_place(placed, present, x, y, BALL_RADIUS, bool(anywhere))
    if not free:
        raise refuse("on_table", int(present.sum()), "must leave a free place")
    return px, py
