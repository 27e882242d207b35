"""Does a drawn table show what lies on it? Pictures, text and films against known places, sizes and balls."""

import re
import sys

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game.balls import BLACK, BROWN, CUE, GREEN, N_BALLS, PINK, SPOTS, YELLOW
from snooker_env.geometry import BALL_RADIUS
from snooker_env.render.ascii_view import ansi
from snooker_env.render.palette import COLOURS
from snooker_env.render.pygame_view import rgb_array
from snooker_env.render.scene import outline, scene
from snooker_env.render.window import Window
from tests.pictures import size_of, to_pixels

ALL = np.ones(N_BALLS, bool)


def without(*balls):
    here = ALL.copy()
    here[list(balls)] = False
    return here


def at(picture, point):
    column, row = np.floor(to_pixels(point, size=picture.shape[1::-1])).astype(int)
    return picture[row, column].astype(int)


def is_drawn(picture, point, ball):
    """The ball is nearer to its colour than to any other ball's, and near it."""
    far = np.abs(COLOURS.astype(int) - at(picture, np.add(point, (0.45 * BALL_RADIUS, 0.0)))).max(axis=1)
    return far[ball] == far.min() and far[ball] < 40


def test_picture_shows_every_ball_in_its_place():
    picture = rgb_array(scene("match", SPOTS, ALL))
    assert picture.shape == (1080, 1920, 3) and picture.dtype == np.uint8
    for ball in range(N_BALLS):
        assert is_drawn(picture, SPOTS[ball], ball), ball
    # Seen from baulk towards the black the yellow is on the right: black right, yellow below, green above.
    places = to_pixels(SPOTS)
    assert places[BLACK, 0] > places[PINK, 0] > places[BROWN, 0]
    assert places[YELLOW, 1] > places[BROWN, 1] > places[GREEN, 1]
    assert places[BLACK, 1] == places[BROWN, 1]


def test_picture_of_the_table():
    picture = rgb_array(scene("match", SPOTS, ~ALL))
    for x, y, radius in sn.Table.preset("match").falls:
        inner = np.array([x, y]) - 0.6 * radius * np.sign([x, y])  # over the fall, on the way into the table
        assert at(picture, inner).max() < 25
    red, green, blue = at(picture, (0.3, 0.5))
    assert green > red + 40 and green > blue + 20
    baulk = SPOTS[BROWN, 1]
    for on, beside in (((0.6, baulk), (0.6, baulk + 0.03)), ((0.0, baulk - 0.292), (0.0, baulk - 0.27))):
        assert at(picture, on).min() > at(picture, beside).min() + 40
    unbounded = rgb_array(scene(None, SPOTS, ALL))
    assert unbounded.shape == picture.shape and is_drawn(unbounded, SPOTS[BLACK], BLACK)
    assert at(unbounded, (0.889, 1.7845))[1] > 60  # no pocket


def test_scene_copies_and_wrong_sizes_are_refused():
    r = SPOTS.copy()
    s = scene("match", r, without(3), paths={CUE: r})
    r[:] = 0
    assert np.array_equal(s.positions, SPOTS[without(3)]) and np.array_equal(
        s.ids, ALL.nonzero()[0][without(3)]
    )
    assert np.array_equal(s.paths[CUE], SPOTS)
    for bad, field in [
        (lambda: scene("pool", SPOTS), "table"),
        (lambda: rgb_array(scene("match", SPOTS), size=(1920, 50)), "size"),
        (lambda: rgb_array(scene("match", SPOTS), size=1920), "size"),
    ]:
        with pytest.raises(ValueError, match=field):
            bad()


def test_text_shows_the_balls():
    picture = ansi(scene("match", SPOTS, ALL, text="break 12"))
    lines = picture.split("\n")
    table = lines[:27]
    assert {len(line) for line in table} == {100} and table[0].startswith("O═")
    assert table[0].count("O") == 4 == table[-1].count("O")
    assert lines[27] == "break 12" and "N=brown" in lines[28] and "\x1b" not in picture
    rows = {letter: [k for k, line in enumerate(table) if letter in line] for letter in "WYGNBPK"}
    assert all(len(found) == 1 for found in rows.values())
    assert rows["G"] < rows["N"] < rows["Y"] and rows["N"] == rows["B"] == rows["P"] == rows["K"] == [13]
    centre = table[13]
    assert centre.index("N") < centre.index("B") < centre.index("P") < centre.index("K")
    assert centre.index("K") == 1 + int((1.4605 + 1.7845) / 3.569 * 98)
    reds = "".join(table)
    assert reds.count("r") + sum(int(digit) for digit in re.findall(r"\d", reds)) == 15
    assert "═" not in ansi(scene(None, SPOTS, ALL))


