"""Which balls on can run straight to which pockets, wherever the cue ball lies? ``find_pots`` to the bit, in less time."""

from math import sqrt

from .._lib.jit import kernel
from ..geometry import AIM_X, AIM_Y, AXIS_X, AXIS_Y, HALF_LENGTH, HALF_WIDTH, IS_MIDDLE, POCKET_AIMS
from .balls import N_BALLS
from .pots import TOLERANCE, clear_segment, insert_pot, window

RUN_BALL, RUN_POCKET, RUN_X, RUN_Y, RUN_DX, RUN_DY, RUN_LENGTH, RUN_WIDTH = range(8)
"""Columns of a run: ball, pocket; the ghost ball [m]; the unit vector to the pocket; length and width of the window [m]."""
RUN_COLUMNS = 8
MOST_RUNS = 6 * (N_BALLS - 1)


@kernel
def list_runs(positions, on_table, on, radius, runs):
    """Write the open runs of the balls of the mask ``on`` into ``runs`` (MOST_RUNS, RUN_COLUMNS); returns their number."""
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
            if abs(x) > HALF_WIDTH - 0.5 * d + 1e-9 or abs(y) > HALF_LENGTH - 0.5 * d + 1e-9:
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
    """``find_pots`` of the first ``many`` rows of ``runs``; the cue ball alone may have moved since these were listed."""
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
