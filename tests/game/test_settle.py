"""Is the table in order after a stroke: balls gone, colours back, snookers seen, the verdict complete?"""

import numpy as np
import pytest

from snooker_env.game import layouts
from snooker_env.game.apply_ruling import settle_table
from snooker_env.game.balls import BLACK, BLUE, GREEN, PINK, SPOTS, YELLOW, BallOn, mask_of
from snooker_env.game.referee import Situation, Stroke, judge
from snooker_env.game.ruling import Foul, Outcome


def table(*balls, **places):
    """A table with those balls on it: at their spots, or where ``b<id>=`` says."""
    positions, on_table = SPOTS.copy(), np.zeros(22, dtype=bool)
    on_table[list(balls)] = True
    for name, place in places.items():
        positions[int(name[1:])], on_table[int(name[1:])] = place, True
    return positions, on_table


def settled(arrays, ball_on, free_ball=False, lead=0, **seen):
    positions, on_table = arrays
    situation = Situation(
        on_table=mask_of(np.flatnonzero(on_table)), ball_on=ball_on, free_ball=free_ball, lead=lead
    )
    return settle_table(positions, on_table, situation, Stroke(**seen))


def test_reds_go_colours_return_and_the_cue_ball_comes_to_hand():
    arrays = layouts.layout("break_off", np.random.default_rng(0))
    potted = mask_of([0, 3, BLUE])
    verdict, positions, on_table = settled(arrays, BallOn.RED, first=1 << 3, potted=potted)
    assert verdict.fouls == Foul.CUE_POTTED | Foul.WRONG_POT and verdict.penalty == 5 and verdict.in_hand
    assert np.flatnonzero(~on_table).tolist() == [0, 3]
    assert np.array_equal(positions[BLUE], SPOTS[BLUE])
    assert arrays[1].all()  # those given are untouched


def test_the_array_and_the_verdict_agree():
    verdict, _, on_table = settled(
        layouts.layout("break_off", np.random.default_rng(0)), BallOn.RED, first=2, potted=mask_of([1, 2])
    )
    assert mask_of(np.flatnonzero(on_table)) & ~1 == verdict.on_table


@pytest.mark.parametrize(("blocker", "free_ball"), [((0.0, 0.0), True), ((0.5, 0.0), False)])
def test_a_free_ball_after_a_foul_that_snookers(blocker, free_ball):
    arrays = table(BLACK, b0=(0.0, -0.8), b1=(0.0, 0.8), b19=blocker)
    assert settled(arrays, BallOn.RED)[0].free_ball == free_ball
    assert not settled(arrays, BallOn.RED, first=2)[0].free_ball


def test_the_snooker_is_seen_with_the_colours_back():
    # The black comes back between the cue ball and the red.
    arrays = table(BLACK, b0=(0.0, 1.2), b1=(0.0, 1.7))
    assert settled(arrays, BallOn.RED, first=2, potted=1 << BLACK)[0].free_ball
    arrays[0][BLACK] = (0.5, 0.5)
    assert not settled(arrays, BallOn.RED, first=1 << BLACK)[0].free_ball


def test_a_snooker_behind_the_free_ball():
    seen = {"nominated": GREEN, "first": 1 << GREEN}
    arrays = table(BLACK, b0=(0.0, -0.8), b1=(0.0, 0.8), b17=(0.0, 0.0))
    verdict = settled(arrays, BallOn.RED, free_ball=True, **seen)[0]
    assert verdict.fouls == Foul.BEHIND_FREE_BALL and verdict.penalty == 4 and verdict.free_ball
    arrays[0][[GREEN, BLACK]] = (0.5, 0.5), (0.0, 0.0)  # behind the black it is fair
    assert not settled(arrays, BallOn.RED, free_ball=True, **seen)[0].fouls


def test_with_pink_and_black_the_free_ball_may_snooker():
    arrays = table(b0=(0.0, -0.8), b20=(0.0, 0.8), b21=(0.0, 0.0))
    assert not settled(arrays, BallOn.PINK, free_ball=True, nominated=BLACK, first=1 << BLACK)[0].fouls


def test_a_free_ball_potted_and_back_on_its_spot_is_no_snooker_laid():
    arrays = table(YELLOW, BLACK, b0=(0.0, 1.2), b16=(0.0, 1.75))
    verdict = settled(
        arrays, BallOn.YELLOW, free_ball=True, nominated=BLACK, first=1 << BLACK, potted=1 << BLACK
    )[0]
    assert not verdict.fouls and verdict.points == 2 and verdict.stays


def test_a_respotted_black_stands_on_its_spot_and_the_cue_ball_is_in_hand():
    verdict, positions, on_table = settled(table(b0=(0.0, 1.4605), b21=(0.3, 0.3)), BallOn.BLACK, lead=7)
    assert verdict.outcome == Outcome.RESPOTTED_BLACK
    assert np.array_equal(positions[BLACK], SPOTS[BLACK])
    assert np.flatnonzero(on_table).tolist() == [BLACK]


def test_what_the_stroke_says_of_snookers_does_not_count():
    arrays = table(BLACK, b0=(0.0, -0.8), b1=(0.0, 0.8))
    assert not settled(arrays, BallOn.RED, snookered=True)[0].free_ball


def test_it_is_the_referees_verdict():
    rng = np.random.default_rng(0)
    for _ in range(50):
        positions, on_table = layouts.layout("random:5", rng)
        situation = Situation(
            on_table=mask_of(np.flatnonzero(on_table)), ball_on=BallOn(int(rng.integers(0, 2)))
        )
        balls = [0, *range(1, 6), *range(YELLOW, 22)]
        stroke = Stroke(
            first=1 << int(rng.choice(balls[1:])),
            potted=mask_of(rng.choice(balls, int(rng.integers(0, 3)), replace=False)),
        )
        verdict = settle_table(positions, on_table, situation, stroke)[0]
        alone = judge(situation, stroke)
        same = (
            "fouls",
            "penalty",
            "points",
            "respotted",
            "on_table",
            "ball_on",
            "stays",
            "in_hand",
            "visit_end",
            "outcome",
            "nominated",
        )
        assert [getattr(verdict, name) for name in same] == [getattr(alone, name) for name in same]


def test_array_and_situation_must_agree():
    positions, on_table = table(PINK, BLACK, 0)
    with pytest.raises(ValueError, match="on_table"):
        settle_table(positions, on_table, Situation(), Stroke())
