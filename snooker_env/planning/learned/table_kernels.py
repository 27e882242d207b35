"""What does a policy of strokes compute between its layers? Reading tables, sums over balls and pots, masks,
each over n rows once. The layouts are those of ``agents.learning.networks.TableReader``."""

import numpy as np

from ..._lib.jit import entry, kernel
from ...game.balls import N_BALLS, N_REDS
from ...tasks.discrete_actions import POTS, SIDES, STROKES, TOPS
from ...tasks.observations import SIZE as OBSERVATION_SIZE
from .pot_view import BALL_X, CUT, POT_ENTRIES, POT_X

STATE = OBSERVATION_SIZE - 5 * N_BALLS  # numbers of the game's state in an observation
BALL_INPUTS = 5 + 2
_TOPS, _TURN = len(TOPS), (len(SIDES) - 1) * len(TOPS)
_X1, _X2, _X3 = POT_X
NEVER = np.float32(-1e8)  # the score of a choice that is not available, as in ``sb3_contrib``
# literals are float64, and half as many of them fit into a register
_ZERO, _FIFTH = np.float32(0.0), np.float32(0.2)


@entry
def read_tables(rows, seen, inputs, at):
    """Write the inputs of the networks for the tables seen[rows]; returns the number of balls on them.

    ``inputs``: (balls, group, first, pots, context, sides). balls (m, BALL_INPUTS), group (m,): the balls on
    the tables; 0 for a red that is not on, 1 for a red on, 2 and 3 likewise for colours. first (n + 1,): each
    table's first row of them. pots (n * POTS, POT_ENTRIES). context[:, at:]: state, cue ball, side. sides
    (n,): -1 where mirrored, else 1."""
    balls, group, first, pots, context, sides = inputs
    m = 0
    for j in range(rows.shape[0]):
        row, first[j] = seen[rows[j]], m
        side = -1.0 if row[BALL_X] < 0.0 else 1.0
        sides[j] = side
        cue_x, cue_y = row[BALL_X] * side, row[1]
        for i in range(1, N_BALLS):
            b = 5 * i
            if row[b + 2] <= 0.0:
                continue
            ball = balls[m]
            x = row[b] * side
            ball[0], ball[5], ball[6] = x, x - cue_x, row[b + 1] - cue_y
            for c in range(1, 5):
                ball[c] = row[b + c]
            group[m] = (2 if i > N_REDS else 0) + (1 if row[b + 4] > 0.0 else 0)
            m += 1
        for p in range(POTS):
            pot, b = pots[POTS * j + p], OBSERVATION_SIZE + POT_ENTRIES * p
            for c in range(POT_ENTRIES):
                pot[c] = row[b + c]
            pot[_X1] *= side
            pot[_X2] *= side
            pot[_X3] *= side
            pot[CUT] *= side
        for c in range(STATE):
            context[j, at + c] = row[5 * N_BALLS + c]
        context[j, at + STATE], context[j, at + STATE + 1], context[j, at + STATE + 2] = cue_x, cue_y, side
    first[rows.shape[0]] = m
    return m


@entry
def sum_balls(codes, group, first, context, width):
    """ReLU of balls' codes (m, width) in place; sums / 5 of those on, reds, colours into context."""
    for j in range(first.shape[0] - 1):
        sums = context[j]
        for c in range(3 * width):
            sums[c] = _ZERO
        for b in range(first[j], first[j + 1]):
            code, kind = codes[b], group[b]
            of_kind = sums[width : 2 * width] if kind < 2 else sums[2 * width : 3 * width]
            for c in range(width):
                x = max(code[c], _ZERO)
                code[c] = x
                of_kind[c] += x
            if kind & 1:
                for c in range(width):
                    sums[c] += code[c]
        for c in range(3 * width):
            sums[c] *= _FIFTH


@entry
def sum_pots(codes, pots, context, at):
    """ReLU of pots' codes (n * POTS, width) in place, 0 for no pot; sums into context[:, at : at + width]."""
    width = codes.shape[1]
    for j in range(context.shape[0]):
        sums = context[j, at : at + width]
        for c in range(width):
            sums[c] = _ZERO
        for p in range(POTS * j, POTS * (j + 1)):
            code, exists = codes[p], pots[p, 0]
            for c in range(width):
                code[c] = max(code[c], _ZERO) * exists
                sums[c] += code[c]


@entry
def join(joint, shared, pots):
    """joint (n * POTS, width) = ReLU(joint + shared of the table), in place, 0 where there is no pot."""
    width = joint.shape[1]
    for j in range(shared.shape[0]):
        common = shared[j]
        for p in range(POTS * j, POTS * (j + 1)):
            row, exists = joint[p], pots[p, 0]
            for c in range(width):
                row[c] = max(row[c] + common[c], _ZERO) * exists


@kernel
def mirror_choice(choice):
    """The choice with the other side spin."""
    return choice + _TURN - 2 * _TOPS * (choice // _TOPS % (_TURN // _TOPS + 1))


@entry
def mask_scores(rows, masks, sides, scores, out):
    """Scores (n, choices) of each pot's (n * POTS, STROKES or more); ``NEVER`` where the mask is False."""
    for j in range(rows.shape[0]):
        mask, row = masks[rows[j]], out[j]
        for p in range(POTS):
            of_pot, at = scores[POTS * j + p], STROKES * p
            if sides[j] > 0.0:
                for c in range(STROKES):
                    row[at + c] = of_pot[c] if mask[at + c] else NEVER
            else:
                for c in range(0, STROKES, _TOPS):
                    other = mirror_choice(at + c)
                    for t in range(_TOPS):
                        row[at + c + t] = of_pot[c + t] if mask[other + t] else NEVER


@entry
def exchange_sides(scores, sides):
    """Exchange the sides of strokes in scores (n, choices), in place, where the table was read mirrored."""
    for j in range(scores.shape[0]):
        if sides[j] < 0.0:
            row = scores[j]
            for c in range(row.shape[0]):
                other = mirror_choice(c)
                if other > c:
                    row[c], row[other] = row[other], row[c]
