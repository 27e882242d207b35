"""Which indirect pots does a position offer, and where must the cue ball be sent? From geometry alone.

* bank: the object ball goes off one cushion into a pocket. It is aimed at the pocket's mirror image in the
  line where a ball's centre meets that cushion: the nose less R.
* plant: the object ball A drives another ball B into a pocket; both must be on together: reds with a red on.
* cannon: the object ball A goes off another ball into a pocket. Rolling, it keeps after the impact 5/7 of the
  velocity that it then has and 2/7 of the one before.

Every shot is a chain of straight legs, and no other ball may be nearer than 2 R to any of them. An error of
the cue ball's aim is magnified by path / (2 R cos cut) as in ``game.pots``, and again at the next impact. The
half window of the pocket, divided by all of it, is the shot's geometric tolerance. Throw and the true rebound
off a cushion, several degrees, are left out: ``aim_search`` solves the aims in the simulator.
"""

from math import asin, atan2, cos, hypot, sin, sqrt

import numpy as np

from snooker_env.game import N_BALLS, TOUCH, BallOn
from snooker_env.geometry import AIM_X as POCKET_X
from snooker_env.geometry import AIM_Y as POCKET_Y
from snooker_env.geometry import AXIS_X, AXIS_Y, BALL_RADIUS, HALF_LENGTH, HALF_WIDTH, IS_MIDDLE, POCKET_AIMS
from snooker_env.kernels import GHOST_X as POT_X
from snooker_env.kernels import GHOST_Y as POT_Y
from snooker_env.kernels import (
    LINE_ROWS,
    POT_BALL,
    POT_COLUMNS,
    POT_POCKET,
    balls_on,
    bits,
    clear_segment,
    entry,
    find_pots,
    kernel,
    line_of,
    window,
)
from snooker_env.kernels import TOLERANCE as POT_TOLERANCE

DIRECT, BANK, PLANT, CANNON = range(4)
"""Kinds of shots."""
(KIND, BALL, OTHER, POCKET, AIM_X, AIM_Y, GHOST_X, GHOST_Y, TOLERANCE, REACH) = range(10)
"""Columns of a shot: its kind, the ball to strike first, the other ball (or -1), the pocket, the point that the
first ball is sent to, where the cue ball meets it, the geometric tolerance and the aim's reach [rad]."""
COLUMNS = 10

_RED = int(BallOn.RED)
_THROW = 0.09
"""How far [rad] friction may throw a ball off the line of centres, about."""
_BENT = 0.2
"""How far [rad] the path off a cushion or a ball may lie from the geometric one, as a turn before it."""
_THINNEST = 0.05
"""Cosine of the thinnest cut, as ``game.pots`` has it."""
_CLOSE = 2.5 * BALL_RADIUS
"""Balls whose centres are nearer than this [m] make a set plant, if their line leads into a pocket."""
_FAR = 1.2
"""Longest path [m] of a ball to the one that it goes off."""
_SAMPLES = 24

MOST = 3
"""Shots tried, those with the widest geometric tolerance."""


@kernel
def _first_leg(positions, present, ball, dx, dy):
    """The way to send ``ball`` along d: (ghost x, ghost y, 2 R cos cut / path); the last is 0 without one."""
    cx, cy = positions[0, 0], positions[0, 1]
    reach = 2.0 * BALL_RADIUS
    gx, gy = positions[ball, 0] - reach * dx, positions[ball, 1] - reach * dy
    px, py = gx - cx, gy - cy
    path = hypot(px, py)
    room = TOUCH - BALL_RADIUS
    if path < 1e-9 or abs(gx) > HALF_WIDTH + room or abs(gy) > HALF_LENGTH + room:
        return gx, gy, 0.0
    cos_cut = (px * dx + py * dy) / path
    if cos_cut < _THINNEST or not clear_segment(
        positions, present, cx, cy, gx, gy, ball, 0, reach * (1.0 - 1e-9)
    ):
        return gx, gy, 0.0
    return gx, gy, reach * cos_cut / path


@kernel
def _width(k, dx, dy):
    """Width [m] of pocket k for a ball that comes along d; 0 if none gets in."""
    along = dx * POCKET_AIMS[k, AXIS_X] + dy * POCKET_AIMS[k, AXIS_Y]
    return window(along, POCKET_AIMS[k, IS_MIDDLE] > 0.0)


