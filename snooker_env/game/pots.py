"""Which direct pots does a layout have, and how wide is each? Ghost balls: straight lines, no throw, no spin.

Object ball b must go along d, the unit vector to the pocket's aim point; the cue ball must arrive at the
ghost ball G = b - 2 R d. With theta the cut angle (between d and the cue ball's path C -> G), the aim may err
by the half window of the pocket as an angle over the magnification of an aiming error at the impact::

    tolerance = w(a) / (2 |b pocket|)  *  2 R cos(theta) / |C G|      [rad]

w(a) is the lateral window of the pocket at the angle a off its axis [m], jaws included, to a millimetre, for
a ball that rolls at 1.5 m/s on table "match" (tests/benchmarks/test_pocket_windows.py); a fast ball's is
smaller, a slow one's larger."""

from math import acos, cos, radians, sqrt

import numpy as np

from .._lib.jit import entry, kernel
from .._lib.types import Flags, Floats, Vectors
from ..geometry import AIM_X, AIM_Y, AXIS_X, AXIS_Y, BALL_RADIUS, IS_MIDDLE, POCKET_AIMS
from ..geometry import HALF_LENGTH as _LENGTH
from ..geometry import HALF_WIDTH as _WIDTH
from .balls import N_BALLS

# degrees, metres
_CORNER_ANGLE, _CORNER_WINDOW = (0.0, 10.0, 20.0, 30.0, 40.0, 50.0), (0.058, 0.055, 0.047, 0.033, 0.016, 0.0)
_MIDDLE_ANGLE, _MIDDLE_WINDOW = (0.0, 15.0, 30.0, 45.0, 60.0, 70.0), (0.073, 0.071, 0.063, 0.043, 0.018, 0.0)
# Squared cosines of the last angles, less a margin above rounding: below them a window is certainly closed.
_CORNER_SHUT, _MIDDLE_SHUT = (cos(radians(angle)) ** 2 - 1e-9 for angle in (50.0, 70.0))
_CORNER_WIDEST, _MIDDLE_WIDEST = max(_CORNER_WINDOW), max(_MIDDLE_WINDOW)
POT_BALL, POT_POCKET, GHOST_X, GHOST_Y, COS_CUT, TOLERANCE = range(6)
"""Columns of a pot: object ball, pocket, ghost ball [m], cosine of the cut, tolerance of the aim [rad]."""
POT_COLUMNS = 6
"""Their number."""
RUN_BALL, RUN_POCKET, RUN_X, RUN_Y, RUN_DX, RUN_DY, RUN_LENGTH, RUN_WIDTH = range(8)
"""Columns of a run: ball, pocket; the ghost ball [m]; the unit vector to the pocket; length and width of the window [m]."""
RUNS = 6 * (N_BALLS - 1), 8
"""The shape of an array for all runs."""


@kernel
def window(cos_angle, middle):
    """Width [m] of a pocket's window at an angle off its axis, by linear interpolation; 0: it is shut."""
    angle = acos(min(1.0, max(-1.0, cos_angle))) * 57.29577951308232
    angles, widths = (_MIDDLE_ANGLE, _MIDDLE_WINDOW) if middle else (_CORNER_ANGLE, _CORNER_WINDOW)
    for k in range(len(angles) - 1):
        if angle <= angles[k + 1]:
            s = (angle - angles[k]) / (angles[k + 1] - angles[k])
            return widths[k] + s * (widths[k + 1] - widths[k])
    return 0.0


@kernel
def clear_segment(positions, on_table, start, end, skip1, skip2, d):
    """Whether the centres of all balls but ``skip1`` and ``skip2`` are at least ``d`` [m] from a segment."""
    (ax, ay), (bx, by) = start, end
    ux, uy = bx - ax, by - ay
    length2 = ux * ux + uy * uy
    sure = 1.001 * d * d * length2
    for i in range(N_BALLS):
        if not on_table[i] or i == skip1 or i == skip2:
            continue
        px, py = positions[i, 0] - ax, positions[i, 1] - ay
        across = px * uy - py * ux
        if across * across > sure:  # off the whole line
            continue
        s = (px * ux + py * uy) / length2 if length2 > 0.0 else 0.0
        s = min(1.0, max(0.0, s))
        px -= s * ux
        py -= s * uy
        if px * px + py * py < d * d:
            return False
    return True


