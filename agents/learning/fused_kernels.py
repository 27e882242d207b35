"""What do the passes of ``fused.FusedTable`` compute besides matrix products? Reading tables, sums over balls and pots, masks, the loss.

Each kernel goes over n rows once. The layouts are those of ``networks.TableReader``; gradients are of the loss with respect to the name
after ``d_``.
"""

from math import exp, log

import numpy as np

from snooker_env.game import N_BALLS
from snooker_env.kernels import entry, kernel
from snooker_env.tasks import OBSERVATION_SIZE, POTS, SIDES, STROKES, TOPS

from ..features.pot_features import BALL_X, CUT, POT_ENTRIES, POT_X

N_REDS = 15
STATE = OBSERVATION_SIZE - 5 * N_BALLS
BALL_INPUTS = 5 + 2
_TOPS, _TURN = len(TOPS), (len(SIDES) - 1) * len(TOPS)
_X1, _X2, _X3 = POT_X
NEVER = np.float32(-1e8)
"""The score of a choice that is not available, as in ``sb3_contrib``."""
_LEAST = 1e-30  # smaller ones are too near to what float32 can hold
_ZERO, _FIFTH = np.float32(0.0), np.float32(0.2)  # literals are float64, and half as many of them fit into a register


@entry
def read_tables(rows, seen, inputs, at):
    """Write the inputs of the networks for the tables seen[rows]; returns the number of balls on these tables.

    inputs: (balls, group, first, pots, context, sides).
    balls (m, BALL_INPUTS), group (m,): the balls on the tables; 0 for a red that is not on, 1 for a red on, 2 and 3 likewise for colours.
    first (n + 1,): each table's first row of them. pots (n * POTS, POT_ENTRIES). context[:, at:]: state, cue ball, side. sides (n,): -1
    where the table is mirrored, else 1.
    """
    (balls, group, first, pots, context, sides), m = inputs, 0
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
            ball[0], ball[1], ball[2], ball[3], ball[4], ball[5], ball[6] = (
                x, row[b + 1], row[b + 2], row[b + 3], row[b + 4], x - cue_x, row[b + 1] - cue_y,
            )  # fmt: skip
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
    """ReLU of the balls' codes (m, width), in place; their sums / 5 into context[:, : 3 * width]: of balls on, of reds, of colours."""
    for j in range(first.shape[0] - 1):
        sums = context[j]
        for c in range(3 * width):
            sums[c] = _ZERO
        for b in range(first[j], first[j + 1]):
            code, kind = codes[b], group[b]
            own = sums[width : 2 * width] if kind < 2 else sums[2 * width : 3 * width]
            for c in range(width):
                x = max(code[c], _ZERO)
                code[c] = x
                own[c] += x
            if kind & 1:
                for c in range(width):
                    sums[c] += code[c]
        for c in range(3 * width):
            sums[c] *= _FIFTH


@entry
def spread_to_balls(d_context, group, first, codes, width, d_codes):
    """d_codes (m, width) before the ReLU, from d_context[:, : 3 * width] and the codes after it."""
    for j in range(first.shape[0] - 1):
        d_sums = d_context[j]
        for b in range(first[j], first[j + 1]):
            code, kind, d_code = codes[b], group[b], d_codes[b]
            own = d_sums[width : 2 * width] if kind < 2 else d_sums[2 * width : 3 * width]
            if kind & 1:
                for c in range(width):
                    d_code[c] = (own[c] + d_sums[c]) * _FIFTH if code[c] > 0 else _ZERO
            else:
                for c in range(width):
                    d_code[c] = own[c] * _FIFTH if code[c] > 0 else _ZERO


@entry
def sum_pots(codes, pots, context, at):
    """ReLU of the pots' codes (n * POTS, width), in place, 0 where there is no pot; their sums into context[:, at : at + width]."""
    width = codes.shape[1]
    for j in range(context.shape[0]):
        sums = context[j, at : at + width]
        for c in range(width):
            sums[c] = _ZERO
        for p in range(POTS * j, POTS * (j + 1)):
            code, there = codes[p], pots[p, 0]
            for c in range(width):
                code[c] = max(code[c], _ZERO) * there
                sums[c] += code[c]


@entry
def join(joint, shared, pots):
    """joint (n * POTS, width) = ReLU(joint + shared of the table), in place, 0 where there is no pot."""
    width = joint.shape[1]
    for j in range(shared.shape[0]):
        common = shared[j]
        for p in range(POTS * j, POTS * (j + 1)):
            row, there = joint[p], pots[p, 0]
            for c in range(width):
                row[c] = max(row[c] + common[c], _ZERO) * there


@entry
def part(d_joint, joint, d_shared):
    """The gradient before the ReLU of ``join``, in place, and its sums over each table's pots into d_shared (n, width)."""
    width = joint.shape[1]
    for j in range(d_shared.shape[0]):
        sums = d_shared[j]
        for c in range(width):
            sums[c] = _ZERO
        for p in range(POTS * j, POTS * (j + 1)):
            d_row, row = d_joint[p], joint[p]
            for c in range(width):
                d_row[c] = d_row[c] if row[c] > 0 else _ZERO
                sums[c] += d_row[c]


