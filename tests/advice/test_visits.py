"""Does the fast player play on as it says? Whole visits again, one position and one stroke at a time."""

import numpy as np
import pytest
from cases import ENDGAME, OPEN

from snooker_env.advice.outcomes import play_on
from snooker_env.advice.practice import GOING_ON, QUICK, practice_of
from snooker_env.planning import Planner, Positions, Search, VisitJudge


def one_by_one(position, visit, visits, seed, noise):
    """Points of the rest of one visit, number ``visit`` of so many, and its strokes."""
    at, planner, total, strokes = Positions.of(position), Planner({"noise": noise}), 0.0, 0
    while True:
        (ranked,) = Search(VisitJudge({"noise": noise}), QUICK).rank(at, [visit])
        rng = np.random.default_rng((seed, GOING_ON, strokes))
        key = rng.integers(0, 2**64 - 1, visits, dtype=np.uint64)[visit]
        made = planner.play_strokes(at, [0], ranked.strokes.values[:1], [key])
        at, total, strokes = made.afterstates, total + made.points[0], strokes + 1
        if not made.goes_on[0]:
            return total, strokes


@pytest.mark.parametrize("noise", ["professional", "amateur"])
def test_visits_are_played_on_stroke_by_stroke(noise):
    positions = [OPEN, ENDGAME, OPEN, ENDGAME, OPEN]
    numbers = np.array([0, 0, 1, 3, 2])
    found = play_on(practice_of(noise), Positions.of(positions), numbers, 7)
    asked = zip(positions, numbers.tolist(), strict=True)
    own = [one_by_one(position, visit, 4, 7, noise) for position, visit in asked]
    assert found.tolist() == [total for total, _ in own]
    assert max(strokes for _, strokes in own) > 2 and found.max() > 5.0