@kernel
def pot_at(positions, on_table, ball, k, d, least):
    """The pot of a ball into pocket k: (tolerance, ghost x, y, cosine of the cut); 0 if below ``least``."""
    cx, cy, bx, by = positions[0, 0], positions[0, 1], positions[ball, 0], positions[ball, 1]
    dx, dy = POCKET_AIMS[k, AIM_X] - bx, POCKET_AIMS[k, AIM_Y] - by
    # seen without a root: the object ball would come back towards the cue ball, or the pocket is shut
    along, middle = dx * POCKET_AIMS[k, AXIS_X] + dy * POCKET_AIMS[k, AXIS_Y], POCKET_AIMS[k, IS_MIDDLE] > 0.0
    shut = (_MIDDLE_SHUT if middle else _CORNER_SHUT) * (dx * dx + dy * dy)
    if dx * (bx - cx) + dy * (by - cy) <= 0.0 or along <= 0.0 or along * along < shut:
        return 0.0, 0.0, 0.0, 0.0
    run = sqrt(dx * dx + dy * dy)
    if run < 1e-9:
        return 0.0, 0.0, 0.0, 0.0
    dx, dy = dx / run, dy / run
    gx, gy = bx - d * dx, by - d * dy
    px, py = gx - cx, gy - cy
    path = sqrt(px * px + py * py)
    # or the ghost ball would be in the cushion
    if path < 1e-9 or abs(gx) > _WIDTH - 0.5 * d + 1e-9 or abs(gy) > _LENGTH - 0.5 * d + 1e-9:
        return 0.0, 0.0, 0.0, 0.0
    cos_cut = (px * dx + py * dy) / path
    of_width = d * cos_cut / (2.0 * run * path)
    # no cut of more than 87 degrees
    if cos_cut < 0.05 or (_MIDDLE_WIDEST if middle else _CORNER_WIDEST) * of_width <= least:
        return 0.0, 0.0, 0.0, 0.0
    width = window(dx * POCKET_AIMS[k, AXIS_X] + dy * POCKET_AIMS[k, AXIS_Y], middle)
    tolerance, pocket = width * of_width, (POCKET_AIMS[k, AIM_X], POCKET_AIMS[k, AIM_Y])
    is_open = width > 0.0 and tolerance > least
    is_open = is_open and clear_segment(positions, on_table, (bx, by), pocket, ball, 0, d)
    if not (is_open and clear_segment(positions, on_table, (cx, cy), (gx, gy), ball, 0, d * (1.0 - 1e-9))):
        return 0.0, 0.0, 0.0, 0.0
    return tolerance, gx, gy, cos_cut


@kernel
def insert_pot(pots, count, ball, pocket, ghost, cos_cut, tolerance):
    """Insert a pot into the first ``count`` rows of ``pots``, widest first, over the last if all are full -> the new number."""
    at = min(count, pots.shape[0] - 1)
    while at > 0 and pots[at - 1, TOLERANCE] < tolerance:
        for c in range(POT_COLUMNS):
            pots[at, c] = pots[at - 1, c]
        at -= 1
    row = pots[at]
    row[POT_BALL], row[POT_POCKET], row[GHOST_X], row[GHOST_Y] = ball, pocket, ghost[0], ghost[1]
    row[COS_CUT], row[TOLERANCE] = cos_cut, tolerance
    return min(count + 1, pots.shape[0])


@kernel
def find_pots(positions, on_table, on, radius, pots):
    """Write the direct pots of the mask ``on`` into ``pots`` (m, POT_COLUMNS), widest first; returns their number."""
    count = 0
    for ball in range(1, N_BALLS):
        if not on_table[ball] or not (on >> ball) & 1:
            continue
        for k in range(6):
            least = pots[count - 1, TOLERANCE] if count == pots.shape[0] else 0.0
            tolerance, gx, gy, cos_cut = pot_at(positions, on_table, ball, k, 2.0 * radius, least)
            if tolerance == 0.0:
                continue
            count = insert_pot(pots, count, ball, k, (gx, gy), cos_cut, tolerance)
    return count


