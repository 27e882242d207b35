"""Are the strokes proposed within their limits, aimed at real pots and shared among them by their chance?"""

from itertools import pairwise
from math import floor
from typing import NamedTuple

import numpy as np
import pytest

from snooker_env import planning
from snooker_env.geometry import POCKET_AIMS
from snooker_env.planning.aims import Dynamics
from snooker_env.planning.proposals import (
    AIM,
    ANYWHERE,
    FASTEST,
    HIGHEST,
    MOST_POTS,
    PLAIN,
    RIM,
    ROLLING,
    SIDE,
    SLOWEST,
    SPEED,
    TOP,
    WIDEST,
    at_balls,
    at_pots,
    over_cushions,
)
from snooker_env.tasks import LEVELS
from snooker_env.tasks.noise import Spread
from tests.positions import chances_by_width, tables

PLANNER = planning.Planner({"fidelity": "fast"}, threads=1)
DYNAMICS = Dynamics.of(PLANNER.rules)
SPREAD = LEVELS["club"].spread()
NO_POT = planning.Position(cue=(0.3, 1.0), reds=[(0.3, 1.758), (0.36, 1.758)], black=(0.0, -1.0))
"""Both reds lie on the top cushion and hide each other from the corners."""


class Hand(NamedTuple):
    """What generators ask of a search."""

    spread: Spread = SPREAD
    dynamics: Dynamics = DYNAMICS


def some(n=20, seed=4):
    return planning.Positions.of(tables(n, layout="random:4", seed=seed))


def seeds(n, first=100):
    return np.arange(first, first + n)


def solved(at, row, strokes, ball, pocket, ghost):
    """The aims of ``Planner.pot_aim`` for strokes (m, 5) at one pot."""
    m = len(strokes)
    target, ghosts = np.tile(POCKET_AIMS[pocket, :2], (m, 1)), np.tile(ghost, (m, 1))
    return PLANNER.pot_aim(at, np.full(m, row), np.full(m, ball), target, strokes, ghosts=ghosts)


def test_strokes_stay_within_their_limits_and_fill_them():
    at = some()
    strokes, chances = at_pots(Hand(), at, 512, seeds(20))
    assert strokes.shape == (20, 512, 5) and chances.shape == (20, 512) and np.isfinite(strokes).all()
    speed, side, top = (strokes[..., c] for c in (SPEED, SIDE, TOP))
    assert speed.min() >= SLOWEST and speed.max() <= FASTEST and speed.min() < 1.02 * SLOWEST
    assert speed.max() > 0.98 * FASTEST
    assert np.abs(side).max() <= WIDEST and np.abs(top).max() <= HIGHEST
    assert np.hypot(side, top).max() <= RIM + 1e-12
    assert np.abs(side).max() > 0.9 * WIDEST and np.abs(top).max() > 0.98 * HIGHEST
    assert (side == 0.0).mean(axis=1) == pytest.approx(np.full(20, PLAIN), abs=0.03)
    # as much to the left, as much below
    assert np.abs(side.mean(axis=1)).max() < 0.01 and np.abs(top.mean(axis=1)).max() < 0.01
    assert np.abs(np.log(speed).mean(axis=1) - 0.5 * np.log(SLOWEST * FASTEST)).max() < 0.02
    assert ((chances > 0.0) & (chances <= 1.0)).all()


def test_each_pot_gets_its_share_with_its_own_aims_and_its_chance():
    """Shares in plain Python, of near pots more (0.09 a metre beside the chance's 0.01); aims by ``Planner.pot_aim``."""
    at, m, several = some(), 150, 0
    direct, likely = planning.pots(at, most=MOST_POTS), chances_by_width(at, SPREAD, 0.1)
    chances = chances_by_width(at, SPREAD)
    proposed = at_pots(Hand(), at, m, seeds(20))
    for k in range(20):
        many = int((direct.ball[k] >= 0).sum())
        if many == 0:
            continue
        values = [1 if ball <= 15 else int(ball) - 14 for ball in direct.ball[k, :many]]
        weights = [likely[k, j] ** 4 * (values[j] + 25.0) + 1e-12 for j in range(many)]
        ends, first, counts = np.cumsum(weights) / sum(weights), 0, []
        for j in range(many):
            last = m if j == many - 1 else floor(m * ends[j] + 0.5)
            strokes = proposed.strokes[k, first:last]
            assert np.allclose(proposed.chances[k, first:last], chances[k, j], rtol=1e-9, atol=0)
            if last > first:
                expected = solved(at, k, strokes, direct.ball[k, j], direct.pocket[k, j], direct.ghost[k, j])
                assert np.array_equal(strokes[:, AIM], expected)
            counts.append(last - first)
            first = last
        reds = [j for j in range(many) if values[j] == values[0]]
        by_chance = sorted(reds, key=lambda j: likely[k, j])
        assert all(counts[a] <= counts[b] + 1 for a, b in pairwise(by_chance))
        several += sum(count > 0 for count in counts) > 1
    assert several >= 5


