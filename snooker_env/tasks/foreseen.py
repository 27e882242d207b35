"""What does ``observation="strokes"`` show? What a player foresees of each stroke on the menu, by closed forms: no shot is
simulated and nothing is learned. One kernel for one table and a thousand."""

from collections import namedtuple
from math import acos, atan2, pi
from typing import NamedTuple

import numpy as np

from .._lib.jit import entry, kernel
from .._lib.types import Floats
from ..game import frame_columns as columns
from ..game import pots as direct_pots
from ..game.balls import N_BALLS, VALUES, balls_on_kernel, bits, next_on_kernel, touching_balls
from ..game.pots import COS_CUT, GHOST_X, GHOST_Y, POT_BALL, POT_COLUMNS, POT_POCKET, TOLERANCE
from ..geometry import AIM_X, AIM_Y, BALL_RADIUS, HALF_LENGTH, HALF_WIDTH, POCKET_AIMS
from ..physics.parameters import Physics
from . import cue_ball_path as path
from . import stroke_menu as menu
from .box_actions import FASTEST, SLOWEST
from .cue_ball_path import foresee_contact, foresee_pot, is_fair, leave
from .escapes import LINE_ROOM
from .kernel_arrays import C_END_MASS, C_MAX_OFFSET, C_RAILS, CueLaw
from .lines import aim_on, end_red_of_rack, find_lines, list_lines, new_work
from .noise import POT_SPEED, Noise, Spread
from .observations import BALLS_SIZE, FRAME_ENTRIES, STATE_ENTRIES, STROKE_SIZE, scale_log, scale_room
from .pot_aim import aim_from
from .pot_chance import RULE_OF_THUMB, at_elevation, length_of, points_left, pot_chance, worth_of_pots
from .stroke import row_of

F_THERE, F_POT, F_CHANCE, F_LOG, F_POINTS, F_SPEED, F_TOP, F_CUT, F_TOLERANCE = range(9)
F_X, F_Y, F_NOSES, F_BALLS, F_RUN, F_LOST, F_MISSED, F_NEAR, F_REACH = range(9, 18)
F_PROSPECTS, F_BEST, F_SECOND, F_FOUL, F_PROMISE = range(18, STROKE_SIZE)
_LEFT = 4  # widest pots of a position that is left, of which it is judged
_EFFORT = 3e-4, 3e-3, 6
"""With which aims are solved, see ``aim_from``: the rest are of pots that the stroke cannot make."""
_ASTRAY = 0.02  # sine of an angle by which a ball that is sent off its line misses any pocket
STATES = len(STATE_ENTRIES), len(STATE_ENTRIES) + len(FRAME_ENTRIES)  # of the state of a visit, of a frame
MOST_WORTH, MOST_PROMISE = 35.0, 42.0  # what a position, and a stroke, may promise [points]


class Errors(NamedTuple):
    """The law of a player's direction at each speed of the menu and, last, at ``POT_SPEED``."""

    cores: Floats
    lapse: float
    factor: float

    @classmethod
    def of(cls, noise: Noise, physics: Physics, speeds: int) -> "Errors":
        """Of a player, with so many speeds."""
        along = (*np.geomspace(SLOWEST, FASTEST, speeds).tolist(), POT_SPEED)
        each = [noise.spread(physics, speed=speed) for speed in along]
        return cls(np.array([one.core for one in each]), each[0].lapse, each[0].factor)


Desk = namedtuple("Desk", "seen its stroke after there runs pots chances aims")
"""Work space: predictions of both balls, the stroke, the table it leaves, the open runs and pots there, the aims."""


@kernel
def _observe_path_into(row, seen):
    """What both kinds of strokes show of the way of the cue ball."""
    # a cue ball that misses the ball is followed on unbounded cloth
    row[F_X] = min(1.0, max(-1.0, seen[path.X] / HALF_WIDTH))
    row[F_Y] = min(1.0, max(-1.0, seen[path.Y] / HALF_LENGTH))
    row[F_NOSES], row[F_BALLS] = min(1.0, seen[path.NOSES] / 5.0), min(1.0, seen[path.BALLS] / 5.0)
    row[F_RUN], row[F_LOST] = min(1.0, seen[path.LENGTH] / 8.0), seen[path.LOST]
    row[F_MISSED] = 0.5 * seen[path.MISSED]
    row[F_NEAR], row[F_REACH] = min(1.0, seen[path.NEAR] / 0.3), seen[path.REACH] / path.FAREST


@kernel
def _judge(ball_on, left, many, law, errors, desk, one):
    """What the table on the desk leaves to whoever is next, with ``many`` open runs; returns its worth [points]."""
    usual = Spread(errors.cores[-1], errors.lapse, errors.factor)
    found = direct_pots.pots_along(desk.runs, many, desk.after, desk.there, BALL_RADIUS, desk.pots)
    table = desk.after, desk.there, left, usual, RULE_OF_THUMB, law.rails, desk.chances
    worth, one[F_BEST], one[F_SECOND] = worth_of_pots(desk.pots, found, *table)
    one[F_PROSPECTS] = worth / MOST_WORTH
    return worth


