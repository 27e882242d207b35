"""What does a plain player do without a pot? The break-off, a soft stroke at what it sees (``windows``), else
an escape (``escapes``), struck ``ROLLING`` above the middle as that table of rebounds supposes. No shot is
simulated."""

from math import atan2, cos, hypot, sin, sqrt

from .._jit import kernel
from ..game.balls import N_BALLS, SPOTS
from ..game.philox import pair
from ..geometry import AIM_X, AIM_Y, BALL_RADIUS, POCKET_AIMS
from .escapes import LINE_AIM, LINE_ROOM, LINE_SPEED, LINE_WORTH, ROLL, ROLLING, find_escapes
from .lines import EASY, NARROW, POTS, nearest, thin_at_end
from .windows import open_part, open_windows

SLIDE = 1.4
"""Initial speed of a ball struck in its middle, over the speed with which it rolls on."""
BREAK_X = float(SPOTS[0, 0])
"""Where the cue ball stands for the break-off: its x, either sign, on the baulk line [m]."""
_BREAK_SPEED, _BREAK_SIDE, _BREAK_TOP = 3.4, 0.42, 0.1
"""Of the break-off: a third of the end red, with running side, back to baulk over three cushions. Chosen,
with ``lines.THIN``, among 6,000 random ones: of those that return the cue ball to baulk in each of 40 trials
of a professional, one that leaves hardly a pot."""
_NUDGE = 0.3
"""How much faster than needed a cue ball is rolled at a ball [m/s]; its speed varies by a tenth."""
_STOP = 6.1
"""Squared speed of a ball struck 0.4 R below its middle that slides so far without spin left, over the
distance [m/s^2]: 0.32 of it, over the cloth's sliding friction of 2 m/s^2."""
_NEAR_POCKET = 0.09
"""A cue ball that passes so near to a pocket's aim point is taken to go in [m]."""


@kernel
def break_off(positions, end_red):
    """The break-off: (speed, side, top, direction); ``end_red``: the right one, mirrored on the left."""
    sign = -1.0 if positions[0, 0] < 0.0 else 1.0
    return _BREAK_SPEED, sign * _BREAK_SIDE, _BREAK_TOP, thin_at_end(positions, end_red, sign)


@kernel
def _goes_in(positions, ball, ux, uy, v2):
    """Whether a cue ball rolling along u into ``ball``, squared speed v2 [m^2/s^2], may go into a pocket."""
    x, y = positions[0, 0], positions[0, 1]
    bx, by = positions[ball, 0] - x, positions[ball, 1] - y
    along, across = bx * ux + by * uy, bx * uy - by * ux
    run = along - sqrt(max(0.0, 4.0 * BALL_RADIUS * BALL_RADIUS - across * across))
    x, y = x + run * ux, y + run * uy
    nx, ny = (positions[ball, 0] - x) / (2.0 * BALL_RADIUS), (positions[ball, 1] - y) / (2.0 * BALL_RADIUS)
    fullness = ux * nx + uy * ny
    # where it rolls after the impact, over the speed before
    gx, gy = ux - fullness * nx * 5.0 / 7.0, uy - fullness * ny * 5.0 / 7.0
    left = hypot(gx, gy)
    end = left * left * v2 / ROLL + 2.0 * BALL_RADIUS
    for k in range(POCKET_AIMS.shape[0]):
        px, py = POCKET_AIMS[k, AIM_X] - x, POCKET_AIMS[k, AIM_Y] - y
        near = min(end, max(0.0, (px * gx + py * gy) / left))
        if hypot(px - near * gx / left, py - near * gy / left) < _NEAR_POCKET:
            return True
    return False


