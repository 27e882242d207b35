"""How does a ball fly, what does it meet in the air, and where does it come down?

Only with ``Physics.flight``. z is the height of a ball's centre above its height on the bed [m], u its rate [m/s].

* **In the air** (``AIR``) du/dt = -g; the velocity in the plane and the spin are constant.
* **The bed** throws a ball that comes down at the speed d up again at e_t d. The cloth rubs as in any impact with the bed: by
  at most mu_s times the normal impulse (1 + e_t) d, and at most 2/7 of the slip (``rub_bed``). A ball that would leave the
  bed with less than ``SETTLE`` stays there; so bounces end.
* **Two balls on the bed** meet as in the paper. Friction lifts one and presses the other with an equal impulse J: the
  one leaves with J, the other with e_t J.
* **A nose** is a sharp edge at the height H = R sin_theta above the centre of a ball that lies. A ball in the air meets it where
  their distance is R, from below or from above, as a free sphere meets a fixed body (``impact/free.py``). On the bed
  a ball stops R off the table's line: so the edge lies R (1 - cos_theta) inside that line, for jaws as well.
* **The top of the rails** is a plane at the height of the noses: z = H + R. A ball bounces there as on the bed; one that would
  stay there has left the table, and so has one that is ``RAIL`` beyond the edge of the noses.
* **Pockets**: a ball that comes down inside a fall drops (``pocket.py``). One that leaves a fall outwards has hit the pocket's
  back and is potted, if its centre is not above the nose's height (7R/5), else it has left the table, or bounces on the rail.

[TP A.14] and [TP B.5] Alciatore; the bed's restitution is measured nowhere: 0.5 in both.
"""

from math import hypot, inf, sqrt

from .._lib.jit import kernel
from . import cloth, events, pocket
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
    P_E_T,
    P_G,
    P_MU_S,
    P_R,
    P_SIN,
)
from .detection import CREEP, SEAM, SKIN, TOUCH, distance_crossing, space_crossing

SETTLE = 0.03
"""A ball that would leave the bed more slowly stays on it [m/s]: a hop of 46 micrometres and 6 ms. Bounces so end."""
RAIL = 0.127  # width of a rail, from the edge of the nose to the floor [m]: 5 inches
_NEAR_ENOUGH = 1e-12  # a ball this near to a jaw touches it [m]
_GLIDES = 1e-9  # the gap of a ball that touches a jaw, but does not approach it [m]
_HOLLOW = 1e12
"""The most that an edge is hollow: by the centre of its arc; finite, so that it times a speed of zero is zero."""
_MOST_STEPS = 1000  # of the search for a jaw, which converges as Newton's method does


MET, STRUCK, WATCHED, WAY_X, WAY_Y, JUMPED = range(pocket.FLIGHT, pocket.FLIGHT + 6)
COLUMNS = pocket.FLIGHT + 6
"""Of ball 0 in ``Motions.flight``, behind the columns of ``pocket``: the ball that it met first, or -1; below 0 once it is
certain whether the stroke was a jump shot; the way it came; 1 for a jump shot."""
OVER = 1e-3  # seen from above a ball covers a part of another if they overlap by this [m]


@kernel
def rub_bed(v, w, press, mu_s, R):
    """(vx, vy) [m/s] and (wx, wy) [rad/s] of a ball after the bed has given it ``press`` [m/s], the upward impulse over the
    mass: friction mu_s ``press`` against the slip; at 2/7 of the slip the ball rolls."""
    (vx, vy), (wx, wy) = v, w
    ux, uy = vx - R * wy, vy + R * wx
    slip, friction = hypot(ux, uy), mu_s * press
    if 3.5 * friction >= slip:
        vx, vy = vx - ux / 3.5, vy - uy / 3.5
        return (vx, vy), (-vy / R, vx / R)
    dx, dy = -friction * ux / slip, -friction * uy / slip
    return (vx + dx, vy + dy), (wx + 2.5 * dy / R, wy - 2.5 * dx / R)


