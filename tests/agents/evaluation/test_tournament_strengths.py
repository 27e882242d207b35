"""Does the model of Bradley and Terry recover known strengths, and does it stay finite where wins alone do
not decide?"""

import numpy as np
import pytest

from agents.evaluation.tournament_figures import ELO, bound, chance, compared, linked, strengths


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


def test_no_other_strengths_are_likelier():
    rng = np.random.default_rng(1)
    wins = rng.integers(0, 9, (5, 5)) * (1 - np.eye(5))
    w = wins + 0.5 * ((wins + wins.T) > 0)

    def likelihood(t):
        return (w * np.log(chance(t[:, None] - t[None]))).sum()

    best = strengths(wins)
    assert all(likelihood(best + rng.normal(0, 0.01, 5)) < likelihood(best) for _ in range(50))


def test_many_tables_at_once_are_those_one_by_one_however_extreme():
    rng = np.random.default_rng(2)
    tables = np.stack([rng.binomial(100, p, (4, 4)) * (1.0 - np.eye(4)) for p in (0.0, 0.001, 0.5, 1.0)])
    tables[0, 0, 1:] = tables[0, 1, 2:] = tables[0, 2, 3:] = 100.0  # each beats all after him
    together = strengths(tables)
    assert np.isfinite(together).all() and (np.diff(together[0]) < 0).all()
    for k in range(4):
        assert together[k] == pytest.approx(strengths(tables[k]), abs=1e-8)


def test_who_can_be_compared_by_results_alone():
    """0 and 1 beat each other; 2 beats both and is never beaten; 3 loses to all; 4 plays nobody."""
    wins = np.zeros((5, 5))
    wins[0, 1] = wins[1, 0] = wins[2, 0] = wins[2, 1] = 3
    wins[[0, 1, 2], 3] = 3
    assert compared(wins, 0).tolist() == [True, True, False, False, False]
    assert compared(wins, 2).tolist() == [False, False, True, False, False]
    assert linked((wins + wins.T) > 0, 1).tolist() == [True, True, True, True, False]
    wins[3, 2] = 1  # now 2 has lost to 3, who lost to 0
    assert compared(wins, 0).tolist() == [True, True, True, True, False]


def test_the_bound_of_one_who_won_all():
    """Against one equal opponent, n matches: p^n = 5 %."""
    for n in (1, 10, 200):
        p = 0.05 ** (1 / n)
        assert bound([0.3], [n]) == pytest.approx(0.3 + np.log(p / (1 - p)), abs=1e-9)
    assert bound([0.0, 0.0], [5, 5]) == pytest.approx(bound([0.0], [10]))
    assert bound([0.0], [0]) == -np.inf
