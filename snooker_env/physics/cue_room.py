"""How must the cue be raised over what lies behind the cue ball? The least elevation, and the tips it leaves.

A cue tapers from a tip of radius 4.75 mm to a butt of 14 mm over 1.45 m: the union of spheres of radius
r0 + k x about its axis, x from the tip. It passes over the rails, 38 mm high from the nose on, and over balls.
(Snooker cues: tips of 9.5 mm, butts of 28 to 29 mm, 57 to 58 inches. [WPBSA, Rules 2019, 1.3]: a rail rises to
35 to 41 mm.) All in closed form, in two unknowns at most.

Frame. C: centre of the cue ball, R above the bed; d: unit vector along the cue, down by the elevation el; up,
right: unit vectors across it, right level; tip offset over R: (side, top), q = sqrt(1 - side^2 - top^2). The
sphere of the tip has its centre at P = C + R (side right + top up - q d), the axis is P - x d.

A rail: its edge is a level line at height h, ``D`` behind C along the outward normal u, sin(phi) = -a . u, a the
level direction of the cue. The plane through the edge that touches the cue has a normal
n = (sin(t) u, -cos(t)) with n . d = k (it touches all spheres), and with c = u . right

    n . (E - P) = r0:   (D - R side c) sin t - (h - R) cos t + R top sqrt(1 - k^2 - c^2 sin^2 t) + R q k = r0
    n . d = k:          sin(el) cos t - cos(el) sin(phi) sin t = k

The first gives t, the second el. A ball with its centre b behind C along a and l to the right of it touches if the
axis is as far from its centre as both radii, (l - R side)^2 + (b sin el + R top)^2 = s^2, where
s sqrt(1 - k^2) = R + r0 + k (b cos el - R q).
"""

from math import atan2, cos, hypot, inf, radians, sin, sqrt

import numpy as np

from .._lib.jit import entry, kernel
from .._lib.types import Floats
from .columns import NOSE_AXIS, NOSE_LEVEL, NOSE_SIDE
from .cue import MAX_ELEVATION, squirt

TIP, BUTT, LENGTH = 4.75e-3, 14e-3, 1.45  # radii of the cue at its ends, and its length [m]
TAPER = (BUTT - TIP) / LENGTH
RAIL = 0.038  # height of a rail above the bed [m]
STEEPEST = radians(45.0)
"""The highest elevation of a stroke that keeps its tip [rad]. Above it a player stands over the ball, the bridge in
the air: a masse, which nobody plays for position. Our choice; players' limits are not published."""
(EDGE_AXIS, EDGE_SIDE, EDGE_LEVEL, EDGE_LOW, EDGE_HIGH, EDGE_BEHIND) = range(6)
EDGE = 6
"""Columns of a rail: those of a nose, and how far behind it the rail begins where its line runs through a pocket [m]."""
FREE, RAISED, MOVED, UNPLAYABLE = 0, 1, 2, 4
"""What a stroke's room does to it: nothing; the cue is raised; the tip is moved up; nobody can play it."""
OVER_NOTHING, OVER_RAIL = -1, 0
"""What sets the least elevation: nothing, or a rail; else the id of a ball, which is never ball 0."""

_ABOVE = 1e-9  # the edge of a rail that a vertical cue still touches stands so far in the cue, or further [m]
_TINY = 1e-12  # keeps a cue that lies along a rail from a quotient of zeros
_PASSES = 3  # over the balls, at most
_HALVINGS = 40  # bisections of a tip's way, to 1e-12 R; few strokes need them
_TRIALS, _SAME = 8, 1e-13
"""Newton's steps and fixed points gain two digits and more each; below such a step they stay [rad]."""


NO_RAILS = np.empty(0)  # the rails of a free cue, which nothing is in the way of
NO_RAILS.setflags(write=False)


def rails_of(noses: Floats, falls: Floats) -> Floats:
    """The rails behind the noses of a table: ``EDGE`` numbers for each nose, those of one side together. Behind a pocket a
    rail begins where the fall ends that reaches farthest behind the noses of that side."""
    rows = []
    for nose in sorted(noses.tolist()):
        axis, side, level = int(nose[NOSE_AXIS]), nose[NOSE_SIDE], nose[NOSE_LEVEL]
        behind = (side * falls[:, axis] + falls[:, 2] - level).max(initial=0.0)
        rows.append([*nose, behind])
    return np.array(rows, np.float64).reshape(-1)


