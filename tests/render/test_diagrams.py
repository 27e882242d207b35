"""Do diagrams show what happened?"""

import sys

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.advice.fan import Strokes, fan, fan_options, shade
from snooker_env.render import palette, shot_paths
from snooker_env.render.density_diagram import bandwidth_of, density_of, level_of
from snooker_env.render.diagrams import compare, density, plot, win_chance
from tests.pictures import unreadable
from tests.refusals import refused
from tests.render.test_shot_paths import R, played

plt = pytest.importorskip("matplotlib.pyplot")


@pytest.fixture(autouse=True)
def no_display():
    plt.switch_backend("Agg")
    yield
    plt.close("all")


@pytest.fixture(scope="module")
def screw():
    """A red is cut into the top right pocket with screw and right side; another lies about."""
    balls = [(0.45, 0.85), (0.62, 1.45), (-0.5, 0.2)]
    match, paper = sn.Table.preset("match"), sn.Physics.of(None)
    strokes = Strokes(2.2, [-0.35], [0.2])
    (option,) = fan_options(np.array(balls), np.ones(3, bool), 1, 3, strokes, match, paper)
    return played(balls, speed=2.2, aim=option.aim, top=-0.35, side=0.2)


def lines(ax, gid):
    """(m, 2) of each line of that gid, as (x, y) of the table."""
    return [line.get_xydata()[:, ::-1] for line in ax.get_lines() if line.get_gid() == gid]


def circles(ax, gid):
    """(x, y, radius) of each circle of that gid."""
    return np.array([(p.center[1], p.center[0], p.radius) for p in ax.patches if p.get_gid() == gid])


def words(ax):
    return [text.get_text() for text in ax.texts]


def test_paths_are_those_of_the_shot_by_slide_and_roll(screw):
    ax = screw.plot()
    for ball, own in shot_paths.paths(screw).items():
        for kind in ("slide", "roll"):
            want = [piece.points for piece in own if piece.kind == kind]
            got = lines(ax, f"{kind}-{ball}")
            assert len(got) == len(want) and all(np.array_equal(a, b) for a, b in zip(got, want, strict=True))
    assert lines(ax, "slide-0") and lines(ax, "roll-0") and lines(ax, "slide-1")
    for line in ax.get_lines():
        if line.get_gid() in ("slide-0", "roll-0"):
            assert line.get_linewidth() * 100 / 72 == pytest.approx(3.0)  # pixels at 100 dots an inch
            assert (line.get_linestyle() == "--") == (line.get_gid() == "slide-0")
            assert np.allclose(line.get_color()[:3], palette.PALE[0] / 255)


def test_the_picture_has_baulk_left_black_right_and_the_yellow_side_down(screw):
    ax = screw.plot()
    seen = lambda x, y: ax.transData.transform((y, x))  # noqa: E731
    origin = seen(0, 0)
    assert seen(0, 1)[0] > origin[0] and seen(0, 1)[1] == pytest.approx(origin[1])  # +y to the right
    assert seen(1, 0)[1] < origin[1] and seen(1, 0)[0] == pytest.approx(origin[0])  # +x down
    assert seen(0, 1)[0] - origin[0] == pytest.approx(origin[1] - seen(1, 0)[1])  # as long


def test_balls_ghosts_and_signs_lie_where_things_happen(screw):
    ax = screw.plot()
    start = screw.at(0.0)[0]
    for ball in range(3):
        assert np.allclose(circles(ax, f"ball-{ball}"), [(*start[ball], R)])
    met = next(c for c in shot_paths.contacts(screw, 0) if c.kind == sn.EventKind.BALL_BALL)
    ghosts = circles(ax, "ghost-0")
    assert np.allclose(ghosts[0], (*met.centre, R)) and np.allclose(ghosts[-1], (*screw.positions[0], R))
    assert len(ghosts) == 2
    assert not len(circles(ax, "ghost-1"))  # potted
    for ball in (0, 1):
        for kind in ("ball_ball", "cushion", "jaw", "pot"):
            want = [c.place for c in shot_paths.contacts(screw, ball) if c.kind.name.lower() == kind]
            got = lines(ax, f"{kind}-{ball}")
            assert len(got) == len(want) and (not want or np.allclose(np.concatenate(got), want))
    assert len(lines(ax, "pot-1")) == 1


