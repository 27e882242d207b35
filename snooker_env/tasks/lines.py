"""Along which lines may the cue ball be sent? To direct pots; else, best first: at the start of a frame thin at either end red;
escapes where hardly anything is seen; the middle and the edges of the widest window, thin, and the middles of others."""

from math import atan2, cos, hypot, pi, sin

import numpy as np

from .._lib.jit import entry, kernel
from ..game.balls import N_BALLS, N_REDS, SPOTS, touching_balls
from ..game.paths import find_first_ball
from ..game.pots import GHOST_X, GHOST_Y, POT_BALL, POT_COLUMNS, POT_POCKET, count_pots, find_pots
from ..geometry import AIM_X, AIM_Y, BALL_RADIUS, POCKET_AIMS
from ..physics.cloth import COLUMNS
from ..physics.impact.polynomial import WORK
from .escapes import LINE_AIM, LINE_ROOM, LINE_SPEED, LINE_WORTH, escape_aim, find_escapes
from .kernel_arrays import Work
from .pot_aim import solved_aim, swerved_aim
from .windows import HIGH, LOW, MOST_EDGES, half_width, open_windows, room, towards, wrap_angle

POTS = 4
"""Number of pots, or of other lines where there is no direct pot, to choose from."""
SAFE_LINES = 6  # number of lines of safeties
LINE_ROWS = SAFE_LINES + MOST_EDGES
"""Rows of the work space of lines: up to ``SAFE_LINES`` lines, then room for windows."""
THIN = 0.62  # of a thin contact: how far the path of the cue ball passes the centre of the ball, over 2 R
EASY, NARROW, _SLIT, _APART = 0.01, 0.25 * 0.01, 1e-6, 2e-3
"""Half windows [rad]: a sure one; below it an escape is better; none. Least difference of two lines."""


BREAK_X = float(SPOTS[0, 0])  # where the cue ball stands for the break-off: its x, either sign [m]
_BREAK_SPEED, _BREAK_SIDE, _BREAK_TOP = 3.4, 0.42, 0.1
"""Of the break-off, thin at the end red, with running side, back to baulk over three cushions: among 6,000
random ones that return to baulk in 40 trials of a professional, one that leaves hardly a pot."""


@entry  # it makes arrays, which an inner kernel may not
def new_work():
    """New work space for one table after another."""
    lines, motion = np.empty((LINE_ROWS, POT_COLUMNS)), np.empty((2, COLUMNS))
    return Work(lines, motion, np.empty(2, np.int64), np.empty(WORK))


