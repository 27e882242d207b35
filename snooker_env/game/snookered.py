"""Is the cue ball snookered, and by which ball? Straight lines past circles, as kernels.

The cue ball can strike an extreme edge of a ball on if its centre can move along the line that passes the ball's
centre at 2 R up to the grazing contact, with no ball not on nearer than 2 R. It is not snookered if it touches a
ball on or can strike one at both edges. A cushion does not snooker: an edge that the curved face of a jaw obstructs,
nearer than any ball not on does, counts as open. In hand the places of ``in_hand.PLACES_IN_D`` are tested, 5 mm
apart, then places right beside each ball; an opening narrower than 5 mm and away from every ball may be missed."""

import numpy as np

from .._lib.check import array, integer, refuse
from .._lib.jit import entry, kernel
from .._lib.types import Flags, Vectors
from ..geometry import BALL_RADIUS, BAULK_Y, D_RADIUS
from .balls import ALL_MASK, CLEARANCE, CUE_BIT, N_BALLS, REFEREE_TOUCH, check_table
from .in_hand import PLACES_IN_D
from .spotting import touches

BESIDE, SLACK = 360, 1e-9
"""Number of places beside a ball that are tested; nearer than 2 R by more than this [m] a ball obstructs."""
NO_JAWS = np.empty((0, 3))  # no curved cushion faces; else rows are their circles (x, y, radius) [m]


@kernel
def segment_distance(px, py, ax, ay, bx, by):
    """The distance of the point p from the segment a-b [m]."""
    ux, uy = bx - ax, by - ay
    length2 = ux * ux + uy * uy
    t = 0.0 if length2 == 0.0 else min(1.0, max(0.0, ((px - ax) * ux + (py - ay) * uy) / length2))
    return np.hypot(px - ax - t * ux, py - ay - t * uy)


@kernel
def _edge(cx, cy, tx, ty, side, radius):
    """Where the cue ball from c grazes the ball at t at its edge ``side`` (+1 left, -1 right): (x, y) [m]."""
    dx, dy = tx - cx, ty - cy
    d = np.hypot(dx, dy)
    s = 2.0 * radius / d  # the sine of the angle between the line of centres and the tangent
    c = np.sqrt(max(0.0, 1.0 - s * s))
    run = d * c
    return cx + run * (c * dx - side * s * dy) / d, cy + run * (c * dy + side * s * dx) / d


@kernel
def hiding_balls(positions, on_table, on, target, cx, cy, jaws, radius):
    """Mask of the nearest balls that hide an edge of ``target`` from (cx, cy); 0: none; -1: a jaw does."""
    tx, ty = positions[target, 0], positions[target, 1]
    if np.hypot(tx - cx, ty - cy) <= 2.0 * radius + REFEREE_TOUCH:
        return 0
    nearest, mask, jaw = np.inf, 0, np.inf
    for side in (-1.0, 1.0):
        ex, ey = _edge(cx, cy, tx, ty, side, radius)
        for i in range(1, N_BALLS):
            if on_table[i] and not (on >> i) & 1:
                bx, by = positions[i, 0], positions[i, 1]
                if segment_distance(bx, by, cx, cy, ex, ey) < 2.0 * radius - SLACK:
                    d = np.hypot(bx - cx, by - cy)
                    if d < nearest - SLACK:
                        nearest, mask = d, 1 << i
                    elif d <= nearest + SLACK:
                        mask |= 1 << i
        for j in range(jaws.shape[0]):
            if segment_distance(jaws[j, 0], jaws[j, 1], cx, cy, ex, ey) < jaws[j, 2] + radius - SLACK:
                jaw = min(jaw, np.hypot(jaws[j, 0] - cx, jaws[j, 1] - cy) - jaws[j, 2])
    return -1 if jaw < nearest - radius else mask


@kernel
def snookered_from(positions, on_table, on, cx, cy, jaws, radius):
    """Whether it is snookered at (cx, cy), and the mask of the effective balls; 0 if they differ."""
    effective = -1
    for target in range(1, N_BALLS):
        if on_table[target] and (on >> target) & 1:
            mask = hiding_balls(positions, on_table, on, target, cx, cy, jaws, radius)
            if mask <= 0:
                return False, 0
            effective &= mask
    return effective != -1, max(effective, 0)


@kernel
def _open_at(positions, on_table, on, x, y, jaws, radius):
    """Whether the cue ball can stand at (x, y) and is not snookered there."""
    if touches(positions, on_table, x, y, 2.0 * radius + REFEREE_TOUCH):
        return False
    return not snookered_from(positions, on_table, on, x, y, jaws, radius)[0]


@kernel
def _open_beside(positions, on_table, on, i, jaws, radius):
    """Whether the cue ball is not snookered at some place in the D beside ball i, baulk line included."""
    gap = 2.0 * radius + CLEARANCE
    x, y = positions[i, 0], positions[i, 1]
    if np.hypot(x, y - BAULK_Y) > D_RADIUS + gap:
        return False
    for k in range(BESIDE + 2):
        turn = 2.0 * np.pi * k / BESIDE
        px, py = x + gap * np.cos(turn), y + gap * np.sin(turn)
        if k >= BESIDE:
            if abs(BAULK_Y - y) > gap:
                break
            px, py = x + (2 * (k - BESIDE) - 1) * np.sqrt(gap * gap - (BAULK_Y - y) ** 2), BAULK_Y
        inside = py <= BAULK_Y and np.hypot(px, py - BAULK_Y) <= D_RADIUS
        if inside and _open_at(positions, on_table, on, px, py, jaws, radius):
            return True
    return False


@kernel
def snookered_in_hand(positions, on_table, on, jaws, radius):
    """Whether the cue ball is snookered from every place in the D; on_table[0] must be False."""
    for k in range(PLACES_IN_D.shape[0]):
        if _open_at(positions, on_table, on, PLACES_IN_D[k, 0], PLACES_IN_D[k, 1], jaws, radius):
            return False
    beside = False
    for i in range(1, N_BALLS):
        beside = beside or (on_table[i] and _open_beside(positions, on_table, on, i, jaws, radius))
    return not beside


@kernel
def find_snooker(positions, on_table, on, jaws, radius):
    """Whether the next striker is snookered, and by which balls: (bool, int); in hand if not on_table[0]."""
    if on_table[0]:
        return snookered_from(positions, on_table, on, positions[0, 0], positions[0, 1], jaws, radius)
    return snookered_in_hand(positions, on_table, on, jaws, radius), 0


_find_snooker = entry(find_snooker, what="the test for a snooker", seconds=1)


def is_snookered(positions: Vectors, on_table: Flags, on: int, jaws: Vectors = NO_JAWS) -> tuple[bool, int]:
    """``find_snooker`` for Python: (bool, mask of effective snookering balls); ValueError for wrong input."""
    placed, present = check_table(positions, on_table)
    if integer("on", on, 0, ALL_MASK) & CUE_BIT:
        raise refuse("on", on, "must name object balls only")
    hidden_all, effective = _find_snooker(placed, present, on, array("jaws", jaws, (-1, 3)), BALL_RADIUS)
    return bool(hidden_all), int(effective)