def test_arrowheads_lie_on_the_path_and_point_along_it(screw):
    ax = screw.plot()
    spacing, n = 0.085 * abs(np.diff(ax.get_xlim())[0]), 0
    for own in shot_paths.paths(screw).values():
        n += len(shot_paths.arrow_places(np.concatenate([p.points for p in own]), spacing))
    heads = [patch.get_xy()[:4, ::-1] for patch in ax.patches if patch.get_gid() == "arrow"]
    assert len(heads) == n >= 5
    times = np.linspace(0, screw.duration, 20001)
    r, v, _ = screw.at(times)
    for tip, one, notch, other in heads:
        place, along = (tip * 0.17 + notch * 0.5) / 0.67, tip - notch
        k, ball = np.unravel_index(np.hypot(*(r[:, :2] - place).transpose(2, 0, 1)).argmin(), (len(times), 2))
        assert np.hypot(*(r[k, ball] - place)) < 1e-3
        assert np.allclose(along / np.hypot(*along), v[k, ball] / np.hypot(*v[k, ball]), atol=0.05)
        assert np.hypot(*(tip - one)) == pytest.approx(np.hypot(*(tip - other)))


def test_speeds_cut_and_tip_are_written(screw):
    ax = screw.plot()
    met = next(c for c in shot_paths.contacts(screw, 0) if c.kind == sn.EventKind.BALL_BALL)
    cut = f"cut {np.degrees(met.cut):.0f}°"
    assert "2.20 m/s" in words(ax) and f"{met.speed:.2f} m/s, {cut}" in words(ax)
    assert "screw 0.35 R, right side 0.20 R" in words(ax) and "red 1 into top right" in words(ax)
    inset, tip = circles(ax, "inset")[0], circles(ax, "tip")[0]
    assert (tip[1] - inset[1]) / inset[2] == pytest.approx(0.2, abs=1e-9)  # right is right
    assert (tip[0] - inset[0]) / inset[2] == pytest.approx(0.35, abs=1e-9)  # below is down
    described = screw.plot(cue={"side": -0.1, "top": 0.4, "speed": 3.0, "elevation": 0.3})
    assert "top 0.40 R, left side 0.10 R" in words(described)
    assert "3.00 m/s, butt raised 17°" in words(described)
    bare = screw.plot(speeds=False, caption="none", title="a title")
    assert words(bare) == ["a title"]


def test_labels_do_not_cover_each_other_and_are_legible():
    shot = played([(0.15, -1.1), (0.5, 0.2), (-0.3, 0.9)], speed=4.5, aim=1.5, side=0.3)
    ax = shot.plot()
    figure = ax.figure
    figure.canvas.draw()
    boxes = [text.get_window_extent() for text in ax.texts]
    assert len(boxes) > 8
    for k, one in enumerate(boxes):
        assert not any(one.overlaps(other) for other in boxes[k + 1 :]), ax.texts[k].get_text()
        assert one.x0 >= 0 and one.x1 <= figure.bbox.x1 and one.y0 >= 0, ax.texts[k].get_text()
        assert one.y1 <= figure.bbox.y1, ax.texts[k].get_text()
    assert min(text.get_size() for text in ax.texts) >= 7.5
    assert figure.get_size_inches()[0] * 100 == pytest.approx(830)


def test_a_break_off_is_drawn_in_full_for_the_balls_that_matter():
    positions, _ = sn.game.layout("break_off", np.random.default_rng(1))
    v, w = sn.strike(4.5, np.arctan2(0.6, -0.03), side=0.3)
    positions[0] = (0.03, 0.2)
    velocities, spins = np.zeros((22, 2)), np.zeros((22, 3))
    velocities[0], spins[0] = v[:2], w
    shot = sn.simulate(positions, velocities, spins)
    found = shot_paths.paths(shot)
    assert len(found) > 7
    ax = shot.plot()
    full = {ball for ball in found if lines(ax, f"roll-{ball}") or lines(ax, f"slide-{ball}")}
    first = next(c.other for c in shot_paths.contacts(shot, 0) if c.kind == sn.EventKind.BALL_BALL)
    assert full == {0, first, *np.flatnonzero(shot.potted >= 0).tolist()}
    assert len(lines(ax, "thin path")) == len(found) - len(full)
    some = shot.plot(balls=[0, 3])
    assert not lines(some, "thin path") and not lines(some, f"roll-{first}")