@kernel
def _foresee_pots(pot, positions, on_table, row, law, errors, work, desk, rows):
    """The strokes at a row of ``find_pots``, into their ``rows``."""
    ball, pocket, seen, rails = int(pot[POT_BALL]), int(pot[POT_POCKET]), desk.seen, law.rails
    free = row.shape[0] > columns.FREE_BALL and row[columns.FREE_BALL] != 0
    free = free and not (balls_on_kernel(row[columns.BALL_ON], 1 << ball)) >> ball & 1
    points = max(1, row[columns.BALL_ON]) if free else VALUES[ball]
    before = 0 if free else row[columns.BALL_ON]  # a free ball comes back
    ball_on = leave(ball, before, positions, on_table, desk.after, desk.there)
    if free:
        ball_on = 0 if row[columns.BALL_ON] == 1 else row[columns.BALL_ON]
    left, on = points_left(desk.there, ball_on), balls_on_kernel(ball_on, bits(desk.there))
    many = direct_pots.list_runs(desk.after, desk.there, on, BALL_RADIUS, desk.runs)
    ghost, target = (pot[GHOST_X], pot[GHOST_Y]), (POCKET_AIMS[pocket, AIM_X], POCKET_AIMS[pocket, AIM_Y])
    aim, length = atan2(ghost[1] - positions[0, 1], ghost[0] - positions[0, 0]), length_of(positions, pot)
    speeds = errors.cores.shape[0] - 1
    for index in range(speeds * len(menu.TOPS)):
        level, height = index // len(menu.TOPS), index % len(menu.TOPS)
        one = rows[index * STROKE_SIZE : (index + 1) * STROKE_SIZE]
        _, speed, side, top = menu.menu_stroke(index, speeds)
        if level:  # from the same tip at the last speed
            aim = desk.aims[height]
        lies = positions, on_table, ball, target, ghost, (speed, side, top, 0.0), law, work
        aim, played = aim_from(aim, _EFFORT, *lies)
        desk.aims[height] = aim
        foresee_pot(played, (ball, pocket), positions, on_table, law, work, seen)
        spread = Spread(errors.cores[level], errors.lapse, errors.factor)
        if rails.shape[0]:
            spread = at_elevation(spread, played[4])
        chance = pot_chance(pot[TOLERANCE], length, spread)
        _observe_path_into(one, seen)
        one[F_THERE] = one[F_POT] = 1.0
        one[F_SPEED], one[F_TOP] = speed / FASTEST, top / menu.TOPS[-1]
        one[F_CHANCE], one[F_LOG] = chance, scale_log(chance)
        one[F_POINTS], one[F_CUT] = points / 7.0, acos(min(1.0, pot[COS_CUT])) / (0.5 * pi)
        one[F_TOLERANCE] = scale_room(pot[TOLERANCE])
        lost = seen[path.LOST] > 0.0 or seen[path.MISSED] > 0.0
        one[F_FOUL], worth = 1.0 if lost else 0.0, 0.0
        if lost or seen[path.REACH] < 1.0 or abs(seen[path.ASIDE]) > _ASTRAY:
            continue
        if ball_on != path.NONE:
            desk.after[0, 0], desk.after[0, 1] = seen[path.X], seen[path.Y]
            worth = _judge(ball_on, left, many, law, errors, desk, one)
        one[F_PROMISE] = chance * (points + worth) / MOST_PROMISE


@kernel
def _foresee_line(room, positions, on_table, on, in_frame, law, errors, work, desk, one):
    """The stroke on the desk along a line without a pot, into its row; in a frame with what it leaves the other player."""
    seen, its, after, there = desk.seen, desk.its, desk.after, desk.there
    touching = touching_balls(positions, on_table)
    ball = foresee_contact(desk.stroke, positions, on_table, law, work, seen, its)
    _observe_path_into(one, seen)
    lost = seen[path.LOST] > 0.0
    one[F_THERE], one[F_FOUL] = 1.0, 0.0 if is_fair(ball, touching, on) and not lost else 1.0
    one[F_SPEED], one[F_TOP] = desk.stroke[0] / FASTEST, desk.stroke[2] / menu.TOPS[-1]
    one[F_TOLERANCE], one[F_POINTS] = scale_room(room), VALUES[ball] / 7.0
    one[F_REACH] = its[path.LOST] if ball else 0.0
    if not in_frame or lost:
        return
    for i in range(N_BALLS):
        after[i, 0], after[i, 1], there[i] = positions[i, 0], positions[i, 1], on_table[i]
    after[0, 0], after[0, 1] = seen[path.X], seen[path.Y]
    if ball:
        after[ball, 0], after[ball, 1], there[ball] = its[path.X], its[path.Y], its[path.LOST] == 0.0
    ball_on = next_on_kernel(bits(there) & ~1)
    many = direct_pots.list_runs(after, there, balls_on_kernel(ball_on, bits(there)), BALL_RADIUS, desk.runs)
    _judge(ball_on, points_left(there, ball_on), many, law, errors, desk, one)


