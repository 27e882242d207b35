"""Are the pots, the obstructions and the clear paths those of the geometry, recomputed one by one?"""

import numpy as np

from snooker_env.game.balls import mask_of
from snooker_env.planning import Position, Positions, clear_paths
from snooker_env.planning.pot_geometry import obstructions
from tests import miss_paths as miss_rule
from tests.positions import tables


def test_what_is_in_the_way_is_nearer_than_two_radii_to_the_path():
    at, rng = Positions.of(tables(10)), np.random.default_rng(0)
    rows, starts, ends = rng.integers(0, 10, 200), *(rng.uniform(-1.0, 1.0, (2, 200, 2)) * (0.85, 1.7))
    none, ignore = np.zeros((200, 0), int), np.stack([np.zeros(200, int), np.full(200, 5)], 1)
    direct, some = obstructions(at, rows, starts, ends, none), np.linspace(0.0, 1.0, 2001)[:, None]
    for i in range(200):
        path = starts[i] + some * (ends[i] - starts[i])
        nearest = np.hypot(*(at.positions[rows[i]][:, None] - path).transpose(2, 0, 1)).min(axis=1)
        sure = np.abs(nearest - 0.0525) > 1e-5
        assert np.array_equal(direct[i, sure], (nearest < 0.0525)[sure] & at.on_table[rows[i], sure])
    assert 0.02 < direct.mean() < 0.5
    ignored = obstructions(at, rows, starts, ends, ignore)
    assert not ignored[:, [0, 5]].any()
    assert np.array_equal(np.delete(ignored, [0, 5], 1), np.delete(direct, [0, 5], 1))


def test_clear_paths_are_those_of_the_miss_rule():
    at = Positions.of(tables(40, layout="snookered"))
    clear = clear_paths(at)
    for k in range(40):
        on = mask_of(np.flatnonzero(at.balls_on[k]).tolist())
        assert clear[k] == miss_rule.paths(at.positions[k], at.on_table[k], on)[0]
    assert not clear.all() and clear.any()
    assert clear_paths(Positions.of(tables(5))).all()
    assert clear_paths(Position(black=(0.0, 1.4605), over=True)).tolist() == [False]