@pytest.mark.parametrize("table", ["pool9", "uk8", "carom", None, "wall", "rectangular"])
def test_every_table_draws_as_itself(table):
    wall = sn.Table("wall", np.array([(0, 1, 0.5, -9.0, 9.0)]), np.empty((0, 6)), np.empty((0, 3)))
    made = {"wall": wall, "rectangular": sn.Table.rectangular(2.0, 1.0, name="small")}
    table = made[table] if table in made else sn.Table.of(table)
    radius = table.ball_radius or R
    physics = sn.Physics.preset("paper", R=radius)
    shot = played([(0.0, -0.5), (0.05, 0.3), (-0.2, 0.55)], speed=2.5, aim=1.5, table=table, physics=physics)
    ax = plot(shot, view="table")
    assert np.allclose(circles(ax, "ball-0")[0], (0.0, -0.5, radius))
    floor = [p for p in ax.patches if p.get_gid() == "snooker-table" and hasattr(p, "radius")]
    hole = np.array(palette.PALETTE["hole"]) / 255
    holes = [p for p in floor if np.allclose(p.get_facecolor()[:3], hole)]
    falls = {(round(p.center[1], 6), round(p.center[0], 6), round(p.radius, 6)) for p in holes}
    assert {tuple(row) for row in np.round(table.falls, 6).tolist()} <= falls
    assert len(holes) == 2 * len(table.falls)
    edges = [line for line in ax.get_lines() if line.get_gid() == "snooker-table"]
    noses = [line.get_xydata()[:, ::-1] for line in edges if line.get_solid_capstyle() == "butt"]
    assert len(noses) == len(table.noses)
    for axis, side, level, low, high in table.noses:
        at = [nose[np.isclose(nose[:, int(axis)], side * level), 1 - int(axis)] for nose in noses]
        assert any(np.isclose(along, low).any() and np.isclose(along, high).any() for along in at)
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    for own in shot_paths.paths(shot).values():  # all of it is seen, above the strip of words
        for piece in own:
            assert (piece.points[:, 1] > left).all() and (piece.points[:, 1] < right).all()
            assert (piece.points[:, 0] > top).all() and (piece.points[:, 0] < bottom).all()


def test_given_axes_are_drawn_on_and_a_table_once(screw):
    figure, (one, other) = plt.subplots(1, 2)
    assert screw.plot(one) is one and not other.patches
    n = sum(p.get_gid() == "snooker-table" for p in one.patches)
    limits = one.get_xlim(), one.get_ylim()
    assert density(np.random.default_rng(0).normal(0.3, 0.1, (200, 2)), one) is one
    assert sum(p.get_gid() == "snooker-table" for p in one.patches) == n > 10
    assert (one.get_xlim(), one.get_ylim()) == limits
    assert figure.axes == [one, other]


def test_options_side_by_side_show_the_same_part_of_the_table():
    balls = [(0.1, 0.35), (0.35, 0.95)]
    shots = [played(balls, aim=1.18, top=top) for top in (-0.35, 0.35)]
    axes = compare(shots, ["back", "through"])
    assert len(axes) == 2 and axes[0].figure is axes[1].figure
    assert axes[0].get_xlim() == axes[1].get_xlim() and axes[0].get_ylim() == axes[1].get_ylim()
    assert axes[0].get_position().x1 <= axes[1].get_position().x0
    tips = "screw 0.35 R", "top 0.35 R"
    for ax, shot, name, tip in zip(axes, shots, ("back", "through"), tips, strict=True):
        assert name in words(ax) and tip in words(ax)
        assert np.allclose(circles(ax, "ghost-0")[-1][:2], shot.positions[0])
    wide = compare(shots, axes=plt.subplots(1, 2)[1], view="table")
    assert wide[0].get_xlim()[0] < -1.78
    refused(lambda: compare([]), "shots", "[]", "must hold at least one")
    refused(lambda: compare(shots, ["one"]), "labels", "1 of them", "must be 2")
    mixed = [shots[0], played(balls, table="tight")]
    refused(lambda: compare(mixed), "shots[1].table", "another table", "must be that of shots[0]")


