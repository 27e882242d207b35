"""Does the sentence about a run say what its figures show, and no more?"""

import pytest

from agents.evaluation.training_summary import conclusion


def player(points, se, share: float | None = 0.9):
    """Figures of a player."""
    means = {"pots_a_visit": points / 3, "points_a_visit": points, "points_a_visit_se": se}
    return means | {"visits": 100, "next_pot_after_a_pot": share}


POOR = player(0.5, 0.1)


def said(*players):
    """The conclusion from these figures of the trained agent, ghost_ball and random."""
    figures = dict(zip(("trained", "ghost_ball", "random"), (player(*one) for one in players), strict=True))
    return conclusion("ppo_mask", 1000, 0, figures)


POOR = (0.5, 0.1)
ALIKE = "is not shown by 100 visits to be better than"
WORSE = "0.03 pots and 0.10 points a visit against 0.67 pots"


@pytest.mark.parametrize(
    ("trained", "ghost", "random", "words"),
    [
        ((1.0, 0.3), (0.9, 0.3), (0.5, 0.3), f"{ALIKE} random strokes: 0.33 pots"),
        ((0.1, 0.1), (0.9, 0.3), (2.0, 0.1), f"plays worse than random strokes: {WORSE}"),
        ((3.0, 0.3), (2.9, 0.3), POOR, f"{ALIKE} ghost_ball"),
        ((2.8, 0.3), (2.9, 0.3), POOR, f"{ALIKE} ghost_ball"),
        ((2.0, 0.1), (9.0, 0.3), POOR, "better than random strokes but worse than ghost_ball"),
        ((9.0, 0.3), (2.9, 0.3), POOR, "ppo_mask is better than ghost_ball"),
        # each player's own share of next pots, whichever is greater
        ((9.0, 0.3, 0.6), (2.9, 0.3, 0.661), POOR, "follows in 60.0 % against 66.1 %."),
        ((9.0, 0.3, 0.898), (2.9, 0.3, 0.661), POOR, "follows in 89.8 % against 66.1 %."),
    ],
)
def test_the_conclusion_claims_only_what_the_figures_show(trained, ghost, random, words):
    assert words in said(trained, ghost, random)


@pytest.mark.parametrize("shares", [(None, 0.6), (0.6, None)])
def test_a_share_of_next_pots_that_is_not_known_is_not_given(shares):
    sentence = said((9.0, 0.3, shares[0]), (2.9, 0.3, shares[1]), POOR)
    assert "ppo_mask is better than ghost_ball" in sentence and "%" not in sentence