@kernel
def _over_rail(D, sin_phi, c, side, top, q, R):
    """Sine and cosine of the least elevation over an edge, ``c`` = u . right; of 0 if the cue ends before it."""
    A, B, K = D - R * side * c, RAIL - R, TIP - R * q * TAPER
    flat = 1.0 - TAPER * TAPER
    # Newton's method on the unit vector (s, o) = (sin t, cos t); exact at once where the cue is square to the rail
    far = hypot(A, B)
    share = max(min((K - R * top * sqrt(flat)) / far, 1.0), -1.0)
    rest = sqrt(1.0 - share * share)
    s, o = (B * rest + A * share) / far, (A * rest - B * share) / far
    off = 0.0
    for _ in range(_TRIALS):
        w = sqrt(max(flat - c * c * s * s, _TINY))
        off = A * s - B * o + R * top * w - K
        step = -off / (A * o + B * s - R * top * c * c * s * o / w)
        s, o = s + step * o, o - step * s
        if s <= 0.0:
            s, o = 0.0, 1.0
        elif o <= 0.0:
            s, o = 1.0, 0.0
        else:
            length = sqrt(s * s + o * o)
            s, o = s / length, o / length
        if abs(step) < _SAME:
            break
    if off < -_ABOVE:
        return 1.0, 0.0
    if s <= 0.0:
        return 0.0, 1.0
    # sin(el) o - cos(el) s sin(phi) = TAPER
    along = s * sin_phi
    h2 = o * o + along * along
    rest = sqrt(max(h2 - TAPER * TAPER, 0.0))
    se, ce = (along * rest + o * TAPER) / h2, (o * rest - along * TAPER) / h2
    if not ce > 0.0:
        se, ce = 1.0, 0.0
    x = D - R * (side * c - top * se * sin_phi + q * ce * sin_phi) - TIP * s
    return (se, ce) if x <= LENGTH * (sin_phi * ce + TAPER * s) else (0.0, 1.0)


@kernel
def _over_ball(b, beside, top, q, se, ce, R):
    """The least elevation (sine, cosine), from (``se``, ``ce``) on, over a ball b behind and ``beside`` the tip [m]."""
    first_se, first_ce, cosine, far = se, ce, sqrt(1.0 - TAPER * TAPER), 0.0
    for trial in range(_TRIALS):
        far = (R + TIP + TAPER * (b * ce - R * q)) / cosine
        # a low cue may pass beside a ball, under its middle
        if far <= abs(beside) or (trial == 0 and hypot(beside, b * se + R * top) >= far):
            return first_se, first_ce
        before = se
        se = (sqrt(far * far - beside * beside) - R * top) / b
        if se >= 1.0:
            return 1.0, 0.0
        ce = sqrt(1.0 - se * se)
        if abs(se - before) < _SAME:
            break
    x = b * ce - R * q + far * TAPER / cosine
    return (se, ce) if se > first_se and 0.0 <= x <= LENGTH else (first_se, first_ce)


@kernel
def _over_rails(ax, ay, side, top, q, x, y, rails, R):
    """The least elevation over the rails (sine, cosine), and how far behind the cue ball the edge is that sets it [m]."""
    # the cue crosses one end rail and one side rail at most, the nearest edge of each
    across_x, across_y, c_x, c_y = inf, inf, 0.0, 0.0
    for m in range(0, rails.shape[0], EDGE):
        ends = rails[m + EDGE_AXIS] != 0.0
        sin_phi = -rails[m + EDGE_SIDE] * (ay if ends else ax)
        D = rails[m + EDGE_LEVEL] - rails[m + EDGE_SIDE] * (y if ends else x)
        # the cue points away from it, or ends before it
        if sin_phi <= 0.0 or LENGTH * sin_phi + BUTT + R < D:
            continue
        at = x - ax * D / sin_phi if ends else y - ay * D / sin_phi
        # right = (ay, -ax)
        c = rails[m + EDGE_SIDE] * (-ax if ends else ay)
        if not rails[m + EDGE_LOW] <= at <= rails[m + EDGE_HIGH]:
            D += rails[m + EDGE_BEHIND]
        if D > 0.0:
            if ends and across_y > D:
                across_y, c_y = D, c
            elif not ends and across_x > D:
                across_x, c_x = D, c
    se, ce, behind = 0.0, 1.0, 0.0
    if across_x < inf:
        se, ce = _over_rail(across_x, abs(ax), c_x, side, top, q, R)
        behind = across_x / abs(ax)
    if across_y < inf:
        other, its = _over_rail(across_y, abs(ay), c_y, side, top, q, R)
        if other > se:
            se, ce, behind = other, its, across_y / abs(ay)
    return se, ce, behind