def test_a_fan_pots_every_time_and_ends_where_the_cue_ball_stops():
    places, tops, sides = [(0.45, 0.85), (0.62, 1.45)], (-0.3, 0.0, 0.3), (-0.2, 0.2)
    ax = fan(places, tops=tops, sides=sides)
    strokes, match = Strokes(2.0, tops, sides), sn.Table.preset("match")
    options = fan_options(np.array(places), np.ones(2, bool), None, None, strokes, match, sn.Physics.of(None))
    assert all(option.shot.potted[1] == 3 for option in options)
    assert len({option.aim for option in options}) > 1
    paths = lines(ax, "fan")
    assert len(paths) == 6
    for path, option in zip(paths, options, strict=True):
        met = next(shot_paths.contacts(option.shot, 0))
        assert np.allclose(path[0], met.centre) and np.allclose(path[-1], option.shot.positions[0])
    ends = [line for line in ax.get_lines() if line.get_gid() == "end"]
    assert [line.get_marker() for line in ends] == ["<", ">"] * 3
    colours = [np.round(np.array(line.get_markerfacecolor()[:3]) * 255).astype(int) for line in ends[::2]]
    assert list(map(tuple, colours)) == [shade(t, tops) for t in tops]
    assert len({shade(t, tops) for t in tops}) == 3 and shade(0.0, tops) == (255, 255, 255)


def test_a_fan_takes_positions_and_tables_without_pockets():
    position = sn.Position(cue=(0.45, 0.85), reds=[(0.62, 1.45)], black=(0.0, 1.0), on="red")
    ax = fan(position, 1, tops=[0.2], sides=[0.0], labels=True)
    assert len(lines(ax, "fan")) == 1 and len(circles(ax, "ball-21")) == 1
    refused(lambda: fan(position), "ball", "None", "must be one of those on the table, [1, 21]")
    carom = {"table": "carom", "physics": sn.Physics.preset("paper", R=sn.Table.preset("carom").ball_radius)}
    two = [(0.0, 0.0), (0.02, 0.5)]
    refused(lambda: fan(two, **carom), "aim", "None", "must be given: the table has no pockets")
    assert len(lines(fan(two, aim=1.5708, tops=[0.0, 0.3], sides=[0.0], **carom), "fan")) == 2
    behind = lambda: fan([(0.0, 0.0), (0.62, 1.45)], 1, 0, tops=[0.0], sides=[0.0])  # noqa: E731
    refused(behind, "(top, side, speed)", "(0.0, 0.0, 2.0)", "must pot ball 1 into pocket 0")


def test_the_density_keeps_every_point_and_its_lines_hold_their_shares():
    points = np.random.default_rng(3).normal((0.2, 0.9), (0.12, 0.06), (4000, 2))
    low, high = np.array([-0.889, -1.7845]), np.array([0.889, 1.7845])
    values, size = density_of(points, low, high, 0.02)
    assert values.sum() * size.prod() == pytest.approx(1.0, abs=1e-12)
    grid = [low[k] + size[k] * (np.arange(values.shape[k]) + 0.5) for k in range(2)]
    mean = [(values.sum(axis=1 - k) * grid[k]).sum() / values.sum() for k in range(2)]
    assert np.allclose(mean, points.mean(axis=0), atol=1e-3)
    squares = [(values.sum(axis=1 - k) * (grid[k] - mean[k]) ** 2).sum() / values.sum() for k in range(2)]
    spread = np.hypot(points.std(axis=0), 0.02)  # the bell adds its own
    assert np.allclose(np.sqrt(squares), spread, rtol=0.01)
    cells = np.floor((points - low) / size).astype(int)
    for share in (0.5, 0.9):
        level = level_of(values, share)
        assert values[values >= level].sum() * size.prod() == pytest.approx(share, abs=0.01)
        assert (values[tuple(cells.T)] >= level).mean() == pytest.approx(share, abs=0.06)
    ax = density(points)
    assert np.allclose(lines(ax, "mean")[0], points.mean(axis=0))
    half = next(c for c in ax.collections if c.get_gid() == "share-0.5")
    for path in half.get_paths():
        inside = path.contains_points(points[:, ::-1])
        assert inside.mean() == pytest.approx(0.5, abs=0.06)
    image = next(i for i in ax.images if i.get_gid() == "density")
    rows, columns = image.get_array().shape[:2]
    left, right, bottom, top = image.get_extent()
    k = np.unravel_index(np.asarray(image.get_array())[..., 3].argmax(), (rows, columns))
    peak = top + (k[0] + 0.5) / rows * (bottom - top), left + (k[1] + 0.5) / columns * (right - left)
    assert np.hypot(*(np.array(peak) - (0.2, 0.9))) < 0.06