@entry
def spread_to_pots(d_codes, codes, d_context, at):
    """The gradient before the ReLU of ``sum_pots``, in place: of the codes themselves and of their sums in d_context[:, at:]."""
    width = codes.shape[1]
    for j in range(d_context.shape[0]):
        d_sums = d_context[j, at : at + width]
        for p in range(POTS * j, POTS * (j + 1)):
            d_row, row = d_codes[p], codes[p]
            for c in range(width):
                d_row[c] = d_row[c] + d_sums[c] if row[c] > 0 else _ZERO


@entry
def cut_off(d, activation, n):
    """The gradient before a ReLU, in place, from its result: the first n rows."""
    for j in range(n):
        d_row, row = d[j], activation[j]
        for c in range(row.shape[0]):
            d_row[c] = d_row[c] if row[c] > 0 else _ZERO


@kernel
def mirrored(choice):
    """The choice with the other side spin."""
    return choice + _TURN - 2 * _TOPS * (choice // _TOPS % (_TURN // _TOPS + 1))


@entry
def mask_scores(rows, masks, sides, scores, out):
    """The scores (n, choices) of the choices that masks[rows] allows, ``NEVER`` for others; a mirrored table's are those in the mirror.

    scores (n * POTS, STROKES or more): of each pot's strokes.
    """
    for j in range(rows.shape[0]):
        own, row = masks[rows[j]], out[j]
        for p in range(POTS):
            of_pot, at = scores[POTS * j + p], STROKES * p
            if sides[j] > 0.0:
                for c in range(STROKES):
                    row[at + c] = of_pot[c] if own[at + c] else NEVER
            else:
                for c in range(0, STROKES, _TOPS):
                    other = mirrored(at + c)
                    for t in range(_TOPS):
                        row[at + c + t] = of_pot[c + t] if own[other + t] else NEVER


@entry
def as_seen(scores, sides):
    """Exchange the sides of strokes in scores (n, choices), in place, where the table was read mirrored."""
    for j in range(scores.shape[0]):
        if sides[j] < 0.0:
            row = scores[j]
            for c in range(row.shape[0]):
                other = mirrored(c)
                if other > c:
                    row[c], row[other] = row[other], row[c]


@entry
def draw(likely, uniform, sides, choices):
    """A choice for each row of probabilities (n, k), by inversion: ``uniform`` (n,) in [0, 1). None of probability 0."""
    for j in range(likely.shape[0]):
        row = likely[j]
        left, pick = np.float64(uniform[j]), 0
        for c in range(row.shape[0]):
            if row[c] > 0:
                pick = c
                left -= row[c]
                if left < 0.0:
                    break
        choices[j] = pick if sides[j] > 0.0 else mirrored(pick)


@kernel
def scale_of(scores, likely, pick):
    """Logarithm of the sum of exp(scores), from a choice's score and probability, or from the likeliest one's if that is too small."""
    if likely[pick] < _LEAST:
        for c in range(likely.shape[0]):
            if likely[c] > likely[pick]:
                pick = c
    return scores[pick] - log(np.float64(likely[pick]))


@entry
def log_probabilities(scores, likely, sides, choices, out):
    """Logarithm of the probability of each row's choice, from scores and probabilities (n, k)."""
    for j in range(scores.shape[0]):
        pick = choices[j] if sides[j] > 0.0 else mirrored(choices[j])
        out[j] = scores[j, pick] - scale_of(scores[j], likely[j], pick)


@entry
def ppo_gradient(rows, passed, played, loss, batch, gradients, sums):
    """The gradients (d_scores, d_values) of PPO's loss, a mean over ``batch`` rows of which these are some.

    passed: (scores, likely, mean, sides, values), with scores and likely as in ``log_probabilities``, mean: sums of likely * scores, and
    values (n, 1). played: (actions, before, advantages, returns) of a ``fused.Rollout``, read at ``rows``. loss: as ``fused.Loss``. The
    sums of the rows' policy losses, squared errors of the values, entropies, clipped ratios and approximate KL divergences are added to
    ``sums``.
    """
    scores, likely, mean, sides, values = passed
    actions, before, advantages, returns = played
    (clip, entropy_weight, value_weight), (d_scores, d_values) = loss, gradients
    for j in range(rows.shape[0]):
        at = rows[j]
        action, own, likelihood = actions[at], scores[j], likely[j]
        pick = action if sides[j] > 0.0 else mirrored(action)
        scale = scale_of(own, likelihood, pick)
        change = own[pick] - scale - before[at]
        ratio, advantage = exp(change), advantages[at]
        surrogate, clipped = advantage * ratio, advantage * min(max(ratio, 1.0 - clip), 1.0 + clip)
        pull = surrogate if surrogate <= clipped else 0.0
        entropy = scale - mean[j]
        error = values[j, 0] - returns[at]
        sums[0] -= min(surrogate, clipped)
        sums[1] += error * error
        sums[2] += entropy
        sums[3] += abs(ratio - 1.0) > clip
        sums[4] += ratio - 1.0 - change
        weight = entropy_weight / batch
        even = pull / batch + weight * (entropy - scale)
        out = d_scores[j]
        a, b = np.float32(weight), np.float32(even)
        for c in range(own.shape[0]):
            out[c] = likelihood[c] * (a * own[c] + b)
        out[pick] -= pull / batch
        d_values[j, 0] = 2.0 * value_weight * error / batch
