"""Is every stroke of a visit kept and counted as it was, on the same tables for everyone?"""

import numpy as np
import pytest

from snooker_env.benchmark import HELD_OUT_SEED, play_visits
from snooker_env.benchmark.rollouts import FIGURES, PlayedStrokes, counts, summary
from snooker_env.benchmark.tasks import tables_of
from snooker_env.envs.vector import SnookerVectorEnv
from snooker_env.game.balls import BallOn
from snooker_env.game.layouts import HELD_OUT


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
    assert s.following.tolist() == [2, -1, 3, 4, -1]
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


def test_a_player_plays_alike_however_actions_are_read_and_whatever_is_seen():
    forms = {}, {"aim": "target", "observation": "balls"}, {"action": "discrete", "observation": "masked"}
    played = [play_visits("ghost_ball", 3, layout="colours", **form).points.tolist() for form in forms]
    assert played[0] == played[1] == played[2] and sum(played[0]) > 0


@pytest.mark.slow
def test_no_table_comes_twice_or_mirrored():
    seeds = tables_of("held_out", 100)
    assert seeds == tuple(sorted(set(seeds))) and seeds[0] == HELD_OUT_SEED
    tables = SnookerVectorEnv(100, layout="held_out")
    tables.reset(seed=seeds)
    reds = np.sort(np.abs(tables.tables.positions[:, 1:16, 0]), axis=1)
    apart = np.abs(reds[:, None] - reds[None]).max(axis=2) + np.eye(100)
    assert apart.min() > 1e-6
    with pytest.raises(ValueError, match=f"visits = {100 * HELD_OUT}: must be at most {HELD_OUT} "):
        tables_of("held_out", 100 * HELD_OUT)