@kernel
def soft(positions, on_table, on, touching, drive, rows):
    """The soft stroke at the nearest ball on with a window that a player cannot miss: (speed, top, direction)
    and half the window [rad], 0: none. It is aimed at the middle of what is seen; where the cue ball would
    follow into a pocket, halfway to an edge, or so that it stops at the ball. ``touching``: mask of balls at
    the cue ball, none of them on. ``drive``: how much farther than needed it rolls [m]."""
    x, y = positions[0, 0], positions[0, 1]
    best, speed, top, aim, window, windows = -1e9, 0.0, 0.0, 0.0, 0.0, rows[POTS:]
    many = open_windows(positions, on_table, on, touching, windows)
    for ball in range(1, N_BALLS):
        if not (on_table[ball] and (on >> ball) & 1):
            continue
        middle, half = open_part(positions, ball, windows, many)
        if half == 0.0:
            continue
        dx, dy = positions[ball, 0] - x, positions[ball, 1] - y
        far = hypot(dx, dy)
        run = max(0.0, far - 2.0 * BALL_RADIUS)
        # its squared speed at the ball
        arrival = _NUDGE * _NUDGE + 2.0 * _NUDGE * sqrt(ROLL * far) + ROLL * drive
        for way in range(4):
            angle, seen = middle + (0.0, 0.5, -0.5, 0.0)[way] * half, 0.5 * half
            wanted, spin = SLIDE * (sqrt(ROLL * far) + _NUDGE), 0.0
            worth = 0.0
            if way == 0:
                seen = half
            if way == 3:
                angle, wanted, spin, worth = atan2(dy, dx), min(5.0, sqrt(_STOP * run) + 0.1), -ROLLING, -1.0
                seen = min(seen, half - abs(sin(angle - middle)))
            elif _goes_in(positions, ball, cos(angle), sin(angle), arrival):
                worth = -5.0
            if drive > 0.0:
                wanted = sqrt(wanted * wanted + SLIDE * SLIDE * ROLL * drive)
            worth += 1e3 * min(seen, EASY) - far
            if seen > 0.0 and worth > best:
                best, speed, top, aim, window = worth, wanted, spin, angle, seen
    return speed, top, aim, window


@kernel
def _escape(positions, on_table, on, vary, lines, stream):
    """The widest escape: (speed, direction, half its window [rad], 0: none). ``vary``: weighted at random."""
    best, speed, aim, window = 0.0, 2.0, 0.0, 0.0
    for k in range(find_escapes(positions, on_table, on, lines, 0)):
        weight = 1.0
        if vary:
            u, _ = pair(stream)
            weight = 0.3 + 0.7 * u
        if weight * lines[k, LINE_WORTH] > best:
            best, speed = weight * lines[k, LINE_WORTH], lines[k, LINE_SPEED]
            aim, window = lines[k, LINE_AIM], lines[k, LINE_ROOM]
    return speed, aim, window


@kernel
def plain(positions, on_table, on, touching, vary, drive, rows, stream):
    """A stroke without a pot: (speed, side, top, direction). Straight away from a touching ball on, which
    counts as striking it; else soft; else an escape; else at a little of a ball on, or the nearest. ``vary``:
    one from here has failed, so another is played; ``drive``: how much farther than needed it rolls [m]."""
    u, _ = pair(stream)
    shift = (1.6 if vary else 0.5) * (u - 0.5)
    for ball in range(1, N_BALLS):
        if ((touching & on) >> ball) & 1:
            speed = 0.6 if drive == 0.0 else sqrt(0.36 + SLIDE * SLIDE * ROLL * drive)
            dx, dy = positions[0, 0] - positions[ball, 0], positions[0, 1] - positions[ball, 1]
            return speed, 0.0, 0.0, atan2(dy, dx) + shift
    speed, top, aim, window = soft(positions, on_table, on, touching, drive, rows)
    if window < NARROW:
        over, other, wide = _escape(positions, on_table, on, vary, rows[:POTS], stream)
        if wide > window:
            speed, aim, window, top = over, other, wide, ROLLING
    if window == 0.0:
        speed, window, aim = 2.0, 0.1, nearest(positions, on_table, on)
    return speed, 0.0, top, aim + shift * window
