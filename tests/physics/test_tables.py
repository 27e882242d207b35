"""Is a table of one's own taken for what it is? Its name, copies and pickles, its bounds, the balls that it is played with."""

import copy
import pickle

import numpy as np
import pytest

import snooker_env as sn
from snooker_env import Table
from snooker_env.physics.table import UNBOUNDED
from tests.refusals import Z

MATCH = Table.preset("match")
NONE = {"jaws": np.zeros((0, 6)), "falls": np.zeros((0, 3))}


def walls(left, right, bottom, top, name="mine"):
    """Four straight noses, no pockets."""
    sides = (0, -1, -left, bottom, top), (0, 1, right, bottom, top)
    ends = (1, -1, -bottom, left, right), (1, 1, top, left, right)
    return Table(name, np.array([*sides, *ends]), **NONE)


COPIES = {
    "pickle": lambda t: pickle.loads(pickle.dumps(t)),
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "inside": lambda t: copy.deepcopy({"table": [t]})["table"][0],
}


@pytest.mark.parametrize("how", COPIES)
@pytest.mark.parametrize("name", ["match", "tight", "unbounded", "mine", ""])
def test_a_copy_of_an_own_table_keeps_its_content_whatever_it_is_called(name, how):
    mine = walls(-0.5, 0.6, -1.0, 1.2, name)
    other = COPIES[how](mine)
    assert other.name == name and not other.is_preset and other is not UNBOUNDED
    for part in ("noses", "jaws", "falls"):
        assert np.array_equal(getattr(other, part), getattr(mine, part))
    start = [(0.0, 0.0)], [(3.0, 1.0)], [Z]
    assert sn.simulate(*start, other).positions.tolist() == sn.simulate(*start, mine).positions.tolist()


def test_other_balls_may_be_played_on_other_tables():
    preset = Table.preset("match")
    mine = Table("match", preset.noses, preset.jaws, preset.falls)
    for R in (0.02, 0.028575):
        for where in (None, mine):
            assert sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], [Z], where, {"R": R}).positions[0, 0] > 0.1
    assert sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], [Z], "match", {"R": 0.02625 + 5e-10}).positions[0, 0] > 0.1


_SIZES = {"start": 0.1018, "jaw_radius": 0.0926, "turn": 43.894, "fall_depth": 0.0289, "fall_radius": 0.0697}


@pytest.mark.parametrize("behind", [(0.6193, 1.0356), (0.5539, 1.1146), (0.4293, 1.0913)])
def test_no_ball_lies_behind_a_deep_pocket(behind):
    """A ball in the mouth is as far beyond the lines of the noses as these, beside the fall and a jaw."""
    middle = sn.Pocket.middle(mouth=0.15, shelf=0.12, fall_radius=0.08)  # where balls can lie as deep
    deep = Table.rectangular(2.0, 1.0, corner=sn.Pocket(is_middle=False, **_SIZES), middle=middle)
    mouth = deep.falls[3, :2] - (deep.falls[3, 2] + 1e-4) * np.sqrt(0.5)
    for sign in ((1, 1), (-1, 1), (1, -1), (-1, -1)):
        deep.check([mouth * sign], 0.02625)
        with pytest.raises(ValueError, match=r"positions\[0\] = .*must be on the table"):
            deep.check([np.multiply(behind, sign)], 0.02625)
