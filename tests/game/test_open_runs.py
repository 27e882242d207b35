"""Are the pots along runs that were listed before those that are found anew?"""

import numpy as np

from snooker_env.envs.vector import SnookerVectorEnv
from snooker_env.game.balls import N_BALLS, mask_of
from snooker_env.game.open_runs import MOST_RUNS, RUN_COLUMNS, list_runs, pots_along
from snooker_env.game.pots import POT_COLUMNS, find_pots
from snooker_env.geometry import BALL_RADIUS, HALF_LENGTH, HALF_WIDTH
from snooker_env.kernels import entry


@entry
def _list(positions, on_table, on, runs):
    return list_runs(positions, on_table, on, BALL_RADIUS, runs)


@entry
def _find_both(positions, on_table, on, runs, many, found, along):
    before = find_pots(positions, on_table, on, BALL_RADIUS, found)
    return before, pots_along(runs, many, positions, on_table, BALL_RADIUS, along)


def test_pots_along_runs_are_those_that_are_found_bit_for_bit():
    """Runs are listed with the cue ball elsewhere; then it lies at ten places of each table."""
    rng, met, full = np.random.default_rng(5), 0, 0
    tables = SnookerVectorEnv(40, layout="random:6", threads=1)
    tables.reset(seed=3)
    for k in range(40):
        positions, on_table = tables.tables.positions[k].copy(), tables.tables.on_table[k].copy()
        on = mask_of(np.flatnonzero(on_table[1:] & (rng.random(N_BALLS - 1) < 0.7)) + 1)
        runs = np.empty((MOST_RUNS, RUN_COLUMNS))
        many = _list(positions, on_table, on, runs)
        for most in (4, 16) * 10:
            positions[0] = rng.uniform(-0.95, 0.95, 2) * (HALF_WIDTH, HALF_LENGTH)
            found, along = np.zeros((most, POT_COLUMNS)), np.zeros((most, POT_COLUMNS))
            count, same = _find_both(positions, on_table, on, runs, many, found, along)
            assert count == same and np.array_equal(found, along)
            met, full = met + count, full + (count == most)
    assert met > 1000 and full > 20
