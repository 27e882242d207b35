"""How is the worth of a position in a frame learned? Search judges the positions of each round of self-play. A network is
fitted to the last rounds, and the next round searches with it."""

import numpy as np
import torch
from torch import nn

from snooker_env.planning.learned.learned_worth import POINTS, SIZE
from snooker_env.planning.worth import FOUL, SPREAD, Chance

from .rounds import Perceptron, descend

WIDTHS = (64, 32)
BATCH, DECAY = 512, 1.0
SNOOKERS, NEEDS, STROKES = 0.3, 3.0, 40
"""Standard deviations of the priors of ``Chance.snookers`` and ``needs``, without which the chance would be 0, because
players who need snookers rarely win; and the strokes of a frame, which count as one observation."""
TRACE = 0.4
"""Weight of the actual continuation in a target; the rest is the search's worth of the next position."""


def targets(rows):
    """Targets for the positions of a round: float64 (m,). They follow mostly the position's own search and partly the points of
    the stroke plus the next target, with weights that fade with distance, and not beyond an exploratory stroke."""
    worth, after = rows["worth"], rows["next"]
    target = worth.copy()
    for k in np.arange(len(worth))[::-1]:  # rows are in the order of play, so the next one comes later
        if not rows["explored"][k]:
            follows = rows["same"][k] * target[after[k]] if after[k] >= 0 else 0.0
            target[k] = (1.0 - TRACE) * worth[k] + TRACE * (rows["swing"][k] + follows)
    return target


def fit_network(seen, wanted, seed, passes):
    """Fit a network to the ``wanted`` (n,) points minus the value of the visit at ``seen`` (n, SIZE), in units of ``POINTS``.
    It starts from new weights, because continuing from the last round's overfits."""
    torch.manual_seed(seed)
    network, rng = Perceptron(SIZE, *WIDTHS, 1), np.random.default_rng(seed)
    with torch.no_grad():  # at first the worth equals the value
        last: nn.Linear = network[-1]  # type: ignore[assignment]
        last.weight.mul_(0.1)
    x, y = torch.from_numpy(seen), torch.from_numpy((wanted / POINTS - seen[:, -1]).astype(np.float32))

    def loss_of(rows):
        return ((network(x[rows])[:, 0] - y[rows]) ** 2).mean()

    descend(network, loss_of, np.arange(len(x)), rng, passes, BATCH, DECAY, pct_start=0.1)
    return network.arrays()


def fitted_chance(now, worth, left, last, spread, won):
    """Find the likeliest ``Chance`` from leads, worths, points on the table, whether only the black is left, errors of
    direction [rad] and winners: (n,) each. Positions with only the black, or with a lead equal to the points on the table,
    are not fitted."""
    rest = ~last & (np.abs(now) != left)
    now, worth, left, errors, won = (
        torch.from_numpy(np.asarray(one, np.float64)[rest])
        for one in (now, worth, left, spread / SPREAD, won)
    )
    beyond = now.abs() - left
    sign = now.sign()
    gain = sign * (sign * worth).clamp(min=-FOUL)
    raw = torch.tensor([1.0, -1.0, -2.0, 0.0], dtype=torch.float64, requires_grad=True)
    power = torch.zeros((), dtype=torch.float64, requires_grad=True)
    optimiser = torch.optim.LBFGS([raw, power], max_iter=200, line_search_fn="strong_wolfe")

    def loss():
        optimiser.zero_grad()
        near, far, snookers, needs = nn.functional.softplus(raw)
        wide = (near + far * left) * errors**power
        fouls = sign * (needs + snookers * beyond) + gain / wide
        logit = torch.where(beyond > 0.0, fouls, (now + worth) / wide)
        value = nn.functional.binary_cross_entropy_with_logits(logit, won)
        value = value + 0.5 * ((snookers / SNOOKERS) ** 2 + (needs / NEEDS) ** 2) * STROKES / len(won)
        value.backward()
        return value

    optimiser.step(loss)
    near, far, snookers, needs = nn.functional.softplus(raw).tolist()
    return Chance(near, far, snookers, needs, power.item())


def calibration(chance, won, groups=10):
    """Mean chance and share won (groups, 2) of positions sorted by the chance, and the mean absolute difference."""
    parts = np.array_split(np.argsort(chance, kind="stable"), groups)
    table = np.array([[chance[rows].mean(), won[rows].mean()] for rows in parts])
    return table, float(np.abs(table[:, 0] - table[:, 1]).mean())


def stages(now, left, last):
    """The stages of a frame in words, and which strokes at the leads ``now`` (n,) belong to each."""
    ahead, beyond = np.abs(now), np.abs(now) - left
    return {
        "more than 75 points on the table": ~last & (beyond < 0) & (left > 75),
        "36 to 75": ~last & (beyond < 0) & (left > 35) & (left <= 75),
        "14 to 35": ~last & (beyond < 0) & (left > 13) & (left <= 35),
        "at most pink and black": ~last & (beyond < 0) & (left <= 13),
        "the lead equals the points on the table": ~last & (beyond == 0),
        "the lead is 1 to 4 points larger": ~last & (beyond > 0) & (beyond <= 4),
        "the lead is at least 5 points larger": ~last & (beyond > 4),
        "black alone, lead of at most 7": last & (ahead <= 7),
        "black alone, larger lead": last & (ahead > 7),
    }


def by_stage(chance, won, now, left, last, frames):
    """One row for each of ``stages``: its words, strokes, frames, the mean chance of the player ahead (of the striker, if
    level), the share of these players that won, and its standard error over frames."""
    ahead = now >= 0
    said, made = np.where(ahead, chance, 1.0 - chance), np.where(ahead, won, ~won)
    every = stages(now, left, last).items()
    return [(words, *_compare(said, made, frames, which)) for words, which in every if which.any()]


def by_tenth(chance, won, frames):
    """The same of strokes whose chance lies in each tenth from 0 to 1, without words."""
    tenth = np.minimum((10.0 * chance).astype(int), 9)
    return [_compare(chance, won, frames, tenth == k) for k in np.unique(tenth).tolist()]


def _compare(said, made, frames, which):
    """Of the strokes ``which``: how many, in how many frames, mean chance, share won, its standard error over frames."""
    each, of = np.unique(frames[which], return_inverse=True)
    off = np.bincount(of, made[which] - made[which].mean())
    error = np.sqrt((off**2).sum()) / which.sum()
    return int(which.sum()), len(each), float(said[which].mean()), float(made[which].mean()), float(error)
