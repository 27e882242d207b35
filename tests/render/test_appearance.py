"""Is a picture drawn as it says?"""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game.balls import CUE, N_BALLS, SPOTS
from snooker_env.render.pygame_view import rgb_array
from snooker_env.render.scene import outline, scene
from tests.pictures import to_pixels

MATCH = sn.Table.preset("match")
NOBODY = np.zeros(N_BALLS, bool)


def pixel(picture, point):
    column, row = np.floor(to_pixels(point)).astype(int)
    return picture[row, column].astype(float)


@pytest.fixture(scope="module")
def empty():
    return rgb_array(scene("match", SPOTS, NOBODY))


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