@kernel
def _least_over(side, top, ax, ay, elevation, positions, on_table, rails, R):
    """``least_elevation`` of a cue along (ax, ay), what sets it (``OVER_NOTHING``, ``OVER_RAIL``, a ball), and how far behind [m]."""
    x, y, q = positions[0, 0], positions[0, 1], sqrt(max(1.0 - side * side - top * top, 0.0))
    own, its = (sin(elevation), cos(elevation)) if elevation != 0.0 else (0.0, 1.0)
    se, ce, behind = _over_rails(ax, ay, side, top, q, x, y, rails, R)
    over = OVER_RAIL
    if own >= se:
        se, ce, over, behind = own, its, OVER_NOTHING, 0.0
    for _ in range(_PASSES):  # what is raised over one ball may meet another
        before = se
        for i in range(1, positions.shape[0]):
            dx, dy = positions[i, 0] - x, positions[i, 1] - y
            b = -(dx * ax + dy * ay)
            if on_table[i] and 0.0 < b < LENGTH + 2.0 * R:
                beside = dx * ay - dy * ax - R * side
                if abs(beside) < R + TIP + 2.0 * TAPER * (b + R):  # wider than ever the cue is there
                    lower = se
                    se, ce = _over_ball(b, beside, top, q, se, ce, R)
                    if se > lower:
                        over, behind = i, b
        if se == before:
            break
    return (elevation if se <= own else atan2(se, ce)), over, behind


@kernel
def least_elevation(stroke, positions, on_table, rails, R):
    """The least elevation [rad] of a stroke (side, top, aim of the cue, elevation): its own or a higher one; pi/2: unplayable."""
    side, top, aim, elevation = stroke
    return _least_over(side, top, cos(aim), sin(aim), elevation, positions, on_table, rails, R)[0]


@kernel
def _tip_at(part, straight, side, top, highest, max_offset):
    """The tip at a part of its way: ``straight`` up, or along the miscue limit."""
    if straight:
        return side, top + part * (highest - top)
    across = side * (1.0 - part)
    return across, sqrt(max(max_offset * max_offset - across * across, 0.0))


@kernel
def _moved_tip(side, top, ax, ay, positions, on_table, rails, R, max_offset):
    """The tip nearest to (side, top), on a way up to the miscue limit and along that to the top, that fits."""
    highest = sqrt(max(max_offset * max_offset - side * side, 0.0))
    low, high = 0.0, 1.0
    straight = _least_over(side, highest, ax, ay, 0.0, positions, on_table, rails, R)[0] <= STEEPEST
    for _ in range(_HALVINGS):
        part = 0.5 * (low + high)
        across, up = _tip_at(part, straight, side, top, highest, max_offset)
        fits = _least_over(across, up, ax, ay, 0.0, positions, on_table, rails, R)[0] <= STEEPEST
        low, high = (low, part) if fits else (part, high)
    return _tip_at(high, straight, side, top, highest, max_offset)


@kernel
def in_room(stroke, positions, on_table, rails, R, max_offset):
    """A stroke (speed, side, top, aim, elevation) as the cue can play it, and what was done: ``FREE``, or a sum of
    ``RAISED``, ``MOVED``, ``UNPLAYABLE``.

    The elevation is raised to the least one. If that is above ``STEEPEST``, the tip goes up until it is not, along the
    miscue limit at last; if that does not help, only a cue that nearly stands can play. A cue without rails is free."""
    if rails.shape[0] == 0:
        return stroke, FREE
    speed, side, top, aim, elevation = stroke
    ax, ay, done = cos(aim), sin(aim), FREE
    least = _least_over(side, top, ax, ay, elevation, positions, on_table, rails, R)[0]
    if least > max(STEEPEST, elevation):
        done = MOVED
        side, top = _moved_tip(side, top, ax, ay, positions, on_table, rails, R, max_offset)
        least = _least_over(side, top, ax, ay, elevation, positions, on_table, rails, R)[0]
        if least > max(STEEPEST, elevation):
            done |= UNPLAYABLE
    if least > elevation:
        elevation, done = min(least, max(elevation, MAX_ELEVATION)), done | RAISED
    return (speed, side, top, aim, elevation), done


@entry
def in_room_over(stroke, positions, on_table, rails, R, max_offset, end_mass_ratio):
    """``in_room`` of a stroke whose aim is the ball's path; and what raised the cue or moved its tip, as of ``_least_over``."""
    speed, side, top, aim, elevation = stroke
    stroke = (speed, side, top, aim - squirt(side, end_mass_ratio), elevation)
    played, done = in_room(stroke, positions, on_table, rails, R, max_offset)
    over, behind, ax, ay = OVER_NOTHING, 0.0, cos(stroke[3]), sin(stroke[3])
    if done & MOVED:  # what the tip that was meant cannot reach over
        _, over, behind = _least_over(side, top, ax, ay, elevation, positions, on_table, rails, R)
    elif done & RAISED:
        _, over, behind = _least_over(played[1], played[2], ax, ay, elevation, positions, on_table, rails, R)
    return played, done, over, behind


@kernel
def raise_cue(stroke, positions, on_table, rails, R):
    """The elevation [rad] of a stroke (side, top, aim, elevation), raised to the least one; a free cue's is its own."""
    if rails.shape[0] == 0:
        return stroke[3]
    return min(least_elevation(stroke, positions, on_table, rails, R), max(stroke[3], MAX_ELEVATION))
