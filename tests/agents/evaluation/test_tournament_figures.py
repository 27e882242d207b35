"""Do the figures of a tournament follow from its frames as they say? Invented frames, and a plain bootstrap
beside."""

import numpy as np
import pytest

from agents.evaluation.tournament_figures import (
    ANCHOR_ELO,
    COLUMNS,
    COUNTED,
    ELO,
    KEYS,
    chance,
    figures_of,
    pairs_of,
    schedule,
    strengths,
)
from snooker_env.benchmark import unseen

SOUND = {
    "points": (60, 30),
    "scored": (50, 30),
    "visits": (10, 10),
    "strokes": (30, 20),
    "fouls": (0, 2),
    "best": (20, 12),
}


def row(first, second, seed, opener, winner, frame=0, **changes):
    """One frame; ``changes``: of what is counted."""
    counted = SOUND | changes
    return [first, second, seed, opener, frame, winner, *(x for name in COUNTED for x in counted[name])]


def invented(t, seeds, rng, best_of=1):
    """Rows of players with these strengths."""
    rows = []
    for a, b in schedule(t):
        for seed in range(seeds):
            for opener in (0, 1):
                for frame in range(best_of):
                    rows.append(row(a, b, seed, opener, int(rng.random() > chance(t[a] - t[b])), frame))
    return rows


def test_the_columns_are_those_of_both_players():
    assert len(COLUMNS) == len(KEYS) + 2 * len(COUNTED) == len(row(0, 1, 0, 0, 0)) and COLUMNS[6:8] == (
        "points_first",
        "points_second",
    )


def test_shares_and_draws():
    rows = [row(0, 1, 7, 0, 0), row(0, 1, 7, 1, 1), row(0, 1, 8, 0, -1), row(0, 1, 8, 1, 0)]
    found = figures_of(["a", "b"], rows, "b")
    a, b, pair = found["players"]["a"], found["players"]["b"], found["pairs"][0]
    assert (a["won"], a["drawn"], a["matches"], a["frames"]) == (2.5, 1, 4, 4) and b["won"] == 1.5
    assert a["win_rate"]["value"] == pair["win_rate"]["value"] == 0.625 and b["win_rate"]["value"] == 0.375
    assert [x["value"] for x in pair["when_opening"]] == [0.75, 0.5]  # a: won, drew; b: won, lost
    assert found["opener"]["value"] == (0.75 * 2 + 0.5 * 2) / 4 and found["stopped"] == 1
    assert b["elo"] == {"value": ANCHOR_ELO, "low": None, "high": None}
    assert a["elo"]["value"] == pytest.approx(ANCHOR_ELO + 400 * np.log10(3.0 / 2.0))


def test_points_breaks_fouls_and_strokes_are_each_players_own():
    rows = [
        row(0, 1, 0, 0, 0),
        row(0, 1, 0, 1, 0, scored=(10, 5), visits=(30, 10), best=(9, 40), fouls=(1, 0), points=(10, 25)),
    ]
    a, b = (figures_of(["a", "b"], rows, "a")["players"][label] for label in "ab")
    assert a["points_a_frame"]["value"] == 35.0 and b["points_a_frame"]["value"] == 27.5
    assert a["average_break"]["value"] == 60 / 40 and b["average_break"]["value"] == 35 / 20
    assert (a["highest_break"], b["highest_break"]) == (20, 40)
    assert (a["fouls_a_frame"]["value"], b["fouls_a_frame"]["value"]) == (0.5, 1.0)
    assert (a["strokes_a_frame"]["value"], b["strokes_a_frame"]["value"]) == (30.0, 20.0)


def test_a_match_is_one_unit():
    """The best of three: 2-0, and 1-1 with a frame that was stopped, which is a draw."""
    rows = [
        row(0, 1, 0, 0, 0),
        row(0, 1, 0, 0, 0, 1),
        row(0, 1, 0, 1, 0),
        row(0, 1, 0, 1, -1, 1),
        row(0, 1, 0, 1, 1, 2),
    ]
    a = figures_of(["a", "b"], rows, "a")["players"]["a"]
    assert (a["matches"], a["frames"], a["won"], a["drawn"]) == (2, 5, 1.5, 1)
    assert a["win_rate"]["value"] == 0.75 and a["frame_rate"]["value"] == pytest.approx(3.5 / 5)


