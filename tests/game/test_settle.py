"""Is the table in order after a stroke: balls gone, colours back, snookers seen, the verdict complete?"""

from dataclasses import replace

import numpy as np
import pytest

from snooker_env.game import layouts
from snooker_env.game.apply_ruling import settle_table
from snooker_env.game.balls import BLACK, BLUE, PINK, SPOTS, YELLOW, BallOn, mask_of
from snooker_env.game.referee import Situation, Stroke, judge
from snooker_env.game.ruling import Foul


def table(*balls, **places):
    """A table with those balls on it: at their spots, or where ``b<id>=`` says."""
    positions, on_table = SPOTS.copy(), np.zeros(22, dtype=bool)
    on_table[list(balls)] = True
    for name, place in places.items():
        positions[int(name[1:])], on_table[int(name[1:])] = place, True
    return positions, on_table


def settled(arrays, ball_on, free_ball=False, lead=0, **seen):
    positions, on_table = arrays
    mask = mask_of(np.flatnonzero(on_table))
    situation = Situation(on_table=mask, ball_on=ball_on, free_ball=free_ball, lead=lead)
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


def test_the_table_decides_what_is_snookered_and_must_be_the_situations():
    arrays = table(BLACK, b0=(0.0, -0.8), b1=(0.0, 0.8))
    assert not settled(arrays, BallOn.RED, snookered=True)[0].free_ball
    positions, on_table = table(PINK, BLACK, 0)
    with pytest.raises(ValueError, match="on_table"):
        settle_table(positions, on_table, Situation(), Stroke())


def test_it_is_the_referees_verdict():
    rng = np.random.default_rng(0)
    for _ in range(50):
        positions, on_table = layouts.layout("random:5", rng)
        situation = Situation(
            on_table=mask_of(np.flatnonzero(on_table)), ball_on=BallOn(int(rng.integers(0, 2)))
        )
        balls = [0, *range(1, 6), *range(YELLOW, 22)]
        first = 1 << int(rng.choice(balls[1:]))
        potted = mask_of(rng.choice(balls, int(rng.integers(0, 3)), replace=False))
        stroke = Stroke(first=first, potted=potted)
        verdict, _, left = settle_table(positions, on_table, situation, stroke)
        assert replace(verdict, free_ball=False) == replace(judge(situation, stroke), free_ball=False)
        assert mask_of(np.flatnonzero(left)) & ~1 == verdict.on_table