@kernel
def _repeat_last(rows, many, size):
    """Strokes that are not there show the ones played for them: the last ``size`` numbers of the first ``many``."""
    for c in range(many, rows.shape[0]):
        rows[c] = rows[many - size + (c - many) % size] if c % STROKE_SIZE != F_THERE else 0.0


@entry(what="what is foreseen of strokes", seconds=30)
def foresee(which, at, player, tables, rules, errors, out):
    """What ``player`` foresees on the tables ``which``, into the rows ``at`` of ``out``, which hold the flat observation.
    ``rules``: the code of the rule set, cues and constants, one row or one a table, fidelity."""
    (positions, on_table, game), (code, cues, phys, fidelity, n_steps) = tables, rules
    work, in_frame = new_work(), game.shape[1] > columns.STRIKER
    speeds = errors.cores.shape[0] - 1
    along, at_pots = speeds * len(menu.TOPS), speeds * menu.PER_SPEED
    strokes = at_pots + (menu.SAFETIES if in_frame else 0)
    choices, state = strokes + (menu.DECISIONS if in_frame else 0), STATES[1 if in_frame else 0]
    table = np.empty((N_BALLS, 2)), np.empty(N_BALLS, np.bool_), np.empty(direct_pots.RUNS)
    wide = np.empty((_LEFT, POT_COLUMNS)), np.empty(0), np.empty(len(menu.TOPS))
    desk = Desk(np.empty(path.SEEN), np.empty(path.SEEN), np.zeros(5), *table, *wide)
    for j in range(which.shape[0]):
        k, rows = which[j], out[at[j]]
        p, here, row, stroke = positions[k], on_table[k], game[k], desk.stroke
        end = STROKE_SIZE * choices
        for c in range(state):
            rows[end + c] = rows[BALLS_SIZE + c]
        for c in range(end):
            rows[c] = 0.0
        if row[columns.OVER] or not here[0] or (in_frame and row[columns.STRIKER] != player):
            continue
        cue_row = cues[row_of(k, cues)]
        phys_row, rails, most = phys[row_of(k, phys)], cue_row[C_RAILS:], cue_row[C_MAX_OFFSET]
        law = CueLaw(phys_row, cue_row[C_END_MASS], fidelity, n_steps, most, rails)
        on = columns.strikeable(row, bits(here))
        many, pots = list_lines(p, here, on, work.lines)
        for line in range(many):
            its = rows[line * along * STROKE_SIZE : (line + 1) * along * STROKE_SIZE]
            if pots:
                _foresee_pots(work.lines[line], p, here, row, law, errors, work, desk, its)
                continue
            for index in range(along):
                _, stroke[0], stroke[1], stroke[2] = menu.menu_stroke(index, speeds)
                played = stroke[0], stroke[1], stroke[2], 0.0
                stroke[3] = aim_on(line, pots, played, p, here, on, law, work)
                one, space = its[index * STROKE_SIZE : (index + 1) * STROKE_SIZE], work.lines[line, LINE_ROOM]
                _foresee_line(space, p, here, on, in_frame, law, errors, work, desk, one)
        _repeat_last(rows[: at_pots * STROKE_SIZE], many * along * STROKE_SIZE, along * STROKE_SIZE)
        if not in_frame:
            continue
        many, end_red = find_lines(p, here, on, work.lines, True), end_red_of_rack(p, here)
        safeties = rows[at_pots * STROKE_SIZE : strokes * STROKE_SIZE]
        for index in range(many * menu.SAFE_ALONG):
            line, safe = index // menu.SAFE_ALONG, (p, here, on, law, work)
            stroke[0], stroke[1], stroke[2], stroke[3] = menu.safe_stroke(index, end_red, work.lines, *safe)
            one = safeties[index * STROKE_SIZE : (index + 1) * STROKE_SIZE]
            _foresee_line(work.lines[line, LINE_ROOM], p, here, on, in_frame, law, errors, work, desk, one)
        _repeat_last(safeties, many * menu.SAFE_ALONG * STROKE_SIZE, menu.SAFE_ALONG * STROKE_SIZE)
        again, back = menu.decisions_of(row, code)
        decisions = rows[strokes * STROKE_SIZE : end]
        decisions[F_THERE], decisions[STROKE_SIZE + F_THERE] = again, back
        decisions[F_POT], decisions[STROKE_SIZE + F_POT] = -1.0, -1.0
        decisions[F_SPEED], decisions[STROKE_SIZE + F_SPEED] = -1.0, 1.0