@kernel
def end_red_of_rack(positions, on_table):
    """The end red of the last row if all balls stand as at a start of a frame, with 15 or 6 reds; else 0."""
    end = 0
    for i in range(1, N_BALLS):
        dx, dy = positions[i, 0] - SPOTS[i, 0], positions[i, 1] - SPOTS[i, 1]
        if on_table[i] and (abs(dx) > 1e-3 or abs(dy) > 1e-3):
            return 0
        if on_table[i] and i <= N_REDS:
            end = i
    return end if on_table[1] and on_table[end // 2] and (end == N_REDS or end == 6) else 0


@kernel
def thin_at_end(positions, end_red, sign):
    """Direction [rad] that strikes the right (``sign`` 1) or left (-1) end red thinly on its outer side."""
    dx, dy = sign * SPOTS[end_red, 0] - positions[0, 0], SPOTS[end_red, 1] - positions[0, 1]
    return atan2(dy, dx) - sign * THIN * 2.0 * BALL_RADIUS / hypot(dx, dy)


@kernel
def break_off(positions, end_red):
    """The break-off: (speed, side, top, direction); ``end_red``: the right one, mirrored on the left."""
    sign = -1.0 if positions[0, 0] < 0.0 else 1.0
    return _BREAK_SPEED, sign * _BREAK_SIDE, _BREAK_TOP, thin_at_end(positions, end_red, sign)


@kernel
def nearest(positions, on_table, on):
    """Direction to the nearest ball on, whatever lies before it [rad]; 0 if there is none."""
    near, aim = 1e9, 0.0
    for ball in range(1, N_BALLS):
        far = hypot(positions[ball, 0] - positions[0, 0], positions[ball, 1] - positions[0, 1])
        if on_table[ball] and (on >> ball) & 1 and far < near:
            near, aim = far, towards(positions, ball)
    return aim


@kernel
def _add(lines, count, aim, space):
    """Append a line at ``aim``, unless it is there or leaves no room for error; returns the number."""
    if count == lines.shape[0] or space < _SLIT:
        return count
    for k in range(count):
        if abs(wrap_angle(aim - lines[k, LINE_AIM])) < _APART:
            return count
    lines[count, LINE_AIM], lines[count, LINE_ROOM] = wrap_angle(aim), space
    lines[count, LINE_SPEED], lines[count, LINE_WORTH] = 0.0, 0.0
    return count + 1


@kernel
def _add_middle(lines, window, count):
    """Append the middle of a window."""
    half = 0.5 * (window[HIGH] - window[LOW])
    return _add(lines, count, window[LOW] + half, half)


@kernel
def _add_thin(positions, on_table, lines, window, count):
    """Append a thin contact at either edge of a window."""
    half = 0.5 * (window[HIGH] - window[LOW])
    middle = window[LOW] + half
    for sign in (-1.0, 1.0):
        edge, x, y = middle + sign * (half - _SLIT), positions[0, 0], positions[0, 1]
        ball = find_first_ball(positions, on_table, x, y, cos(edge), sin(edge), 1e9)
        thin = (1.0 - THIN) * (half_width(positions, ball) if ball else 0.5 * pi)
        if thin < 0.6 * half:
            count = _add(lines, count, middle + sign * (half - thin), thin)
    return count


@kernel
def find_lines(positions, on_table, on, rows, safe):
    """Write up to ``POTS`` lines into ``rows`` (LINE_ROWS, POT_COLUMNS) or, of a ``safe`` stroke, up to ``SAFE_LINES``: thin
    contacts before full ones, at the edges of all windows. Returns the number, >= 1."""
    most, count = SAFE_LINES if safe else POTS, 0
    lines, windows = rows[:most], rows[most:]
    touching, end_red = touching_balls(positions, on_table), end_red_of_rack(positions, on_table)
    many = open_windows(positions, on_table, on, touching, windows)
    if end_red:
        outwards = -1.0 if positions[0, 0] < 0.0 else 1.0
        for sign in (outwards, -outwards):
            aim = thin_at_end(positions, end_red, sign)
            space = room(windows, many, aim)
            count = _add(lines, count, aim, space if space > NARROW else 0.0)
    if many == 0 or windows[0, HIGH] - windows[0, LOW] < 2.0 * NARROW:
        count = find_escapes(positions, on_table, on & ~touching, lines, count)
    if many and not safe:
        count = _add_middle(lines, windows[0], count)
    for k in range(many if safe else min(many, 1)):
        count = _add_thin(positions, on_table, lines, windows[k], count)
        if k == 0 and safe:
            count = _add_middle(lines, windows[0], count)
    for k in range(1, many):
        count = _add_middle(lines, windows[k], count)
    if count == 0:  # nothing is known to succeed
        lines[0, LINE_AIM], lines[0, LINE_ROOM] = nearest(positions, on_table, on), 0.0
        lines[0, LINE_SPEED], lines[0, LINE_WORTH] = 1.0, 0.0
    return max(1, count)


@kernel
def count_lines(positions, on_table, on, rows):
    """The number of lines to choose from, at least 1: direct pots, else others. ``rows``: work space."""
    many = count_pots(positions, on_table, on, BALL_RADIUS, POTS)
    return many if many else find_lines(positions, on_table, on, rows, False)


@kernel
def aim_at_ball(aim, stroke, positions, on_table, law, work):
    """Direction [rad] in which the stroke (speed, side, top, elevation) reaches the ball that lies in the direction ``aim``."""
    if law.rails.shape[0] == 0 or stroke[1] == 0.0:
        return aim
    x, y = positions[0, 0], positions[0, 1]
    ball = find_first_ball(positions, on_table, x, y, cos(aim), sin(aim), 1e9)
    if ball == 0:
        return aim
    far = max(BALL_RADIUS, hypot(positions[ball, 0] - x, positions[ball, 1] - y) - 2.0 * BALL_RADIUS)
    return swerved_aim(aim, far, stroke, positions, on_table, law, work)


@kernel
def aim_along(line, stroke, positions, on_table, on, law, work):
    """Direction [rad] of the stroke (speed, side, top, elevation) along a row of ``find_lines``."""
    if line[LINE_SPEED] == 0.0:
        return aim_at_ball(line[LINE_AIM], stroke, positions, on_table, law, work)
    return escape_aim(line[LINE_AIM], stroke, positions, on_table, on, law, work)


@kernel
def list_lines(positions, on_table, on, rows):
    """Write the lines to choose from, as ``find_lines``: direct pots, else others; their number, and whether they are pots."""
    many = find_pots(positions, on_table, on, BALL_RADIUS, rows[:POTS])
    return (many, True) if many else (find_lines(positions, on_table, on, rows, False), False)


@kernel
def aim_on(k, pots, stroke, positions, on_table, on, law, work):
    """Direction [rad] of the stroke (speed, side, top, elevation) on line ``k`` of ``list_lines``, in ``work.lines``."""
    line = work.lines[k]
    if not pots:
        return aim_along(line, stroke, positions, on_table, on, law, work)
    pocket, ghost, ball = int(line[POT_POCKET]), (line[GHOST_X], line[GHOST_Y]), int(line[POT_BALL])
    target = POCKET_AIMS[pocket, AIM_X], POCKET_AIMS[pocket, AIM_Y]
    return solved_aim(positions, on_table, ball, target, ghost, stroke, law, work)
