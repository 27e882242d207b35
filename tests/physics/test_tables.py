"""Is a table of one's own taken for what it is? Its name, copies and pickles, its bounds, the balls that it
is played with."""

import copy
import pickle

import numpy as np
import pytest

import snooker_env as sn
from snooker_env import Table
from snooker_env.physics.table import UNBOUNDED
from tests.refusals import Z, case, refused, shot

MATCH = Table.preset("match")
NONE = {"jaws": np.zeros((0, 6)), "falls": np.zeros((0, 3))}


def walls(left, right, bottom, top, name="mine"):
    """Four straight noses, no pockets."""
    noses = [
        (0, -1, -left, bottom, top),
        (0, 1, right, bottom, top),
        (1, -1, -bottom, left, right),
        (1, 1, top, left, right),
    ]
    return Table(name, np.array(noses), **NONE)


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


@pytest.mark.parametrize("how", COPIES)
def test_a_copy_of_a_preset_is_the_preset(how):
    for preset in (MATCH, Table.preset("tight"), UNBOUNDED):
        assert COPIES[how](preset) is preset


SMALL, POOL = 0.02, 0.028575


@pytest.mark.parametrize("name", ["match", "tight"])
@pytest.mark.parametrize("R", [SMALL, POOL, 0.0263])
def test_presets_are_played_with_their_own_balls(name, R):
    allowed = f'must be 0.02625 on table "{name}", which is made for it: write physics={{"R": 0.02625}}'
    refused(shot(table=name, physics={"R": R}), "physics.R", repr(R), allowed)
    many = [[(0.0, 0.0)]], [[(1.0, 0.0)]], [[Z]]
    refused(lambda: sn.simulate_batch(*many, name, {"R": R}), "physics.R", repr(R), allowed)


def test_other_balls_may_be_played_on_other_tables():
    preset = Table.preset("match")
    mine = Table("match", preset.noses, preset.jaws, preset.falls)
    for R in (SMALL, POOL):
        for where in (None, mine):
            assert sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], [Z], where, {"R": R}).positions[0, 0] > 0.1
    assert sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], [Z], "match", {"R": 0.02625 + 5e-10}).positions[0, 0] > 0.1


WIDE = walls(-1.067, 1.067, -2.5, 2.5)
ODD = walls(-0.3, 1.0, -0.5, 2.0)
CHANNEL = Table("channel", np.array([(0, -1, 0.3, -9, 9), (0, 1, 0.3, -9, 9)]), **NONE)


@pytest.mark.parametrize(
    ("own", "inside", "outside", "allowed"),
    [
        (WIDE, (0.95, 2.3), (1.1, 0.0), "|x| <= 1.04075, |y| <= 2.47375 away"),
        (WIDE, (-1.04, -2.47), (0.0, -2.6), "|x| <= 1.04075, |y| <= 2.47375 away"),
        # beyond the ends of both noses, where no nose is beside it
        (WIDE, (1.04, 2.47), (1.07, 2.503), "|x| <= 1.04075, |y| <= 2.47375 away"),
        (ODD, (0.9, 1.9), (-0.4, 0.0), "-0.27375 <= x <= 0.97375, -0.47375 <= y <= 1.97375 away"),
        (ODD, (-0.27, -0.47), (0.0, -1.0), "-0.27375 <= x <= 0.97375"),
        (CHANNEL, (0.27, 500.0), (0.5, 0.0), "must be on the table, |x| <= 0.27375 away"),
    ],
)
def test_balls_lie_between_the_noses_of_the_table_given(own, inside, outside, allowed):
    assert sn.simulate([inside], [(0.0, 0.0)], [Z], own).duration == 0.0
    refused(shot(positions=[(0.2, 0.2), outside], table=own), "positions[1]", str(outside), allowed)


_SIZES = {"start": 0.1018, "jaw_radius": 0.0926, "turn": 43.894, "fall_depth": 0.0289, "fall_radius": 0.0697}
DEEP = Table.rectangular(
    2.0,
    1.0,
    corner=sn.Pocket(is_middle=False, **_SIZES),
    middle=sn.Pocket.middle(mouth=0.15, shelf=0.12, fall_radius=0.08),
)
"""A table whose balls can lie deep in the mouths of its middle pockets, as no ball can behind its corners."""