@kernel
def count_pots(positions, on_table, on, radius, most):
    """The number of rows that ``find_pots`` writes into ``most`` rows; stops at the last that counts."""
    count = 0
    for ball in range(1, N_BALLS):
        if not on_table[ball] or not (on >> ball) & 1:
            continue
        for k in range(6):
            if count == most:
                return count
            tolerance, _x, _y, _cos = pot_at(positions, on_table, ball, k, 2.0 * radius, 0.0)
            count += tolerance > 0.0
    return count


@kernel
def list_runs(positions, on_table, on, radius, runs):
    """Write the runs of the mask ``on`` that are open, wherever the cue ball lies, into ``runs`` (RUNS); returns their number."""
    count, d = 0, 2.0 * radius
    for ball in range(1, N_BALLS):
        if not on_table[ball] or not (on >> ball) & 1:
            continue
        bx, by = positions[ball, 0], positions[ball, 1]
        for k in range(6):
            pocket = POCKET_AIMS[k, AIM_X], POCKET_AIMS[k, AIM_Y]
            dx, dy = pocket[0] - bx, pocket[1] - by
            length = sqrt(dx * dx + dy * dy)
            if length < 1e-9:
                continue
            dx, dy = dx / length, dy / length
            x, y = bx - d * dx, by - d * dy
            if abs(x) > _WIDTH - 0.5 * d + 1e-9 or abs(y) > _LENGTH - 0.5 * d + 1e-9:
                continue
            along = dx * POCKET_AIMS[k, AXIS_X] + dy * POCKET_AIMS[k, AXIS_Y]
            width = window(along, POCKET_AIMS[k, IS_MIDDLE] > 0.0)
            if width <= 0.0 or not clear_segment(positions, on_table, (bx, by), pocket, ball, 0, d):
                continue
            run = runs[count]
            run[RUN_BALL], run[RUN_POCKET], run[RUN_X], run[RUN_Y] = ball, k, x, y
            run[RUN_DX], run[RUN_DY], run[RUN_LENGTH], run[RUN_WIDTH] = dx, dy, length, width
            count += 1
    return count


@kernel
def pots_along(runs, many, positions, on_table, radius, pots):
    """``find_pots`` to the bit, of the first ``many`` rows of ``runs``: the cue ball alone may have moved since these were listed."""
    count, d, cx, cy = 0, 2.0 * radius, positions[0, 0], positions[0, 1]
    for k in range(many):
        run = runs[k]
        least = pots[count - 1, TOLERANCE] if count == pots.shape[0] else 0.0
        ball = int(run[RUN_BALL])
        px, py = run[RUN_X] - cx, run[RUN_Y] - cy
        ahead = px * run[RUN_DX] + py * run[RUN_DY]
        if ahead <= 0.0:
            continue
        path = sqrt(px * px + py * py)
        cos_cut = ahead / path
        if path < 1e-9 or cos_cut < 0.05:  # a cut of more than 87 degrees
            continue
        tolerance = run[RUN_WIDTH] * (d * cos_cut / (2.0 * run[RUN_LENGTH] * path))
        if tolerance <= least:
            continue
        ghost = run[RUN_X], run[RUN_Y]
        if not clear_segment(positions, on_table, (cx, cy), ghost, ball, 0, d * (1.0 - 1e-9)):
            continue
        count = insert_pot(pots, count, ball, int(run[RUN_POCKET]), ghost, cos_cut, tolerance)
    return count


_find_pots = entry(find_pots)


def pots(positions: Vectors, on_table: Flags, on: int, *, most: int = 32) -> Floats:
    """Direct pots (k, POT_COLUMNS) of the mask ``on``, widest tolerance first, k at most ``most``."""
    out = np.zeros((most, POT_COLUMNS))
    placed, present = np.ascontiguousarray(positions, np.float64), np.ascontiguousarray(on_table, np.bool_)
    return out[: _find_pots(placed, present, int(on), BALL_RADIUS, out)].copy()
