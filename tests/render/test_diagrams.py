"""Do diagrams show what happened?"""

import sys
from itertools import pairwise

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.render import palette
from snooker_env.render.scene import find_contacts, trace_paths
from tests.refusals import refused

plt = pytest.importorskip("matplotlib.pyplot")
R = 0.02625


@pytest.fixture(autouse=True)
def no_display():
    plt.switch_backend("Agg")
    yield
    plt.close("all")


def played(balls, speed=2.0, aim=1.5708, table="match", physics=None, **tip):
    v, w = sn.strike(speed, aim, physics=physics, **tip)
    still = [(0.0, 0.0)] * (len(balls) - 1)
    return sn.simulate(balls, [v[:2], *still], [w, *[(0.0, 0.0, 0.0)] * len(still)], table, physics)


@pytest.fixture(scope="module")
def screw():
    """A red is cut into the top right pocket with screw and right side; another lies about."""
    balls = [(0.45, 0.85), (0.62, 1.45), (-0.5, 0.2)]
    return played(balls, speed=2.2, aim=1.3188738263576985, top=-0.35, side=0.2)


def lines(ax, gid):
    """(m, 2) of each line of that gid, as (x, y) of the table."""
    return [line.get_xydata()[:, ::-1] for line in ax.get_lines() if line.get_gid() == gid]


def circles(ax, ball, faint):
    """(x, y, radius) of each circle of a ball as it lay before the shot, or of its faint ones."""
    mine = [p for p in ax.patches if p.get_gid() == f"ball-{ball}" and (p.get_facecolor()[3] < 1) == faint]
    return np.array([(p.center[1], p.center[0], p.radius) for p in mine])


def test_paths_are_those_of_the_shot_in_the_colours_of_the_balls(screw):
    ax, want = screw.plot(), trace_paths(screw, (1, 0))
    drawn = {line.get_xydata().tobytes(): line for line in ax.get_lines() if line.get_gid() == "path"}
    assert len(drawn) == len(want) == 2
    for ball, (points, _) in want.items():
        line = drawn[np.ascontiguousarray(points[:, ::-1]).tobytes()]
        assert np.allclose(line.get_color()[:3], palette.PALE[ball] / 255)


def test_a_path_is_striped_where_the_contact_point_slips(screw):
    """Slip v + R (-w_y, w_x), from the shot itself, at the middle of each part of a path."""
    stripes = {(tuple(a), tuple(b)) for line in lines(screw.plot(), "slides") for a, b in pairwise(line)}
    kinds = set()
    for ball, (points, times) in trace_paths(screw, (0, 1)).items():
        for k, time in enumerate((times[1:] + times[:-1]) / 2):
            _, v, w = (part[ball] for part in screw.at(time))
            slips = bool(np.hypot(v[0] - R * w[1], v[1] + R * w[0]) > 1e-9)
            assert ((tuple(points[k]), tuple(points[k + 1])) in stripes) == slips
            kinds.add(slips)
    assert kinds == {True, False}


def test_balls_lie_where_they_were_met_and_stopped(screw):
    ax = screw.plot()
    start = screw.at(0.0)[0]
    for ball in range(3):
        assert np.allclose(circles(ax, ball, False), [(*start[ball], R)])
    (met,), _ = find_contacts(screw)
    assert np.allclose(circles(ax, 0, True), [(*met, R), (*screw.positions[0], R)])
    assert np.allclose(circles(ax, 1, True), [(*start[1], R)])  # met there, and potted
    assert len(circles(ax, 2, True)) == 0  # it never moved


@pytest.mark.parametrize("table", ["pool9", "uk8", "carom", None, "wall", "rectangular"])
def test_every_table_draws_as_itself(table):
    """Its picture stands where the table is, and all of the paths is seen."""
    wall = sn.Table("wall", np.array([(0, 1, 0.5, -9.0, 9.0)]), np.empty((0, 6)), np.empty((0, 3)))
    made = {"wall": wall, "rectangular": sn.Table.rectangular(2.0, 1.0, name="small")}
    table = made[table] if table in made else sn.Table.of(table)
    radius = table.ball_radius or R
    physics = sn.Physics.preset("paper", R=radius)
    shot = played([(0.0, -0.5), (0.05, 0.3), (-0.2, 0.55)], speed=2.5, aim=1.5, table=table, physics=physics)
    ax = shot.plot()
    assert np.allclose(circles(ax, 0, False)[0], (0.0, -0.5, radius))
    (image,) = ax.images
    pixels, (left, right, bottom, top) = image.get_array(), image.get_extent()
    rows, columns = pixels.shape[:2]
    for x, y, fall in table.falls:
        x, y = np.array([x, y]) * (1 - 0.5 * fall / np.hypot(x, y))
        row, column = (x - top) / (bottom - top) * rows, (y - left) / (right - left) * columns
        assert pixels[int(row), int(column)].max() < 40  # a hole
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    for points, _ in trace_paths(shot, range(3)).values():
        assert (points[:, 1] > left).all() and (points[:, 1] < right).all()
        assert (points[:, 0] > top).all() and (points[:, 0] < bottom).all()


def test_what_cannot_be_drawn_is_refused_and_no_figure_is_left(screw, monkeypatch):
    env = sn.SnookerEnv()
    env.reset(seed=1)
    env.step([0.0, 0.0, 0.0, 0.5])
    refused(lambda: env.last_shot.plot(), "shot.segments", "none", "keep_history = True")
    refused(lambda: env.last_shot.at(0.0), "shot.segments", "none", "keep_history = True")
    many = sn.simulate(np.arange(46.0).reshape(23, 2), np.zeros((23, 2)), np.zeros((23, 3)), None)
    refused(lambda: many.plot(), "balls of the shot", "23", "must be at most 22")
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(
        ImportError, match=r'diagrams need matplotlib; .* pip install -c constraints.txt -e "\.\[plot\]"'
    ):
        screw.plot()
    assert not plt.get_fignums()
