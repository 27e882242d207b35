"""What becomes of a ball over the edge of a pocket? It flies, strikes jaw or edge, is lost or comes back.

Most balls have no jaw in their way and are lost at the edge at once, and so are slow ones; the others are
followed. z is the drop of the centre below its height on the bed [m], u its rate [m/s]; no friction with the
cloth.

* Gravity: du/dt = g.
* The slate's edge is a sharp circle, the fall. A sphere whose centre is d inside touches it where
  d^2 + (R - z)^2 = R^2, its normal from edge to centre. Restitution ``EDGE``, frictionless; below ``SOFT`` it
  tips over.
* A jaw's nose is an arc at height (1 + sin_theta) R: a ball touches it at the angle phi above its equator,
  sin(phi) = sin_theta + z/R, as a free sphere touches a fixed body (``free.against``). The nose is above the centre and
  drives the ball down.
* Lost: no arc ahead and its line leaves the fall on the far side from where it came in; or below the noses,
  z = (1 - sin_theta) R, where the edge pushes it inwards too; or it touches the throat behind an arc.

Balls meet each other in the plane, whatever their drop. ``SLOW``, ``SOFT`` and ``STEP`` suit snooker balls
and normal gravity. A ball that clears the edge flies to the first jaw in closed form; one that touches it is
followed in steps of ``STEP``, parabolas with the impacts at their ends. Oracle: a compliant ball in 3D
(``tests/oracles/pocket_3d.py``).
"""

from math import inf, sqrt

from .._lib.jit import kernel
from . import events
from .cloth import AX, AY, FALLING, HI_X, HI_Y, LO_X, LO_Y, T0, T_END, UZ, VX, VY, WX, WY, WZ, X, Y, Z
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
    P_G,
    P_R,
    P_SIN,
)

JAW, LOST, BACK = range(3)  # how a leg of the flight ends
EDGE = 0.5  # restitution on the slate's edge (a ball dropped on covered slate rises to about a quarter)
SLOW = 0.4  # a ball slower than this is lost at the edge [m/s]: it tips in before it could come back
SOFT = 0.05  # closing speed below which the ball does not bounce on edge or jaw, but stays in contact [m/s]
STRIDE, STEP = 4e-4, 4e-4
"""Distance in a step [m], and the longest step [s]. With a quarter of both no window of a pocket
(``benchmarks.pockets``) changes by more than 1.1 mm of its width, most by at most 0.3 mm."""
SHORTEST = 1e-9  # the shortest leg [s]; the ball can meet a jaw right at the edge
_MOST_STEPS = 10_000  # after so many steps (seconds) a ball in the mouth is lost: wedged in a narrow throat
IN_X, IN_Y, POCKET, HAD, Z0, U0, Z1, U1, END_VX, END_VY, KIND, INDEX = range(12)
FLIGHT = 12
"""Columns of ``flight``. IN_X, IN_Y: where the ball came in, from the pocket's centre [m]; POCKET. HAD: its
energy of translation and height at the leg's start, per unit mass [m^2/s^2]. Z0, U0, Z1, U1: drop [m] and
rate [m/s] at start and end. END_VX, END_VY, KIND, INDEX: velocity [m/s], kind of event and its index at the
end."""


@kernel
def _first_arc(x, y, vx, vy, jaws, R):
    """The first jaw arc ahead on a line: time until the ball meets it [s], and its index; or (inf, -1)."""
    speed2 = vx * vx + vy * vy
    best, jaw = inf, -1
    for k in range(jaws.shape[0]):
        px, py, reach = jaws[k, JAW_X] - x, jaws[k, JAW_Y] - y, jaws[k, JAW_RADIUS] + R
        towards, beside = px * vx + py * vy, px * vy - py * vx
        chord2 = reach * reach * speed2 - beside * beside
        if towards <= 0.0 or chord2 <= 0.0:
            continue
        t = max(0.0, (towards - sqrt(chord2)) / speed2)
        if t < best:
            qx, qy = vx * t - px, vy * t - py
            if qx * jaws[k, JAW_UX] + qy * jaws[k, JAW_UY] >= jaws[k, JAW_COS] * sqrt(qx * qx + qy * qy):
                best, jaw = t, k
    return best, jaw


