"""Does the sentence about a run say what its figures show, and no more?"""

from agents.evaluation.training_summary import conclusion


def player(points, se, share: float | None = 0.9):
    """Figures of a player."""
    return {
        "pots_a_visit": points / 3,
        "points_a_visit": points,
        "points_a_visit_se": se,
        "visits": 100,
        "next_pot_after_a_pot": share,
    }


def said(trained, ghost, random, **more):
    """The conclusion from these figures."""
    return conclusion(
        "ppo_mask", 1000, 0, {"trained": trained, "ghost_ball": ghost, "random": random}, **more
    )


def test_the_conclusion_claims_only_what_the_figures_show():
    poor = player(0.5, 0.1)
    no_better = "is not shown by 100 visits to be better than random strokes: 0.33 pots"
    assert no_better in said(player(1.0, 0.3), player(0.9, 0.3), player(0.5, 0.3))
    worse = "plays worse than random strokes: 0.03 pots and 0.10 points a visit against 0.67 pots"
    assert worse in said(player(0.1, 0.1), player(0.9, 0.3), player(2.0, 0.1))
    assert "is not shown by 100 visits to be better than ghost_ball" in said(
        player(3.0, 0.3), player(2.9, 0.3), poor
    )
    assert "is not shown by 100 visits to be better than ghost_ball" in said(
        player(2.8, 0.3), player(2.9, 0.3), poor
    )
    assert "better than random strokes but worse than ghost_ball" in said(
        player(2.0, 0.1), player(9.0, 0.3), poor
    )
    assert "ppo_mask is better than ghost_ball" in said(player(9.0, 0.3), player(2.9, 0.3), poor)


def test_the_conclusion_gives_each_player_its_own_share_of_next_pots():
    """Whichever is greater; and none where there is none."""
    poor = player(0.5, 0.1)
    assert "follows in 60.0 % against 66.1 %." in said(player(9.0, 0.3, 0.6), player(2.9, 0.3, 0.661), poor)
    assert "follows in 89.8 % against 66.1 %." in said(player(9.0, 0.3, 0.898), player(2.9, 0.3, 0.661), poor)
    for shares in ((None, 0.6), (0.6, None)):
        sentence = said(player(9.0, 0.3, shares[0]), player(2.9, 0.3, shares[1]), poor)
        assert "ppo_mask is better than ghost_ball" in sentence and "%" not in sentence
