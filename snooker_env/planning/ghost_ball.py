"""How does "ghost_ball" play? The widest direct pot, softly; without one, a plain stroke."""

from math import atan2, cos, hypot, sin, sqrt

import numpy as np

from .._lib.jit import entry, kernel
from ..game import frame_columns as columns
from ..game.balls import N_BALLS, N_REDS, YELLOW, balls_on_kernel, bits, touching_balls
from ..game.fouls import AUTO
from ..game.philox import pair
from ..game.pots import COS_CUT, GHOST_X, GHOST_Y, POT_BALL, POT_COLUMNS, POT_POCKET, TOLERANCE, find_pots
from ..game.rule_sets import SHOOT_OUT
from ..geometry import AIM_X, AIM_Y, BALL_RADIUS, BAULK_Y, D_RADIUS, POCKET_AIMS
from ..tasks.box_actions import MIN_SPEED
from ..tasks.declarations import nominated_ball
from ..tasks.escapes import LINE_AIM, LINE_ROOM, LINE_SPEED, LINE_WORTH, ROLL, ROLLING, find_escapes
from ..tasks.lines import BREAK_X, EASY, LINE_ROWS, NARROW, POTS, break_off, end_red_of_rack, nearest
from ..tasks.stroke import place
from ..tasks.windows import open_part, open_windows

SLIDE = 1.4  # initial speed of a ball struck in its middle, over the speed with which it rolls on
_NUDGE = 0.3  # how much faster than needed a cue ball is rolled at a ball [m/s]; its speed varies by a tenth
_STOP = 6.1
"""Squared speed of a ball struck 0.4 R below its middle that slides so far without spin left, over the
distance [m/s^2]: 0.32 of it, over the cloth's sliding friction of 2 m/s^2."""
_NEAR_POCKET = 0.09  # a cue ball that passes so near to a pocket's aim point is taken to go in [m]


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
    """The soft stroke at the nearest ball on that a player cannot miss: (speed, top, direction), half the window [rad], 0: none.
    It is aimed at the middle of what is seen; where the cue ball would follow into a pocket, aside, or so that it stops there."""
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
    """Without a pot: away from a touching ball on; else soft; else an escape; else at a ball on. ``vary``: one has failed."""
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


_OVER, _BACK = (-0.8, -0.4, 0.0, 0.4, 0.8), (0.0, 0.5)
_PLACES = tuple((x * D_RADIUS, BAULK_Y - y * D_RADIUS) for y in _BACK for x in _OVER)
_BEHIND = 0.3  # how far behind the ghost ball the cue ball is placed, where it may stand anywhere [m]
DRIVE = 4.0  # how much farther than needed it rolls where some ball must reach a cushion [m]


@kernel
def _put_on_bed(positions, on_table, mask, rows):
    """Place a cue ball behind the ball of the easiest pot; without a pot, where most of a ball on is seen."""
    widest, best_x, best_y = 0.0, positions[0, 0], positions[0, 1]
    for tries in range(2):
        for ball in range(1, N_BALLS):
            if not (on_table[ball] and (mask >> ball) & 1):
                continue
            for k in range(POCKET_AIMS.shape[0]):
                dx = positions[ball, 0] - POCKET_AIMS[k, AIM_X]
                dy = positions[ball, 1] - POCKET_AIMS[k, AIM_Y]
                far = (2.0 * BALL_RADIUS + _BEHIND) / max(1e-9, hypot(dx, dy))
                x, y = positions[ball, 0] + far * dx, positions[ball, 1] + far * dy
                place(positions, on_table, x, y, True)
                worth = 0.0
                if tries == 1:
                    _, _, _, worth = soft(positions, on_table, 1 << ball, 0, DRIVE, rows)
                elif find_pots(positions, on_table, 1 << ball, BALL_RADIUS, rows[:1]):
                    worth = rows[0, TOLERANCE]
                if worth > widest:
                    widest, best_x, best_y = worth, positions[0, 0], positions[0, 1]
        if widest > 0.0:
            break
    positions[0, 0], positions[0, 1] = best_x, best_y


@kernel
def put(positions, on_table, mask, anywhere, rows, stream):
    """Place a cue ball in hand for the widest pot, else where most is seen; for the break-off by lot."""
    if anywhere:
        _put_on_bed(positions, on_table, mask, rows)
        return
    if end_red_of_rack(positions, on_table):
        u, _ = pair(stream)
        place(positions, on_table, BREAK_X if u < 0.5 else -BREAK_X, BAULK_Y, False)
        return
    widest, best = 0.0, -1
    for c in range(len(_PLACES)):
        place(positions, on_table, *_PLACES[c], False)
        if find_pots(positions, on_table, mask, BALL_RADIUS, rows[:1]) and rows[0, TOLERANCE] > widest:
            widest, best = rows[0, TOLERANCE], c
    if best < 0:
        best = 0
        for c in range(len(_PLACES)):
            place(positions, on_table, *_PLACES[c], False)
            _, _, _, window = soft(positions, on_table, mask, 0, 0.0, rows)
            if window > widest:
                widest, best = window, c
    place(positions, on_table, *_PLACES[best], False)