def test_text_never_hides_the_cue_ball():
    for other in (1, YELLOW, BLACK):
        r = SPOTS.copy()
        r[other] = r[CUE] + (0.0, 1e-4)
        for order in (ALL, without(5)):
            lines = ansi(scene("match", r, order, paths={CUE: r[:2]})).split("\n")
            assert sum("W" in line for line in lines[:27]) == 1
            assert lines[-1] == f"hidden: {'r' if other == 1 else 'Y' if other == YELLOW else 'K'} under W"
    assert "W" not in "".join(ansi(scene("match", SPOTS, without(CUE))).split("\n")[:27])


def test_without_pygame_the_message_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "pygame", None)
    for draw in (rgb_array, Window().draw):
        with pytest.raises(ImportError, match=re.escape('pip install -c constraints.txt -e ".[render]"')):
            draw(scene("match", SPOTS))
    assert "W" in ansi(scene("match", SPOTS))


OTHERS = {name: sn.Table.preset(name) for name in ("uk8", "pool9", "carom")}
OTHERS["mine"] = sn.Table.rectangular(1.2, 1.5, pockets=4, ball_radius=0.03)
NOSES = np.array([(0, -1, 0.3, -9, 9), (0, 1, 1.0, -9, 9), (1, -1, 0.5, -9, 9), (1, 1, 2.0, -9, 9)])
OTHERS["aside"] = sn.Table("aside", NOSES, np.zeros((0, 6)), np.zeros((0, 3)), ball_radius=0.02)
"""Tables that are not snooker's; the last lies beside the origin."""


@pytest.mark.parametrize("name", OTHERS)
def test_a_picture_shows_the_table_and_the_balls_of_another_game(name):
    """Its cloth from nose to nose, its pockets black, no snooker lines, a ball in place and of its size."""
    table = OTHERS[name]
    size = size_of(table, 601)
    place = table.bounds @ (0.6, 0.4)
    empty = rgb_array(scene(table, [place], np.zeros(1, bool)), size=size)
    (low_x, high_x), (low_y, high_y) = table.bounds
    first, last = to_pixels([(low_x, low_y), (high_x, high_y)], table, size=size)
    scale = (last - first)[0] / (high_y - low_y)
    assert (last - first)[1] == pytest.approx(scale * (high_x - low_x))
    # rails and margin
    assert empty.shape[1] == pytest.approx((last - first)[0] + 2 * scale * (0.155 + 0.012), abs=2)
    assert empty.shape[0] * 14 / 15 == pytest.approx((last - first)[1] + 2 * scale * (0.155 + 0.012), abs=2)

    def pixel(point):
        column, row = np.floor(to_pixels(point, table, size=size)).astype(int)
        return empty[row, column].astype(int)

    for x, y, radius in table.falls:
        way = np.sign([x, y])
        assert pixel(np.array([x, y]) - 0.8 * radius * way / np.hypot(*way)).max() < 25
    for x in np.linspace(low_x + 0.03, high_x - 0.03, 7):
        for y in np.linspace(low_y + 0.2, high_y - 0.2, 19):
            # cloth everywhere, also where snooker's lines and spots would be
            red, green, blue = pixel((x, y))
            assert green > red + 40 and green > blue + 20 and red < 60
    drawn = rgb_array(scene(table, [place]), size=size).astype(int)
    rows, columns = np.nonzero(drawn.min(axis=2) > 90)
    centre, seen = to_pixels(place, table, size=size), np.stack([columns, rows], axis=1) + 0.5
    near = np.abs(seen - centre).max(axis=1) < 2 * 0.03 * scale
    assert seen[near].mean(axis=0) == pytest.approx(centre, abs=0.5)
    assert near.sum() == pytest.approx(np.pi * (table.ball_radius * scale) ** 2, rel=0.12)


TRIED = {"pool9": 50, "mine": 164, "carom": 4, "match": 194, "tight": 190}


@pytest.mark.parametrize("name", TRIED)
def test_outlines_are_what_the_balls_meet(name):
    """A ball touching a drawn nose or jaw from the table's side is free, one 0.1 mm nearer is refused."""
    table = OTHERS[name] if name in OTHERS else sn.Table.preset(name)
    parts, R = outline(table), table.ball_radius
    assert len(parts.cushions) == len(table.noses) and len(parts.throats) == len(table.falls)
    tried = 0
    for nose in parts.noses:
        steps = np.diff(nose, axis=0)
        long = np.hypot(*steps.T) > 1e-3
        middles, along = (nose[:-1] + nose[1:])[long] / 2, steps[long] / np.hypot(*steps[long].T)[:, None]
        for middle, (dx, dy) in zip(middles, along, strict=True):
            normal = np.array([-dy, dx]) if np.dot((-dy, dx), -middle) > 0 else np.array([dy, -dx])
            place = middle + R * normal
            over = np.hypot(*(table.falls[:, :2] - place).T) < table.falls[:, 2] + 1e-3
            if not over.any() and (np.abs(place) < table.bounds[:, 1]).all():  # the rest is behind the falls
                tried += 1
                table.check([middle + normal * (R + 5e-5)], R)
                with pytest.raises(ValueError, match=r"cushion|jaw"):
                    table.check([middle + normal * (R - 1e-4)], R)
    assert tried == TRIED[name]
