"""How strong is each player, on one scale? Bradley and Terry's model, fitted to the results of all pairs.

Player i beats player j with probability p_ij = 1 / (1 + exp(t_j - t_i)) [Bradley & Terry, Biometrika 39
(1952) 324]. A draw is half a win for each. The strengths t maximise the sum of w_ij log p_ij over all pairs,
w_ij being the wins of i over j. With 0 % or 100 % wins there is no maximum: so each pair that met gets
``PRIOR`` drawn matches more, half a win for each. On the scale of Elo a strength counts 400 / ln 10 points,
so that 400 points more mean ten wins for one loss.
"""

import numpy as np

PRIOR = 1.0
"""Drawn matches that are added to each pair that met."""
ELO = 400.0 / np.log(10.0)
"""Points of Elo for one unit of strength."""
SMALLEST = 1e-10
"""The fit ends when no player's expected wins differ by more from the real ones, in shares of all."""
LONGEST = 2.0
"""Longest step of Newton's method in a strength: further from the maximum it would overshoot."""
ROUNDS = 200


def strengths(wins, prior=PRIOR):
    """The strengths (..., k) of k players, with mean 0, for one or many tables of wins.

    ``wins[..., i, j]``: how often i beat j, draws as halves; pairs that met must link all players.
    """
    w = np.array(wins, np.float64)
    k = w.shape[-1]
    first = w.reshape(-1, k, k)[0]
    w = w + 0.5 * prior * ((first + first.T) > 0)
    n = w + np.swapaxes(w, -1, -2)
    many, t = np.maximum(n.sum(-1), 1e-300), np.zeros(w.shape[:-1])
    for _ in range(ROUNDS):
        p = chance(t[..., :, None] - t[..., None, :])
        slope = w.sum(-1) - (n * p).sum(-1)
        if np.abs(slope / many).max(initial=0.0) < SMALLEST:
            break
        curve = n * p * (1.0 - p)
        bend = -curve + 1.0 / k  # the mean stays 0
        bend[..., range(k), range(k)] += curve.sum(-1)
        step = np.linalg.solve(bend, slope[..., None])[..., 0]
        longest = np.abs(step).max(-1, keepdims=True)
        t += step * np.minimum(1.0, LONGEST / np.maximum(longest, LONGEST))
    return t - t.mean(-1, keepdims=True)


def chance(ahead):
    """The chance to win of a player whose strength is ``ahead`` of the other's."""
    return 0.5 * (1.0 + np.tanh(0.5 * np.asarray(ahead, np.float64)))


def linked(edges, start):
    """Which players (k,) can be reached from one, itself included, by steps that ``edges`` (k, k) allow."""
    reached = np.zeros(len(edges), bool)
    reached[start] = True
    for _ in range(len(edges)):
        reached |= edges[reached].any(0)
    return reached


def compared(wins, anchor):
    """Who (k,) won and lost something against the anchor, perhaps by way of others: results compare them."""
    won = np.asarray(wins) > 0
    return linked(won, anchor) & linked(won.T, anchor)


def bound(others, matches, level=0.95):
    """The least strength of a player that won all its matches (m,) against players of strengths (m,).

    There winning all has the probability 1 - level. For one that lost all: negate strengths and bound.
    """
    others, matches = np.asarray(others, np.float64), np.asarray(matches, np.float64)
    if matches.sum() <= 0:
        return -np.inf
    low, high = others.min() - 50.0, others.max() + 50.0
    for _ in range(100):
        middle = 0.5 * (low + high)
        likely = (matches * np.log(np.maximum(chance(middle - others), 1e-300))).sum() > np.log(1.0 - level)
        low, high = (low, middle) if likely else (middle, high)
    return 0.5 * (low + high)