@kernel
def ahead(x, y, vx, vy, falls, pocket, jaws, phys):
    """A ball crosses the edge at (x, y) [m]: time until it hits a jaw [s] (inf: never, -1: maybe), the jaw.

    -1: it touches the edge, as tested at the end of the path. Over a circle depth grows ever more slowly, but clearing it
    needs almost linear growth (sqrt(g R)): a ball that clears the edge there did before, but for a graze."""
    R, g = phys[P_R], phys[P_G]
    if vx * vx + vy * vy < SLOW * SLOW:
        return inf, -1
    best, jaw = _first_arc(x, y, vx, vy, jaws, R)
    if best == inf:
        return best, jaw
    below = sqrt(2.0 * (1.0 - phys[P_SIN]) * R / g)  # a free fall until it is below the noses
    t = min(best, below)
    dx, dy = x + vx * t - falls[pocket, FALL_X], y + vy * t - falls[pocket, FALL_Y]
    depth, high = falls[pocket, FALL_RADIUS] - sqrt(dx * dx + dy * dy), R - 0.5 * g * t * t
    if depth < 0.0 or depth * depth + high * high < R * R:
        return -1.0, jaw
    return (best, jaw) if best < below else (inf, -1)


@kernel
def _goes_through(x, y, vx, vy, in_x, in_y, falls, pocket):
    """Whether a line from (x, y) leaves the fall on the far side from where the ball came in."""
    dx, dy = x - falls[pocket, FALL_X], y - falls[pocket, FALL_Y]
    speed2, along = vx * vx + vy * vy, dx * vx + dy * vy
    inside = falls[pocket, FALL_RADIUS] * falls[pocket, FALL_RADIUS] - dx * dx - dy * dy
    if inside < 0.0 or speed2 == 0.0:
        return False
    t = (sqrt(along * along + inside * speed2) - along) / speed2
    return (dx + vx * t) * in_x + (dy + vy * t) * in_y < 0.0


@kernel
def jaw_gap(r, jaws, k, R, sin_theta):
    """Of a sphere at r = (x, y, z): distance from jaw k in the plane [m], unit vector to it, sin(phi), part.

    Past its ends (part 1, else 0) the arc goes on along its tangents, as throat or nose. Above the nose it is a wall."""
    x, y, z = r
    dx, dy, ux, uy = x - jaws[k, JAW_X], y - jaws[k, JAW_Y], jaws[k, JAW_UX], jaws[k, JAW_UY]
    cos_half = jaws[k, JAW_COS]
    far, near = dx * dx + dy * dy, jaws[k, JAW_RADIUS] + 4.0 * R
    if far > near * near:
        return 1.0, 0.0, 0.0, 0.0, 0
    far = sqrt(far)
    along, aside, part = dx * ux + dy * uy, dy * ux - dx * uy, 0
    nx, ny = dx / far, dy / far
    if along < cos_half * far:
        sin_half, part = sqrt(1.0 - cos_half * cos_half), 1
        far = cos_half * along + sin_half * abs(aside)
        if far <= jaws[k, JAW_RADIUS]:
            return 1.0, 0.0, 0.0, 0.0, 0
        s = sin_half if aside > 0.0 else -sin_half
        nx, ny = cos_half * ux - s * uy, cos_half * uy + s * ux
    # on the bed a ball touches at R from the table's arc; dropped too, so it comes back without an overlap
    sin_phi = min(1.0, max(0.0, sin_theta + z / R))
    high = min(sin_phi, sin_theta)
    reach = 1.0 - sqrt(1.0 - sin_theta * sin_theta) + sqrt(1.0 - high * high)
    return far - jaws[k, JAW_RADIUS] - R * reach, -nx, -ny, sin_phi, part


@kernel
def _deepest_jaw(r, v, jaws, first, last, R, sin_theta):
    """The deepest jaw that a ball moves into: index (or -1), gap [m], closing [m/s], normal; if any touches, and one behind its arc."""
    vx, vy, u = v
    jaw, deepest, hard, touches, behind = -1, 0.0, 0.0, False, False
    px, py, pz = 0.0, 0.0, 0.0
    for k in range(first, last):
        gap, nx, ny, sin_phi, part = jaw_gap(r, jaws, k, R, sin_theta)
        touches = touches or gap < 0.0
        behind = behind or (gap < 0.0 and part == 1)
        if gap < deepest:
            cos_phi = sqrt(1.0 - sin_phi * sin_phi)
            closing = (vx * nx + vy * ny) * cos_phi - u * sin_phi
            if closing > 0.0:
                jaw, deepest, hard = k, gap, closing
                px, py, pz = nx * cos_phi, ny * cos_phi, sin_phi
    return jaw, deepest, hard, px, py, pz, touches, behind


