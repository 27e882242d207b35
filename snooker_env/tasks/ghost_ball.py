"""How does the opponent "ghost_ball" play? The widest direct pot, softly; without one, a plain stroke."""

from math import atan2, cos, hypot, sin, sqrt
from typing import Any

import numpy as np

from .._jit import entry, kernel
from .._types import Ints
from ..game import frame_columns as columns
from ..game.balls import N_BALLS, YELLOW, bits, touching_balls
from ..game.philox import pair
from ..game.pots import COS_CUT, GHOST_X, GHOST_Y, POT_BALL, POT_COLUMNS, POT_POCKET, TOLERANCE, find_pots
from ..game.rule_sets import SHOOT_OUT
from ..game.ruling import AUTO
from ..geometry import AIM_X, AIM_Y, BALL_RADIUS, BAULK_Y, D_RADIUS, POCKET_AIMS
from ..physics.cue import squirt
from .arrays import StruckArrays
from .declarations import A_END_MASS, A_NOMINATE, nominated_ball
from .escapes import ROLL
from .frame import Frames, Opponent
from .lines import LINE_ROWS, racked
from .opponents import SIDE
from .plain_stroke import BREAK_X, SLIDE, break_off, plain, soft
from .stroke import ShotBuffers, place, place_anywhere, strike

_OVER, _BACK = (-0.8, -0.4, 0.0, 0.4, 0.8), (0.0, 0.5)
_PLACES = tuple((x * D_RADIUS, BAULK_Y - y * D_RADIUS) for y in _BACK for x in _OVER)
_BEHIND = 0.3
"""How far behind the ghost ball the cue ball is placed, where it may stand anywhere [m]."""
DRIVE = 4.0
"""How much farther than needed a plain stroke would roll where some ball must reach a cushion [m]; a ball
struck full comes half as far."""


@kernel
def _put_on_bed(positions, on_table, mask, rows):
    """Place a cue ball behind the ball of the easiest pot, on the line from the pocket, or as near as the bed
    allows; without a pot, where most of a ball on is seen."""
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
                place_anywhere(positions, on_table, x, y)
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
    """Place a cue ball in hand for the widest pot, else where most of a ball on is seen; for the break-off to
    the left or right of the brown, as the stream decides. ``anywhere``: not in the D only."""
    if anywhere:
        _put_on_bed(positions, on_table, mask, rows)
        return
    if racked(positions, on_table):
        u, _ = pair(stream)
        place(positions, on_table, BREAK_X if u < 0.5 else -BREAK_X, BAULK_Y)
        return
    widest, best = 0.0, -1
    for c in range(len(_PLACES)):
        place(positions, on_table, *_PLACES[c])
        if find_pots(positions, on_table, mask, BALL_RADIUS, rows[:1]) and rows[0, TOLERANCE] > widest:
            widest, best = rows[0, TOLERANCE], c
    if best < 0:
        best = 0
        for c in range(len(_PLACES)):
            place(positions, on_table, *_PLACES[c])
            _, _, _, window = soft(positions, on_table, mask, 0, 0.0, rows)
            if window > widest:
                widest, best = window, c
    place(positions, on_table, *_PLACES[best])


@kernel
def stroke_at(positions, on_table, on, in_hand, failed, drive, rows, stream):
    """The geometric player's shot: (speed, side, top, direction). ``in_hand``: just placed; ``failed``: a
    stroke from here has; ``drive``: how much farther than needed one without a pot is to roll [m]."""
    end_red = racked(positions, on_table) if in_hand else 0
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
def named(positions, on_table, row, aim):
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
    """Its turn: (speed, side, top, aim, what it nominates, what it decides after a foul). ``row``: of a visit
    or frame, after its decision; a cue ball in hand is placed. ``rules``: the code of the rule set."""
    frame, decision = row.shape[0] > columns.ANYWHERE, columns.PLAY
    if frame and row[columns.PHASE] == columns.CHOICE:
        decision = columns.PLACE_ANYWHERE if columns.may_place_anywhere(row, rules) else columns.PLAY
        columns.choose(row, decision)
    elif frame and row[columns.PHASE] == columns.LOT:
        columns.draw(row, row[columns.STRIKER])
    mask = columns.strikeable(row, bits(on_table) & ~1)
    if row[columns.IN_HAND]:
        put(positions, on_table, mask, frame and row[columns.ANYWHERE], rows, stream)
    jitter, _ = pair(stream)
    failed = frame and row[columns.SAVED] != 0  # it plays from a position that has been restored
    drive = DRIVE if rules == SHOOT_OUT else 0.0
    placed = row[columns.IN_HAND]
    speed, side, top, aim = stroke_at(positions, on_table, mask, placed, failed, drive, rows, stream)
    speed *= 1.0 + (0.04 if placed and racked(positions, on_table) else 0.2) * (jitter - 0.5)
    return speed, side, top, aim, named(positions, on_table, row, aim) if frame else AUTO, decision


@entry(what="the geometric opponent", seconds=3)
def _ghost_ball(which, tables, shots, packed, rules):
    """The turns of ``GhostBallOpponent``, up to the strike. ``rules``: the code of the rule set."""
    positions, on_table, game, streams, nominated = tables
    shots, (options, noise, _), rows = StruckArrays(*shots), packed, np.empty((LINE_ROWS, POT_COLUMNS))
    for j in range(which.shape[0]):
        k = which[j]
        p, on = positions[k], on_table[k]
        speed, side, top, aim, colour, _ = geometric_turn(p, on, game[k], rules, rows, streams[k])
        if options[A_NOMINATE] >= 0:
            nominated[k] = colour
        intended = (speed, side, top, aim - squirt(side, options[A_END_MASS]), 0.0)
        strike(intended, p, on, streams[k], options, noise, j, shots)


@entry(what="the geometric player", seconds=3)
def geometric_strokes(positions, on_table, game, rules, streams, strokes, nominated, decisions):
    """The geometric player's strokes (n, 5), nominations and decisions (n,); places cue balls in hand."""
    rows = np.empty((LINE_ROWS, POT_COLUMNS))
    for k in range(len(game)):
        turn = geometric_turn(positions[k], on_table[k], game[k], rules, rows, streams[k])
        speed, side, top, aim, colour, decision = turn
        nominated[k], decisions[k] = colour, decision
        strokes[k, 0], strokes[k, 1], strokes[k, 2], strokes[k, 3], strokes[k, 4] = speed, side, top, aim, 0.0


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


class GhostBallOpponent(Opponent):
    """The geometric player ``ghost_ball`` as a kernel: the widest direct pot (``game.pots``), softly.

    * Without a pot: a plain stroke (``plain_stroke``). In the Shoot Out it is harder, so that a ball reaches
      a cushion.
    * It nominates the colour that its line meets first, never concedes or claims, and begins if it wins the
      lot.
    * A cue ball in hand goes to the best of ten places in the D; where it may stand anywhere, straight behind
      the ball of the easiest pot. After a foul it always plays the table as it lies.
    * It allows for neither throw nor position.
    * Its speed varies by a tenth (at the break-off by a fiftieth), and the direction of a plain stroke within
      the window that strikes the ball. From a position restored after its miss it tries no pot and varies
      more: two exact players cannot repeat one failing stroke for ever."""

    def prepare(self, frames: Frames, which: Ints, asked: Any, buffers: ShotBuffers) -> Ints:
        """See ``Opponent.prepare``."""
        _ghost_ball(which, frames.arrays, buffers.struck, frames.packs[SIDE], frames.rules.rule_set.code)
        frames.hold_late(which, buffers)
        return which