@kernel
def _keep(bed, shots, count, what, legs, aim, ghost, tolerance, reach):
    """Put a shot, what = (kind, ball, other, pocket), among the ``count`` widest; returns their number.

    legs: where the ball's first way ends, and where the last one, to the pocket, begins. Both must be clear.
    """
    if count == shots.shape[0] and tolerance <= shots[count - 1, TOLERANCE]:
        return count
    (positions, present), (_, ball, other, k), (end, start) = bed, what, legs
    far, one = 2.0 * BALL_RADIUS, max(other, 0)
    x, y, gap = positions[ball, 0], positions[ball, 1], far if other < 0 else far * (1.0 - 1e-9)
    if not clear_segment(positions, present, x, y, end[0], end[1], ball, one, gap):
        return count
    x, y = POCKET_AIMS[k, POCKET_X], POCKET_AIMS[k, POCKET_Y]
    if not clear_segment(positions, present, start[0], start[1], x, y, ball, one, far):
        return count
    at = min(count, shots.shape[0] - 1)
    while at > 0 and shots[at - 1, TOLERANCE] < tolerance:
        for c in range(COLUMNS):
            shots[at, c] = shots[at - 1, c]
        at -= 1
    row = shots[at]
    row[KIND], row[BALL], row[OTHER], row[POCKET] = what
    row[AIM_X], row[AIM_Y] = aim
    row[GHOST_X], row[GHOST_Y] = ghost
    row[TOLERANCE], row[REACH] = tolerance, reach
    return min(count + 1, shots.shape[0])


@kernel
def _banks(positions, present, ball, noses, shots, count):
    """Add the banks of one ball."""
    bx, by = positions[ball, 0], positions[ball, 1]
    for j in range(noses.shape[0]):
        across_x, side, line = noses[j, 0] == 0.0, noses[j, 1], noses[j, 2] - BALL_RADIUS
        depth = line - side * (bx if across_x else by)
        if depth < 1e-3:  # it touches the cushion
            continue
        for k in range(6):
            kx, ky = POCKET_AIMS[k, POCKET_X], POCKET_AIMS[k, POCKET_Y]
            if side * (kx if across_x else ky) >= line:  # a pocket at this very cushion
                continue
            mx, my = (2.0 * side * line - kx, ky) if across_x else (kx, 2.0 * side * line - ky)
            dx, dy = mx - bx, my - by
            run = hypot(dx, dy)
            dx, dy = dx / run, dy / run
            s = depth / (side * (dx if across_x else dy))
            qx, qy = bx + s * dx, by + s * dy
            if not noses[j, 3] <= (qy if across_x else qx) <= noses[j, 4]:
                continue
            ex, ey = (-dx, dy) if across_x else (dx, -dy)
            width = _width(k, ex, ey)
            if width <= 0.0:
                continue
            gx, gy, gain = _first_leg(positions, present, ball, dx, dy)
            if gain <= 0.0:
                continue
            tolerance = width / (2.0 * run) * gain
            what, aim, legs = (BANK, ball, -1, k), (qx, qy), ((qx, qy), (qx, qy))
            bed = positions, present
            count = _keep(bed, shots, count, what, legs, aim, (gx, gy), tolerance, _BENT * gain)
    return count