def test_points_that_are_none_are_left_out_and_reported():
    points = np.random.default_rng(0).normal(0.2, 0.05, (100, 2))
    points[:25] = np.nan
    assert "stops on the table in 75 %" in words(density(points))
    width = np.sqrt(points[25:].var(axis=0).mean()) * 75 ** (-1 / 6)
    assert bandwidth_of(points[25:]) == pytest.approx(width)
    refused(lambda: density(points[:25]), "points", "25 rows", "must hold at least one")
    refused(lambda: density(points[0]), "points", "array of shape (2,)", "must have shape (n, 2)")
    refused(lambda: density(points, shares=[1.0]), "shares", "[1.0]", "must each be below 1")
    assert len(density(points, position=[(0.0, 0.0), (0.3, 0.3)], view="shot").patches) > 20


def test_the_chance_to_win_is_shared_out_over_the_strokes():
    chances = [0.5, 0.25, 0.75, 1.0]
    ax = win_chance(chances, players=("Ada", "Grace"), title="A frame")
    first, other = ax.patches
    assert [part.get_gid() for part in (first, other)] == ["first", "other"]
    assert first.get_data().values.tolist() == other.get_data().baseline.tolist() == chances
    assert first.get_data().baseline.tolist() == [0.0] * 4 and other.get_data().values.tolist() == [1.0] * 4
    assert first.get_data().edges.tolist() == [-0.5, 0.5, 1.5, 2.5, 3.5]  # around the strokes played: 0 to 3
    assert first.get_facecolor() != other.get_facecolor()
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["Ada", "Grace"]
    assert ax.get_ylim() == (0.0, 1.0) and ax.get_title(loc="left") == "A frame"
    assert [said for said in unreadable(ax.figure) if "no title" not in said] == []  # that is of pages
    mine = plt.figure().add_subplot()
    assert win_chance([0.3], mine) is mine
    refused(lambda: win_chance(None), "chances", "None", "made with a judge")
    refused(lambda: win_chance([]), "chances", "[]", "must hold at least one")
    refused(lambda: win_chance([0.5, 1.2]), "chances[1]", "1.2", "must be in [0, 1]")
    refused(lambda: win_chance([0.5], players="AB"), "players", "AB", "must be two names")


@pytest.mark.parametrize(
    ("options", "field", "value", "allowed"),
    [
        ({"view": "all"}, "view", "'all'", 'must be "table", "shot"'),
        ({"view": ((1, 0), (0, 1))}, "view", "((1, 0), (0, 1))", "must have its lower ends first"),
        ({"cue": {"side": 0.1}}, "keys of cue", "['side']", "must hold 'top'"),
        ({"cue": {"side": 0, "top": 0, "spin": 1}}, "keys of cue", "'spin'", "must be of 'speed', 'side'"),
        ({"cue": {"side": 2.0, "top": 0.0}}, "cue.side", "2.0", "must be a finite number in [-1, 1]"),
        ({"balls": [5]}, "balls", "5", "must be an integer in [0, 2]"),
        ({"labels": 1}, "labels", "1", "must be True or False"),
        ({"caption": "long"}, "caption", "'long'", "must be one of 'full', 'short', 'none'"),
    ],
)
def test_wrong_options_are_refused(screw, options, field, value, allowed):
    refused(lambda: screw.plot(**options), field, value, allowed)
    assert not plt.get_fignums()  # and no figure is left


def test_without_matplotlib_the_line_that_installs_it_is_said(screw, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ImportError, match=r'diagrams need matplotlib; .* pip install -e "\.\[plot\]"'):
        screw.plot()


def test_a_ball_that_left_the_table_is_in_no_pocket():
    """A table with one pocket: the number of a ball off the table is that of no other."""
    match = sn.Table.preset("match")
    table = sn.Table("one hole", match.noses, match.jaws, match.falls[:1], pockets=("hole",))
    physics = sn.Physics.preset("match", flight=True)
    v, w = sn.strike(5.0, np.pi / 2, 0.0, 0.3, 0.6, physics)
    still = (0.0, 0.0, 0.0)
    shot = sn.simulate([(0.0, 1.2), (0.0, 1.35)], [v, still], [w, still], table, physics=physics)
    assert shot.potted.tolist() == [-2, -1]
    assert "hole" not in " ".join(text.get_text() for text in plot(shot).texts)
