"""Which direct pots does a layout offer, and how wide is each? Ghost-ball geometry: straight lines, no throw, no spin.

For object ball b and pocket k the object ball must go along d, the unit vector from b to the pocket's aim point; the cue ball must
arrive at the ghost G = b - 2 R d. With theta the cut angle (between d and the cue ball's path C -> G), the aim may err by about::

    tolerance = w(a) / (2 |b pocket|)  *  2 R cos(theta) / |C G|      [rad]

that is: the pocket's half window as an angle of the object ball's path, divided by how much an error of aim is magnified at the impact.
w(a) is the width of the lateral window that the pocket offers at the angle a off its axis, to a ball that rolls at 1.5 m/s on table
"match", jaws included, to a millimetre (tests/benchmarks/test_pocket_windows.py; a firm ball has less, a dying one more).
"""

from math import acos, hypot

import numpy as np

from .._jit import entry, kernel
from .._types import Flags, Floats, Vectors
from ..geometry import AIM_X, AIM_Y, AXIS_X, AXIS_Y, BALL_RADIUS, HALF_LENGTH, HALF_WIDTH, IS_MIDDLE, POCKET_AIMS
from .balls import N_BALLS

_CORNER_ANGLE, _CORNER_WINDOW = (0.0, 10.0, 20.0, 30.0, 40.0, 50.0), (0.058, 0.055, 0.047, 0.033, 0.016, 0.0)  # degrees, metres
_MIDDLE_ANGLE, _MIDDLE_WINDOW = (0.0, 15.0, 30.0, 45.0, 60.0, 70.0), (0.073, 0.071, 0.063, 0.043, 0.018, 0.0)

POT_BALL, POT_POCKET, GHOST_X, GHOST_Y, COS_CUT, TOLERANCE = range(6)
"""Columns of a pot: object ball, pocket, place of the ghost ball [m], cosine of the cut angle, tolerance [rad]."""
POT_COLUMNS = 6


@kernel
def window(cos_angle, middle):
    """Width w [m] of the pocket's window at an angle off its axis, by linear interpolation; 0 past the table's end."""
    angle = acos(min(1.0, max(-1.0, cos_angle))) * 57.29577951308232
    angles, widths = (_MIDDLE_ANGLE, _MIDDLE_WINDOW) if middle else (_CORNER_ANGLE, _CORNER_WINDOW)
    for k in range(len(angles) - 1):
        if angle <= angles[k + 1]:
            s = (angle - angles[k]) / (angles[k + 1] - angles[k])
            return widths[k] + s * (widths[k + 1] - widths[k])
    return 0.0


@kernel
def clear_segment(positions, on_table, ax, ay, bx, by, skip1, skip2, d):
    """Does no ball but ``skip1``, ``skip2`` come nearer than d to the segment a-b?"""
    ux, uy = bx - ax, by - ay
    length2 = ux * ux + uy * uy
    for i in range(N_BALLS):
        if not on_table[i] or i == skip1 or i == skip2:
            continue
        px, py = positions[i, 0] - ax, positions[i, 1] - ay
        s = (px * ux + py * uy) / length2 if length2 > 0.0 else 0.0
        s = min(1.0, max(0.0, s))
        px -= s * ux
        py -= s * uy
        if px * px + py * py < d * d:
            return False
    return True


@kernel
def find_pots(positions, on_table, on, radius, pots):
    """Fill ``pots`` (m, POT_COLUMNS) with the direct pots of the balls in the mask ``on``, widest first; returns how many there are.

    If there are more than m, the m widest are kept.
    """
    count = 0
    cx, cy = positions[0, 0], positions[0, 1]
    d = 2.0 * radius
    for ball in range(1, N_BALLS):
        if not on_table[ball] or not (on >> ball) & 1:
            continue
        bx, by = positions[ball, 0], positions[ball, 1]
        for k in range(6):
            dx, dy = POCKET_AIMS[k, AIM_X] - bx, POCKET_AIMS[k, AIM_Y] - by
            run = hypot(dx, dy)
            if run < 1e-9:
                continue
            dx, dy = dx / run, dy / run
            width = window(dx * POCKET_AIMS[k, AXIS_X] + dy * POCKET_AIMS[k, AXIS_Y], POCKET_AIMS[k, IS_MIDDLE] > 0.0)
            gx, gy = bx - d * dx, by - d * dy
            px, py = gx - cx, gy - cy
            path = hypot(px, py)
            if width <= 0.0 or path < 1e-9:
                continue
            if abs(gx) > HALF_WIDTH - radius + 1e-9 or abs(gy) > HALF_LENGTH - radius + 1e-9:  # the cue ball would be in the cushion
                continue
            cos_cut = (px * dx + py * dy) / path
            if cos_cut < 0.05:  # thinner than 87 degrees
                continue
            tolerance = width / (2.0 * run) * d * cos_cut / path
            if count == pots.shape[0] and tolerance <= pots[count - 1, TOLERANCE]:
                continue
            if not clear_segment(positions, on_table, bx, by, POCKET_AIMS[k, AIM_X], POCKET_AIMS[k, AIM_Y], ball, 0, d):
                continue
            if not clear_segment(positions, on_table, cx, cy, gx, gy, ball, 0, d * (1.0 - 1e-9)):
                continue
            at = min(count, pots.shape[0] - 1)
            while at > 0 and pots[at - 1, TOLERANCE] < tolerance:
                for c in range(POT_COLUMNS):
                    pots[at, c] = pots[at - 1, c]
                at -= 1
            row = pots[at]
            row[POT_BALL], row[POT_POCKET], row[GHOST_X], row[GHOST_Y] = ball, k, gx, gy
            row[COS_CUT], row[TOLERANCE] = cos_cut, tolerance
            count = min(count + 1, pots.shape[0])
    return count


@entry
def _pots(positions, on_table, on, radius, pots):
    return find_pots(positions, on_table, on, radius, pots)


def pots(positions: Vectors, on_table: Flags, on: int, *, most: int = 32, radius: float = BALL_RADIUS) -> Floats:
    """The direct pots (k, POT_COLUMNS) of the balls in the mask ``on``, widest tolerance first, ``most`` at the most."""
    out = np.zeros((most, POT_COLUMNS))
    n = _pots(np.ascontiguousarray(positions, dtype=np.float64), np.ascontiguousarray(on_table, dtype=np.bool_), int(on), radius, out)
    return out[:n].copy()
