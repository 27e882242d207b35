"""Is there one geometry? One definition of table and ball, one order of pockets, sizes as published."""

import dataclasses

import numpy as np
import pytest

import snooker_env as sn
from snooker_env import Pocket, Table, geometry
from snooker_env.game import balls
from tests.refusals import refuse_each

INCH = 0.0254
SIDE, END = {"left": -1, "right": 1}, {"bottom": -1, "middle": 0, "top": 1}


def test_snooker_is_as_the_rules_say():
    assert (2 * geometry.HALF_WIDTH, 2 * geometry.HALF_LENGTH) == (1.778, 3.569)  # WPBSA
    assert np.array_equal(geometry.COLOUR_SPOTS, balls.SPOTS[16:])
    assert geometry.HALF_LENGTH - geometry.COLOUR_SPOTS[5, 1] == pytest.approx(0.324)
    assert geometry.COLOUR_SPOTS[4, 1] == geometry.HALF_LENGTH / 2
    assert sn.Physics().R == sn.Physics.preset("match").R == geometry.BALL_RADIUS == sn.Physics().pack()[0]


@pytest.mark.parametrize("name", ["match", "tight", "uk8", "pool9"])
def test_the_order_of_pockets_is_one(name):
    """Names, aims, nominal places, falls of every preset: index k is one pocket."""
    table = Table.preset(name)
    assert table.pockets == geometry.POCKETS == sn.POCKETS
    for k, called in enumerate(geometry.POCKETS):
        end, side = called.split()
        want = [SIDE[side], END[end]]
        row = geometry.POCKET_AIMS[k]
        aim, axis = row[[geometry.AIM_X, geometry.AIM_Y]], row[[geometry.AXIS_X, geometry.AXIS_Y]]
        for way in (table.falls[k, :2], aim, axis, geometry.POCKET_PLACES[k], geometry.SIDES[k]):
            assert np.sign(way).tolist() == want
        assert geometry.POCKET_AIMS[k, geometry.IS_MIDDLE] == (end == "middle")


@pytest.mark.parametrize("name", ["match", "tight"])
def test_the_aim_points_lie_where_the_falls_meet_the_axes(name):
    for (x, y, radius), (ax, ay, ux, uy, _) in zip(
        Table.preset(name).falls, geometry.POCKET_AIMS, strict=True
    ):
        assert np.hypot(ux, uy) == pytest.approx(1.0, abs=1e-12)
        assert np.hypot(x - ax, y - ay) == pytest.approx(radius, abs=2e-5)
        assert np.hypot(ax + radius * ux - x, ay + radius * uy - y) < 2e-5


def test_rectangular_tables_keep_the_order_of_pockets_and_snookers_shape():
    four = Table.rectangular(2, 1, pockets=4)
    assert four.pockets == ("bottom left", "bottom right", "top right", "top left")
    assert np.sign(four.falls[:, :2]).tolist() == [[-1, -1], [1, -1], [1, 1], [-1, 1]]
    bare = Table.rectangular(2, 1, pockets=0)
    assert bare.pockets == () and bare.falls.shape == (0, 3) and bare.jaws.shape == (0, 6)
    assert bare.bounds.tolist() == [[-0.5, 0.5], [-1, 1]]
    own, match = Table.rectangular(3.569, 1.778), Table.preset("match")
    for part in ("noses", "jaws", "falls"):
        assert np.array_equal(getattr(own, part), getattr(match, part))
    assert own.ball_radius is None and own.ball == {}
    assert match.ball == {"R": 0.02625, "M": 0.1406, "sin_theta": 0.4}


def test_presets_have_the_published_sizes():
    pool, carom, uk8 = (Table.preset(name) for name in ("pool9", "carom", "uk8"))
    assert np.diff(pool.bounds).ravel() == pytest.approx([1.27, 2.54])
    assert 2 * pool.ball_radius == pytest.approx(0.05715)
    assert np.diff(carom.bounds).ravel() == pytest.approx([1.42, 2.84])
    assert 2 * carom.ball_radius == pytest.approx(0.0615)
    assert np.diff(uk8.bounds).ravel() == pytest.approx([1.0668, 2.1336])
    assert 2 * uk8.ball_radius == pytest.approx(0.0508)
    assert carom.ball["R"] * (1 + carom.ball["sin_theta"]) == pytest.approx(0.037)  # UMB: the nose's height
    assert (1 + pool.ball["sin_theta"]) / 2 == pytest.approx(0.635)  # WPA: over the ball's diameter


def test_the_pockets_of_pool_are_within_the_specification_of_the_wpa():
    """Read from the arrays: where the noses end, how the facings run, where the fall begins."""
    pool = Table.preset("pool9")
    points, facings = pool.jaws[pool.jaws[:, 2] == 0.0, :2], pool.jaws[pool.jaws[:, 2] > 0.0]
    for k, (low, high, cut, shelf) in enumerate(
        [(4.5, 4.625, 142, (1, 2.25)), (4.5, 4.625, 142, (1, 2.25)), (5, 5.125, 104, (0, 0.375))] * 2
    ):
        a, b = points[2 * k : 2 * k + 2]
        x, y, radius = pool.falls[k]
        assert low <= np.hypot(*(a - b)) / INCH <= high
        assert shelf[0] <= (np.hypot(*((a + b) / 2 - (x, y))) - radius) / INCH <= shelf[1]
        for place, (fx, fy, flat, ux, uy, _) in zip((a, b), facings[2 * k : 2 * k + 2], strict=True):
            assert np.hypot(*(place - (fx, fy))) == pytest.approx(flat, abs=1e-9)  # it begins at the point
            # the facing's normal against the nose's: the turn is 180 degrees less the cut angle
            nose = min(
                ([1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]), key=lambda n: _off_the_rail(place, n)
            )
            assert np.degrees(np.arccos(np.dot(nose, (ux, uy)))) == pytest.approx(180 - cut, abs=0.1)


