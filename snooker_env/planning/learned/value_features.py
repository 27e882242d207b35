"""What does a learned value see of a position? The best pots, how open each ball is, where the balls lie, and
the ball on. The table is nearly symmetric: it is read mirrored so that the cue ball is on the right."""

from math import cos, log, log10, radians, sqrt

import numpy as np

from ..._lib.jit import entry, kernel
from ...game.balls import N_BALLS, VALUES, bits
from ...game.balls import balls_on_kernel as balls_on
from ...game.pots import window
from ...geometry import (
    AIM_X,
    AIM_Y,
    AXIS_X,
    AXIS_Y,
    BALL_RADIUS,
    HALF_LENGTH,
    HALF_WIDTH,
    IS_MIDDLE,
    POCKET_AIMS,
)
from ...tasks.pot_chance import pot_chance
from ..prospects import in_parts

POTS_SEEN = 6
POT_ENTRIES = 13
COLOUR_ENTRIES = 6
SHARED = 28  # entries of the whole position: see ``_fill``
SIZE = POTS_SEEN * POT_ENTRIES + 6 * COLOUR_ENTRIES + SHARED
LOGIT = SIZE - 1
"""The entry that holds the logit of the likeliest pot, where the network's own estimate begins."""
_CORNER_EDGE, _MIDDLE_EDGE = cos(radians(50.0)), cos(radians(70.0))
"""Beyond these angles no pocket has a window (``pots.window``)."""
_NEAR_CUSHION, _CLUSTER = 3.0 * BALL_RADIUS, 2.3 * BALL_RADIUS


@kernel
def _length(x, y):
    return sqrt(x * x + y * y)  # math.hypot guards against overflow, at ten times the cost


@kernel
def _logit(p):
    return log((p + 1e-3) / (1.0 - p + 1e-3))


@kernel
def _clear(balls, many, ax, ay, bx, by, ball, reach):
    """Whether ``many`` of ``balls`` (id, x, y), without ``ball``, keep ``reach`` away from a segment."""
    ux, uy = bx - ax, by - ay
    length = _length(ux, uy)
    if length > 0.0:
        ux, uy = ux / length, uy / length
    square = reach * reach
    for i in range(many):
        px, py = balls[i, 1] - ax, balls[i, 2] - ay
        across = ux * py - uy * px
        if across >= reach or across <= -reach or balls[i, 0] == ball:
            continue
        along = px * ux + py * uy
        beyond = max(0.0, -along, along - length)
        if across * across + beyond * beyond < square:
            return False
    return True


@kernel
def _open(balls, many, open_to):
    """Each ball's window for each pocket as an angle (22, 6) [rad], for any cue ball; 0: blocked."""
    d = 2.0 * BALL_RADIUS
    for i in range(many):
        b, x, y = int(balls[i, 0]), balls[i, 1], balls[i, 2]
        for k in range(6):
            open_to[b, k] = 0.0
            dx, dy = POCKET_AIMS[k, AIM_X] - x, POCKET_AIMS[k, AIM_Y] - y
            run = _length(dx, dy)
            if run < 1e-9:
                continue
            dx, dy = dx / run, dy / run
            cosine = dx * POCKET_AIMS[k, AXIS_X] + dy * POCKET_AIMS[k, AXIS_Y]
            if cosine < (_MIDDLE_EDGE if POCKET_AIMS[k, IS_MIDDLE] > 0.0 else _CORNER_EDGE):
                continue
            width = window(cosine, POCKET_AIMS[k, IS_MIDDLE] > 0.0)
            gx, gy = abs(x - d * dx), abs(y - d * dy)
            if width <= 0.0 or gx > HALF_WIDTH - BALL_RADIUS + 1e-9 or gy > HALF_LENGTH - BALL_RADIUS + 1e-9:
                continue
            if _clear(balls, many, x, y, POCKET_AIMS[k, AIM_X], POCKET_AIMS[k, AIM_Y], b, d):
                open_to[b, k] = width / (2.0 * run)


@kernel
def _same_balls(positions, on_table, before, on_before):
    """Whether all balls but the cue ball lie as in another position."""
    for b in range(1, N_BALLS):
        if on_table[b] != on_before[b]:
            return False
        if on_table[b] and (positions[b, 0] != before[b, 0] or positions[b, 1] != before[b, 1]):
            return False
    return True


