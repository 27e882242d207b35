"""What does a ``fused.FusedTable`` compute besides matrix products? Draws, the loss and gradients.

Each kernel passes over n rows once. A name with ``d_`` is the gradient of the loss with respect to the rest of the name.
"""

from math import exp, log

import numpy as np

from snooker_env.kernels import entry, kernel
from snooker_env.planning.learned.stroke_policy import mirror_choice
from snooker_env.tasks import POTS

_LEAST = 1e-30  # smaller ones are too close to the limit of float32
# literals are float64, and only half as many fit into a register
_ZERO, _FIFTH = np.float32(0.0), np.float32(0.2)


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
def part(d_joint, joint, d_shared):
    """The gradient before the ReLU of ``join``, in place; its sums over pots into d_shared (n, width)."""
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
    """The gradient before the ReLU of ``sum_pots``, in place: of codes and sums in d_context[:, at:]."""
    width = codes.shape[1]
    for j in range(d_context.shape[0]):
        d_sums = d_context[j, at : at + width]
        for p in range(POTS * j, POTS * (j + 1)):
            d_row, row = d_codes[p], codes[p]
            for c in range(width):
                d_row[c] = d_row[c] + d_sums[c] if row[c] > 0 else _ZERO


@entry
def cut_off(d, activation, n):
    """The gradient before a ReLU, in place, from its result, for the first n rows."""
    for j in range(n):
        d_row, row = d[j], activation[j]
        for c in range(row.shape[0]):
            d_row[c] = d_row[c] if row[c] > 0 else _ZERO


@entry
def draw(likely, uniform, sides, choices):
    """Draw a choice for each row of probabilities (n, k) by inversion, never one with probability 0; ``uniform`` (n,) in [0, 1)."""
    for j in range(likely.shape[0]):
        row = likely[j]
        left, pick = np.float64(uniform[j]), 0
        for c in range(row.shape[0]):
            if row[c] > 0:
                pick = c
                left -= row[c]
                if left < 0.0:
                    break
        choices[j] = pick if sides[j] > 0.0 else mirror_choice(pick)


@kernel
def scale_of(scores, likely, pick):
    """Logarithm of the sum of exp(scores), from the score and probability of a choice, or of the likeliest one."""
    if likely[pick] < _LEAST:
        for c in range(likely.shape[0]):
            if likely[c] > likely[pick]:
                pick = c
    return scores[pick] - log(np.float64(likely[pick]))


@entry
def log_probabilities(scores, likely, sides, choices, out):
    """Logarithm of the probability of each row's choice, from scores and probabilities (n, k)."""
    for j in range(scores.shape[0]):
        pick = choices[j] if sides[j] > 0.0 else mirror_choice(choices[j])
        out[j] = scores[j, pick] - scale_of(scores[j], likely[j], pick)


@entry
def ppo_gradient(rows, passed, played, loss, batch, gradients, sums):
    """The gradients (d_scores, d_values) of PPO's loss, a mean over ``batch`` rows that include these.

    passed: (scores, likely, mean, sides, values), with scores and likely as in ``log_probabilities``, mean:
    sums of likely * scores, and values (n, 1). played: (actions, before, advantages, returns) of a
    ``fused.Rollout``, read at ``rows``. loss: as ``fused.Loss``. The sums of the rows' policy losses, squared
    errors of the values, entropies, clipped ratios and approximate KL divergences are added to ``sums``.
    """
    scores, likely, mean, sides, values = passed
    actions, before, advantages, returns = played
    (clip, entropy_weight, value_weight), (d_scores, d_values) = loss, gradients
    for j in range(rows.shape[0]):
        at = rows[j]
        action, own, likelihood = actions[at], scores[j], likely[j]
        pick = action if sides[j] > 0.0 else mirror_choice(action)
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
