"""Do the features say what they claim, whatever the order of the reds and the side of the table?"""

from math import erf, exp, hypot, log, sqrt

import numpy as np
import pytest

from snooker_env.game import COLOUR_NAMES, VALUES
from snooker_env.geometry import SIDES
from snooker_env.planning import Position, Positions, pots
from snooker_env.planning.learned.value_features import (
    COLOUR_ENTRIES,
    LOGIT,
    POT_ENTRIES,
    POTS_SEEN,
    SIZE,
    value_features,
)
from snooker_env.tasks import LEVELS
from snooker_env.tasks.noise import Spread
from tests.positions import chances_by_width, tables

SPREAD = LEVELS["professional"].spread()
OF_ALL = POTS_SEEN * POT_ENTRIES + 6 * COLOUR_ENTRIES
"""The first entry of the whole position."""
LIKELIEST, BALL_ON, LEFT, SIDE, COUNT = OF_ALL + 10, OF_ALL + 14, OF_ALL + 22, OF_ALL + 25, OF_ALL + 26


def some(n, layout="random:5", seed=0):
    return Positions.of(tables(n, layout=layout, seed=seed))


def seen(*positions, spread=SPREAD):
    return value_features(Positions.of(list(positions)), spread)


def test_a_table_and_its_mirror_image_differ_by_the_side_alone():
    """Balls that are off the table do not matter, wherever their rows say that they are."""
    for layout in ("opened", "random:3", "colours", "line_up"):
        at = some(60, layout)
        turned = at.copy()
        turned.positions[..., 0] *= -1.0
        gone = ~turned.on_table
        turned.positions[gone] = np.random.default_rng(0).uniform(-0.8, 0.8, (gone.sum(), 2))
        one, other = value_features(at, SPREAD), value_features(turned, SPREAD)
        rest = np.arange(SIZE) != SIDE
        assert one[:, rest] == pytest.approx(other[:, rest], abs=2e-6)
        off = at.positions[:, 0, 0] != 0.0
        assert np.array_equal(one[off, SIDE], -other[off, SIDE])
        assert np.array_equal(one[off, SIDE], np.sign(at.positions[off, 0, 0]))


def test_the_order_of_the_reds_does_not_matter():
    at, rng = some(60, "random:9"), np.random.default_rng(3)
    other = at.copy()
    for k in range(60):
        order = 1 + rng.permutation(15)
        other.positions[k, 1:16], other.on_table[k, 1:16] = at.positions[k, order], at.on_table[k, order]
    assert value_features(at, SPREAD) == pytest.approx(value_features(other, SPREAD), abs=2e-6)
    other.positions[:, [17, 21]] = other.positions[:, [21, 17]]  # a green is no black
    assert (np.abs(value_features(at, SPREAD) - value_features(other, SPREAD)).max(axis=1) > 0.1).all()


@pytest.mark.parametrize(("ball_on", "spread"), [(0, SPREAD), (1, SPREAD), (1, Spread(3e-3, 0.1, 4.0))])
def test_the_pots_are_the_best_ones_recomputed(ball_on, spread):
    """Recomputed from ``planning.pots`` and the docstring's chance, by chance x (20 + value)."""
    at = some(60, "random:4", seed=5)
    at.game[:, 0] = ball_on
    rows, direct = value_features(at, spread), pots(at, most=40)
    chances = chances_by_width(at, spread)
    several = 0
    for k in range(60):
        best = []
        for j in np.flatnonzero(direct.ball[k] >= 0):
            ball, tolerance = int(direct.ball[k, j]), float(direct.tolerance[k, j])
            (gx, gy), (cx, cy), (x, y) = direct.ghost[k, j], at.positions[k, 0], at.positions[k, ball]
            away, middle = hypot(gx - cx, gy - cy), direct.pocket[k, j] in (2, 5)
            aim_point = 0.889 - (0.0016 if middle else 0.01524), 1.7845 - 0.01524
            px, py = np.multiply(SIDES[direct.pocket[k, j]], aim_point)
            run = hypot(px - x, py - y)
            core, lapse = (erf(tolerance / (times * spread.core * sqrt(2))) for times in (1.0, spread.factor))
            chance = (core + spread.lapse * (lapse - core)) * exp(-0.01 * (away + run))
            side = -1.0 if cx < 0 else 1.0
            odds = 0.25 * log((chance + 1e-3) / (1 - chance + 1e-3))
            entries = [1, chance, odds, VALUES[ball] / 7, np.cos(direct.cut[k, j]), away - 1, run - 1]
            entries += [2 + np.log10(tolerance + 1e-6), side * gx / 0.889, gy / 1.7845]
            entries += [side * x / 0.889, y / 1.7845, middle]
            best.append((chance * (20 + VALUES[ball]), chance, entries))
        best.sort(key=lambda one: -one[0])
        shown = rows[k, : POTS_SEEN * POT_ENTRIES].reshape(POTS_SEEN, POT_ENTRIES)
        expected = np.zeros((POTS_SEEN, POT_ENTRIES))
        for j, (_, _, entries) in enumerate(best[:POTS_SEEN]):
            expected[j] = entries
        assert shown == pytest.approx(expected, abs=2e-5)
        all_of = [one[1] for one in best] or [0.0]
        assert rows[k, COUNT] == pytest.approx(len(best) / 8)
        assert rows[k, OF_ALL + 7] == pytest.approx(0.25 * sum(all_of), rel=1e-5)
        assert rows[k, OF_ALL + 8] == sum(c > 0.9 for c in all_of) / 4
        assert rows[k, OF_ALL + 9] == sum(c > 0.6 for c in all_of) / 4
        assert rows[k, LIKELIEST] == pytest.approx(max(all_of), rel=1e-5)
        assert rows[k, LOGIT] == pytest.approx(log((max(all_of) + 1e-3) / (1 - max(all_of) + 1e-3)), abs=1e-4)
        several += len(best) > POTS_SEEN
    assert rows[:, LIKELIEST] == pytest.approx(chances.max(axis=1), rel=1e-5) and several > 5


def test_the_ball_on_is_one_of_eight():
    spots = [(0.3, -1.0), (-0.3, -1.0), (0.0, -1.0), (0.0, 0.0), (0.0, 0.9), (0.0, 1.4)]
    colours = dict(zip(COLOUR_NAMES, spots, strict=True))
    names = list(colours)
    at = {"cue": (0.5, 0.3)}
    places = [Position(**at, **colours, on="any_colour"), Position(**at, **colours, reds=[(0.4, 0.6)])]
    places += [Position(**at, **{name: colours[name] for name in names[k:]}) for k in range(6)]
    rows = seen(*places)
    assert np.array_equal(rows[:, BALL_ON : BALL_ON + 8], np.eye(8))
    # any colour after a red: a seventh black more; then what lies there, a black with each red
    assert (147 * rows[:, LEFT]).round(3).tolist() == [27 + 7, 27 + 8, 27, 25, 22, 18, 13, 7]
    assert value_features(some(1, "break_off"), SPREAD)[0, LEFT] == 1.0
    assert rows[:, OF_ALL + 23].tolist() == [1, 0, 1, 1, 1, 1, 1, 1]
    assert rows[:, OF_ALL + 24].tolist() == [0, 1, 0, 0, 0, 0, 0, 0]
