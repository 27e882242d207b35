"""What does ``observation="strokes"`` show? Of each stroke on the menu what a player foresees of it, by closed forms: no shot is
simulated and nothing is learned. One kernel for one table and a thousand."""

from math import acos, log10, pi
from typing import NamedTuple

import numpy as np

from .._lib.jit import entry, kernel
from .._lib.types import Floats
from ..game.balls import N_BALLS, VALUES, balls_on_kernel, bits, touching_balls
from ..game.frame_columns import BALL_ON, IN_HAND, OVER, POINTS, strikeable
from ..game.open_runs import MOST_RUNS, RUN_COLUMNS, list_runs, pots_along
from ..game.pots import COS_CUT, POT_BALL, POT_COLUMNS, POT_POCKET, TOLERANCE
from ..geometry import BALL_RADIUS, HALF_LENGTH, HALF_WIDTH
from . import cue_ball_path as path
from .cue_ball_path import foresee_contact, foresee_pot, leave
from .escapes import LINE_ROOM
from .kernel_arrays import C_END_MASS, C_MAX_OFFSET, C_RAILS, CueLaw
from .lines import aim_on, list_lines, new_work
from .noise import POT_SPEED, Noise, Spread
from .observations import STROKE_SIZE, observe_state_into
from .pot_chance import length_of, pot_chance, raised_spread
from .rule_of_thumb import RULE_OF_THUMB, points_left, worth_of_pots
from .stroke import row_of
from .stroke_menu import MENU_SIZE, SPEEDS, STROKES, TOPS, stroke_of

F_THERE, F_POT, F_CHANCE, F_LOG, F_POINTS, F_SPEED, F_TOP, F_CUT, F_TOLERANCE = range(9)
F_X, F_Y, F_NOSES, F_BALLS, F_RUN, F_LOST, F_MISSED, F_NEAR, F_REACH = range(9, 18)
F_PROSPECTS, F_BEST, F_SECOND, F_FOUL, F_PROMISE = range(18, STROKE_SIZE)
_LEFT = 8  # widest pots of a position that is left, of which it is judged
_HALF = 0.01  # a middling tolerance [rad]
_ASTRAY = 0.02  # sine of an angle by which a ball that is sent off its line misses any pocket


class Errors(NamedTuple):
    """The law of a player's direction at each speed of the menu and, last, at ``POT_SPEED``."""

    cores: Floats
    lapse: float
    factor: float

    @classmethod
    def of(cls, noise: Noise, physics) -> "Errors":
        """Of a player."""
        each = [noise.spread(physics, speed=speed) for speed in (*SPEEDS, POT_SPEED)]
        return cls(np.array([one.core for one in each]), each[0].lapse, each[0].factor)


@kernel
def _observe_path_into(row, seen):
    """What both kinds of strokes show of the way of the cue ball."""
    row[F_X], row[F_Y] = seen[path.X] / HALF_WIDTH, seen[path.Y] / HALF_LENGTH
    row[F_NOSES], row[F_BALLS] = min(1.0, seen[path.NOSES] / 5.0), min(1.0, seen[path.BALLS] / 5.0)
    row[F_RUN], row[F_LOST], row[F_MISSED] = (
        min(1.0, seen[path.LENGTH] / 8.0),
        seen[path.LOST],
        0.5 * seen[path.MISSED],
    )
    row[F_NEAR], row[F_REACH] = min(1.0, seen[path.NEAR] / 0.3), seen[path.REACH] / path.FAREST


