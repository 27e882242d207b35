"""Does the quick player play on as it says? Whole visits again, one position and one stroke at a time."""

import numpy as np
import pytest
from cases import ENDGAME, OPEN

from snooker_env.advice.practice import GOING_ON, practice_of
from snooker_env.advice.visits import BEST, EVEN_SAMPLES, PICKS, played_on
from snooker_env.planning import Planner, Positions, action_masks, prospects_of, spread_of
from snooker_env.tasks import LEVELS, STROKES
from snooker_env.tasks.noise import errors_of


def stroke(at, pick):
    """A choice as a stroke, to the last bit: rounding grows from stroke to stroke."""
    return Planner({"action": "discrete"}).strokes_of(at, [0], [pick])[0]


def by_plain_python(position, visit, visits, seed, noise):
    """Points of the rest of one visit, number ``visit`` of so many, and its strokes."""
    at, exact, noisy = Positions.of(position), Planner({}), Planner({"noise": noise})
    spread, total, strokes = spread_of(LEVELS[noise]), 0.0, 0

    def worth(outcome):
        points, goes_on, left, _ = outcome
        return points[0] + goes_on[0] * prospects_of(left, spread)[0][0]

    while True:
        chances, tried = prospects_of(at, spread)[1][0], []
        for pick in PICKS[action_masks(at)[0, PICKS]].tolist():
            look = worth(exact.play(at, [0], strokes=stroke(at, pick)))
            tried.append((-chances[pick // STROKES] * look, pick))
        best, chosen = -1.0, -1
        for _, pick in sorted(tried)[:BEST]:
            five = [noisy.play(at, [0], strokes=stroke(at, pick), keys=[key]) for key in EVEN_SAMPLES]
            mean = np.mean([worth(outcome) for outcome in five])
            if mean > best:
                best, chosen = mean, pick
        rng = np.random.default_rng((seed, GOING_ON, strokes))
        key = rng.integers(0, 2**64 - 1, visits, dtype=np.uint64)[visit]
        points, goes_on, at, _ = noisy.play(at, [0], strokes=stroke(at, chosen), keys=[key])
        total, strokes = total + points[0], strokes + 1
        if not goes_on[0]:
            return total, strokes


@pytest.mark.parametrize("noise", ["professional", "amateur"])
def test_visits_are_played_on_stroke_by_stroke(noise):
    positions = [OPEN, ENDGAME, OPEN, ENDGAME, OPEN]
    numbers = np.array([0, 0, 1, 3, 2])
    found = played_on(practice_of(noise), Positions.of(positions), numbers, 7)
    asked = zip(positions, numbers.tolist(), strict=True)
    own = [by_plain_python(position, visit, 4, 7, noise) for position, visit in asked]
    assert found.tolist() == [total for total, _ in own]
    assert max(strokes for _, strokes in own) > 2 and len(set(found.tolist())) > 2


def test_no_visits_bring_no_points():
    assert played_on(practice_of("club"), Positions.of(OPEN)[:0], np.empty(0, np.int64), 0).shape == (0,)


def test_the_noise_samples_are_even():
    """Each kind of error near five equally likely values, far nearer than any of 1,000 random sets."""
    sets = np.random.default_rng(0).integers(1, 5001, (1000, 5)).astype(np.uint64)

    def apart(keys):
        errors = np.sort(errors_of(np.stack([keys, np.zeros_like(keys)], axis=1)), axis=0)
        return np.abs(errors.T - [-1.2816, -0.5244, 0.0, 0.5244, 1.2816]).mean()

    assert apart(np.array(EVEN_SAMPLES, np.uint64)) < 0.5 * min(map(apart, sets))
