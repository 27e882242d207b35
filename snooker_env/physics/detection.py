"""What happens next to a ball? Times of its next contact with a ball, nose, jaw or fall: reject cheaply, then solve exactly.

Relative position over a phase is c(x) = c0 + c1 x + c2 x^2. A contact is the first fall of |c| through a distance d.

Contact at gap zero. Two bodies that touch (gap below TOUCH) and close faster than CREEP meet at once. If they close more slowly,
stand still, or part, the next contact is the fall of the gap through -SKIN (if it is there already: at once): bodies pressed together by friction from rest gain a
closing speed before they meet, instead of meeting without end at speed zero, and bodies that part do not meet again by rounding.
"""

from math import inf, sqrt

from .._jit import kernel
from .cloth import AX, AY, REST, T0, T_END, VX, VY, X, Y
from .roots import quadratic_crossing, quartic_crossing

TOUCH = 1e-10  # m
SKIN = 5e-10  # m; overlap stays under the 1e-9 that the tests allow
STILL = 1e-12  # m/s; rounding may leave this much of a closing speed after a meeting
CREEP = 5e-5  # m/s; the speed gained over SKIN at the largest relative acceleration on cloth, about 2 mu_s g


@kernel
def distance_crossing(x0, y0, x1, y1, x2, y2, d, T):
    """Earliest time in [0, T] at which |c| falls through d, or inf."""
    far2 = x0 * x0 + y0 * y0
    dot1 = x0 * x1 + y0 * y1
    dot2 = x0 * x2 + y0 * y2
    if dot1 >= 0.0 and dot2 >= 0.0 and far2 > d * d:
        return inf  # the component along the line of centres only grows
    far = sqrt(far2)
    gap = far - d
    if gap < TOUCH:
        if -dot1 > CREEP * far or (gap <= -SKIN and -dot1 > STILL * far):
            return 0.0
        d = d - SKIN if gap > -1.5 * SKIN else far - SKIN
    else:
        # along the line of centres: its least value in [0, T] must come down to d
        reach = dot1 * T + dot2 * T * T
        if dot2 > 0.0 and dot1 < 0.0 and -dot1 < 2.0 * dot2 * T:
            reach = -0.25 * dot1 * dot1 / dot2
        if far2 + min(0.0, reach) > d * far:
            return inf
        # across the first direction of motion: the offset, less what the curve can take off it, must come down to d
        speed2 = x1 * x1 + y1 * y1
        side = abs(x1 * y0 - y1 * x0) - abs(x1 * y2 - y1 * x2) * T * T
        if side > 0.0 and side * side > d * d * speed2 * (1.0 + 1e-12):
            return inf
    return quartic_crossing(x2 * x2 + y2 * y2, 2.0 * (x1 * x2 + y1 * y2), x1 * x1 + y1 * y1 + 2.0 * dot2, 2.0 * dot1, far2 - d * d, T)


@kernel
def pair_time(motion, state, i, j, t, d):
    """Absolute time of the next contact of balls i and j, at centre distance d, within their present phases; t is now."""
    a, b = motion[i], motion[j]
    ti, tj = t - a[T0], t - b[T0]
    x2, y2 = 0.5 * (b[AX] - a[AX]), 0.5 * (b[AY] - a[AY])
    x1, y1 = b[VX] + b[AX] * tj - a[VX] - a[AX] * ti, b[VY] + b[AY] * tj - a[VY] - a[AY] * ti
    x0 = b[X] + (b[VX] + 0.5 * b[AX] * tj) * tj - a[X] - (a[VX] + 0.5 * a[AX] * ti) * ti
    y0 = b[Y] + (b[VY] + 0.5 * b[AY] * tj) * tj - a[Y] - (a[VY] + 0.5 * a[AY] * ti) * ti
    return t + distance_crossing(x0, y0, x1, y1, x2, y2, d, min(a[T_END], b[T_END]) - t)


@kernel
def _level_crossing(gap, closing, closing2, beside, T):
    """Earliest time in [0, T] at which gap - closing x - closing2 x^2 falls through contact, or inf.

    beside: the ball is beside the nose itself. In the mouth of a pocket it may be far beyond the nose's line without touching anything.
    """
    if beside and gap < TOUCH:
        if closing > CREEP or (gap <= -SKIN and closing > STILL):
            return 0.0
        gap = gap + SKIN if gap > -1.5 * SKIN else SKIN
    return quadratic_crossing(gap, -closing, -closing2, T)


@kernel
def boundary_event(motion, state, i, noses, jaws, falls, R):
    """The next nose (kind 1), jaw (2) or fall (3) of ball i after T0 within its phase: absolute time, kind, index; inf if none."""
    row = motion[i]
    best, kind, index = inf, 0, -1
    if state[i] == REST:
        return best, kind, index
    T = row[T_END] - row[T0]
    x0, y0, x1, y1, x2, y2 = row[X], row[Y], row[VX], row[VY], 0.5 * row[AX], 0.5 * row[AY]
    for k in range(noses.shape[0]):
        side, level = noses[k, 1], noses[k, 2]
        if noses[k, 0] == 0.0:
            p, p1, p2, q, q1, q2 = x0, x1, x2, y0, y1, y2
        else:
            p, p1, p2, q, q1, q2 = y0, y1, y2, x0, x1, x2
        beside = noses[k, 3] <= q <= noses[k, 4]
        s = _level_crossing(level - R - side * p, side * p1, side * p2, beside, min(T, best))
        if s < best:
            along = q + (q1 + q2 * s) * s
            if noses[k, 3] <= along <= noses[k, 4]:
                best, kind, index = s, 1, k
    for k in range(falls.shape[0]):
        s = distance_crossing(x0 - falls[k, 0], y0 - falls[k, 1], x1, y1, x2, y2, falls[k, 2], min(T, best))
        if s < best:
            best, kind, index = s, 3, k
    for k in range(jaws.shape[0]):
        cx, cy = x0 - jaws[k, 0], y0 - jaws[k, 1]
        s = distance_crossing(cx, cy, x1, y1, x2, y2, jaws[k, 2] + R, min(T, best))
        if s < best:
            dx, dy = cx + (x1 + x2 * s) * s, cy + (y1 + y2 * s) * s
            # closed range and a little more: the nose ends where the arc starts, and no rounding may open a gap between them
            if dx * jaws[k, 3] + dy * jaws[k, 4] >= (jaws[k, 5] - 1e-9) * sqrt(dx * dx + dy * dy):
                best, kind, index = s, 2, k
    return row[T0] + best, kind, index