@kernel
def bounce_off_bed(v, w, down, phys):
    """What the bed, or the top of a rail, makes of a ball that comes down at the speed ``down``: v, w, and its speed up; 0: it stays."""
    up = phys[P_E_T] * down
    if up < SETTLE:
        up = 0.0
    (vx, vy), (wx, wy) = rub_bed((v[0], v[1]), (w[0], w[1]), down + up, phys[P_MU_S], phys[P_R])
    return (vx, vy), (wx, wy, w[2]), up


@kernel
def press_into_bed(v, w, impulse, phys):
    """The same of a ball on the bed that another has pressed into it with this impulse, which has rubbed already."""
    up = phys[P_E_T] * impulse
    if up < SETTLE:
        return (v[0], v[1]), w, 0.0
    (vx, vy), (wx, wy) = rub_bed((v[0], v[1]), (w[0], w[1]), up, phys[P_MU_S], phys[P_R])
    return (vx, vy), (wx, wy, w[2]), up


@kernel
def height(motion, state, i, t, phys):
    """Ball i's height above the bed [m] at t within its present phase, and its rate [m/s]; over a pocket below 0."""
    if state[i] != cloth.AIR and state[i] != cloth.FALLING:
        return 0.0, 0.0
    dt, g = t - motion[i, cloth.T0], phys[P_G]
    return motion[i, cloth.Z] + (motion[i, cloth.UZ] - 0.5 * g * dt) * dt, motion[i, cloth.UZ] - g * dt


@kernel
def evaluate(motion, state, i, t, phys):
    """``cloth.evaluate`` of a ball that may be in the air."""
    if state[i] != cloth.AIR:
        return cloth.evaluate(motion, state, i, t, phys)
    dt, v = t - motion[i, cloth.T0], (motion[i, cloth.VX], motion[i, cloth.VY])
    w = motion[i, cloth.WX], motion[i, cloth.WY], motion[i, cloth.WZ]
    return (motion[i, cloth.X] + v[0] * dt, motion[i, cloth.Y] + v[1] * dt), v, w


@kernel
def take_off(motion, state, i, t, r, v, w, phys):
    """Ball i is in the air at t [s], at r = (x, y, z) with v = (vx, vy, u): write its flight, at the longest to the bed."""
    (x, y, z), (vx, vy, u), g = r, v, phys[P_G]
    state[i] = cloth.AIR
    motion[i, cloth.X], motion[i, cloth.Y], motion[i, cloth.Z] = x, y, z
    motion[i, cloth.VX], motion[i, cloth.VY], motion[i, cloth.UZ] = vx, vy, u
    motion[i, cloth.AX] = motion[i, cloth.AY] = 0.0
    motion[i, cloth.WX], motion[i, cloth.WY], motion[i, cloth.WZ] = w
    root = sqrt(u * u + 2.0 * g * max(0.0, z))
    T = (u + root) / g if u > 0.0 else 2.0 * max(0.0, z) / (root - u) if root > 0.0 else 0.0
    motion[i, cloth.T0], motion[i, cloth.T_END] = t, t + T
    motion[i, cloth.LO_X], motion[i, cloth.HI_X] = min(x, x + vx * T), max(x, x + vx * T)
    motion[i, cloth.LO_Y], motion[i, cloth.HI_Y] = min(y, y + vy * T), max(y, y + vy * T)


@kernel
def leave(motion, state, i, t, r, v, w, up, phys):
    """Ball i is on the bed at r = (x, y) [m] and leaves it at the speed ``up``, or moves on it."""
    if up >= SETTLE:
        take_off(motion, state, i, t, (r[0], r[1], 0.0), (v[0], v[1], up), w, phys)
    else:
        cloth.begin(motion, state, i, t, (r[0], r[1]), (v[0], v[1]), w, phys)
        motion[i, cloth.Z] = motion[i, cloth.UZ] = 0.0