@kernel
def _fill(positions, on_table, ball_on, spread, opened, balls, open_to, best, row):
    """One row of features; ``opened``: ``open_to`` is known. Work space: balls (22, 3), open_to (22, 6), best
    (POTS_SEEN,)."""
    d = 2.0 * BALL_RADIUS
    for c in range(SIZE):
        row[c] = 0.0
    cx, cy = positions[0, 0], positions[0, 1]
    side = -1.0 if cx < 0.0 else 1.0
    on = balls_on(ball_on, bits(on_table))
    many = 0
    for b in range(1, N_BALLS):
        if on_table[b]:
            balls[many, 0], balls[many, 1], balls[many, 2] = b, positions[b, 0], positions[b, 1]
            many += 1
    if not opened:
        _open(balls, many, open_to)
    shared = POTS_SEEN * POT_ENTRIES + 6 * COLOUR_ENTRIES
    for j in range(POTS_SEEN):
        best[j] = 0.0
    total = likely = good = fair = 0.0
    count = 0
    for b in range(1, N_BALLS):
        if not on_table[b] or not (on >> b) & 1:
            continue
        x, y = positions[b, 0], positions[b, 1]
        for k in range(6):
            if open_to[b, k] == 0.0:
                continue
            px, py = POCKET_AIMS[k, AIM_X] - x, POCKET_AIMS[k, AIM_Y] - y
            run = _length(px, py)
            gx, gy = x - d * px / run, y - d * py / run
            path = _length(gx - cx, gy - cy)
            if path < 1e-9:
                continue
            cut = ((gx - cx) * px + (gy - cy) * py) / (path * run)
            if cut < 0.05:
                continue
            tolerance = open_to[b, k] * d * cut / path
            chance = pot_chance(tolerance, path + run, spread)
            worth = chance * (20.0 + VALUES[b])
            if not _clear(balls, many, cx, cy, gx, gy, b, d * (1.0 - 1e-9)):
                continue
            count += 1
            total += chance
            likely = max(likely, chance)
            good += chance > 0.9
            fair += chance > 0.6
            if worth <= best[POTS_SEEN - 1]:
                continue
            at = POTS_SEEN - 1
            while at > 0 and best[at - 1] < worth:
                best[at] = best[at - 1]
                for c in range(POT_ENTRIES):
                    row[at * POT_ENTRIES + c] = row[(at - 1) * POT_ENTRIES + c]
                at -= 1
            best[at] = worth
            o = at * POT_ENTRIES
            row[o], row[o + 1], row[o + 2] = 1.0, chance, 0.25 * _logit(chance)
            row[o + 3], row[o + 4], row[o + 5] = VALUES[b] / 7.0, cut, path - 1.0
            row[o + 6], row[o + 7] = run - 1.0, 2.0 + log10(tolerance + 1e-6)
            row[o + 8], row[o + 9] = side * gx / HALF_WIDTH, gy / HALF_LENGTH
            row[o + 10], row[o + 11] = side * x / HALF_WIDTH, y / HALF_LENGTH
            row[o + 12] = POCKET_AIMS[k, IS_MIDDLE]
    reds = reds_open = near = cluster = ends = 0.0
    sum_open = to_reds = 0.0
    for b in range(1, N_BALLS):
        if not on_table[b]:
            continue
        x, y = positions[b, 0], positions[b, 1]
        first = second = 0.0
        for k in range(6):
            if open_to[b, k] > first:
                first, second = open_to[b, k], first
            elif open_to[b, k] > second:
                second = open_to[b, k]
        away = _length(x - cx, y - cy)
        if b > 15:
            o = POTS_SEEN * POT_ENTRIES + (b - 16) * COLOUR_ENTRIES
            row[o], row[o + 1], row[o + 2] = 1.0, min(2.0, 20.0 * first), min(2.0, 20.0 * second)
            row[o + 3], row[o + 4], row[o + 5] = away - 1.0, side * x / HALF_WIDTH, y / HALF_LENGTH
            continue
        reds += 1.0
        reds_open += first > 0.0
        sum_open += min(0.1, first)
        to_reds += away
        near += abs(x) > HALF_WIDTH - _NEAR_CUSHION or abs(y) > HALF_LENGTH - _NEAR_CUSHION
        ends += y > 0.0
        for i in range(many):
            dx, dy = balls[i, 1] - x, balls[i, 2] - y
            if balls[i, 0] != b and dx * dx + dy * dy < _CLUSTER * _CLUSTER:
                cluster += 1.0
                break
    o = shared
    row[o], row[o + 1], row[o + 2], row[o + 3] = reds / 15.0, reds_open / 8.0, 2.0 * sum_open, near / 8.0
    row[o + 4], row[o + 5], row[o + 6] = cluster / 8.0, ends / 8.0, to_reds / max(1.0, reds) - 1.0
    row[o + 7], row[o + 8], row[o + 9], row[o + 10] = 0.25 * total, good / 4.0, fair / 4.0, likely
    row[o + 11], row[o + 12] = side * cx / HALF_WIDTH, cy / HALF_LENGTH
    row[o + 13] = min(HALF_WIDTH - abs(cx), HALF_LENGTH - abs(cy))
    row[o + 14 + ball_on] = 1.0  # 0 any colour, 1 red, 2 to 7 yellow to black
    left = 7.0 if ball_on == 0 else 0.0
    for i in range(1, N_BALLS):
        if on_table[i]:
            left += 8.0 if VALUES[i] == 1 else VALUES[i]
    row[o + 22] = left / 147.0
    row[o + 23], row[o + 24] = reds == 0.0, reds == 1.0
    row[o + 25] = side
    row[o + 26] = count / 8.0
    row[LOGIT] = _logit(likely)


@entry(what="the features of positions", seconds=3)
def _features(positions, on_table, ball_on, spread, out):
    balls, open_to, best = np.empty((N_BALLS, 3)), np.empty((N_BALLS, 6)), np.empty(POTS_SEEN)
    for k in range(len(out)):
        # the windows of balls do not depend on the cue ball: other places of it need no others
        same = k > 0 and _same_balls(positions[k], on_table[k], positions[k - 1], on_table[k - 1])
        _fill(positions[k], on_table[k], ball_on[k], spread, same, balls, open_to, best, out[k])


def value_features(at, spread, threads=1):
    """Features of n ``Positions`` with the cue ball on the table: float32 (n, SIZE)."""
    out = np.empty((len(at), SIZE), np.float32)
    balls = at.positions, at.on_table, at.ball_on.copy()
    in_parts(len(at), threads, lambda rows: _features(*(each[rows] for each in balls), spread, out[rows]))
    return out
