"""Is it impossible to hit a ball on, because balls that are not on shut the cue ball in? Exact, in the plane.

The cue ball passes between two balls whose centres are 4 R apart, and between a ball and a cushion 3 R apart. Balls
that are not on and nearer than that form walls. The cue ball is shut in if walls part it from every place at which it
would touch a ball on: then no stroke but a jump, which is a foul, hits one first.

Two places are parted if, along some closed chain of walls, the directions from both turn by different amounts: by a
whole turn about the one and not about the other. All cushions count as one wall."""

from math import pi

import numpy as np

from .._lib.jit import entry, kernel
from ..geometry import HALF_LENGTH, HALF_WIDTH
from .balls import CUE, N_BALLS
from .paths import ARC_COS, ARC_RADIUS, ARC_UX, ARC_UY, ARC_X, ARC_Y, AXIS, HIGH, LEVEL, LOW, SIDE
from .snookered import BESIDE, SLACK

_CUSHION = N_BALLS  # the node of all cushions, after those of the balls


@kernel
def _turn(x, y, ax, ay, bx, by):
    """The angle [rad], in [-pi, pi], by which the direction from (x, y) turns between the points a and b."""
    ax, ay, bx, by = ax - x, ay - y, bx - x, by - y
    return np.arctan2(ax * by - ay * bx, ax * bx + ay * by)


@kernel
def _nearest_on_cushion(k, noses, jaws, x, y):
    """The place on nose k, or on jaw k - len(noses), that is nearest to (x, y): (x, y, distance [m])."""
    if k < noses.shape[0]:
        level, upright = noses[k, SIDE] * noses[k, LEVEL], noses[k, AXIS] == 0.0
        along = min(noses[k, HIGH], max(noses[k, LOW], y if upright else x))
        px, py = (level, along) if upright else (along, level)
        return px, py, np.hypot(px - x, py - y)
    jaw = jaws[k - noses.shape[0]]
    dx, dy = x - jaw[ARC_X], y - jaw[ARC_Y]
    d = np.hypot(dx, dy)
    if d == 0.0 or dx * jaw[ARC_UX] + dy * jaw[ARC_UY] < jaw[ARC_COS] * d:
        return x, y, np.inf  # the ends of the arc belong to noses and facings too
    share = jaw[ARC_RADIUS] / d
    return jaw[ARC_X] + share * dx, jaw[ARC_Y] + share * dy, d - jaw[ARC_RADIUS]


@kernel
def _walls(positions, on_table, on, noses, jaws, radius, ends, places):
    """Write each wall: its two nodes into ``ends``, the points at them into ``places``; returns their number."""
    n, cushions = 0, noses.shape[0] + jaws.shape[0]
    for i in range(1, N_BALLS):
        if not on_table[i] or (on >> i) & 1:
            continue
        x, y = positions[i, 0], positions[i, 1]
        for j in range(1, i):
            px, py = positions[j, 0], positions[j, 1]
            if on_table[j] and not (on >> j) & 1 and np.hypot(px - x, py - y) < 4.0 * radius - SLACK:
                ends[n, 0], ends[n, 1] = i, j
                places[n, 0], places[n, 1], places[n, 2], places[n, 3] = x, y, px, py
                n += 1
        for k in range(cushions):
            px, py, gap = _nearest_on_cushion(k, noses, jaws, x, y)
            if gap < 3.0 * radius - SLACK:
                ends[n, 0], ends[n, 1] = i, _CUSHION
                places[n, 0], places[n, 1], places[n, 2], places[n, 3] = x, y, px, py
                n += 1
    return n


@kernel
def _inside(x, y, radius):
    """The place nearest to (x, y) that is no farther out than a ball at the noses."""
    wide, high = HALF_WIDTH - radius, HALF_LENGTH - radius
    return min(wide, max(-wide, x)), min(high, max(-high, y))


@kernel
def _walls_part(cx, cy, qx, qy, walls, n, work, radius):
    """Whether the first ``n`` walls part the free places c and q."""
    (ends, places), (turned, seen) = walls, work
    # From c to q past the noses' corners: the place of either in a pocket's mouth is left straight inwards.
    (ix, iy), (jx, jy) = _inside(cx, cy, radius), _inside(qx, qy, radius)
    for i in range(N_BALLS + 1):
        seen[i] = False
    for root in range(n):
        if seen[ends[root, 0]]:
            continue
        turned[ends[root, 0]], seen[ends[root, 0]], growing = 0.0, True, True
        while growing:
            growing = False
            for m in range(n):
                a, b = ends[m, 0], ends[m, 1]
                if not (seen[a] or seen[b]):
                    continue
                ax, ay, bx, by = places[m, 0], places[m, 1], places[m, 2], places[m, 3]
                more = _turn(cx, cy, ax, ay, bx, by) - _turn(qx, qy, ax, ay, bx, by)
                if b == _CUSHION:  # along cushions both turn alike, but for the angle from c to q seen there
                    more -= _turn(bx, by, qx, qy, jx, jy) + _turn(bx, by, jx, jy, ix, iy)
                    more -= _turn(bx, by, ix, iy, cx, cy)
                if seen[a] and seen[b]:
                    if abs(turned[a] + more - turned[b]) > pi:
                        return True
                    continue
                growing = True
                if seen[a]:
                    turned[b] = turned[a] + more
                else:
                    turned[a] = turned[b] - more
                seen[a] = seen[b] = True
    return False


@kernel
def _free(positions, on_table, on, x, y, noses, jaws, radius):
    """Whether cushions and the balls that are not on let the cue ball stand at (x, y)."""
    if abs(x) > HALF_WIDTH - radius + SLACK or abs(y) > HALF_LENGTH - radius + SLACK:
        return False
    free = True
    for i in range(1, N_BALLS):
        far = np.hypot(positions[i, 0] - x, positions[i, 1] - y)
        free = free and (not on_table[i] or (on >> i) & 1 or far >= 2.0 * radius - SLACK)
    for k in range(noses.shape[0] + jaws.shape[0]):
        free = free and _nearest_on_cushion(k, noses, jaws, x, y)[2] >= radius - SLACK
    return free


@entry(what="the test for a cue ball that is shut in", seconds=2)
def shut_in(positions, on_table, on, noses, jaws, radius):
    """Whether the cue ball, where it lies, can reach no ball of the mask ``on`` on any way over the cloth."""
    most = N_BALLS * (N_BALLS + noses.shape[0] + jaws.shape[0])
    walls = ends, places = np.empty((most, 2), np.int64), np.empty((most, 4))
    work = np.empty(N_BALLS + 1), np.empty(N_BALLS + 1, np.bool_)
    n = _walls(positions, on_table, on, noses, jaws, radius, ends, places)
    cx, cy = positions[CUE, 0], positions[CUE, 1]
    for i in range(1, N_BALLS):
        if not (on_table[i] and (on >> i) & 1):
            continue
        before = False
        for k in range(BESIDE):  # one place on each part of its edge that is free
            turn, x, y = 2.0 * pi * k / BESIDE, positions[i, 0], positions[i, 1]
            qx, qy = x + 2.0 * radius * np.cos(turn), y + 2.0 * radius * np.sin(turn)
            here = _free(positions, on_table, on, qx, qy, noses, jaws, radius)
            if here and not before and not _walls_part(cx, cy, qx, qy, walls, n, work, radius):
                return False
            before = here
    return True
