"""Do the balls stop where destinations say?"""

import numpy as np
import pytest
from cases import ENDGAME, played

import snooker_env as sn
from snooker_env.advice import CueStroke, destinations


@pytest.fixture(scope="module")
def blue():
    return sn.advise(ENDGAME, n=1, samples=10, visits=0)[0]


def test_shares_are_those_of_the_environment(blue):
    many = 8000
    stops = destinations(ENDGAME, blue, noise="amateur", samples=many)
    points, fouls, after = played(ENDGAME, blue.stroke, many, noise="amateur")
    cue = np.array([s["positions"][0] for s in after if s["on_table"][0]])
    assert stops.scored == pytest.approx((points > 0).mean(), abs=0.05)
    assert stops.foul == pytest.approx(fouls.mean(), abs=0.03)
    assert stops.points == pytest.approx(points.mean(), abs=0.25)
    assert stops.samples == many
    assert 0.3 < stops.potted < 1.0 and stops.potted == pytest.approx(1.0 - len(stops.ball) / many)
    assert len(stops.cue) == round(many * (1.0 - stops.in_off))
    assert stops.cue.mean(axis=0) == pytest.approx(cue.mean(axis=0), abs=0.05)
    # lapses decide a standard deviation, and a few of them are no sample: half of the strokes, and nine in ten
    near, its_near = (np.abs(some - np.median(some, axis=0)) for some in (stops.cue, cue))
    for part, rel in ((0.5, 0.1), (0.9, 0.15)):
        assert np.quantile(near, part, axis=0) == pytest.approx(np.quantile(its_near, part, axis=0), rel=rel)
    missed = (points == 0) & ~fouls & [s["on_table"][0] for s in after]
    places = np.array([s["positions"][19] for s in after])[missed]
    assert stops.ball.mean(axis=0) == pytest.approx(places.mean(axis=0), abs=0.1)


def test_without_noise_it_is_the_one_shot(blue):
    stops = destinations(ENDGAME, blue, noise="none")
    _, _, (state,) = played(ENDGAME, blue.stroke, 1, noise="none")
    assert stops.samples == 1 and stops.potted == 1.0 and stops.ball.shape == (0, 2)
    assert np.allclose(stops.cue[0], state["positions"][0], atol=2e-3)


def test_seeds_and_common_errors(blue):
    first, again, other = (destinations(ENDGAME, blue, seed=seed) for seed in (1, 1, 2))
    assert np.array_equal(first.cue, again.cue) and not np.array_equal(first.cue, other.cue)
    # a hair's turn of the aim moves every sample a little: the same errors are met
    soft = CueStroke(speed=0.5, aim=0.2)
    turned = CueStroke(speed=0.5, aim=0.2 + 1e-6)
    empty = sn.Position(cue=(-0.6, 0.6), black=(0.6, -1.5))
    near = destinations(empty, soft).cue - destinations(empty, turned).cue
    assert 0.0 < np.abs(near).max() < 1e-4