@kernel
def fly(r, v, entered, falls, pocket, jaws, phys):
    """One leg of a flight over ``pocket`` from r = (x, y, z) [m] with v = (vx, vy, u) [m/s], which ``entered`` the circle at a
    place from its centre [m]. Returns ``JAW``, ``LOST`` or ``BACK``, the jaw, the duration [s], and r and v at the end
    (before the jaw's impact; on the bed for ``BACK``)."""
    R, sin_theta, g = phys[P_R], phys[P_SIN], phys[P_G]
    (x, y, z), (vx, vy, u), (in_x, in_y) = r, v, entered
    if z == 0.0 and u == 0.0:  # just over the edge: a ball that clears it goes on to the first jaw
        t, jaw = ahead(x, y, vx, vy, falls, pocket, jaws, phys)
        if 0.0 <= t < inf:
            return JAW, jaw, t, (x + vx * t, y + vy * t, 0.5 * g * t * t), (vx, vy, g * t)
    elif (
        _goes_through(x, y, vx, vy, in_x, in_y, falls, pocket) and _first_arc(x, y, vx, vy, jaws, R)[0] == inf
    ):
        # nothing is in its way, and the edge only pushes it inwards
        return LOST, -1, STEP, (x + vx * STEP, y + vy * STEP, z), v
    first, last = jaws.shape[0], 0  # the jaws of this pocket
    for k in range(jaws.shape[0]):
        # from the middle of the arc (the centre of a straight facing's very large circle is far away)
        dx = jaws[k, JAW_X] + jaws[k, JAW_RADIUS] * jaws[k, JAW_UX] - falls[pocket, FALL_X]
        dy = jaws[k, JAW_Y] + jaws[k, JAW_RADIUS] * jaws[k, JAW_UY] - falls[pocket, FALL_Y]
        half = jaws[k, JAW_RADIUS] * sqrt(2.0 * (1.0 - jaws[k, JAW_COS]))
        reach = half + 4.0 * R + falls[pocket, FALL_RADIUS]
        if dx * dx + dy * dy < reach * reach:
            first, last = min(first, k), k + 1
    T = 0.0
    for _ in range(_MOST_STEPS):
        h = min(STEP, STRIDE / sqrt(vx * vx + vy * vy + u * u + 1e-300))
        T += h
        x, y, z, u = x + vx * h, y + vy * h, z + (u + 0.5 * g * h) * h, u + g * h
        if z >= (1.0 - sin_theta) * R:
            return LOST, -1, T, (x, y, z), (vx, vy, u)
        dx, dy = x - falls[pocket, FALL_X], y - falls[pocket, FALL_Y]
        far = sqrt(dx * dx + dy * dy)
        depth, high = falls[pocket, FALL_RADIUS] - far, R - z
        found = _deepest_jaw((x, y, z), (vx, vy, u), jaws, first, last, R, sin_theta)
        jaw, deepest, hard, px, py, pz, touches, behind = found
        if behind and depth > 0.0:
            return LOST, -1, T, (x, y, z), (vx, vy, u)  # through the throat
        # it met the jaw within the step, with the velocity of the step: the edge comes after it
        if hard > SOFT:
            back = min(0.9 * h, -deepest * sqrt(1.0 - pz * pz) / hard)  # time since the contact
            r = x - vx * back, y - vy * back, z - (u - 0.5 * g * back) * back
            return JAW, jaw, T - back, r, (vx, vy, u - g * back)
        reach2 = depth * depth + high * high
        if depth > 0.0 and reach2 < R * R:  # in contact with the edge
            reach = sqrt(reach2)
            ex, ey, ez = -dx / far * depth / reach, -dy / far * depth / reach, high / reach
            closing = u * ez - vx * ex - vy * ey
            if closing > 0.0:
                p = closing * (1.0 + EDGE if closing > SOFT else 1.0)
                vx, vy, u = vx + p * ex, vy + p * ey, u - p * ez
        if touches:
            found = _deepest_jaw((x, y, z), (vx, vy, u), jaws, first, last, R, sin_theta)
            _, _, hard, px, py, pz, _, _ = found
            # it stays on the jaw; if the edge has driven it into the jaw harder, the next step finds it there
            if hard <= SOFT:
                vx, vy, u = vx - hard * px, vy - hard * py, u + hard * pz
        if depth < 0.0 and dx * vx + dy * vy > 0.0 and not touches:
            speed2, climb2 = vx * vx + vy * vy, 2.0 * g * max(z, 0.0)
            if dx * in_x + dy * in_y > 0.0 and speed2 > climb2:
                slower = sqrt(1.0 - climb2 / speed2)
                return BACK, -1, T, (x, y, 0.0), (vx * slower, vy * slower, 0.0)
            return LOST, -1, T, (x, y, z), (vx, vy, u)
    return LOST, -1, T, (x, y, z), (vx, vy, u)


