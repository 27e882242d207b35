"""Does the score bar say what it is given?"""

import numpy as np
import pytest

from snooker_env.game.balls import SPOTS
from snooker_env.render.palette import PALETTE
from snooker_env.render.pygame_balls import BOLD, MEDIUM, typeset
from snooker_env.render.pygame_view import rgb_array, score_bar
from snooker_env.render.scene import ScoreBar, scene

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


@pytest.mark.parametrize("file", [BOLD, MEDIUM])
def test_figures_are_as_wide_as_each_other(file):
    widths = {typeset(digit * 20, (255, 255, 255), 40, file).get_width() for digit in "0123456789"}
    assert len(widths) == 1
    narrow, wide = (typeset(text, (255, 255, 255), 40, file).get_width() for text in ("iii", "mmm"))
    assert narrow < wide / 2


def test_the_bar_is_under_the_table_and_changes_nothing_else():
    bare, said = (rgb_array(scene("match", SPOTS, bar=bar)) for bar in (None, ScoreBar(**FULL)))
    assert np.array_equal(bare[:1008], said[:1008]) and np.any(bare[1008:] != said[1008:])
    assert np.array_equal(said, rgb_array(scene("match", SPOTS, bar=ScoreBar(**FULL), text="not shown")))


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


def test_what_is_too_long_is_cut():
    names = "A very long name of a player of snooker", "Another name that is quite as long"
    others = {"ball_on": "a ball that is on for " * 5, "words": "words " * 50}
    given = {**FULL, "potted": (1, 21) * 15 + tuple(range(16, 22)), **others}
    players = {"players": names, "scores": (147, 1000), "striker": 1}
    middle = where(pixels(ScoreBar()), pixels(ScoreBar(**players)))
    sides = np.any(pixels(ScoreBar(**players)) != pixels(ScoreBar(**players, **given)), axis=(0, 2))
    assert 500 < middle[0] < 700 and 1220 < middle[1] < 1420 and sides.sum() > 500
    assert not sides[middle[0] - 10 : middle[1] + 10].any()


@pytest.mark.parametrize(
    "given", [{}, {"players": ("Ann",), "scores": (7,)}, {"players": ("Ann", "Bob"), "scores": (7, 0)}]
)
@pytest.mark.parametrize("width", [101, 400, 1000, 4000])
def test_a_bar_of_any_size_and_with_anything_left_out(given, width):
    for height in (7, 35, 36, 72, 200):
        assert pixels(ScoreBar(**given), width=width, height=height).shape == (height, width, 3)
        assert pixels(ScoreBar(**given, **FULL), width=width, height=height).shape == (height, width, 3)