@kernel
def stroke_at(positions, on_table, on, in_hand, failed, drive, rows, stream):
    """The geometric player's shot: (speed, side, top, direction). ``in_hand``: just placed; see ``plain``."""
    end_red = end_red_of_rack(positions, on_table) if in_hand else 0
    if end_red:
        return break_off(positions, end_red)
    touching = touching_balls(positions, on_table)
    x, y = positions[0, 0], positions[0, 1]
    if not failed and find_pots(positions, on_table, on & ~touching, BALL_RADIUS, rows[:1]):
        ball, pocket = int(rows[0, POT_BALL]), int(rows[0, POT_POCKET])
        gx, gy = rows[0, GHOST_X], rows[0, GHOST_Y]
        tx, ty = POCKET_AIMS[pocket, AIM_X], POCKET_AIMS[pocket, AIM_Y]
        run = hypot(tx - positions[ball, 0], ty - positions[ball, 1])
        # of the cue ball at the impact
        needed = SLIDE * sqrt(ROLL * (run + 0.6)) / max(rows[0, COS_CUT], 0.2)
        speed = min(6.0, SLIDE * sqrt(ROLL * hypot(gx - x, gy - y) + needed * needed))
        return speed, 0.0, 0.0, atan2(gy - y, gx - x)
    return plain(positions, on_table, on, touching, failed, drive, rows, stream)


@kernel
def nominate_on_line(positions, on_table, row, aim):
    """What the geometric player nominates: the colour on its line; else the cheapest, or no free ball."""
    dx, dy, near, ball = cos(aim), sin(aim), np.inf, 0
    for i in range(1, N_BALLS):
        x, y = positions[i, 0] - positions[0, 0], positions[i, 1] - positions[0, 1]
        along = x * dx + y * dy
        if on_table[i] and 0.0 < along < near and abs(x * dy - y * dx) < 2.0 * BALL_RADIUS:
            near, ball = along, i
    return nominated_ball(max(0, ball - YELLOW + 1), row)


@kernel
def geometric_turn(positions, on_table, row, rules, rows, stream):
    """Its turn: (speed, side, top, aim, nomination, decision); a ball in hand is placed."""
    frame, decision = row.shape[0] > columns.ANYWHERE, columns.PLAY
    if frame and row[columns.PHASE] == columns.CHOICE:
        decision = columns.PLACE_ANYWHERE if columns.may_place_anywhere(row, rules) else columns.PLAY
        columns.choose(row, decision)
    elif frame and row[columns.PHASE] == columns.LOT:
        columns.draw(row, row[columns.STRIKER])
    mask = columns.strikeable(row, bits(on_table) & ~1)
    if row[columns.IN_HAND]:
        put(positions, on_table, mask, frame and row[columns.ANYWHERE] != 0, rows, stream)
    jitter, _ = pair(stream)
    failed = frame and row[columns.SAVED] != 0  # it plays from a position that has been restored
    drive = DRIVE if rules == SHOOT_OUT else 0.0
    placed = row[columns.IN_HAND]
    speed, side, top, aim = stroke_at(positions, on_table, mask, placed, failed, drive, rows, stream)
    speed *= 1.0 + (0.04 if placed and end_red_of_rack(positions, on_table) else 0.2) * (jitter - 0.5)
    speed = max(MIN_SPEED, speed)  # at a ball a few millimetres away it is softer than anybody can strike
    return speed, side, top, aim, nominate_on_line(positions, on_table, row, aim) if frame else AUTO, decision


@entry(what="the strokes of ghost_ball", seconds=3)
def geometric_strokes(
    positions, on_table, game, rules, streams, strokes, places, nominated, decisions, visits, pots
):
    """Fill the geometric player's strokes, places (NaN: none), nominations and decisions; ``pots``: where an aim is solved.
    Then the arrays of the tables are those it strikes on, as ``visits`` (n, 5)."""
    rows = np.empty((LINE_ROWS, POT_COLUMNS))
    for k in range(len(game)):
        p, on, row, visit, reds = positions[k], on_table[k], game[k], visits[k], 0
        for i in range(1, 1 + N_REDS):
            reds += on[i]
        frame = row.shape[0] > columns.ANYWHERE
        solves = not (row[columns.IN_HAND] and reds == N_REDS) and not (frame and row[columns.MISS_CALLED])
        speed, side, top, aim, colour, decision = geometric_turn(p, on, row, rules, rows, streams[k])
        nominated[k], decisions[k] = colour, decision
        strokes[k, 0], strokes[k, 1], strokes[k, 2], strokes[k, 3], strokes[k, 4] = speed, side, top, aim, 0.0
        places[k, 0] = places[k, 1] = np.nan
        if row[columns.IN_HAND]:
            places[k, 0], places[k, 1] = p[0, 0], p[0, 1]
        for c in range(columns.VISIT_COLUMNS):
            visit[c] = row[c]
        if frame:  # a free ball is any colour, and a ball that may stand anywhere has been placed
            visit[columns.BALL_ON] = 0 if row[columns.FREE_BALL] else row[columns.BALL_ON]
            visit[columns.IN_HAND] = row[columns.IN_HAND] and not row[columns.ANYWHERE]
        mask = balls_on_kernel(visit[columns.BALL_ON], bits(on))
        pots[k] = solves and on[0] and find_pots(p, on, mask, BALL_RADIUS, rows[:1]) > 0


@entry(what="the places of a cue ball in hand", seconds=2)
def put_in_hand(positions, on_table, game, streams):
    """Place the cue balls in hand of n positions, of visits or frames, in place."""
    rows = np.empty((LINE_ROWS, POT_COLUMNS))
    for k in range(len(game)):
        row = game[k]
        if row[columns.IN_HAND]:
            anywhere = row.shape[0] > columns.ANYWHERE and row[columns.ANYWHERE] != 0
            mask = columns.strikeable(row, bits(on_table[k]) & ~1)
            put(positions[k], on_table[k], mask, anywhere, rows, streams[k])
