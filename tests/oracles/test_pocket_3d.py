"""Does the engine pot what the three-dimensional oracle of a pocket pots? Windows of both; the oracle against half the step."""

import math

import numpy as np
import pytest

import snooker_env as sn
from benchmarks.pockets.windows import CORNER, MIDDLE, Paths, alone, strokes, windows

from .pocket_3d import POTTED, UNDECIDED, G, R, at_rest, default_step, fates, pocket, stiff, trace

MATCH, PHYSICS = sn.Table.preset("match"), sn.Physics()
HALF = {MIDDLE: 0.055, CORNER: 0.04}
SPEEDS = (0.5, 1.0, 2.0, 4.0, 6.0)
PATHS = [(CORNER, 0), (CORNER, 20), (CORNER, 40), (MIDDLE, 0), (MIDDLE, 30), (MIDDLE, 45), (MIDDLE, 60)]


def starts(index, offsets, degrees, away, speed, rolling):
    """Positions, velocities and spins on parallel paths, ``offsets`` beside the one through the aim point."""
    angles = np.full(len(offsets), math.radians(degrees))
    return strokes(alone(MATCH, index), np.array(offsets), angles, away, speed, rolling, False, PHYSICS)


@pytest.mark.slow
@pytest.mark.parametrize(("index", "speed"), [(MIDDLE, 1.0), (CORNER, 4.0)])
def test_half_the_step_gives_the_same_path(index, speed):
    m = stiff(speed)
    jaws, fall, _ = pocket(MATCH, index)
    balls = starts(index, [-0.02, 0.01, 0.03], math.degrees(0.5), 0.12, speed, True)
    balls[2][:] *= np.array([[1.0], [0.0], [-1.0]])  # one slides, and one has screw
    ends = []
    for dt in (default_step(m), 0.5 * default_step(m)):
        states = at_rest(*balls, m, 2)
        for state in states:
            trace(state, jaws, fall, m, dt, round(0.15 / speed / dt))
        ends.append(states[:, :3])
    assert np.abs(ends[0] - ends[1]).max() <= 5e-4


@pytest.mark.parametrize("speed", [0.6, 1.0])
def test_a_ball_faster_than_the_root_of_g_r_flies_from_the_edge(speed):
    """From a circle so large that its edge is straight: x = 0, the slate at x < 0."""
    assert speed > math.sqrt(G * R)
    m, edge, no_jaws = stiff(1.0), np.array([1e3, 0.0, 1e3]), np.zeros((0, 7))
    (state,) = at_rest([[-1e-4, 0.0]], [[speed, 0.0]], [[0.0, speed / R, 0.0]], m, 0)
    steps = round(0.05 / default_step(m))
    trace(state, no_jaws, edge, m, default_step(m), steps)
    x = speed * steps * default_step(m) - 1e-4
    assert state[[0, 2]] == pytest.approx([x, R - 0.5 * G * (x / speed) ** 2], abs=3e-5)


def window(index, angle, speed, rolling, nearer=0.0, grid=1e-3, halvings=2):
    """Width [m] of the oracle's window: of all parallel paths, those whose ball is potted. On a grid, the ends between
    its points by halving."""

    def potted(offsets):
        start = starts(index, offsets, angle, 0.25, speed, rolling)
        room = np.ones(len(offsets), bool)
        room[MATCH.unfit(start[0][:, None], R)] = False
        found = fates(*(part[room] for part in start), MATCH, index, stiff(speed), nearer)
        assert not (found == UNDECIDED).any()
        out = np.zeros(len(offsets), bool)
        out[room] = found == POTTED
        return out

    offsets = np.linspace(-HALF[index], HALF[index], round(2 * HALF[index] / grid) + 1)
    inside = potted(offsets)
    ends = np.flatnonzero(inside[1:] != inside[:-1])
    low, high, first = offsets[ends], offsets[ends + 1], inside[ends]
    for _ in range(halvings):
        middle = 0.5 * (low + high)
        same = potted(middle) == first
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    share = np.where(first, 0.5 * (low + high) - offsets[ends], offsets[ends + 1] - 0.5 * (low + high))
    return grid * np.sum(inside[1:] & inside[:-1]) + share.sum()


TOLERANCE = 6e-3
"""Of the width of a window [m]. Measured: 5 mm for rolling balls at 4 m/s straight at a middle pocket, where
some that have struck a jaw bounce out of the hole off the slate's edge (the engine's edge has no friction);
at most 4 mm elsewhere."""


OFTEN = (CORNER, 20), (MIDDLE, 45)


@pytest.mark.parametrize(
    ("index", "angle"),
    [pytest.param(*path, marks=[] if path in OFTEN else pytest.mark.slow) for path in PATHS],
)
def test_the_engines_windows_are_those_of_the_oracle(index, angle):
    """Of rolling balls, and of one that slides; a window that is much wider at one speed is wider in both."""
    speeds, rolling = np.array([2.0, *SPEEDS]), np.array([False, *(True for _ in SPEEDS)])
    paths = Paths(math.radians(angle), 0.25, speeds, rolling, False)
    engine = windows(alone(MATCH, index), paths, PHYSICS).width
    oracle = np.array([window(index, angle, *ball) for ball in zip(speeds, rolling, strict=True)])
    np.testing.assert_allclose(engine, oracle, rtol=0, atol=TOLERANCE)
    wider = oracle[1:, None] - oracle[1:] > TOLERANCE
    assert (engine[1:, None] - engine[1:])[wider].min(initial=1.0) > 0.0


def test_a_middle_pocket_s_window_hangs_on_what_stands_behind_its_jaws():
    """As docs/physics/limits.md says: 12 mm between 10 mm nearer and 10 mm farther; most of it straight on."""
    wide = {
        angle: [window(MIDDLE, angle, 6.0, True, nearer) for nearer in (0.01, -0.01)] for angle in (0, 30, 45)
    }
    assert wide[0] == pytest.approx((0.0682, 0.0563), abs=3e-4)
    assert wide[30][0] - wide[30][1] == pytest.approx(0.0037, abs=3e-4)
    assert abs(wide[45][0] - wide[45][1]) < 1e-3
