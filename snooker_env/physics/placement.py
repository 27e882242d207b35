"""Is a layout sound? The first ball that is off the table, in a cushion, a jaw or another ball, or over a pocket: a kernel."""

from math import sqrt

from .._jit import entry
from .columns import (
    FALL_RADIUS,
    FALL_X,
    FALL_Y,
    JAW_COS,
    JAW_RADIUS,
    JAW_UX,
    JAW_UY,
    JAW_X,
    JAW_Y,
    NOSE_AXIS,
    NOSE_HIGH,
    NOSE_LEVEL,
    NOSE_LOW,
    NOSE_SIDE,
)

OVERLAP_ALLOWED = 1e-6
"""Balls may overlap another ball or a cushion by this much [m], as in layouts printed to a micrometre. They count as touching."""

SOUND, OFF, IN_NOSE, OVER_POCKET, IN_JAW, IN_BALL = range(6)
"""Kinds of faults: none; off the table; in a cushion; over a pocket; in a jaw; in another ball."""


@entry
def first_fault(positions, on_table, reach, noses, jaws, falls, R):
    """The first unsound place in positions (b, n, 2) [m]: table, ball, kind of fault, and index of the nose, fall, jaw or ball.

    ``reach`` (2, 2): the lowest and highest x and y [m] that a ball's centre may have; ``R``: radius of the balls [m]. (-1, -1, SOUND, -1)
    if all places are sound.
    """
    for k in range(positions.shape[0]):
        for i in range(positions.shape[1]):
            if not on_table[k, i]:
                continue
            x, y = positions[k, i, 0], positions[k, i, 1]
            if not (reach[0, 0] < x < reach[0, 1] and reach[1, 0] < y < reach[1, 1]):
                return k, i, OFF, -1
            for j in range(noses.shape[0]):
                along, across = (y, x) if noses[j, NOSE_AXIS] == 0.0 else (x, y)
                if (
                    noses[j, NOSE_LOW] <= along <= noses[j, NOSE_HIGH]
                    and noses[j, NOSE_LEVEL] - R - noses[j, NOSE_SIDE] * across < -OVERLAP_ALLOWED
                ):
                    return k, i, IN_NOSE, j
            for j in range(falls.shape[0]):
                dx, dy = x - falls[j, FALL_X], y - falls[j, FALL_Y]
                if dx * dx + dy * dy < falls[j, FALL_RADIUS] * falls[j, FALL_RADIUS]:
                    return k, i, OVER_POCKET, j
            for j in range(jaws.shape[0]):
                dx, dy = x - jaws[j, JAW_X], y - jaws[j, JAW_Y]
                d2, least = dx * dx + dy * dy, jaws[j, JAW_RADIUS] + R - OVERLAP_ALLOWED
                if d2 < least * least and dx * jaws[j, JAW_UX] + dy * jaws[j, JAW_UY] >= jaws[j, JAW_COS] * sqrt(d2):
                    return k, i, IN_JAW, j
        least = 2.0 * R - OVERLAP_ALLOWED
        for i in range(positions.shape[1]):
            for j in range(i + 1, positions.shape[1]):
                dx, dy = positions[k, j, 0] - positions[k, i, 0], positions[k, j, 1] - positions[k, i, 1]
                if dx * dx + dy * dy < least * least and on_table[k, i] and on_table[k, j]:
                    return k, i, IN_BALL, j
    return -1, -1, SOUND, -1
