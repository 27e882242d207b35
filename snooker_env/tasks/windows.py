"""In which directions does the cue ball meet a ball on first? Windows between tangents, exact for straight lines.

What is met first changes only at the tangents of the balls and where the cue ball meets a ball on and another at once:
one direction of each interval tells. A touching ball on counts as struck in every direction away from touching balls."""

from math import asin, atan2, cos, floor, hypot, pi, sin, sqrt

from .._lib.jit import kernel
from ..game.balls import N_BALLS
from ..game.paths import find_first_ball
from ..geometry import BALL_RADIUS

LOW, HIGH, EDGE = range(3)
"""Columns of the windows: where each begins and ends [rad], anticlockwise; the last is work space."""
MOST_EDGES = 2 * N_BALLS + 2 * (N_BALLS // 2) ** 2
"""Rows of the windows: one for each direction at which something may change."""


@kernel
def half_width(positions, ball):
    """Half the angle under which the cue ball meets a ball: from its middle to a graze [rad]."""
    dx, dy = positions[ball, 0] - positions[0, 0], positions[ball, 1] - positions[0, 1]
    return asin(min(1.0, 2.0 * BALL_RADIUS / hypot(dx, dy)))


@kernel
def towards(positions, ball):
    """Direction from the cue ball to the centre of a ball [rad]."""
    return atan2(positions[ball, 1] - positions[0, 1], positions[ball, 0] - positions[0, 0])


@kernel
def wrap_angle(angle):
    """An angle as the same one in [-pi, pi] [rad]."""
    return angle - 2.0 * pi * floor(angle / (2.0 * pi) + 0.5)


@kernel
def _edges(positions, on_table, on, windows):
    """Write where the ball met first may change, ascending in [0, 2 pi), to ``EDGE``; returns the number."""
    x, y = positions[0, 0], positions[0, 1]
    n = 0
    for i in range(1, N_BALLS):
        if not on_table[i]:
            continue
        middle, half = towards(positions, i), half_width(positions, i)
        windows[n, EDGE], windows[n + 1, EDGE] = middle - half, middle + half
        n += 2
        for j in range(1, i):
            sx, sy = positions[j, 0] - positions[i, 0], positions[j, 1] - positions[i, 1]
            apart = hypot(sx, sy)
            if on_table[j] and ((on >> i) ^ (on >> j)) & 1 and 0.0 < apart < 4.0 * BALL_RADIUS:
                # where the cue ball touches both
                height = sqrt(4.0 * BALL_RADIUS * BALL_RADIUS - 0.25 * apart * apart) / apart
                mx = 0.5 * (positions[i, 0] + positions[j, 0]) - x
                my = 0.5 * (positions[i, 1] + positions[j, 1]) - y
                windows[n, EDGE] = atan2(my + height * sx, mx - height * sy)
                windows[n + 1, EDGE] = atan2(my - height * sx, mx + height * sy)
                n += 2
    for k in range(n):  # insertion sort
        angle = windows[k, EDGE] - 2.0 * pi * floor(windows[k, EDGE] / (2.0 * pi))
        at = k
        while at > 0 and windows[at - 1, EDGE] > angle:
            windows[at, EDGE] = windows[at - 1, EDGE]
            at -= 1
        windows[at, EDGE] = angle
    return n


@kernel
def open_windows(positions, on_table, on, touching, windows):
    """Write the windows (MOST_EDGES, 3) in which balls of the mask ``on`` are met first; returns how many."""
    x, y, away = positions[0, 0], positions[0, 1], (touching & on) != 0
    n = _edges(positions, on_table, on, windows)
    wanted = ~touching if away else on & ~touching  # of the ball met first, 0 for none
    count, shut, is_open, low = 0, -1, False, 0.0
    for k in range(2 * n):  # once round, from the first interval that is shut
        here = windows[k % n, EDGE] + 2.0 * pi * (k // n)
        end = windows[(k + 1) % n, EDGE] + 2.0 * pi * ((k + 1) // n)
        angle, was_open = 0.5 * (here + end), is_open
        is_open = (wanted >> find_first_ball(positions, on_table, x, y, cos(angle), sin(angle), 1e9)) & 1 != 0
        if shut < 0:
            shut, is_open = (-1 if is_open else k), False
        elif is_open and not was_open:
            low = here
        elif was_open and not is_open:
            at = count
            while at > 0 and windows[at - 1, HIGH] - windows[at - 1, LOW] < here - low:
                windows[at, LOW], windows[at, HIGH] = windows[at - 1, LOW], windows[at - 1, HIGH]
                at -= 1
            windows[at, LOW], windows[at, HIGH] = low, here
            count += 1
        if k == shut + n:
            break
    if shut < 0 and n > 0:  # every direction is open
        windows[0, LOW], windows[0, HIGH], count = 0.0, 2.0 * pi, 1
    return count


@kernel
def room(windows, count, angle):
    """How far a direction may err within its window [rad]; 0 if it lies in none."""
    most = 0.0
    for k in range(count):
        half = 0.5 * (windows[k, HIGH] - windows[k, LOW])
        most = max(most, half - abs(wrap_angle(angle - windows[k, LOW] - half)))
    return most


@kernel
def open_part(positions, ball, windows, count):
    """The widest part of a ball on that can be struck: (direction, half its width) [rad], 0: none."""
    middle, half = towards(positions, ball), half_width(positions, ball)
    best, widest = middle, 0.0
    for k in range(count):
        wide = 0.5 * (windows[k, HIGH] - windows[k, LOW])
        off = wrap_angle(windows[k, LOW] + wide - middle)
        low, high = max(-half, off - wide), min(half, off + wide)
        if 0.5 * (high - low) > widest:
            best, widest = middle + 0.5 * (low + high), 0.5 * (high - low)
    return best, widest