@kernel
def pair_time(motion, state, i, j, t, d, phys):
    """``detection.pair_time`` where one or both of the balls are in the air."""
    ti, tj, g = t - motion[i, cloth.T0], t - motion[j, cloth.T0], phys[P_G]
    axi, ayi, axj, ayj = motion[i, cloth.AX], motion[i, cloth.AY], motion[j, cloth.AX], motion[j, cloth.AY]
    vxi, vyi, vxj, vyj = motion[i, cloth.VX], motion[i, cloth.VY], motion[j, cloth.VX], motion[j, cloth.VY]
    # a ball over a pocket is met as if it were on the bed
    zi, ui = height(motion, state, i, t, phys) if state[i] == cloth.AIR else (0.0, 0.0)
    zj, uj = height(motion, state, j, t, phys) if state[j] == cloth.AIR else (0.0, 0.0)
    c0 = (
        motion[j, cloth.X] + (vxj + 0.5 * axj * tj) * tj - motion[i, cloth.X] - (vxi + 0.5 * axi * ti) * ti,
        motion[j, cloth.Y] + (vyj + 0.5 * ayj * tj) * tj - motion[i, cloth.Y] - (vyi + 0.5 * ayi * ti) * ti,
        zj - zi,
    )
    c1 = vxj + axj * tj - vxi - axi * ti, vyj + ayj * tj - vyi - ayi * ti, uj - ui
    falls = (g if state[i] == cloth.AIR else 0.0) - (g if state[j] == cloth.AIR else 0.0)
    c2 = 0.5 * (axj - axi), 0.5 * (ayj - ayi), 0.5 * falls
    return t + space_crossing(c0, c1, c2, d, min(motion[i, cloth.T_END], motion[j, cloth.T_END]) - t)


@kernel
def _edge_of(x, y, jaws, k, inset):
    """The place on the edge of jaw k nearest to (x, y) [m], and how hollow the edge is from there (``_jaw_time``): at most 1
    in front of it. ``inset``: how far the edge lies inside the table's line."""
    dx, dy, ux, uy = x - jaws[k, JAW_X], y - jaws[k, JAW_Y], jaws[k, JAW_UX], jaws[k, JAW_UY]
    cos_half, radius, far = jaws[k, JAW_COS], jaws[k, JAW_RADIUS] + inset, hypot(dx, dy)
    if far == 0.0:
        return jaws[k, JAW_X] + radius * ux, jaws[k, JAW_Y] + radius * uy, _HOLLOW
    nx, ny = dx / far, dy / far
    hollow = radius / far
    if cos_half > -1.0 and nx * ux + ny * uy < cos_half:  # beside it: its end
        sin_half, aside = sqrt(1.0 - cos_half * cos_half), dy * ux - dx * uy
        hollow = radius * sin_half / abs(aside) if aside != 0.0 else _HOLLOW
        s = sin_half if aside > 0.0 else -sin_half
        nx, ny = cos_half * ux - s * uy, cos_half * uy + s * ux
    return jaws[k, JAW_X] + radius * nx, jaws[k, JAW_Y] + radius * ny, min(hollow, _HOLLOW)


@kernel
def _jaw_time(r, v, jaws, k, high, T, phys):
    """The first time in [0, T] at which a ball at r with v meets jaw k [s], or inf.

    Along a line the distance to a convex edge is convex; gravity bends it by at most g. So while the ball is in front of
    the edge its gap after h is at least gap - closing h - g h^2 / 2: each step goes to where this is zero.

    Behind the edge, which is hollow there, other places of it come nearer. Let D be the distance from P to e, the nearest.
    For any place e' on the edge |e' - e|^2 <= hollow (|P - e'|^2 - D^2): hollow is the arc's radius over the distance from its
    centre, or where an end is the nearest, half the chord over the distance from the axis. With the speed s in the
    plane, |P + v h - e'|^2 is then at least (D - closing h)^2 - m h^2, m = hollow s^2 + closing^2 - |v|^2: the gap bends by up
    to g + 2 m / R. No gap closes faster than the ball moves: that bound is the better one by the arc's centre.
    """
    (x, y, z), (vx, vy, u), R, g = r, v, phys[P_R], phys[P_G]
    level2 = vx * vx + vy * vy
    inset, t, goal = R - sqrt(R * R - high * high), 0.0, 0.0
    for n in range(_MOST_STEPS):
        px, py, pz = x + vx * t, y + vy * t, z + (u - 0.5 * g * t) * t
        ex, ey, hollow = _edge_of(px, py, jaws, k, inset)
        dx, dy, dz = ex - px, ey - py, high - pz
        far = sqrt(dx * dx + dy * dy + dz * dz)
        closing = (vx * dx + vy * dy + (u - g * t) * dz) / far
        if n == 0 and far - R < TOUCH:
            if closing > CREEP:
                return 0.0
            goal = min(far - R, 0.0) - SKIN
        gap = far - R - goal
        if gap < _NEAR_ENOUGH:
            if closing > 0.0:
                return min(t, T)
            gap = _GLIDES
        step = (sqrt(closing * closing + 2.0 * g * gap) - closing) / g
        if hollow > 1.0:
            speed2 = level2 + (u - g * t) * (u - g * t)
            bend = g + 2.0 * max(0.0, hollow * level2 + closing * closing - speed2) / (R + goal)
            step = (sqrt(closing * closing + 2.0 * bend * gap) - closing) / bend
            step = max(step, (sqrt(speed2 + 2.0 * g * gap) - sqrt(speed2)) / g)
        t += step
        if t > T:
            return inf
    return inf


