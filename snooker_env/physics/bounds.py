"""How far can a ball go on a table, and how narrow is it? From the arrays of a ``table.Table``."""

from math import acos, cos, hypot, inf, pi, sqrt

import numpy as np

from .._lib.types import Floats
from .columns import JAW_COS, JAW_RADIUS, JAW_UX, JAW_UY, JAW_X, JAW_Y, NOSE_AXIS, NOSE_LEVEL, NOSE_SIDE


def bounds_of(noses: Floats) -> Floats:
    """``Table.bounds`` (2, 2) [m], from the noses (k, 5)."""
    bounds = np.full((2, 2), inf)
    for axis in (0, 1):
        for end, side in enumerate((-1, 1)):
            levels = noses[(noses[:, NOSE_AXIS] == axis) & (noses[:, NOSE_SIDE] == side), NOSE_LEVEL]
            bounds[axis, end] = side * max(levels, default=inf)
    return bounds


_PAST_THE_END = 5e-3
"""So much of a jaw's circle beyond its arc's end counts [m]: an arc may end before the fall's edge, at the mouth of a middle
pocket that is narrower than a ball by 4 mm."""


def deepest(jaws: Floats, falls: Floats, bounds: Floats, R: float) -> float:
    """How far past the noses a ball of radius R can lie between a jaw and the fall, plus 0.5 mm [m]."""
    deepest = 0.0
    for x, y, edge in falls:
        for jx, jy, radius, ux, uy, cos_half in jaws:
            # the ball's centre on the fall's edge and the ball at the jaw: the crossing of two circles
            dx, dy, reach, half = jx - x, jy - y, radius + R, acos(min(max(cos_half, -1.0), 1.0))
            far = hypot(dx, dy)
            if not abs(reach - edge) < far < reach + edge:
                continue
            along = (far * far + edge * edge - reach * reach) / (2.0 * far)
            off = sqrt(edge * edge - along * along)
            for side in (-1.0, 1.0):
                px, py = x + (along * dx - side * off * dy) / far, y + (along * dy + side * off * dx) / far
                on_arc = (px - jx) * ux + (py - jy) * uy >= reach * cos(min(half + _PAST_THE_END / reach, pi))
                if on_arc and not _in_a_jaw(px, py, jaws, R):
                    past = max(bounds[0, 0] - px, px - bounds[0, 1], bounds[1, 0] - py, py - bounds[1, 1])
                    deepest = max(deepest, past + 5e-4)
    return deepest


def _in_a_jaw(x, y, jaws, R):
    """As ``placement.in_jaw``, for all jaws."""
    dx, dy, radius, cos_half = x - jaws[:, JAW_X], y - jaws[:, JAW_Y], jaws[:, JAW_RADIUS], jaws[:, JAW_COS]
    far, width = np.hypot(dx, dy), 2.0 * radius * np.where(cos_half > 0.0, np.sqrt(1.0 - cos_half**2), 1.0)
    deep = (far < radius + R - 1e-6) & (far > radius - R - width)
    return bool(np.any(deep & (dx * jaws[:, JAW_UX] + dy * jaws[:, JAW_UY] >= cos_half * far)))


def narrowest(noses: Floats) -> tuple[float, int, int]:
    """The least distance of two facing noses that a ball can touch together [m], and their indices."""
    least = (np.inf, -1, -1)
    for a, (axis, side, level, low, high) in enumerate(noses):
        for b, (other_axis, other_side, other_level, other_low, other_high) in enumerate(noses):
            faces = a < b and axis == other_axis and side != other_side
            if faces and low <= other_high and other_low <= high:
                least = min(least, (float(level + other_level), a, b))
    return least
