"""Where may the cue ball stand when it is in hand? The D, and the free place in it nearest to a given point, exact, as kernels.

The centre must lie on or within the lines of the D: the part of the baulk line between yellow and green, and the half circle behind it.
"""

from typing import Any

import numpy as np

from .._check import number, refuse
from .._jit import entry, kernel
from .._types import Flags, Place, Vectors
from ..geometry import BALL_RADIUS, BAULK_Y, D_RADIUS
from .balls import N_BALLS, REFEREE_TOUCH, check_table
from .spotting import touches

CLEARANCE = 2.0 * REFEREE_TOUCH
"""The gap between a cue ball placed next to a ball and that ball [m]: the referee sees that they do not touch."""
ROUNDING = 1e-12
"""Tolerance for points on the lines of the D [m]."""


def within_d(x: float, y: float) -> bool:
    """Whether (x, y) [m] is on or within the lines of the D."""
    return y <= BAULK_Y + ROUNDING and np.hypot(x, y - BAULK_Y) <= D_RADIUS + ROUNDING


in_d: Any = kernel(within_d)
"""``within_d`` as an inner kernel."""


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
def _better(positions, on_table, wish_x, wish_y, px, py, best_x, best_y, best, radius):
    """The better of a candidate p and the best place so far: (x, y) and distance from the wish [m]. A NaN is never better."""
    far = np.hypot(px - wish_x, py - wish_y)
    if far < best and in_d(px, py) and not touches(positions, on_table, px, py, 2.0 * radius + REFEREE_TOUCH):
        return px, py, far
    return best_x, best_y, best


@kernel
def nearest_place(positions, on_table, x, y, radius):
    """The free place in the D nearest to (x, y) [m], and whether there is one: (x, y, bool). At a free place a ball touches no other.

    Each ball excludes a disc around it. The nearest point outside all discs is the wish itself (moved into the D), the nearest point of one
    circle, or a point where two of the circles and the lines of the D cross: all are tried. ``on_table[0]`` must be False.
    """
    x, y = _into_d(x, y)
    reach = 2.0 * radius + CLEARANCE
    place = _better(positions, on_table, x, y, x, y, x, y, np.inf, radius)
    if place[2] == 0.0:
        return x, y, True
    for sign in (-1.0, 1.0):
        place = _better(positions, on_table, x, y, sign * D_RADIUS, BAULK_Y, *place, radius)
    for i in range(N_BALLS):
        if not on_table[i]:
            continue
        bx, by = positions[i, 0], positions[i, 1]
        away = np.hypot(x - bx, y - by)
        ux, uy = (0.0, -1.0) if away == 0.0 else ((x - bx) / away, (y - by) / away)
        place = _better(positions, on_table, x, y, bx + reach * ux, by + reach * uy, *place, radius)
        for sign in (-1.0, 1.0):
            half = np.sqrt(reach * reach - (by - BAULK_Y) ** 2)
            place = _better(positions, on_table, x, y, bx + sign * half, BAULK_Y, *place, radius)
            px, py = _meet(0.0, BAULK_Y, D_RADIUS, bx, by, reach, sign)
            place = _better(positions, on_table, x, y, px, py, *place, radius)
            for j in range(i):
                if on_table[j]:
                    px, py = _meet(bx, by, reach, positions[j, 0], positions[j, 1], reach, sign)
                    place = _better(positions, on_table, x, y, px, py, *place, radius)
    return place[0], place[1], place[2] < np.inf


@entry
def _nearest_place(positions, on_table, x, y, radius):
    return nearest_place(positions, on_table, x, y, radius)


def place_cue(positions: Vectors, on_table: Flags, x: float, y: float, *, radius: float = BALL_RADIUS) -> Place:
    """The free place (x, y) in the D nearest to (x, y) [m]. The cue ball's own position is ignored.

    Raises ``ValueError`` for wrong arrays or numbers, and if the D has no free place (which no legal table has).
    """
    placed, present = check_table(positions, on_table)
    present[0] = False
    px, py, found = _nearest_place(placed, present, number("x", x), number("y", y), float(radius))
    if not found:
        raise refuse("on_table", int(present.sum()), "must leave a free place in the D")
    return px, py
