"""Where may the cue ball stand when it is in hand? The D, and the free place in it that is nearest to a wish, exact, as kernels.

The centre must lie on or within the lines of the D: the baulk line's part between yellow and green, and the half circle behind it.
"""

import numpy as np

from .._check import number, refuse
from .._jit import entry, kernel
from .balls import BALL_RADIUS, BAULK_Y, D_RADIUS, N_BALLS, check_table
from .spotting import CLEARANCE, occupied

ROUNDING = 1e-12
"""A point on a line of the D is within it, to this [m]."""


@kernel
def in_d(x, y):
    """Is (x, y) on or within the lines of the D?"""
    return y <= BAULK_Y + ROUNDING and np.hypot(x, y - BAULK_Y) <= D_RADIUS + ROUNDING


@kernel
def _into_d(x, y):
    """The point of the D nearest to (x, y)."""
    depth = max(0.0, BAULK_Y - y)
    far = np.hypot(x, depth)
    if far <= D_RADIUS:
        return x, BAULK_Y - depth
    if depth == 0.0:
        return min(D_RADIUS, max(-D_RADIUS, x)), BAULK_Y
    return x * D_RADIUS / far, BAULK_Y - depth * D_RADIUS / far


@kernel
def _meet(ax, ay, a, bx, by, b, sign):
    """One of the two points (``sign`` +1, -1) where circles about a and b meet; NaN if they do not."""
    dx, dy = bx - ax, by - ay
    d2 = dx * dx + dy * dy
    along = 0.5 * (1.0 + (a * a - b * b) / d2)
    across = sign * np.sqrt(a * a / d2 - along * along)
    return ax + along * dx - across * dy, ay + along * dy + across * dx


@kernel
def nearest_place(positions, on_table, x, y, radius):
    """The free place in the D nearest to (x, y), and whether there is one: (x, y, bool). A place is free if a ball there touches none.

    Each ball bars a disc about it. The nearest point outside them is the wish itself (moved into the D), the nearest point of one
    circle, or a corner where two of the circles and lines of the D meet: all are tried. The cue ball itself is not asked.
    """
    x, y = _into_d(x, y)
    cue, on_table[0] = on_table[0], False
    best_x, best_y, best, found = x, y, np.inf, False
    reach = 2.0 * radius + CLEARANCE
    for i in range(-1, N_BALLS):
        if i >= 0 and not on_table[i]:
            continue
        # One circle: its point nearest to the wish; of a wish at the centre itself, the point towards the brown side's -y.
        for j in range(-3, N_BALLS):
            for sign in (-1.0, 1.0):
                px, py = x, y
                if i < 0 and j >= -1:
                    continue
                if i < 0:  # the ends of the baulk line's part, and the wish
                    if j == -2:
                        px, py = sign * D_RADIUS, BAULK_Y
                elif j == -3:
                    away = np.hypot(x - positions[i, 0], y - positions[i, 1])
                    ux, uy = (0.0, -1.0) if away == 0.0 else ((x - positions[i, 0]) / away, (y - positions[i, 1]) / away)
                    px, py = positions[i, 0] + reach * ux, positions[i, 1] + reach * uy
                elif j == -2:
                    h = np.sqrt(reach * reach - (positions[i, 1] - BAULK_Y) ** 2)
                    px, py = positions[i, 0] + sign * h, BAULK_Y
                elif j == -1:
                    px, py = _meet(0.0, BAULK_Y, D_RADIUS, positions[i, 0], positions[i, 1], reach, sign)
                elif j > i and on_table[j]:
                    px, py = _meet(positions[i, 0], positions[i, 1], reach, positions[j, 0], positions[j, 1], reach, sign)
                else:
                    continue
                far = np.hypot(px - x, py - y)
                if far < best and in_d(px, py) and not occupied(positions, on_table, px, py, radius):
                    best_x, best_y, best, found = px, py, far, True
    on_table[0] = cue
    return best_x, best_y, found
