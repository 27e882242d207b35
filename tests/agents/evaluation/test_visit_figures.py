"""Is every stroke of a visit counted as it was?"""

import numpy as np
import pytest

from agents.evaluation.visit_figures import FIGURES, counts, find_next, summary
from snooker_env.benchmark import play_visits
from snooker_env.benchmark.playing import PlayedStrokes
from snooker_env.game.balls import BallOn


def strokes(**columns):
    """``PlayedStrokes`` of these columns, with nothing in the others."""
    n = len(columns["visit"])
    usual = {
        "cleared": np.zeros(n, bool),
        "cue": np.zeros((n, 2)),
        "tolerance": np.zeros(n),
        "luck": np.zeros(n),
    }
    arrays = {name: np.array(column) for name, column in columns.items()}
    return PlayedStrokes(visits=max(columns["visit"]) + 1, decision_seconds=0.0, **usual | arrays)


def test_counts_of_a_visit_by_hand():
    """Two visits: red, black, red with nothing after; then a miss."""
    s = strokes(
        visit=[0, 1, 0, 0, 0],
        number=[0, 0, 1, 2, 3],
        points=[1.0, 0, 7, 1, 0],
        foul=[False, False, False, False, True],
        ball_on=[BallOn.RED, BallOn.RED, BallOn.ANY_COLOUR, BallOn.RED, 0],
        tolerance=[1e-2, 0, 1e-3, 1e-2, 0],
    )
    assert find_next(s).tolist() == [2, -1, 3, 4, -1]
    first = {
        "points": 9,
        "adjusted": 9,
        "pots": 3,
        "strokes": 4,
        "fouls": 1,
        "goes_on": 3,
        "followed": 2,
        "easy": 2,
    }
    first |= {"colours": 1, "colour_points": 7, "high": 1, "reds": 2, "high_after_red": 1, "visits": 1}
    wanted = {name: [first.get(name, 0), int(name in ("strokes", "visits"))] for name in counts(s)}
    assert {name: values.tolist() for name, values in counts(s).items()} == wanted
    assert set(wanted) == {*first, "clearances", "centuries", "maximums"}
    means = {"points_a_visit": 4.5, "pots_a_visit": 1.5, "next_pot_after_a_pot": 2 / 3, "high_colours": 1.0}
    assert {name: summary(s)[name] for name in means} == pytest.approx(means)


def a_clearance_a_foul_and_a_miss():
    """The last ball goes in for a century (points as no shot brings them); it goes in by a foul; it stays."""
    return strokes(
        visit=[0, 1, 2, 0],
        number=[0, 0, 0, 1],
        points=[95.0, 0, 0, 7],
        foul=[False, True, False, False],
        ball_on=[BallOn.ANY_COLOUR, BallOn.BLACK, BallOn.BLACK, BallOn.BLACK],
        cleared=[False, True, False, True],
    )


def test_counts_agree_with_the_summary():
    s = play_visits("ghost_ball", 60, noise="professional")
    for strokes in (s, a_clearance_a_foul_and_a_miss()):
        c, f = counts(strokes), summary(strokes)
        for name in str.split(
            "points_a_visit pots_a_visit fouls_a_visit pot_rate next_pot_after_a_pot colour_value "
            "high_colours centuries clearances"
        ):
            above, below = FIGURES[name]
            assert c[above].sum() / c[below].sum() == pytest.approx(f[name])
    c, f = counts(s), summary(s)
    # a visit ends with its first miss
    assert f["next_pot_after_a_pot"] > 0.4 and np.all(c["strokes"] - c["pots"] == 1 - c["clearances"])