def test_intervals_are_those_of_seeds_drawn_together():
    """Against a bootstrap that draws seeds one by one, both frames of a seed and all pairs together."""
    rng = np.random.default_rng(3)
    t, n = [0.8, 0.0, -0.5], 40
    rows = invented(t, n, rng)
    found = figures_of(["a", "b", "c"], rows, "b", resamples=2000)
    table, drawn = np.array(rows), []
    for _ in range(2000):
        seeds = np.bincount(rng.integers(n, size=n), minlength=n)
        wins, weight = np.zeros((3, 3)), seeds[table[:, 2]]
        np.add.at(wins, (table[:, 0], table[:, 1]), weight * (table[:, 5] == 0))
        np.add.at(wins, (table[:, 1], table[:, 0]), weight * (table[:, 5] == 1))
        s = strengths(wins)
        drawn.append([wins[0].sum() / (4 * n), ANCHOR_ELO + ELO * (s[0] - s[1])])
    low, high = np.quantile(drawn, [0.025, 0.975], axis=0)
    a = found["players"]["a"]
    assert a["win_rate"]["low"] == pytest.approx(low[0], abs=0.01) and a["win_rate"]["high"] == pytest.approx(
        high[0], abs=0.01
    )
    assert a["elo"]["low"] == pytest.approx(low[1], abs=8) and a["elo"]["high"] == pytest.approx(
        high[1], abs=8
    )


def test_intervals_of_elo_cover_the_truth():
    """Of 200 tournaments 95 % of the intervals hold the true difference, within what 200 can tell."""
    t, held = [0.6, 0.0, -0.4], 0
    for k in range(200):
        elo = figures_of(["a", "b", "c"], invented(t, 60, np.random.default_rng(k)), "b", resamples=200)[
            "players"
        ]["a"]["elo"]
        held += elo["low"] <= ANCHOR_ELO + ELO * 0.6 <= elo["high"]
    assert 178 <= held <= 199


def test_who_never_wins_has_bounds_and_no_interval():
    rows = [row(a, b, seed, opener, 0) for a, b in schedule("abc") for seed in range(30) for opener in (0, 1)]
    for one in rows:
        if one[:2] == [0, 1] and one[2] % 3 == 0:
            one[5] = 1  # a and b beat each other, c never wins
    found = figures_of(["a", "b", "c"], rows, "a")["players"]
    assert found["c"]["elo_by_prior"] and not found["b"]["elo_by_prior"]
    assert (
        found["c"]["elo"]["low"] is None
        and found["c"]["elo"]["value"] < found["c"]["elo"]["high"] < found["b"]["elo"]["value"]
    )
    assert found["c"]["win_rate"] == {"value": 0.0, "low": 0.0, "high": unseen(60)}
    assert found["a"]["elo"]["value"] == ANCHOR_ELO
    turned = [[*one[:5], 1 - one[5], *one[6:]] for one in rows]
    other = figures_of(["a", "b", "c"], turned, "a")["players"]["c"]["elo"]
    assert other["high"] is None and other["low"] == pytest.approx(2 * ANCHOR_ELO - found["c"]["elo"]["high"])


def test_a_slow_player_with_fewer_seeds_counts_each_opponent_alike():
    rows = [row(0, 1, seed, opener, 0) for seed in range(10) for opener in (0, 1)]
    rows += [row(0, 2, seed, opener, 1) for seed in range(2) for opener in (0, 1)]
    rows += [row(1, 2, seed, opener, opener) for seed in range(2) for opener in (0, 1)]
    found = figures_of(["a", "b", "slow"], rows, "a")["players"]
    assert found["a"]["win_rate"]["value"] == 0.5 and found["a"]["matches"] == 24
    assert found["b"]["win_rate"]["value"] == 0.25


def test_part_of_a_tournament_has_figures_too():
    """Pairs that were not played: who cannot be reached from the anchor has no Elo."""
    rows = [row(0, 1, seed, opener, opener) for seed in range(5) for opener in (0, 1)]
    found = figures_of(["a", "b", "c", "d"], rows, "a")
    assert found["players"]["c"] is None and len(found["pairs"]) == 1 == len(pairs_of(rows))
    found = figures_of(["a", "b", "c", "d"], rows + [[2, 3, *r[2:]] for r in rows], "a")
    assert found["players"]["c"]["elo"]["value"] is None and found["players"]["b"]["elo"][
        "value"
    ] == pytest.approx(ANCHOR_ELO)