@kernel
def next_leg(paths, i, t, r, v, w, boundaries, phys):
    """Ball i is in the air at r = (x, y, z) with v = (vx, vy, u): write its leg, a line to its next event."""
    flight = paths.flight
    into, entered = int(flight[i, POCKET]), (flight[i, IN_X], flight[i, IN_Y])
    leg = fly(r, v, entered, boundaries.falls, into, boundaries.jaws, phys)
    _write(paths, i, t, r, v, w, leg, phys)


@kernel
def lose(paths, i, t, r, v, w, phys):
    """The same of a ball that is lost."""
    (x, y, z), (vx, vy, _) = r, v
    _write(paths, i, t, r, v, w, (LOST, -1, STEP, (x + vx * STEP, y + vy * STEP, z), v), phys)


@kernel
def _write(paths, i, t, r, v, w, leg, phys):
    """Write a leg of ball i, as ``fly`` returns it."""
    (motion, state, flight), (x, y, z), (vx, vy, u) = paths, r, v
    end, jaw, T, (x1, y1, z1), (vx1, vy1, u1) = leg
    state[i] = FALLING
    T = max(T, SHORTEST)
    motion[i, X], motion[i, Y], motion[i, VX], motion[i, VY] = x, y, (x1 - x) / T, (y1 - y) / T
    motion[i, AX] = motion[i, AY] = 0.0
    motion[i, WX], motion[i, WY], motion[i, WZ] = w
    motion[i, T0], motion[i, T_END] = t, t + T
    motion[i, LO_X], motion[i, HI_X] = min(x, x1), max(x, x1)
    motion[i, LO_Y], motion[i, HI_Y] = min(y, y1), max(y, y1)
    # a free fall between the heights at both ends
    motion[i, Z], motion[i, UZ] = -z, (z - z1) / T + 0.5 * phys[P_G] * T
    flight[i, HAD] = 0.5 * (vx * vx + vy * vy + u * u) - phys[P_G] * z
    flight[i, Z0], flight[i, U0], flight[i, Z1], flight[i, U1] = z, u, z1, u1
    flight[i, END_VX], flight[i, END_VY] = vx1, vy1
    flight[i, KIND] = events.JAW if end == JAW else events.RETURN if end == BACK else events.POT
    flight[i, INDEX] = jaw if end == JAW else int(flight[i, POCKET])


@kernel
def aloft(motion, flight, i, t, v, phys):
    """The velocity of ball i over a pocket as a ball meets it at t; its leg, whose velocity is v, starts anew. A leg by the edge
    or a soft jaw is not straight: its mean speed and the drop may have more energy than the ball had, which is then slowed."""
    s = (t - motion[i, T0]) / (motion[i, T_END] - motion[i, T0])
    z = flight[i, Z0] + s * (flight[i, Z1] - flight[i, Z0])
    u = flight[i, U0] + s * (flight[i, U1] - flight[i, U0])
    vx, vy = v
    has, had = 0.5 * (vx * vx + vy * vy + u * u), max(0.0, flight[i, HAD] + phys[P_G] * z)
    if has > had:
        k = sqrt(had / has)
        vx, vy, u = vx * k, vy * k, u * k
    flight[i, Z0], flight[i, U0] = z, u
    return vx, vy
