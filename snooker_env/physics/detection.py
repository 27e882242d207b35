"""When does a ball next meet a ball, nose, jaw or fall? A quick rejection, then the exact time.

A contact is the first time x from now [s] at which |c| falls through d, c(x) = c0 + c1 x + c2 x^2 [m].

Bodies in touch (gap below TOUCH) that approach faster than CREEP meet at once. Otherwise their contact is
where the gap falls through -SKIN (at once if it is there). So what friction presses together gains a closing
speed first, does not meet infinitely often at speed zero, and bodies that separate do not meet by rounding.

A ball's centre is kept out by lines beside noses and by circles about arcs (facings too) in their sectors,
with common tangents. Each judges a path from where it comes into its range, by the rule above: so a ball SKIN
deep in a nose is handed on to the arc. Ranges are longer by SEAM, so that no crack is left. Deeper than HELD
behind a piece is another part of the table.
"""

from math import inf, sqrt

from .._lib.jit import kernel
from . import events
from .cloth import AX, AY, HI_X, HI_Y, LO_X, LO_Y, REST, ROLL, T0, T_END, VX, VY, X, Y, extent
from .columns import (
    AXIS_X,
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
from .placement import OVERLAP_ALLOWED
from .roots import quadratic_crossing, quartic_crossing

TOUCH = 1e-10  # m
SKIN = 5e-10  # m; so the overlap stays under the 1e-9 that the tests allow
_DEEP = SKIN * (1.0 - 1e-6)  # an overlap of at least this is SKIN, up to rounding
_MARGIN = 1e-9  # m; bodies nearer than this to a path may touch it
_AROUND = 1e-5  # m^2; more than SEAM and HELD add to the square of a half chord of 1 m or less
SEAM = 1e-9  # m; past its end a line is 1e-17 m off the arc that goes on
HELD = 2.0 * OVERLAP_ALLOWED  # m
STILL = 1e-12  # m/s; rounding may leave this much of a closing speed after a meeting
CREEP = 5e-5  # m/s; the speed gained over SKIN at the largest relative acceleration on cloth, about 2 mu_s g


@kernel
def distance_crossing(x0, y0, x1, y1, x2, y2, d, T):
    """Earliest time in [0, T] at which |c| falls through d [s], or inf; c_i = (x_i, y_i)."""
    far2 = x0 * x0 + y0 * y0
    dot1 = x0 * x1 + y0 * y1
    dot2 = x0 * x2 + y0 * y2
    if dot1 >= 0.0 and dot2 >= 0.0 and far2 > d * d:
        return inf  # the component along the line of centres can only grow
    far = sqrt(far2)
    gap = far - d
    if gap < TOUCH:
        if -dot1 > CREEP * far or (gap <= -_DEEP and -dot1 > STILL * far):
            return 0.0
        d = d - SKIN if gap > -1.5 * SKIN else far - SKIN
    else:
        # along the line of centres: the lowest value in [0, T] must be d or less
        reach = dot1 * T + dot2 * T * T
        if dot2 > 0.0 and dot1 < 0.0 and -dot1 < 2.0 * dot2 * T:
            reach = -0.25 * dot1 * dot1 / dot2
        if far2 + min(0.0, reach) > d * far:
            return inf
        # across the first direction of motion: the offset, less the most by curvature, must be d or less
        speed2 = x1 * x1 + y1 * y1
        side = abs(x1 * y0 - y1 * x0) - abs(x1 * y2 - y1 * x2) * T * T
        if side > 0.0 and side * side > d * d * speed2 * (1.0 + 1e-12):
            return inf
    return quartic_crossing(
        x2 * x2 + y2 * y2,
        2.0 * (x1 * x2 + y1 * y2),
        x1 * x1 + y1 * y1 + 2.0 * dot2,
        2.0 * dot1,
        far2 - d * d,
        T,
    )


@kernel
def space_crossing(c0, c1, c2, d, T):
    """``distance_crossing`` in three dimensions."""
    far2 = c0[0] * c0[0] + c0[1] * c0[1] + c0[2] * c0[2]
    dot1 = c0[0] * c1[0] + c0[1] * c1[1] + c0[2] * c1[2]
    dot2 = c0[0] * c2[0] + c0[1] * c2[1] + c0[2] * c2[2]
    if dot1 >= 0.0 and dot2 >= 0.0 and far2 > d * d:
        return inf
    far = sqrt(far2)
    gap = far - d
    if gap < TOUCH:
        if -dot1 > CREEP * far or (gap <= -_DEEP and -dot1 > STILL * far):
            return 0.0
        d = d - SKIN if gap > -1.5 * SKIN else far - SKIN
    else:
        reach = dot1 * T + dot2 * T * T
        if dot2 > 0.0 and dot1 < 0.0 and -dot1 < 2.0 * dot2 * T:
            reach = -0.25 * dot1 * dot1 / dot2
        if far2 + min(0.0, reach) > d * far:
            return inf
    return quartic_crossing(
        c2[0] * c2[0] + c2[1] * c2[1] + c2[2] * c2[2],
        2.0 * (c1[0] * c2[0] + c1[1] * c2[1] + c1[2] * c2[2]),
        c1[0] * c1[0] + c1[1] * c1[1] + c1[2] * c1[2] + 2.0 * dot2,
        2.0 * dot1,
        far2 - d * d,
        T,
    )


@kernel
def _rolls_onto(dx, dy, vx, vy, ax, ay, d):
    """Time until a ball rolling at v, deceleration a, meets one at rest at (dx, dy) from it [s], or inf."""
    speed2 = vx * vx + vy * vy
    along, across = dx * vx + dy * vy, dx * vy - dy * vx  # times the speed
    half = d * d * speed2 - across * across
    if along <= 0.0 or half <= 0.0:
        return inf
    speed = sqrt(speed2)
    # along the straight path to the contact
    distance = (dx * dx + dy * dy - d * d) * speed / (along + sqrt(half))
    left = speed2 - 2.0 * distance * sqrt(ax * ax + ay * ay)  # the square of its speed there
    return 2.0 * distance / (speed + sqrt(left)) if left >= 0.0 else inf


@kernel
def pair_time(motion, state, i, j, t, d):
    """Absolute time of the next contact of i and j in their phases [s]; t: now; d: distance then."""
    ti, tj = t - motion[i, T0], t - motion[j, T0]
    axi, ayi, axj, ayj = motion[i, AX], motion[i, AY], motion[j, AX], motion[j, AY]
    vxi, vyi, vxj, vyj = motion[i, VX], motion[i, VY], motion[j, VX], motion[j, VY]
    x1, y1 = vxj + axj * tj - vxi - axi * ti, vyj + ayj * tj - vyi - ayi * ti
    x0 = motion[j, X] + (vxj + 0.5 * axj * tj) * tj - motion[i, X] - (vxi + 0.5 * axi * ti) * ti
    y0 = motion[j, Y] + (vyj + 0.5 * ayj * tj) * tj - motion[i, Y] - (vyi + 0.5 * ayi * ti) * ti
    if state[i] + state[j] == ROLL + REST and x0 * x0 + y0 * y0 > (d + TOUCH) * (d + TOUCH):
        # one is at rest, so the relative motion is that of the other
        return t + _rolls_onto(-x0, -y0, x1, y1, axj - axi, ayj - ayi, d)
    T = min(motion[i, T_END], motion[j, T_END]) - t
    return t + distance_crossing(x0, y0, x1, y1, 0.5 * (axj - axi), 0.5 * (ayj - ayi), d, T)


@kernel
def _apart(lo_x, hi_x, lo_y, hi_y, x, y, r2):
    """Whether a circle about (x, y), radius^2 r2, and the rectangle have no common point."""
    dx, dy = max(lo_x - x, x - hi_x, 0.0), max(lo_y - y, y - hi_y, 0.0)
    return dx * dx + dy * dy > r2


@kernel
def _arc_outside(lo_x, hi_x, lo_y, hi_y, jaws, k, d):
    """Whether the arc of radius d about jaw k, in its sector, is outside the rectangle, by its bounds."""
    x, y, ux, uy, cos_half = (
        jaws[k, JAW_X],
        jaws[k, JAW_Y],
        jaws[k, JAW_UX],
        jaws[k, JAW_UY],
        jaws[k, JAW_COS],
    )
    sin_half = sqrt(1.0 - cos_half * cos_half)
    x1, y1 = cos_half * ux - sin_half * uy, cos_half * uy + sin_half * ux
    x2, y2 = cos_half * ux + sin_half * uy, cos_half * uy - sin_half * ux
    left, right = -1.0 if -ux >= cos_half else min(x1, x2), 1.0 if ux >= cos_half else max(x1, x2)
    low, high = -1.0 if -uy >= cos_half else min(y1, y2), 1.0 if uy >= cos_half else max(y1, y2)
    return (
        x + d * right < lo_x + _MARGIN
        or x + d * left > hi_x - _MARGIN
        or y + d * high < lo_y + _MARGIN
        or y + d * low > hi_y - _MARGIN
    )


@kernel
def clear_box(boundaries):
    """A rectangle (lo_x, hi_x, lo_y, hi_y) [m] where centres meet no nose, jaw or fall; may be empty."""
    noses, jaws, falls, R = boundaries
    lo_x, hi_x, lo_y, hi_y = -inf, inf, -inf, inf
    for k in range(noses.shape[0]):
        level = noses[k, NOSE_LEVEL] - R
        if noses[k, NOSE_AXIS] == AXIS_X:
            lo_x, hi_x = (lo_x, min(hi_x, level)) if noses[k, NOSE_SIDE] > 0.0 else (max(lo_x, -level), hi_x)
        else:
            lo_y, hi_y = (lo_y, min(hi_y, level)) if noses[k, NOSE_SIDE] > 0.0 else (max(lo_y, -level), hi_y)
    free = True
    for k in range(jaws.shape[0]):
        d = jaws[k, JAW_RADIUS] + R
        r2 = (d - _MARGIN) * (d - _MARGIN)
        free = free and (
            _apart(lo_x, hi_x, lo_y, hi_y, jaws[k, JAW_X], jaws[k, JAW_Y], r2)
            or _arc_outside(lo_x, hi_x, lo_y, hi_y, jaws, k, d)
        )
    for k in range(falls.shape[0]):
        r2 = (falls[k, FALL_RADIUS] - _MARGIN) * (falls[k, FALL_RADIUS] - _MARGIN)
        free = free and _apart(lo_x, hi_x, lo_y, hi_y, falls[k, FALL_X], falls[k, FALL_Y], r2)
    if not free:
        return inf, -inf, inf, -inf
    return lo_x, hi_x, lo_y, hi_y


@kernel
def _level_crossing(gap, closing, closing2, held, T):
    """Earliest x in [0, T] at which gap - closing x - closing2 x^2 falls through 0 or inf; held: touching."""
    if held and gap < TOUCH:
        if closing > CREEP or (gap <= -_DEEP and closing > STILL):
            return 0.0
        gap = gap + SKIN if gap > -1.5 * SKIN else SKIN
    return quadratic_crossing(gap, -closing, -closing2, T)


@kernel
def _beside_later(approach, along, low, high, T):
    """Earliest contact in [0, T] with a nose of a ball that comes in touch from the next arc [s], or inf.

    ``approach``: its gap is gap - closing t - closing2 t^2; ``along``: its place is q + q1 t + q2 t^2, not
    beside the nose (``low`` to ``high``) when it passes the line.
    """
    (gap, closing, closing2), (q, q1, q2) = approach, along
    first = inf
    for x in (quadratic_crossing(low - q, -q1, -q2, T), quadratic_crossing(q - high, q1, q2, T)):
        if x < inf and gap - (closing + closing2 * x) * x > -HELD:
            s = x + _level_crossing(
                gap - (closing + closing2 * x) * x, closing + 2.0 * closing2 * x, closing2, True, T - x
            )
            if s < first and low <= q + (q1 + q2 * s) * s <= high:
                first = s
    return first


@kernel
def _past_end(x, y, ux, uy, cos_half, sin_half):
    """How far outside the arc's sector (x, y) from its centre is, near its ends [m]; inside <= 0."""
    past = cos_half * sqrt(x * x + y * y) - (x * ux + y * uy)
    return past / sin_half if past > 0.0 and sin_half > 0.0 else past


@kernel
def _jaw_time(path, d, sector, T):
    """Earliest time in [0, T] at which |c| (``path``) falls through d within the arc's sector [s], or inf."""
    (x0, y0, x1, y1, x2, y2), (ux, uy, cos_half) = path, sector
    s = distance_crossing(x0, y0, x1, y1, x2, y2, d, T)
    far2, sin_half = x0 * x0 + y0 * y0, sqrt(1.0 - cos_half * cos_half)
    held = far2 > (d - HELD) * (d - HELD) and _past_end(x0, y0, ux, uy, cos_half, sin_half) <= SEAM
    if far2 > (d + TOUCH) * (d + TOUCH) or held:
        if s == inf:
            return s
        px, py = x0 + (x1 + x2 * s) * s, y0 + (y1 + y2 * s) * s
        past = _past_end(px, py, ux, uy, cos_half, sin_half)
        closing = -(px * (x1 + 2.0 * x2 * s) + py * (y1 + 2.0 * y2 * s))
        # (a ball that glides along the nose only grazes the circle)
        if past <= 0.0 or (past <= SEAM and closing > CREEP * d):
            return s
    # it meets the circle outside the sector, but may come into it in touch, over either end
    first = inf
    for side in (-1.0, 1.0):
        # from the centre to the end of the arc
        ex, ey = cos_half * ux - side * sin_half * uy, cos_half * uy + side * sin_half * ux
        x = quadratic_crossing(
            side * (y0 * ex - x0 * ey), side * (y1 * ex - x1 * ey), side * (y2 * ex - x2 * ey), T
        )
        if x == inf:
            continue
        px, py = x0 + (x1 + x2 * x) * x, y0 + (y1 + y2 * x) * x
        if px * ex + py * ey > max(0.0, d - HELD):
            s = x + distance_crossing(px, py, x1 + 2.0 * x2 * x, y1 + 2.0 * y2 * x, x2, y2, d, T - x)
            if (
                s < first
                and _past_end(x0 + (x1 + x2 * s) * s, y0 + (y1 + y2 * s) * s, ux, uy, cos_half, sin_half)
                <= SEAM
            ):
                first = s
    return first


@kernel
def boundary_event(motion, state, i, boundaries, clear):
    """The next nose, jaw or fall that ball i meets in its phase: time [s] or inf, kind, index."""
    noses, jaws, falls, R = boundaries
    best, kind, index = inf, events.NONE, -1
    lo_x, hi_x, lo_y, hi_y = (
        motion[i, LO_X] - _MARGIN,
        motion[i, HI_X] + _MARGIN,
        motion[i, LO_Y] - _MARGIN,
        motion[i, HI_Y] + _MARGIN,
    )
    clear_lo_x, clear_hi_x, clear_lo_y, clear_hi_y = clear
    if state[i] == REST or (
        lo_x > clear_lo_x and hi_x < clear_hi_x and lo_y > clear_lo_y and hi_y < clear_hi_y
    ):
        return best, kind, index
    T = motion[i, T_END] - motion[i, T0]
    x0, y0, x1, y1, x2, y2 = (
        motion[i, X],
        motion[i, Y],
        motion[i, VX],
        motion[i, VY],
        0.5 * motion[i, AX],
        0.5 * motion[i, AY],
    )
    for k in range(noses.shape[0]):
        side, level, low, high = (
            noses[k, NOSE_SIDE],
            noses[k, NOSE_LEVEL],
            noses[k, NOSE_LOW],
            noses[k, NOSE_HIGH],
        )
        if noses[k, NOSE_AXIS] == AXIS_X:
            if (hi_x if side > 0.0 else -lo_x) < level - R or hi_y < low or lo_y > high:
                continue
            p, p1, p2, q, q1, q2 = x0, x1, x2, y0, y1, y2
        else:
            if (hi_y if side > 0.0 else -lo_y) < level - R or hi_x < low or lo_x > high:
                continue
            p, p1, p2, q, q1, q2 = y0, y1, y2, x0, x1, x2
        gap, low, high = level - R - side * p, low - SEAM, high + SEAM
        beside = low <= q <= high
        s = _level_crossing(gap, side * p1, side * p2, beside and gap > -HELD, min(T, best))
        past = not low <= q + (q1 + q2 * s) * s <= high if s < inf else gap <= 0.0 and not beside
        if past:
            s = _beside_later((gap, side * p1, side * p2), (q, q1, q2), low, high, min(T, best))
        if s < best:
            best, kind, index = s, events.CUSHION, k
    if best < T:  # only something on the way to the nose can come first
        lo_x, hi_x = extent(x0, x1, motion[i, AX], best)
        lo_y, hi_y = extent(y0, y1, motion[i, AY], best)
        lo_x, hi_x, lo_y, hi_y = lo_x - _MARGIN, hi_x + _MARGIN, lo_y - _MARGIN, hi_y + _MARGIN
    # one limit for all falls, then one for all jaws: so the result does not depend on their order
    T = min(T, best)
    for k in range(falls.shape[0]):
        radius = falls[k, FALL_RADIUS]
        if _apart(lo_x, hi_x, lo_y, hi_y, falls[k, FALL_X], falls[k, FALL_Y], radius * radius):
            continue
        s = distance_crossing(x0 - falls[k, FALL_X], y0 - falls[k, FALL_Y], x1, y1, x2, y2, radius, T)
        if s < best:
            best, kind, index = s, events.POT, k
    T = min(T, best)
    for k in range(jaws.shape[0]):
        x, y, d = jaws[k, JAW_X], jaws[k, JAW_Y], jaws[k, JAW_RADIUS] + R
        if _apart(lo_x, hi_x, lo_y, hi_y, x, y, d * d):
            continue
        ux, uy, cos_half = jaws[k, JAW_UX], jaws[k, JAW_UY], jaws[k, JAW_COS]
        # of the half arc; of a facing this is a small part of a very large circle
        chord2 = 2.0 * (1.0 - cos_half) * d * d
        if _apart(lo_x, hi_x, lo_y, hi_y, x + d * ux, y + d * uy, chord2 + _AROUND):
            continue
        s = _jaw_time((x0 - x, y0 - y, x1, y1, x2, y2), d, (ux, uy, cos_half), T)
        if s < best:
            best, kind, index = s, events.JAW, k
    return motion[i, T0] + best, kind, index
