"""Is a layout sound? The first ball off the table, in a cushion, jaw or ball, or over a pocket: a kernel."""

from math import inf, sqrt

from .._lib.jit import entry, kernel
from . import columns
from .arrays import Boundaries

OVERLAP_ALLOWED = 1e-6
"""Balls may overlap a ball or cushion by this much [m] (printed layouts), and then count as touching."""

SOUND, OFF, IN_NOSE, OVER_POCKET, IN_JAW, IN_BALL = range(6)
"""Kinds of faults: none; off the table; in a cushion; over a pocket; in a jaw; in another ball."""


@kernel
def in_jaw(x, y, jaws, k, R, allowed):
    """Whether a ball at (x, y) is deeper than ``allowed`` [m] in jaw k, which is as deep as wide: a straight facing is a huge arc."""
    dx, dy = x - jaws[k, columns.JAW_X], y - jaws[k, columns.JAW_Y]
    ux, uy = jaws[k, columns.JAW_UX], jaws[k, columns.JAW_UY]
    radius, cos_half = jaws[k, columns.JAW_RADIUS], jaws[k, columns.JAW_COS]
    d2, least = dx * dx + dy * dy, radius + R - allowed
    if not (d2 < least * least and dx * ux + dy * uy >= cos_half * sqrt(d2)):
        return False
    width = 2.0 * radius * (sqrt(1.0 - cos_half * cos_half) if cos_half > 0.0 else 1.0)
    return sqrt(d2) > radius - R - width


@kernel
def _piece_at(x, y, boundaries, allowed, edge):
    """The piece of the table that a ball at (x, y) [m] is in: kind, index of nose, fall or jaw; or (SOUND, -1)."""
    noses, jaws, falls, R = boundaries
    for j in range(noses.shape[0]):
        along, across = (y, x) if noses[j, columns.NOSE_AXIS] == 0.0 else (x, y)
        gap = noses[j, columns.NOSE_LEVEL] - R - noses[j, columns.NOSE_SIDE] * across
        if noses[j, columns.NOSE_LOW] <= along <= noses[j, columns.NOSE_HIGH] and gap < -allowed:
            return IN_NOSE, j
    for j in range(falls.shape[0]):
        dx, dy = x - falls[j, columns.FALL_X], y - falls[j, columns.FALL_Y]
        radius = falls[j, columns.FALL_RADIUS] - edge
        if dx * dx + dy * dy < radius * radius:
            return OVER_POCKET, j
    for j in range(jaws.shape[0]):
        if in_jaw(x, y, jaws, j, R, allowed):
            return IN_JAW, j
    return SOUND, -1


@kernel
def _is_cut_off(x, y, reach, boundaries):
    """Whether a ball at (x, y) [m], in no piece of the table, is behind one: a fall, a jaw, a nose.

    A pocket grows no narrower towards the table: a ball in its mouth leaves it straight away from the nearest fall, or
    back over the nose's line if that fall is another pocket's. A ball behind a piece meets it on that way."""
    _noses, _jaws, falls, R = boundaries
    lo_x, hi_x, lo_y, hi_y = reach[0, 2], reach[0, 3], reach[1, 2], reach[1, 3]
    out_x, out_y = min(max(x, lo_x), hi_x) - x, min(max(y, lo_y), hi_y) - y
    if out_x == 0.0 and out_y == 0.0:
        return False
    ux, uy, nearest = out_x, out_y, inf
    for j in range(falls.shape[0]):
        fx, fy = falls[j, columns.FALL_X], falls[j, columns.FALL_Y]
        far = (x - fx) * (x - fx) + (y - fy) * (y - fy)
        if far < nearest:
            nearest, ux, uy = far, min(max(fx, lo_x), hi_x) - fx, min(max(fy, lo_y), hi_y) - fy
    if (out_x != 0.0 and ux * out_x <= 0.0) or (out_y != 0.0 and uy * out_y <= 0.0):
        ux, uy = out_x, out_y
    way = max(out_x / ux if out_x != 0.0 else 0.0, out_y / uy if out_y != 0.0 else 0.0)
    n = int(way * sqrt(ux * ux + uy * uy) / (0.25 * R)) + 1
    for k in range(1, n):
        part = way * k / n
        # a straight facing is an arc: hence 0.1 R
        if _piece_at(x + ux * part, y + uy * part, boundaries, 0.1 * R, 0.1 * R)[0] != SOUND:
            return True
    return False


@kernel
def place_fault(x, y, reach, boundaries, allowed, edge):
    """The fault of a ball on the bed at (x, y) [m], ``allowed`` [m] deep in a cushion and ``edge`` [m] over a pocket at most:
    kind, index of nose, fall or jaw; or (SOUND, -1)."""
    if not (reach[0, 0] < x < reach[0, 1] and reach[1, 0] < y < reach[1, 1]):
        return OFF, -1
    fault, j = _piece_at(x, y, boundaries, allowed, edge)
    if fault == SOUND and _is_cut_off(x, y, reach, boundaries):
        return OFF, -1
    return fault, j


@kernel
def layout_fault(positions, on_table, reach, boundaries):
    """The first unsound place of a layout (n, 2) [m]: ball, kind, index of what it is in; or (-1, SOUND, -1)."""
    n = positions.shape[0]
    for i in range(n):
        if on_table[i]:
            fault, j = place_fault(positions[i, 0], positions[i, 1], reach, boundaries, OVERLAP_ALLOWED, 0.0)
            if fault != SOUND:
                return i, fault, j
    least = 2.0 * boundaries.R - OVERLAP_ALLOWED
    for i in range(n):
        for j in range(i + 1, n):
            dx, dy = positions[j, 0] - positions[i, 0], positions[j, 1] - positions[i, 1]
            if dx * dx + dy * dy < least * least and on_table[i] and on_table[j]:
                return i, IN_BALL, j
    return -1, SOUND, -1


@entry
def first_fault(positions, on_table, reach, noses, jaws, falls, R):
    """The first unsound place in positions (b, n, 2) [m]: table, ball, kind, index; or (-1, -1, SOUND, -1). ``reach`` (2, 4):
    lowest and highest x and y of centres [m], and of those that touch a nose."""
    boundaries = Boundaries(noses, jaws, falls, R)
    for k in range(positions.shape[0]):
        i, fault, j = layout_fault(positions[k], on_table[k], reach, boundaries)
        if fault != SOUND:
            return k, i, fault, j
    return -1, -1, SOUND, -1
