"""Are the pots that are offered ones that can be played?"""

import numpy as np
import pytest

from snooker_env.game.balls import mask_of
from snooker_env.game.layouts import deal_tables, plan_of
from snooker_env.game.philox import stream_of
from snooker_env.game.pots import GHOST_X, GHOST_Y, pots
from snooker_env.geometry import BALL_RADIUS, HALF_LENGTH, HALF_WIDTH


def two(cue, red):
    positions, on_table = np.zeros((22, 2)), np.zeros(22, bool)
    positions[:2], on_table[:2] = (cue, red), True
    return pots(positions, on_table, mask_of([1]))


def test_no_ghost_lies_in_a_cushion():
    """A red by the rail cannot be potted across the table: there is no room behind it."""
    assert not (np.abs(two((-0.5, 1.6), (-0.86, 0.3))[:, GHOST_X]) > HALF_WIDTH - BALL_RADIUS + 1e-9).any()
    deal = plan_of("opened")
    for seed in range(200):
        positions, on_table = np.zeros((1, 22, 2)), np.zeros((1, 22), bool)
        deal_tables(np.zeros(1, np.int64), deal.code, deal.tables, stream_of(np.random.default_rng(seed))[None], positions, on_table)
        found = pots(positions[0], on_table[0], mask_of(range(1, 16)))
        assert (np.abs(found[:, GHOST_X]) <= HALF_WIDTH - BALL_RADIUS + 1e-9).all()
        assert (np.abs(found[:, GHOST_Y]) <= HALF_LENGTH - BALL_RADIUS + 1e-9).all()


@pytest.mark.parametrize("side", [-1, 1])
def test_a_ball_frozen_to_a_rail_can_be_sent_along_it(side):
    red = (side * (HALF_WIDTH - BALL_RADIUS), 1.2)
    found = two((side * 0.7, 0.4), red)
    assert len(found) and found[0, GHOST_Y] < red[1]