@kernel
def edge_normal(motion, state, i, t, kind, j, boundaries, phys):
    """The unit vector from ball i in the air, at t, to the nose or jaw j that it touches."""
    dt, R = t - motion[i, cloth.T0], phys[P_R]
    x, y = motion[i, cloth.X] + motion[i, cloth.VX] * dt, motion[i, cloth.Y] + motion[i, cloth.VY] * dt
    z, _ = height(motion, state, i, t, phys)
    inset, noses = R - R * sqrt(1.0 - phys[P_SIN] * phys[P_SIN]), boundaries.noses
    if kind == events.JAW:
        ex, ey, _ = _edge_of(x, y, boundaries.jaws, j, inset)
        dx, dy = ex - x, ey - y
    else:
        side, level = noses[j, NOSE_SIDE], noses[j, NOSE_LEVEL] - inset
        dx, dy = (side * level - x, 0.0) if noses[j, NOSE_AXIS] == AXIS_X else (0.0, side * level - y)
    dz = R * phys[P_SIN] - z
    far = sqrt(dx * dx + dy * dy + dz * dz)
    return dx / far, dy / far, dz / far


@kernel
def _beyond(x, y, noses, inset):
    """How far (x, y) is beyond the edge of a nose or the line on which it lies [m]; inside below 0."""
    far = -inf
    for k in range(noses.shape[0]):
        along = x if noses[k, NOSE_AXIS] == AXIS_X else y
        far = max(far, noses[k, NOSE_SIDE] * along - noses[k, NOSE_LEVEL] + inset)
    return far


@kernel
def _fall_at(x, y, falls):
    """The fall whose circle has (x, y) inside, or -1."""
    for k in range(falls.shape[0]):
        dx, dy = x - falls[k, FALL_X], y - falls[k, FALL_Y]
        if dx * dx + dy * dy < falls[k, FALL_RADIUS] * falls[k, FALL_RADIUS]:
            return k
    return -1