@kernel
def _plants(positions, present, ball, other, shots, count):
    """Add the plants of ``ball`` onto ``other``."""
    ax, ay, bx, by = positions[ball, 0], positions[ball, 1], positions[other, 0], positions[other, 1]
    reach = 2.0 * BALL_RADIUS
    ux, uy = bx - ax, by - ay
    apart = hypot(ux, uy)
    ux, uy = ux / apart, uy / apart
    for k in range(6):
        kx, ky = POCKET_AIMS[k, POCKET_X], POCKET_AIMS[k, POCKET_Y]
        dx, dy = kx - bx, ky - by
        run = hypot(dx, dy)
        if run < 1e-9:
            continue
        dx, dy = dx / run, dy / run
        width = _width(k, dx, dy)
        if width <= 0.0 or ux * dx + uy * dy < _THINNEST:
            continue
        half = width / (2.0 * run)
        aside = abs(atan2(ux * dy - uy * dx, ux * dx + uy * dy))
        if apart < _CLOSE and aside < half:  # struck full it goes in: two balls this close have one line only
            half -= aside
            dx, dy = ux, uy
        mx, my = bx - reach * dx, by - reach * dy  # where A meets B
        px, py = mx - ax, my - ay
        path = hypot(px, py)
        px, py = (px / path, py / path) if path > 1e-6 else (ux, uy)
        cos_cut = px * dx + py * dy
        if cos_cut < _THINNEST:
            continue
        second = reach * cos_cut / max(path, 1e-6)
        gx, gy, gain = _first_leg(positions, present, ball, px, py)
        if gain <= 0.0:
            continue
        # no wider than the face of the ball: a half-ball hit to either side
        face = 0.5 * reach / hypot(gx - positions[0, 0], gy - positions[0, 1])
        tolerance = min(half * second * gain, face)
        off = max(path, BALL_RADIUS)  # the aim is not solved for a point at no distance
        aim, reaches = (ax + off * px, ay + off * py), min(_THROW * second * gain, face)
        bed, what, legs = (positions, present), (PLANT, ball, other, k), ((mx, my), (bx, by))
        count = _keep(bed, shots, count, what, legs, aim, (gx, gy), tolerance, reaches)
    return count


@kernel
def _off(ax, ay, ux, uy, apart, s, e):
    """The ball at a, ``apart`` along u from another, meets it with the centres 2 R s beside its path and to
    the right of the other's: (where x, y, direction before x, y, direction after x, y)."""
    reach = 2.0 * BALL_RADIUS
    turn = asin(reach * s / apart)
    c, n = cos(turn), sin(turn)
    ix, iy = ux * c + uy * n, uy * c - ux * n
    deep = sqrt(1.0 - s * s)
    way = apart * c - reach * deep
    # the line of centres: turned to the left of the path
    nx, ny = ix * deep - iy * s, iy * deep + ix * s
    given = 5.0 / 7.0 * 0.5 * (1.0 + e) * deep
    ox, oy = ix - given * nx, iy - given * ny
    size = hypot(ox, oy)
    return ax + way * ix, ay + way * iy, ix, iy, ox / size, oy / size


@kernel
def _passing(k, qx, qy, ox, oy):
    """The angle [rad] by which a ball at q with direction o passes pocket k on the left."""
    kx, ky = POCKET_AIMS[k, POCKET_X] - qx, POCKET_AIMS[k, POCKET_Y] - qy
    return atan2(kx * oy - ky * ox, kx * ox + ky * oy)


@kernel
def _cannons(positions, present, ball, other, e, shots, count):
    """Add the cannons of ``ball`` off ``other``."""
    ax, ay = positions[ball, 0], positions[ball, 1]
    reach = 2.0 * BALL_RADIUS
    ux, uy = positions[other, 0] - ax, positions[other, 1] - ay
    apart = hypot(ux, uy)
    if apart < reach + BALL_RADIUS or apart > _FAR:
        return count
    ux, uy = ux / apart, uy / apart
    tx, ty = ax - positions[0, 0], ay - positions[0, 1]
    if tx * ux + ty * uy < -0.1 * hypot(tx, ty):  # the cue ball lies on the wrong side
        return count
    step = 1.9 / _SAMPLES
    for i in range(_SAMPLES):
        low, high = -0.95 + i * step, -0.95 + (i + 1) * step
        q0x, q0y, _, _, o0x, o0y = _off(ax, ay, ux, uy, apart, low, e)
        q1x, q1y, _, _, o1x, o1y = _off(ax, ay, ux, uy, apart, high, e)
        for k in range(6):
            at_low, at_high = _passing(k, q0x, q0y, o0x, o0y), _passing(k, q1x, q1y, o1x, o1y)
            if at_low * at_high > 0.0 or abs(at_low - at_high) > 1.0:
                continue
            a, b = low, high
            for _ in range(30):
                middle = 0.5 * (a + b)
                qx, qy, ix, iy, ox, oy = _off(ax, ay, ux, uy, apart, middle, e)
                if _passing(k, qx, qy, ox, oy) * at_low > 0.0:
                    a = middle
                else:
                    b = middle
            qx, qy, ix, iy, ox, oy = _off(ax, ay, ux, uy, apart, a, e)
            width = _width(k, ox, oy)
            if width <= 0.0:
                continue
            gx, gy, gain = _first_leg(positions, present, ball, ix, iy)
            if gain <= 0.0:
                continue
            turn = abs(asin(reach * high / apart) - asin(reach * low / apart)) / abs(at_high - at_low)
            kx, ky = POCKET_AIMS[k, POCKET_X], POCKET_AIMS[k, POCKET_Y]
            tolerance = width / (2.0 * hypot(kx - qx, ky - qy)) * turn * gain
            bed, what, legs = (positions, present), (CANNON, ball, other, k), ((qx, qy), (qx, qy))
            count = _keep(bed, shots, count, what, legs, (qx, qy), (gx, gy), tolerance, _BENT * turn * gain)
    return count


