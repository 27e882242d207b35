"""Is a picture drawn as it says?"""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game.balls import CUE, N_BALLS, SPOTS
from snooker_env.geometry import BALL_RADIUS
from snooker_env.render import pygame_balls
from snooker_env.render.outline import outline
from snooker_env.render.pygame_view import SIZE, View, rgb_array
from snooker_env.render.scene import rotate, scene
from tests.pictures import to_pixels

MATCH = sn.Table.preset("match")
NOBODY = np.zeros(N_BALLS, bool)


def only(*balls):
    here = NOBODY.copy()
    here[list(balls)] = True
    return here


def pixel(picture, point):
    column, row = np.floor(to_pixels(point)).astype(int)
    return picture[row, column].astype(float)


@pytest.fixture(scope="module")
def empty():
    return rgb_array(scene("match", SPOTS, NOBODY))


def test_a_picture_is_full_hd_with_the_table_above_the_bar(empty):
    assert SIZE == (1920, 1080) and empty.shape == (1080, 1920, 3)
    view = View.of(MATCH)
    (left, top), (right, bottom) = view(np.array([(-1.044, -1.9395), (1.044, 1.9395)]))
    assert 0 < top < 10 and view.height - view.bar - 10 < bottom < view.height - view.bar and 0 < left < 50
    assert right == 1920 - left
    assert 2 * BALL_RADIUS * view.scale > 25  # a ball, in pixels
    assert (view(np.array((0.3, -1.1))) - (view.x, view.y)) / view.scale == pytest.approx((-1.1, 0.3))


def test_pockets_have_leather_and_depth(empty):
    for x0, y0, x1, y1, half in outline(MATCH).throats:
        back = np.array([x1 - x0, y1 - y0]) / np.hypot(x1 - x0, y1 - y0)
        leather = pixel(empty, (x1, y1) + back * (half + 0.008))
        red, green, blue = leather
        assert 1.75 * green > red > green > blue and 50 < red < 190
        # the inside fades away
        assert pixel(empty, (x1, y1) + back * (half - 0.002)).sum() > pixel(empty, (x1, y1)).sum() + 10
        assert pixel(empty, (x1, y1)).max() < 15
        wood = pixel(empty, (x1, y1) + back * (half + 0.035)) if abs(y1) < 0.1 else pixel(empty, (0.99, 0.8))
        assert wood[0] > 1.8 * wood[1]


def test_cushions_are_drawn_to_their_true_ends(empty):
    """Along each nose and jaw of the outline: lighter 3 mm into the cushion than the shadow 3 mm outside."""
    for nose in outline(MATCH).noses:
        middle = (nose[:-1] + nose[1:]) / 2
        step = nose[1:] - nose[:-1]
        normal = np.stack([-step[:, 1], step[:, 0]], axis=1) / np.hypot(*step.T)[:, None]
        if normal[24] @ middle[24] < 0:
            normal = -normal  # into the cushion
        for k in (4, 12, 24, 36, 44):
            inside, outside = (pixel(empty, middle[k] + side * 0.003 * normal[k])[1] for side in (1, -1))
            assert inside > outside + 25, (k, middle[k])


def test_a_path_is_three_pixels_wide_with_a_dark_edge_at_every_angle():
    middle = np.array([0.1, 0.6])
    for angle in np.radians([0, 17, 45, 60, 90, 133]):
        along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
        ends = [middle - 0.3 * along, middle + 0.3 * along]
        picture = rgb_array(scene("match", SPOTS, NOBODY, paths={CUE: ends}))
        offsets = np.arange(-8, 8.01, 0.25) / 477.27
        points = middle + np.linspace(-0.05, 0.05, 41)[:, None, None] * along + offsets[:, None] * across
        profile = np.array([[pixel(picture, point)[0] for point in row] for row in points])
        profile = profile.mean(axis=0)  # red: the cloth has 36, the line 253, the edge 10
        assert profile.max() > 240
        width = (profile > 131).sum() * 0.25
        assert 3.0 <= width <= 4.0, (angle, width)
        middle_at = int(np.argmax(profile))
        assert min(profile[:middle_at]) < 27 > min(profile[middle_at:])


def test_a_path_that_grew_is_as_if_it_was_drawn_at_once():
    turn = np.linspace(0, 3, 300)
    points = np.stack([0.5 * np.sin(2 * turn), turn - 1.5 + 0.2 * np.sin(9 * turn)], axis=1)
    drawn = lambda points: rgb_array(scene("match", SPOTS, NOBODY, paths={CUE: points}))  # noqa: E731
    for length in range(2, 300, 7):
        grown = drawn(points[:length])
    pygame_balls._piece.cache_clear()
    assert np.array_equal(grown, drawn(points[:length]))
    assert np.array_equal(drawn(np.tile((0.1, 0.1), (5, 1))), rgb_array(scene("match", SPOTS, NOBODY)))


def test_spots_turn_with_the_ball():
    """A spot on top of a ball turned by 45 degrees about +y moves to +x, which is down in the picture."""
    place = np.array([0.3, 0.5])
    balls = np.tile(place, (N_BALLS, 1))
    for angle in (0.0, np.pi / 4):
        turn = rotate(np.array([0.0, angle, 0.0]))
        picture = rgb_array(scene("match", balls, only(CUE), turn=turn))
        column, row = to_pixels(place)
        rows, columns = np.nonzero((picture[..., 0] > 120) & (picture[..., 1] < 70))
        across, down = columns + 0.5 - column, rows + 0.5 - row
        near = (np.hypot(across, down) < 0.85 * 12.5) & (np.abs(across) < 4) & ((angle == 0) | (rows > row))
        assert down[near].mean() == pytest.approx(12.53 * np.sin(angle), abs=1.2), angle
    around = slice(int(row) - 13, int(row) + 13), slice(int(column) - 13, int(column) + 13)
    plain = rgb_array(scene("match", balls, only(CUE)))[around]
    assert not np.any((plain[..., 0] > 120) & (plain[..., 1] < 70))