def _off_the_rail(place, normal):
    """How far a point is from the pool table's nose line with this normal into the table."""
    return abs(np.dot(place, normal) + (0.635 if normal[1] == 0 else 1.27))


@pytest.mark.parametrize(
    "shape",
    [
        Pocket.corner(mouth=0.14, shelf=0.03, fall_radius=0.075),
        Pocket.corner(mouth=0.14, shelf=-0.01, fall_radius=0.08, jaw_radius=0.05),
        Pocket.corner(mouth=0.12, shelf=0.02, fall_radius=0.06, cut=140, jaw_radius=0.004),
        Pocket.middle(mouth=0.13, shelf=0.005, fall_radius=0.07),
        Pocket.middle(mouth=0.22, shelf=-0.002, fall_radius=0.053, jaw_radius=0.06),
        Pocket.middle(mouth=0.13, shelf=0.0, fall_radius=0.07, cut=104),
    ],
)
def test_a_pocket_has_the_sizes_that_it_was_made_from(shape):
    make = Pocket.middle if shape.is_middle else Pocket.corner
    sizes = {name: getattr(shape, name) for name in ("mouth", "shelf", "fall_radius", "jaw_radius")}
    again = make(**sizes, cut=180 - shape.turn)
    for field in ("start", "turn", "fall_depth", "fall_radius", "jaw_radius"):
        assert getattr(again, field) == pytest.approx(getattr(shape, field), abs=1e-12)
    table = Table.rectangular(2.5, 1.25, **{"middle" if shape.is_middle else "corner": shape})
    k = geometry.POCKETS.index("middle right" if shape.is_middle else "top right")
    _, _, ux, uy, _ = geometry.POCKET_AIMS[k]
    x, y, radius = table.falls[k]
    corner = np.array((0.625, 0.0 if shape.is_middle else 1.25))
    depth = (np.array((x, y)) - corner) @ (ux, uy) - radius
    assert depth == pytest.approx(shape.shelf + shape.mouth_depth, abs=1e-12)


SMALL = {"mouth": 0.12, "shelf": 0.02, "fall_radius": 0.06}
CORNER, MIDDLE = Pocket.corner(**SMALL), Pocket.middle(**SMALL)
WRONG = """
table(length=0) | table.length | 0 | must be a finite number in (0, 100]
table(width=INF) | table.width | inf | must be a finite number in (0, 100]
table(pockets=?) | table.pockets | ? | must be 6, 4 or 0 | 5; "six"
table(corner=MIDDLE) | table.corner | is_middle=True | must be a Pocket made by Pocket.corner
table(middle=0.1) | table.middle | 0.1 | must be a Pocket made by Pocket.middle
table(pockets=0, corner=CORNER) | table.corner | Pocket | must be None on a table with 0 pockets
table(pockets=4, middle=MIDDLE) | table.middle | Pocket | must be None on a table with 4 pockets
table(width=0.15) | table.width | 0.15 | must be more than 0.19527
table(length=0.4) | table.length | 0.4 | must be more than 0.41364
table(ball_radius=0.05) | table.ball_radius | 0.05 | half the throat of the corner pockets
table(ball_radius=0.0) | table.ball_radius | 0.0 | must be a finite number in [0.001, 1]
table(name=None) | table.name | None | must be a str
corner(mouth=-1) | pocket.corner.mouth | -1 | must be a finite number in (0, 1]
corner(cut=100) | pocket.corner.cut | 100 | must be a finite number in [135, 180]
middle(cut=80) | pocket.middle.cut | 80 | must be a finite number in [90, 180]
middle(cut=180) | pocket.middle.turn | 0.0 | must be a finite number in (0, 90]
middle(jaw_radius=0.07) | pocket.middle | Pocket( | must leave an opening between its jaws
middle(fall_radius=0.03) | pocket.middle | Pocket( | a fall at least as wide as the throat
replace(CORNER, is_middle="no") | pocket.is_middle | 'no' | must be True or False
named(("a", "b")) | table.pockets | ('a', 'b') | must be a tuple of 1 names
"""


def test_tables_and_pockets_that_do_not_fit_together_are_refused():
    names = {"CORNER": CORNER, "MIDDLE": MIDDLE, "INF": np.inf, "replace": dataclasses.replace}
    names |= {
        kind: lambda kind=kind, **sizes: getattr(Pocket, kind)(**SMALL | sizes)
        for kind in ("corner", "middle")
    }
    parts = np.zeros((0, 5)), np.zeros((0, 6)), np.ones((1, 3))
    names |= {"table": lambda **sizes: Table.rectangular(**{"length": 2, "width": 1} | sizes)}
    refuse_each(WRONG, names | {"named": lambda pockets: Table("a", *parts, pockets=pockets)})
