"""Do a tournament's figures follow from its frames, beside a plain bootstrap, and are its strengths right?"""

import numpy as np
import pytest

from agents.evaluation import tournament_figures
from agents.evaluation.tournament_figures import (
    ANCHOR_ELO,
    COUNTED,
    ELO,
    bound,
    chance,
    figures_of,
    find_comparable,
    find_reachable,
    schedule,
    strengths,
)
from snooker_env.benchmark.statistics import bound_if_none

SOUND = {"points": (60, 30), "scored": (50, 30), "visits": (10, 10), "strokes": (30, 20)}
SOUND |= {"fouls": (0, 2), "best": (20, 12)}


def row(first, second, seed, opener, winner, frame=0, luck=0, **changes):
    """One frame; ``changes``: of what is counted."""
    counted = SOUND | changes
    return [first, second, seed, opener, frame, winner, *(x for name in COUNTED for x in counted[name]), luck]


def invented(t, seeds, rng):
    """Rows of players with these strengths."""
    frames = [(a, b, seed, opener) for a, b in schedule(t) for seed in range(seeds) for opener in (0, 1)]
    return [row(*frame, int(rng.random() > chance(t[frame[0]] - t[frame[1]]))) for frame in frames]


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
    other = {"scored": (10, 5), "visits": (30, 10), "best": (9, 40), "fouls": (1, 0), "points": (10, 25)}
    rows = [row(0, 1, 0, 0, 0), row(0, 1, 0, 1, 0, **other)]
    a, b = (figures_of(["a", "b"], rows, "a")["players"][label] for label in "ab")
    assert a["points_a_frame"]["value"] == 35.0 and b["points_a_frame"]["value"] == 27.5
    assert a["average_break"]["value"] == 60 / 40 and b["average_break"]["value"] == 35 / 20
    assert (a["highest_break"], b["highest_break"]) == (20, 40)
    assert (a["fouls_a_frame"]["value"], b["fouls_a_frame"]["value"]) == (0.5, 1.0)
    assert (a["strokes_a_frame"]["value"], b["strokes_a_frame"]["value"]) == (30.0, 20.0)


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
    bounds, a = np.quantile(drawn, [0.025, 0.975], axis=0).T, found["players"]["a"]
    for name, (low, high), near in zip(("win_rate", "elo"), bounds, (0.01, 8), strict=True):
        assert [a[name]["low"], a[name]["high"]] == pytest.approx([low, high], abs=near)


def test_who_never_wins_has_bounds_and_no_interval():
    rows = [row(a, b, seed, opener, 0) for a, b in schedule("abc") for seed in range(30) for opener in (0, 1)]
    for one in rows:
        if one[:2] == [0, 1] and one[2] % 3 == 0:
            one[5] = 1  # a and b beat each other, c never wins
    a, b, c = figures_of(["a", "b", "c"], rows, "a")["players"].values()
    assert c["elo_by_prior"] and not b["elo_by_prior"] and c["elo"]["low"] is None
    assert c["elo"]["value"] < c["elo"]["high"] < b["elo"]["value"]
    assert (
        c["win_rate"] == {"value": 0.0, "low": 0.0, "high": bound_if_none(60)}
        and a["elo"]["value"] == ANCHOR_ELO
    )
    turned = [[*one[:5], 1 - one[5], *one[6:]] for one in rows]
    other = figures_of(["a", "b", "c"], turned, "a")["players"]["c"]["elo"]
    assert other["high"] is None and other["low"] == pytest.approx(2 * ANCHOR_ELO - c["elo"]["high"])


def test_part_of_a_tournament_has_figures_too():
    """Pairs that were not played: who cannot be reached from the anchor has no Elo."""
    rows = [row(0, 1, seed, opener, opener) for seed in range(5) for opener in (0, 1)]
    found = figures_of(["a", "b", "c", "d"], rows, "a")
    assert found["players"]["c"] is None and len(found["pairs"]) == 1
    assert len(tournament_figures.pairs_of(rows)) == 1
    found = figures_of(["a", "b", "c", "d"], rows + [[2, 3, *r[2:]] for r in rows], "a")
    assert found["players"]["c"]["elo"]["value"] is None
    assert found["players"]["b"]["elo"]["value"] == pytest.approx(ANCHOR_ELO)


def expected(t, matches):
    """The wins that players of these strengths have on average."""
    t = np.asarray(t)
    return matches * chance(t[:, None] - t[None]) * (1 - np.eye(len(t)))


def test_the_expected_wins_give_the_strengths_back():
    rng = np.random.default_rng(0)
    for k in (2, 3, 8):
        t = rng.normal(0.0, 2.0, k)
        matches = rng.integers(1, 300, (k, k))
        found = strengths(expected(t, np.triu(matches, 1) + np.triu(matches, 1).T), prior=0.0)
        assert found == pytest.approx(t - t.mean(), abs=1e-8)


def test_two_players_have_the_closed_form():
    """Three wins for one loss: 400 log10(3) points of Elo; with the added draw (w + 1/2) / (l + 1/2)."""
    for wins, losses in ((75, 25), (300.5, 10)):
        a, b = strengths([[0, wins], [losses, 0]], prior=0.0)
        assert ELO * (a - b) == pytest.approx(400 * np.log10(wins / losses))
        a, b = strengths([[0, wins], [losses, 0]])
        assert ELO * (a - b) == pytest.approx(400 * np.log10((wins + 0.5) / (losses + 0.5)))
    a, b = strengths([[0, 100], [0, 0]])  # no loss at all
    assert ELO * (a - b) == pytest.approx(400 * np.log10(100.5 / 0.5))


def test_who_can_be_compared_by_results_alone():
    """0 and 1 beat each other; 2 beats both and is never beaten; 3 loses to all; 4 plays nobody."""
    wins = np.zeros((5, 5))
    wins[0, 1] = wins[1, 0] = wins[2, 0] = wins[2, 1] = 3
    wins[[0, 1, 2], 3] = 3
    assert find_comparable(wins, 0).tolist() == [True, True, False, False, False]
    assert find_comparable(wins, 2).tolist() == [False, False, True, False, False]
    assert find_reachable((wins + wins.T) > 0, 1).tolist() == [True, True, True, True, False]
    wins[3, 2] = 1  # now 2 has lost to 3, who lost to 0
    assert find_comparable(wins, 0).tolist() == [True, True, True, True, False]


def test_the_bound_of_one_who_won_all():
    """Against one equal opponent, n matches: p^n = 5 %."""
    for n in (1, 10, 200):
        p = 0.05 ** (1 / n)
        assert bound([0.3], [n]) == pytest.approx(0.3 + np.log(p / (1 - p)), abs=1e-9)
    assert bound([0.0, 0.0], [5, 5]) == pytest.approx(bound([0.0], [10]))
    assert bound([0.0], [0]) == -np.inf
