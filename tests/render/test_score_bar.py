"""Does the score bar say what it is given?"""

import numpy as np
import pytest

from snooker_env.render.palette import PALETTE
from snooker_env.render.pygame_view import score_bar
from snooker_env.render.scene import ScoreBar

pytest.importorskip("pygame")
FULL = {
    "break_points": 57,
    "points_on": 91,
    "ball_on": "any colour",
    "words": "red 7, one point",
}


def pixels(bar, text="", width=1920, height=72):
    import pygame

    return pygame.surfarray.array3d(score_bar(bar, text, width, height)).transpose(1, 0, 2).astype(int)


def test_the_chance_to_win_is_a_strip_of_two_colours():
    for chance in (0.0, 0.25, 1.0):
        strip = pixels(ScoreBar(("Ann", "Bob"), (0, 0), win_chance=chance))[:7]
        first = np.all(strip == PALETTE["first"], axis=2)
        assert first[:, : round(1920 * chance)].all() and not first[:, round(1920 * chance) + 1 :].any()
        assert np.all(strip[:, round(1920 * chance) + 1 :] == PALETTE["other"])
    plain, said = (pixels(ScoreBar(("Ann", "Bob"), (0, 0), **FULL, win_chance=c)) for c in (None, 0.5))
    assert np.array_equal(plain[7:], said[7:]) and not np.any(np.all(plain[:7] == PALETTE["first"], axis=2))


def test_each_part_is_shown_from_left_to_right():
    """What changes when one part changes begins where the part before it ends."""
    given = {"players": ("Ann", "Bob"), "scores": (41, 12), "striker": 0, **FULL}
    full, begins = pixels(ScoreBar(**given)), [0]
    for change in (
        {"players": ("Eve", "Bob")},
        {"scores": (42, 12)},
        {"scores": (41, 13)},
        {"break_points": 58},
        {"ball_on": "red"},
        {"points_on": 92},
        {"words": "red 7, two points"},
    ):
        changed = np.flatnonzero(np.any(full != pixels(ScoreBar(**given | change)), axis=(0, 2)))
        assert len(changed) and changed[0] > begins[-1], change
        begins.append(changed[0])
    turned = np.flatnonzero(np.any(full != pixels(ScoreBar(**given | {"striker": 1})), axis=(0, 2)))
    assert len(turned) and turned[0] < begins[2]  # the first name is bold no longer


@pytest.mark.parametrize("width", [1920, 640, 100])
def test_what_has_no_room_is_cut_and_the_edge_stays_free(width):
    long = pixels(ScoreBar(("Ann" * 40, "Bob"), (0, 0), **FULL), width=width, height=round(width * 0.0375))
    ground = np.all(long[3:, -2:] == PALETTE["bar"], axis=2)
    assert ground.all()