def test_a_chance_is_what_errors_leave_of_the_pot():
    """Strokes that score without errors, under a professional's: by the chance that they have."""
    n, m, errors = 40, 30, 12
    at = planning.Positions.of(tables(n, seed=9))
    tool = planning.VisitJudge({"noise": "professional", "fidelity": "fast"}, threads=1)
    strokes, chances = at_pots(tool, at, m, seeds(n))
    rows = np.repeat(np.arange(n), m * errors)
    drawn = np.random.default_rng(0).standard_normal((len(rows), 5))
    flat, chances = strokes.reshape(-1, 5), chances.ravel()
    play = tool.planner.play_strokes
    made = play(at, rows, np.repeat(flat, errors, 0), errors=drawn).points > 0
    made = made.reshape(-1, errors).mean(axis=1)
    scores = play(at, np.repeat(np.arange(n), m), flat, errors=np.zeros((n * m, 5))).points > 0
    firm = flat[:, 0] > 3.0
    for some, exact in (
        (scores & (chances > 0.9), 0.05),
        (scores & (chances < 0.9), 0.1),
        (scores & firm, 0.1),
    ):
        assert some.sum() > 30 and made[some].mean() == pytest.approx(chances[some].mean(), abs=exact)


HIDDEN = planning.Position(cue=(0.0, 0.0), reds=[(0.6, 0.0)], blue=(0.2, 0.0), on="red")
SEARCH = planning.VisitJudge({"fidelity": "fast", "noise": "club"}, threads=1)


def first_struck(at, strokes):
    """Ids of the balls that strokes (m, 5) at one position meet first."""
    return PLANNER.play_strokes(at, np.zeros(len(strokes), int), strokes).first


def test_where_there_is_no_pot_the_strokes_hit_the_balls_on_from_thin_to_full():
    at, m = planning.Positions.of(NO_POT), 200
    assert planning.pots(at).ball[0, 0] == -1 and not at_pots(SEARCH, at, m, [5]).chances.any()
    strokes, chances = (one[0] for one in at_balls(SEARCH, at, m, [5]))
    assert (chances == 1.0).all() and not over_cushions(SEARCH, at, m, [5]).chances.any()
    # a soft one with backspin does not arrive
    first, hard = first_struck(at, strokes), strokes[:, SPEED] > 2.0
    assert set(first[hard]) == {1, 2} and hard.sum() > 100
    x, y = at.positions[0, 1:3].T - at.positions[0, 0][:, None]
    # +-1 grazes that red
    off = (strokes[:, AIM, None] - np.arctan2(y, x)) / np.arcsin(2 * 0.02625 / np.hypot(x, y))
    for red in (0, 1):
        mine = off[first == red + 1, red]
        assert mine.min() < -0.8 or mine.max() > 0.8  # one side of each is behind the other
        assert len(mine) > 0.25 * m and (np.abs(mine) < 0.1).any()


def test_away_from_a_ball_on_that_touches_the_cue_ball():
    """It counts as struck: every direction away from it is fair, none into it."""
    at = planning.Positions.of(planning.Position(cue=(0.0, 0.0), reds=[(0.0525, 0.0)], black=(0.0, -1.0)))
    strokes = at_balls(SEARCH, at, 100, [3]).strokes[0]
    assert np.cos(strokes[:, AIM]).max() < 1e-6 and np.ptp(strokes[:, AIM]) > 3.0
    fouls = PLANNER.play_strokes(at, np.zeros(100, int), strokes)
    assert (fouls.penalty[(fouls.potted[:, [0, 21]] < 0).all(axis=1)] == 0).all()
    assert (fouls.penalty == 0).mean() > 0.7


def test_hidden_balls_are_reached_over_cushions():
    at = planning.Positions.of(HIDDEN)
    assert not at_balls(SEARCH, at, 64, [4]).chances.any()
    strokes, chances = (one[0] for one in over_cushions(SEARCH, at, 64, [4]))
    assert (chances == 1.0).all()
    aimed = np.arange(64) % ANYWHERE != ANYWHERE - 1
    fair = PLANNER.play_strokes(at, np.zeros(64, int), strokes).penalty == 0
    assert fair[:4].all() and fair[aimed].mean() > 0.7 and fair[~aimed].mean() < 0.5
    assert len(np.unique(strokes[:, AIM].round(1))) > 6 and (strokes[aimed, TOP] == ROLLING).all()


@pytest.mark.parametrize("generate", [at_pots, at_balls, over_cushions])
def test_a_position_is_proposed_for_by_itself(generate):
    """Its strokes depend on its own seed and layout alone, and nothing that is passed is changed."""
    at = planning.Positions.of(tables(30, layout="random:6" if generate is at_pots else "snookered", seed=6))
    kept, made = at.copy(), generate(SEARCH, at, 40, seeds(30))
    some = np.flatnonzero(made.chances.any(axis=1))
    assert len(some) > 1
    again = generate(SEARCH, at[some[::-1]], 40, seeds(30)[some[::-1]])
    assert all(np.array_equal(one, whole[some[::-1]]) for one, whole in zip(again, made, strict=True))
    other = generate(SEARCH, at, 40, seeds(30, first=500)).strokes
    assert all(not np.array_equal(other[k], made.strokes[k]) for k in some)
    names = "positions", "on_table", "game"
    assert all(np.array_equal(getattr(at, name), getattr(kept, name)) for name in names)