@pytest.mark.parametrize(
    ("behind", "beside"),
    [((0.6193, 1.0356), "the fall"), ((0.5539, 1.1146), "the fall"), ((0.4293, 1.0913), "a jaw")],
)
def test_no_ball_lies_behind_a_deep_pocket(behind, beside):
    """A ball in the mouth is as far beyond the lines of the noses as these."""
    fall = DEEP.falls[3]
    axis = np.sqrt(0.5) * np.ones(2)
    mouth = fall[:2] - (fall[2] + 1e-4) * axis
    for sign in ((1, 1), (-1, 1), (1, -1), (-1, -1)):
        DEEP.check([mouth * sign], 0.02625)
        with pytest.raises(ValueError, match=r"positions\[0\] = .*must be on the table"):
            DEEP.check([np.multiply(behind, sign)], 0.02625)


def test_a_table_of_pockets_and_jaws_alone_has_no_bounds():
    bare = Table("bare", np.zeros((0, 5)), MATCH.jaws, MATCH.falls)
    assert sn.simulate([(50.0, 50.0)], [(0.1, 0.0)], [Z], bare).positions[0, 0] > 50.0
    refused(
        shot(positions=[(0.0, 0.0), (0.895, 0.0)], table=bare),
        "positions[1]",
        "(0.895, 0.0)",
        "is over a pocket",
    )


def own(**parts):
    return lambda: Table(**{"name": "mine", "noses": np.zeros((0, 5)), **NONE} | parts)


NOSE, JAW = (
    "must be axis 0 or 1, side -1 or 1, level, and lo <= hi",
    "must be x, y, radius >= 0, a unit vector (to 1e-6), and a cosine",
)


@pytest.mark.parametrize(
    ("call", "field", "value", "allowed"),
    [
        case(own(name=None), "table.name", "None", "must be a str"),
        case(
            lambda: Table.rectangular(2.0, 1.0, pockets=False), "table.pockets", "False", "must be 6, 4 or 0"
        ),
        case(own(name=3), "table.name", "3", "must be a str"),
        case(own(noses=[(2, 1, 1, -1, 1)]), "table.noses[0]", "(2.0, 1.0, 1.0, -1.0, 1.0)", NOSE),
        case(
            own(noses=[(0, 1, 1, -1, 1), (0, 0, 1, -1, 1)]),
            "table.noses[1]",
            "(0.0, 0.0, 1.0, -1.0, 1.0)",
            NOSE,
        ),
        case(own(noses=[(0, 1, 1, 1, -1)]), "table.noses[0]", "(0.0, 1.0, 1.0, 1.0, -1.0)", NOSE),
        case(own(noses=[(0, 1, np.nan, -1, 1)]), "table.noses[0, 2]", "nan", "must be finite"),
        case(own(jaws=[(0, 0, -0.1, 1, 0, 0)]), "table.jaws[0]", "-0.1", JAW),
        case(own(jaws=[(0, 0, 0.1, 0, 0, 0)]), "table.jaws[0]", "(0.0, 0.0, 0.1, 0.0, 0.0, 0.0)", JAW),
        case(own(jaws=[(0, 0, 0.1, 1, 0, 1.5)]), "table.jaws[0]", "1.5", JAW),
        case(own(falls=[(0, 0, 0)]), "table.falls[0]", "(0.0, 0.0, 0.0)", "must be x, y, and a radius > 0"),
        case(
            own(falls=[(0, 0, 0.1), (0, 0, -0.1)]), "table.falls[1]", "-0.1", "must be x, y, and a radius > 0"
        ),
    ],
)
def test_odd_shapes(call, field, value, allowed):
    refused(call, field, value, allowed)


@pytest.mark.parametrize(
    ("places", "there", "says"),
    [
        (
            [(0.0, 0.0), (0.1, 0.5)],
            [True],
            r"on_table = bool array of shape \(1,\): must be bool of shape \(2,\)",
        ),
        (
            [(0.0, 0.0), (0.1, 0.5)],
            [True] * 4,
            r"on_table = bool array of shape \(4,\): must be bool of shape \(2,\)",
        ),
        (
            np.zeros((3, 2, 2)),
            [True, False],
            r"on_table = bool array of shape \(2,\): must be bool of shape \(3, 2\)",
        ),
        ([(0.0, 0.0)], [1], r"on_table = int64 array of shape \(1,\): must be bool of shape \(1,\)"),
        ([0.0, 1.0], None, r"positions = array of shape \(2,\): must have shape \(n, 2\) or \(b, n, 2\)"),
        (
            [(0.0, 0.0, 0.0)],
            None,
            r"positions = array of shape \(1, 3\): must have shape \(n, 2\) or \(b, n, 2\)",
        ),
    ],
)
def test_a_layout_of_another_shape_is_refused_by_name(places, there, says):
    with pytest.raises(ValueError, match=says):
        sn.Table.preset("match").check(places, 0.02625, on_table=there)
