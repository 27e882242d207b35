"""Does the score bar say what it is given?"""

import numpy as np
import pytest

from snooker_env.render.palette import PALETTE
from snooker_env.render.pygame_view import score_bar
from snooker_env.render.scene import ScoreBar

pytest.importorskip("pygame")
FULL = {
    "break_points": 57,
    "potted": (1, 21, 2, 20),
    "reds_left": 8,
    "points_on": 91,
    "ball_on": "any colour",
    "words": "red 7, one point",
}


def pixels(bar, text="", width=1920, height=72):
    import pygame

    return pygame.surfarray.array3d(score_bar(bar, text, width, height)).transpose(1, 0, 2).astype(int)


def where(one, two):
    """Columns from the first to the last that differ."""
    columns = np.flatnonzero(np.any(one != two, axis=(0, 2)))
    return (int(columns[0]), int(columns[-1])) if len(columns) else None


def test_the_chance_to_win_is_a_strip_of_two_colours():
    for chance in (0.0, 0.25, 1.0):
        strip = pixels(ScoreBar(("Ann", "Bob"), (0, 0), win_chance=chance))[:7]
        first = np.all(strip == PALETTE["first"], axis=2)
        assert first[:, : round(1920 * chance)].all() and not first[:, round(1920 * chance) + 1 :].any()
        assert np.all(strip[:, round(1920 * chance) + 1 :] == PALETTE["other"])
    plain, said = (pixels(ScoreBar(("Ann", "Bob"), (0, 0), **FULL, win_chance=c)) for c in (None, 0.5))
    assert np.array_equal(plain[7:], said[7:]) and not np.any(np.all(plain[:7] == PALETTE["first"], axis=2))


def test_each_thing_has_its_place():
    """What changes when one thing changes lies where it belongs, and never over the rest."""
    given = {"players": ("Ann", "Bob"), "scores": (41, 12), "striker": 0, **FULL}
    full = pixels(ScoreBar(**given))
    for change, low, high in [
        ({"break_points": 58}, 20, 100),
        ({"potted": (1, 21, 2, 19)}, 100, 300),
        ({"words": "red 7, two points"}, 100, 700),
        ({"scores": (42, 12)}, 860, 960),
        ({"scores": (41, 13)}, 960, 1060),
        ({"players": ("Eve", "Bob")}, 600, 870),
        ({"striker": 1}, 600, 1300),
        ({"reds_left": 7}, 1600, 1890),
        ({"points_on": 90}, 1700, 1900),
    ]:
        left, right = where(full, pixels(ScoreBar(**{**given, **change})))
        assert low <= left <= right < high, change
    bars = full, pixels(ScoreBar(**{**given, "striker": 1}))
    accents = [np.flatnonzero(np.all(bar[37] == PALETTE["bar_accent"], axis=1)) for bar in bars]
    assert accents[0].max() < 960 < accents[1].min()  # the box of the score, and the triangle beside the name
    assert accents[0].min() < 780 and accents[1].max() > 1140