@kernel
def next_event(motion, i, boundaries, clear, phys):
    """What ball i in the air meets next, but for balls: time [s], kind, index."""
    noses, jaws, falls, R = boundaries
    T, g, high = motion[i, cloth.T_END] - motion[i, cloth.T0], phys[P_G], phys[P_SIN] * phys[P_R]
    inset = R - sqrt(R * R - high * high)
    lo_x, hi_x = motion[i, cloth.LO_X], motion[i, cloth.HI_X]
    lo_y, hi_y = motion[i, cloth.LO_Y], motion[i, cloth.HI_Y]
    free_x = lo_x > clear[0] + inset and hi_x < clear[1] - inset
    if free_x and lo_y > clear[2] + inset and hi_y < clear[3] - inset:
        return motion[i, cloth.T_END], events.LAND, -1
    x, y, z = motion[i, cloth.X], motion[i, cloth.Y], motion[i, cloth.Z]
    vx, vy, u = motion[i, cloth.VX], motion[i, cloth.VY], motion[i, cloth.UZ]
    into = _fall_at(x + vx * T, y + vy * T, falls)
    best, kind, index = T, events.DROP if into >= 0 else events.LAND, into
    for k in range(noses.shape[0]):
        side, edge = noses[k, NOSE_SIDE], noses[k, NOSE_LEVEL] - inset
        if noses[k, NOSE_AXIS] == AXIS_X:
            p, p1, q, q1 = side * x, side * vx, y, vy
        else:
            p, p1, q, q1 = side * y, side * vy, x, vx
        if max(p, p + p1 * T) < edge - R:
            continue
        # the edge has ends: a ball is judged from where it comes beside it
        low, upto, since = noses[k, NOSE_LOW], noses[k, NOSE_HIGH], 0.0
        if (q < low and q1 > 0.0) or (q > upto and q1 < 0.0):
            since = ((low if q < low else upto) - q) / q1
        if since <= T:
            off, up, u0 = edge - (p + p1 * since), high - (z + (u - 0.5 * g * since) * since), u - g * since
            s = since + distance_crossing(off, up, -p1, -u0, 0.0, 0.5 * g, R, T - since)
            if s < best and low - SEAM <= q + q1 * s <= upto + SEAM:
                best, kind, index = s, events.CUSHION, k
        s = (edge + RAIL - p) / p1 if p1 > 0.0 else inf
        if s < best:
            best, kind, index = max(0.0, s), events.OFF, -1
    T = best  # one limit for all jaws: so the result does not depend on their order
    for k in range(jaws.shape[0]):
        radius = jaws[k, JAW_RADIUS] + inset
        mx, my = jaws[k, JAW_X] + radius * jaws[k, JAW_UX], jaws[k, JAW_Y] + radius * jaws[k, JAW_UY]
        reach = R + TOUCH + radius * sqrt(2.0 * (1.0 - jaws[k, JAW_COS]))  # from the middle of the arc
        dx, dy = max(lo_x - mx, mx - hi_x, 0.0), max(lo_y - my, my - hi_y, 0.0)
        if dx * dx + dy * dy < reach * reach:
            s = _jaw_time((x, y, z), (vx, vy, u), jaws, k, high, T, phys)
            if s < best:
                best, kind, index = s, events.JAW, k
    top = high + R
    above2 = u * u + 2.0 * g * (z - top)
    if above2 > 0.0 and (u > 0.0 or z > top):
        s = (u + sqrt(above2)) / g
        if s < best:
            px, py = x + vx * s, y + vy * s
            if _beyond(px, py, noses, inset) > 0.0 and _fall_at(px, py, falls) < 0:
                best, index = s, -1
                kind = events.RAIL if phys[P_E_T] * sqrt(above2) >= SETTLE else events.OFF
    for k in range(falls.shape[0]):
        dx, dy, radius = x - falls[k, FALL_X], y - falls[k, FALL_Y], falls[k, FALL_RADIUS]
        along, speed2 = dx * vx + dy * vy, vx * vx + vy * vy
        inside = along * along + (radius * radius - dx * dx - dy * dy) * speed2
        if speed2 == 0.0 or inside <= 0.0:
            continue
        s = (sqrt(inside) - along) / speed2  # it leaves the circle
        if 0.0 < s < best and _beyond(x + vx * s, y + vy * s, noses, inset) > 0.0:
            at = z + (u - 0.5 * g * s) * s
            if at <= top:
                best, kind, index = s, events.POT if at <= high else events.OFF, k if at <= high else -1
    return motion[i, cloth.T0] + best, kind, index


@kernel
def passes_over(motion, state, i, t, skip, d):
    """Whether ball i, in the air until t, flies over a part of a ball at rest other than ``skip``; ``d``: two radii [m]."""
    x, y, dt, least = motion[i, cloth.X], motion[i, cloth.Y], t - motion[i, cloth.T0], d - OVER
    wx, wy = motion[i, cloth.VX] * dt, motion[i, cloth.VY] * dt
    length2 = wx * wx + wy * wy
    for k in range(state.shape[0]):
        if k != i and k != skip and state[k] == cloth.REST:
            dx, dy = motion[k, cloth.X] - x, motion[k, cloth.Y] - y
            share = min(1.0, max(0.0, (dx * wx + dy * wy) / length2)) if length2 > 0.0 else 0.0
            dx, dy = dx - share * wx, dy - share * wy
            if dx * dx + dy * dy < least * least:
                return True
    return False
