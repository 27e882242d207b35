"""Are pots, clear paths and what is in the way those of the geometry, and a position worth what the docstrings say, recomputed?"""

from math import atan, exp, hypot, radians, sqrt

import numpy as np
import pytest
from scipy.stats import norm

from snooker_env.game.balls import BLACK, CUE, PINK, BallOn, mask_of
from snooker_env.game.pots import pots
from snooker_env.geometry import POCKET_AIMS
from snooker_env.physics.parameters import Physics
from snooker_env.planning import RULE_OF_THUMB, Position, Positions, clear_paths, prospects_of
from snooker_env.planning.pot_geometry import obstructions
from snooker_env.tasks.noise import Noise, Spread
from snooker_env.tasks.visit import BALL_ON
from tests import miss_paths as miss_rule
from tests.positions import tables

VALUE = {**dict.fromkeys(range(1, 16), 1), **{14 + k: k for k in range(2, 8)}}
"""Points of each ball."""


def by_plain_python(positions, on_table, ball_on, spread, follows, second, third, distant):
    """The value of a position and the chances of its pots, from the 16 widest pots of ``game.pots``."""
    present = [ball for ball in VALUE if on_table[ball]]
    balls = [ball for ball in present if (VALUE[ball] == 1) == (ball_on == BallOn.RED)]
    left = sum(8 if VALUE[ball] == 1 else VALUE[ball] for ball in present)
    left += 7 * (ball_on == BallOn.ANY_COLOUR)
    chances, worths = [], [0.0, 0.0, 0.0]
    for ball, pocket, gx, gy, _, tolerance in pots(positions, on_table, mask_of(balls))[:16]:
        (cx, cy), (bx, by), (px, py) = positions[CUE], positions[int(ball)], POCKET_AIMS[int(pocket), :2]
        run = hypot(gx - cx, gy - cy) + hypot(px - bx, py - by)
        both = (1.0 - spread.lapse, spread.core), (spread.lapse, spread.factor * spread.core)
        within = sum(share * (1.0 - 2.0 * norm.cdf(-tolerance, scale=wide)) for share, wide in both)
        chances.append(within * exp(-0.01 * run))
        more = follows * (1 - exp(-max(0, left - VALUE[int(ball)]) / follows))
        worths.append(chances[-1] * (VALUE[int(ball)] + more) * exp(-distant * run))
    best = sorted(worths, reverse=True)
    return best[0] + second * best[1] + third * best[2], chances


@pytest.mark.parametrize("ball_on", [BallOn.RED, BallOn.ANY_COLOUR])
@pytest.mark.parametrize("constants", [RULE_OF_THUMB, (8.0, 0.4, 0.3, 0.5)])
def test_prospects_recomputed(ball_on, constants):
    env = tables(30, layout="random:3", seed=2)
    at = Positions.of(env)
    at.game[:, BALL_ON] = int(ball_on)
    for spread in (Spread(5e-4), Spread(6e-3), Spread(5e-4, 0.1, 4.0)):
        values, chances = prospects_of(at, spread, constants, most=6)
        for k in range(30):
            value, all_of = by_plain_python(at.positions[k], at.on_table[k], ball_on, spread, *constants)
            assert values[k] == pytest.approx(value, rel=1e-9)
            assert chances[k] == pytest.approx(([*all_of, *[0.0] * 6])[:6], rel=1e-9)
    assert (chances[:, 2] > 0).sum() > 20  # there are third pots to count


def test_what_is_left_of_a_last_black():
    """Nothing follows: the pots are worth their chance times 7, here as much from far."""
    at = Positions.of(tables(1))
    at.on_table[0, 1:] = False
    at.on_table[0, BLACK] = True
    at.positions[0, CUE], at.positions[0, BLACK] = (0.0, 0.8), (0.4, 1.3)
    at.game[0, BALL_ON] = int(BallOn.BLACK)
    (value,), (chances,) = prospects_of(at, Spread(2e-3), near := (25.0, 0.15, 0.05, 0.0))
    best = 7.0 * np.sort(chances)[::-1]
    assert value == pytest.approx(best[0] + 0.15 * best[1] + 0.05 * best[2]) and value > 1.0
    at.on_table[0, PINK] = True  # but is not on: it follows
    at.positions[0, PINK] = (-0.6, -1.0)
    assert prospects_of(at, Spread(2e-3), near)[0][0] == pytest.approx(
        value * (7 + 25 * (1 - exp(-6 / 25))) / 7
    )


@pytest.mark.parametrize("level", ["professional", "olympiad"])
def test_spread_is_that_of_the_aim_and_of_the_squirt(level):
    """Squirt [Alciatore, TP A.31] of a tip that is off by one standard deviation."""
    noise, physics = Noise.of(level), Physics.of("paper")
    b = 1e-3 * noise.offset_mm / physics.R
    squirt = atan(2.5 * b * sqrt(1 - b * b) / (1 + physics.end_mass_ratio + 2.5 * (1 - b * b)))
    spread = hypot(radians(noise.aim_deg), squirt) * hypot(1.0, noise.growth * 1.5)
    assert noise.spread(physics) == pytest.approx((spread, noise.lapse, noise.lapse_factor), rel=1e-3)
    assert Noise().spread(physics) == (1e-5, 0.0, 1.0)


def test_what_is_in_the_way_is_nearer_than_two_radii_to_the_path():
    at, rng = Positions.of(tables(10)), np.random.default_rng(0)
    rows, starts, ends = rng.integers(0, 10, 200), *(rng.uniform(-1.0, 1.0, (2, 200, 2)) * (0.85, 1.7))
    none, ignore = np.zeros((200, 0), int), np.stack([np.zeros(200, int), np.full(200, 5)], 1)
    direct, some = obstructions(at, rows, starts, ends, none), np.linspace(0.0, 1.0, 2001)[:, None]
    for i in range(200):
        path = starts[i] + some * (ends[i] - starts[i])
        nearest = np.hypot(*(at.positions[rows[i]][:, None] - path).transpose(2, 0, 1)).min(axis=1)
        sure = np.abs(nearest - 0.0525) > 1e-5
        assert np.array_equal(direct[i, sure], (nearest < 0.0525)[sure] & at.on_table[rows[i], sure])
    assert 0.02 < direct.mean() < 0.5
    ignored = obstructions(at, rows, starts, ends, ignore)
    assert not ignored[:, [0, 5]].any()
    assert np.array_equal(np.delete(ignored, [0, 5], 1), np.delete(direct, [0, 5], 1))


def test_clear_paths_are_those_of_the_miss_rule():
    at = Positions.of(tables(40, layout="snookered"))
    clear = clear_paths(at)
    for k in range(40):
        on = mask_of(np.flatnonzero(at.balls_on[k]).tolist())
        assert clear[k] == miss_rule.paths(at.positions[k], at.on_table[k], on)[0]
    assert not clear.all() and clear.any()
    assert clear_paths(Positions.of(tables(5))).all()
    assert clear_paths(Position(black=(0.0, 1.4605), over=True)).tolist() == [False]
