"""Where do the tables of the layout "escape" come from? They are the tables of "snookered" on which constant choices fail.

A constant choice is the same choice of ``action="discrete"`` on every table. The third that escapes from the largest share
of other snookers is played on each table, with a professional's execution errors and a real cue. The later half of the
tables is held out.
"""

import numpy as np

from snooker_env import SnookerVectorEnv
from snooker_env.players import decision_seeds
from snooker_env.tasks import CHOICES

RULES = {"layout": "snookered", "reward": "legal", "one_stroke": True, "noise": "professional", "cue": "real"}
SIDE_BY_SIDE, SCREENED = 2000, 200
"""Tables at once, and tables on which the constants are compared."""
ROUNDS = ((4, 0.75), (16, 0.65), (64, 0.6))
"""Strokes on each table: totals, each with the largest share of fair strokes with which a table continues."""


def legal(seeds, choices, errors):
    """Deal the tables (n, 22, 2) with these seeds, NaN for absent balls, and find which of the choices (n,) are fair on
    them with the errors of the seeds (n,)."""
    tables = SnookerVectorEnv(len(seeds), **RULES, action="discrete", autoreset_mode="Disabled")
    tables.reset(seed=seeds.tolist())
    dealt = np.where(tables.tables.on_table[:, :, None], tables.tables.positions, np.nan)
    tables.tables.streams[:, 0] = errors
    fair = tables.step(choices)[1] > 0.0
    tables.close()
    return dealt, fair


def best_third(first):
    """The best third of the constants on the tables with seeds from ``first`` on."""
    seeds = np.tile(np.arange(first, first + SCREENED), CHOICES)
    choices = np.repeat(np.arange(CHOICES), SCREENED)
    fair = legal(seeds, choices, decision_seeds(1, seeds, choices))[1].reshape(CHOICES, SCREENED)
    return np.argsort(-fair.mean(axis=1), kind="stable")[: CHOICES // 3]


def kept_of(first, constants):
    """The kept tables with seeds from ``first`` on: (k, 22, 2) float32."""
    seeds, fair, played = np.arange(first, first + SIDE_BY_SIDE), np.zeros(SIDE_BY_SIDE), 0
    for strokes, most in ROUNDS:
        for trial in range(played, strokes):
            picks = constants[decision_seeds(2, seeds, trial) % len(constants)]
            dealt, made = legal(seeds, picks, decision_seeds(3, seeds, trial))
            fair += made
        few, played = fair <= most * strokes, strokes
        seeds, fair, dealt = seeds[few], fair[few], dealt[few]
    return dealt.astype(np.float32)


def make(size, seed):
    """Tables (size, 22, 2), and the number of snookers examined."""
    kept, first = np.empty((0, 22, 2), np.float32), 1_000_000 * seed
    constants = best_third(first + 500_000)
    while len(kept) < size:
        kept = np.concatenate([kept, kept_of(first, constants)])
        first += SIDE_BY_SIDE
    return kept[:size], first - 1_000_000 * seed