@entry(what="the menus of strokes", seconds=4, uses=(aim_on, foresee_pot, foresee_contact))
def foresee(which, at, tables, rules, errors, out):
    """What is foreseen on the tables ``which``, into the rows ``at`` of ``out``. ``rules``: cues and constants, one row or one a
    table; fidelity."""
    (positions, on_table, game), (cues, phys, fidelity, n_steps) = tables, rules
    work, seen, its, stroke = new_work(), np.empty(path.SEEN), np.empty(path.SEEN), np.zeros(5)
    after, there, runs = (
        np.empty((N_BALLS, 2)),
        np.empty(N_BALLS, np.bool_),
        np.empty((MOST_RUNS, RUN_COLUMNS)),
    )
    lines, chances, none = np.empty((_LEFT, POT_COLUMNS)), np.empty(0), Spread(1.0)
    usual = Spread(errors.cores[len(SPEEDS)], errors.lapse, errors.factor)
    for j in range(which.shape[0]):
        k, all_rows = which[j], out[at[j]]
        for c in range(MENU_SIZE * STROKE_SIZE):
            all_rows[c] = 0.0
        p, here, row = positions[k], on_table[k], game[k]
        state = here, row[BALL_ON], row[IN_HAND], row[POINTS]
        observe_state_into(all_rows, MENU_SIZE * STROKE_SIZE, *state)
        if row[OVER] or not here[0]:
            continue
        cue_row = cues[row_of(k, cues)]
        rails = cue_row[C_RAILS:]
        law = CueLaw(
            phys[row_of(k, phys)], cue_row[C_END_MASS], fidelity, n_steps, cue_row[C_MAX_OFFSET], rails
        )
        on = strikeable(row, bits(here))
        many, pots = list_lines(p, here, on, work.lines)
        touching, open_runs, left, ball_on = touching_balls(p, here), 0, 0.0, 0
        for index in range(STROKES * many):
            line, level, height = stroke_of(index)
            pot, new = work.lines[line], index % STROKES == 0
            one = all_rows[index * STROKE_SIZE : (index + 1) * STROKE_SIZE]
            stroke[0], stroke[2] = SPEEDS[level], TOPS[height]
            played = stroke[0], 0.0, stroke[2], 0.0
            aim = stroke[3] = aim_on(line, pots, played, p, here, on, law, work)
            one[F_THERE] = 1.0
            one[F_SPEED], one[F_TOP] = stroke[0] / SPEEDS[-1], stroke[2] / TOPS[-1]
            if not pots:
                ball = foresee_contact(stroke, p, here, law, work, seen, its)
                _observe_path_into(one, seen)
                fair = ball > 0 and not (touching >> ball) & 1 and (touching & on or (on >> ball) & 1)
                one[F_FOUL] = 0.0 if fair and seen[path.LOST] == 0.0 else 1.0
                one[F_TOLERANCE] = pot[LINE_ROOM] / (pot[LINE_ROOM] + _HALF)
                continue
            ball, pocket = int(pot[POT_BALL]), int(pot[POT_POCKET])
            if new:
                ball_on = leave(ball, row[BALL_ON], p, here, after, there)
                left = points_left(there, ball_on)
                open_runs = list_runs(after, there, balls_on_kernel(ball_on, bits(there)), BALL_RADIUS, runs)
            spread = Spread(errors.cores[level], errors.lapse, errors.factor)
            spread = raised_spread(spread, 0.0, stroke[2], aim, p, here, rails)
            chance = pot_chance(pot[TOLERANCE], length_of(p, pot), spread)
            foresee_pot(stroke, (ball, pocket), p, here, law, work, seen)
            _observe_path_into(one, seen)
            one[F_POT], one[F_CHANCE], one[F_LOG] = 1.0, chance, max(-1.0, 0.5 * log10(max(chance, 1e-9)))
            one[F_POINTS], one[F_CUT] = VALUES[ball] / 7.0, acos(min(1.0, pot[COS_CUT])) / (0.5 * pi)
            one[F_TOLERANCE] = pot[TOLERANCE] / (pot[TOLERANCE] + _HALF)
            lost = seen[path.LOST] > 0.0 or seen[path.MISSED] > 0.0
            one[F_FOUL] = 1.0 if lost else 0.0
            if lost or ball_on == path.NONE:
                worth, best, second = 0.0, 0.0, 0.0
            else:
                after[0, 0], after[0, 1] = seen[path.X], seen[path.Y]
                found = pots_along(runs, open_runs, after, there, BALL_RADIUS, lines)
                worth, best, second = worth_of_pots(
                    lines, found, after, there, left, usual, RULE_OF_THUMB, rails, chances
                )
            one[F_PROSPECTS], one[F_BEST], one[F_SECOND] = worth / 35.0, best, second
            arrives = not lost and seen[path.REACH] >= 1.0 and abs(seen[path.ASIDE]) < _ASTRAY
            one[F_PROMISE] = chance * (VALUES[ball] + worth) / 42.0 if arrives else 0.0
        last = STROKES * (many - 1) * STROKE_SIZE  # a stroke that is not there shows the one that is played for it
        for c in range(STROKES * many * STROKE_SIZE, MENU_SIZE * STROKE_SIZE):
            all_rows[c] = all_rows[last + c % (STROKES * STROKE_SIZE)] if c % STROKE_SIZE != F_THERE else 0.0