@kernel
def _find(positions, on_table, ball_on, noses, e, present, shots):
    """Fill ``shots`` (m, COLUMNS), widest first; returns their number. ``present`` (22,): work space."""
    count, on = 0, balls_on(ball_on, bits(on_table))
    for i in range(N_BALLS):
        present[i] = on_table[i] and i > 0  # the cue ball leaves its place
    for ball in range(1, N_BALLS):
        if not (on >> ball) & 1:
            continue
        count = _banks(positions, present, ball, noses, shots, count)
        for other in range(1, N_BALLS):
            if other == ball or not on_table[other]:
                continue
            if ball_on == _RED and (on >> other) & 1:
                count = _plants(positions, present, ball, other, shots, count)
            count = _cannons(positions, present, ball, other, e, shots, count)
    return count


@entry(what="the search for indirect pots", seconds=3)
def _indirect(positions, on_table, ball_on, noses, e, shots):
    return _find(positions, on_table, ball_on, noses, e, np.empty(N_BALLS, np.bool_), shots)


@entry
def direct_pots(positions, on_table, ball_on, shots, counts):
    """Fill ``shots`` (n, m, COLUMNS) with the direct pots of n tables, widest first; ``counts`` (n,) of them.

    Where there is none the first is the best other line of the cue ball (``line_of``), with -1 for its ball.
    """
    found, space = np.empty((shots.shape[1], POT_COLUMNS)), np.empty((LINE_ROWS, POT_COLUMNS))
    for t in range(len(counts)):
        p, on = positions[t], balls_on(ball_on[t], bits(on_table[t]))
        counts[t] = find_pots(p, on_table[t], on, BALL_RADIUS, found)
        for j in range(counts[t]):
            pocket, row = int(found[j, POT_POCKET]), shots[t, j]
            row[KIND], row[BALL], row[OTHER], row[POCKET] = DIRECT, found[j, POT_BALL], -1, pocket
            row[AIM_X], row[AIM_Y] = POCKET_AIMS[pocket, POCKET_X], POCKET_AIMS[pocket, POCKET_Y]
            row[GHOST_X], row[GHOST_Y] = found[j, POT_X], found[j, POT_Y]
            row[TOLERANCE] = row[REACH] = found[j, POT_TOLERANCE]
        if counts[t] == 0:
            row, angle = shots[t, 0], line_of(p, on_table[t], on, space)
            row[KIND], row[TOLERANCE], row[REACH] = DIRECT, 0.0, 0.0
            row[BALL] = row[OTHER] = row[POCKET] = -1
            row[AIM_X] = row[GHOST_X] = p[0, 0] + cos(angle)
            row[AIM_Y] = row[GHOST_Y] = p[0, 1] + sin(angle)


def direct(positions, on_table, ball_on, most=MOST):
    """The direct pots (k, COLUMNS) of the balls on, widest first, ``most`` at the most."""
    shots, counts = np.empty((1, most, COLUMNS)), np.empty(1, np.int64)
    direct_pots(positions[None], on_table[None], np.array([ball_on]), shots, counts)
    return shots[0, : counts[0]]


def indirect(positions, on_table, ball_on, table, physics, most=MOST):
    """The banks, plants and cannons (k, COLUMNS) on a ``Table``, widest first, ``most`` at the most."""
    shots = np.empty((most, COLUMNS))
    return shots[: _indirect(positions, on_table, ball_on, table.noses, physics.e_b, shots)]
