"""How near did a snookered striker's cue ball come to a ball on? Exact, for ``miss="attempt"``.

S3 R14(a) demands the striker's best endeavour, which a referee judges. The rule declared here: the cue ball
passes within ``ATTEMPT_GAP`` of a ball on, all still at rest, before its first contact or before it comes to
rest. If no ball on can be hit (``shut_in``), the balls that are not on are left out of that test.

The cue ball moves on pieces x + v t + a t^2 / 2. The derivative of its squared distance from a ball is a cubic,
monotone between its extremes: bisection finds every minimum."""

import numpy as np

from .._lib.jit import kernel
from ..geometry import BALL_RADIUS
from ..physics.cloth import AX, AY, SEGMENT_BALL, T0, T_END, VX, VY, X, Y
from .balls import CUE, N_BALLS

ATTEMPT_GAP = 2.0 * BALL_RADIUS
"""A gap up to this counts as the best effort [m]: one ball would just fit between cue ball and ball on."""
_HALVINGS = 60


@kernel
def _slope(c0, c1, c2, c3, t):
    """The cubic c0 + c1 t + c2 t^2 + c3 t^3."""
    return c0 + t * (c1 + t * (c2 + t * c3))


@kernel
def _minimum(c0, c1, c2, c3, low, high):
    """Where in [low, high], in which the cubic is monotone, it rises through zero; otherwise an end."""
    if _slope(c0, c1, c2, c3, low) >= 0.0:
        return low
    if _slope(c0, c1, c2, c3, high) <= 0.0:
        return high
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if _slope(c0, c1, c2, c3, middle) < 0.0:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


@kernel
def nearest_on_piece(dx, dy, vx, vy, ax, ay, T):
    """The smallest distance [m] from the origin of a point at d + v t + a t^2 / 2 for t in [0, T]."""
    c0, c1 = dx * vx + dy * vy, vx * vx + vy * vy + dx * ax + dy * ay
    c2, c3 = 1.5 * (vx * ax + vy * ay), 0.5 * (ax * ax + ay * ay)
    # The slope turns where c1 + 2 c2 t + 3 c3 t^2 = 0.
    first, second = T, T
    if c3 > 0.0:
        root = c2 * c2 - 3.0 * c1 * c3
        if root > 0.0:
            first, second = (-c2 - np.sqrt(root)) / (3.0 * c3), (-c2 + np.sqrt(root)) / (3.0 * c3)
    first, second = min(T, max(0.0, first)), min(T, max(0.0, second))
    best = np.inf
    for low, high in ((0.0, first), (first, second), (second, T)):
        t = _minimum(c0, c1, c2, c3, low, high)
        for at in (low, t, high):
            best = min(best, np.hypot(dx + at * (vx + 0.5 * at * ax), dy + at * (vy + 0.5 * at * ay)))
    return best


@kernel
def closest_approach(segments, n_segments, until, positions, on_table, on, radius):
    """The smallest gap [m] to a ball of the mask ``on`` up to the time ``until`` [s], or inf."""
    best, k = np.inf, 0
    while k < n_segments:
        if segments[k, SEGMENT_BALL] != CUE:
            k += 1
            continue
        following = k + 1
        while following < n_segments and segments[following, SEGMENT_BALL] != CUE:
            following += 1
        end = min(until, segments[k, T_END])
        if following < n_segments:
            end = min(end, segments[following, T0])
        T = end - segments[k, T0]
        if T >= 0.0:
            for i in range(1, N_BALLS):
                if on_table[i] and (on >> i) & 1:
                    dx, dy = segments[k, X] - positions[i, 0], segments[k, Y] - positions[i, 1]
                    vx, vy, ax, ay = segments[k, VX], segments[k, VY], segments[k, AX], segments[k, AY]
                    best = min(best, nearest_on_piece(dx, dy, vx, vy, ax, ay, T) - 2.0 * radius)
        k = following
    return best
