"""Is the closest approach of the cue ball to a ball on exact?"""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game import attempt
from snooker_env.game.attempt import ATTEMPT_GAP
from snooker_env.game.balls import BLACK, CUE, N_BALLS, SPOTS, mask_of
from snooker_env.geometry import BALL_RADIUS as R
from snooker_env.physics import cloth
from tests.kernels import from_python

closest_approach = from_python(attempt.closest_approach)
nearest_on_piece = from_python(attempt.nearest_on_piece)


def test_one_ball_would_just_fit_into_the_gap_of_an_attempt():
    assert ATTEMPT_GAP == 2 * R


def test_one_piece_against_dense_sampling():
    rng = np.random.default_rng(3)
    for _ in range(300):
        d, v, a = rng.normal(0, 0.5, 2), rng.normal(0, 1, 2), rng.normal(0, 2, 2) * (rng.random() < 0.8)
        T = rng.uniform(0.01, 2)
        t = np.linspace(0, T, 20001)[:, None]
        sampled = np.hypot(*(d + v * t + 0.5 * a * t * t).T).min()
        got = nearest_on_piece(*d, *v, *a, T)
        assert got <= sampled + 1e-12 and got == pytest.approx(sampled, abs=1e-3)


def sampled_gap(segments, until, places):
    """The smallest gap from the cue ball's path, at 2,000 instants of each piece, to balls at ``places``."""
    own = segments[segments[:, cloth.SEGMENT_BALL] == CUE]
    ends = np.minimum(np.append(own[1:, cloth.T0], np.inf), np.minimum(own[:, cloth.T_END], until))
    best = np.inf
    for piece, end in zip(own, ends, strict=True):
        if end >= piece[cloth.T0]:
            t = np.linspace(0.0, end - piece[cloth.T0], 2000)[:, None]
            path = piece[[cloth.X, cloth.Y]] + piece[[cloth.VX, cloth.VY]] * t
            path = path + 0.5 * piece[[cloth.AX, cloth.AY]] * t * t
            best = min(best, np.hypot(*(path[:, None] - places).T).min())
    return best - 2 * R


def test_shots_off_cushions_against_dense_sampling():
    """Two reds that are on, and a black that may be struck first; side, top and several cushions."""
    rng, met = np.random.default_rng(4), {"black": 0, "none": 0, "near": 0}
    positions, on_table = SPOTS.copy(), np.zeros(N_BALLS, bool)
    positions[[CUE, 1, 2, BLACK]] = (0.1, -1.2), (0.5, 1.3), (-0.6, 0.9), (0.0, 0.5)
    on_table[[CUE, 1, 2, BLACK]] = True
    for _ in range(80):
        velocities, spins = np.zeros((N_BALLS, 2)), np.zeros((N_BALLS, 3))
        v, spins[CUE] = sn.strike(*rng.uniform((0.5, 0, -0.3, -0.3), (5, 2 * np.pi, 0.3, 0.3)))
        velocities[CUE] = v[:2]
        shot = sn.simulate(positions, velocities, spins, on_table=on_table)
        hits = shot.events[(shot.events["kind"] == 0) & (shot.events["i"] == CUE)]
        until = hits["time"][0] if len(hits) else shot.duration
        got = closest_approach(
            shot.segments, len(shot.segments), until, positions, on_table, mask_of([1, 2]), R
        )
        assert got == pytest.approx(sampled_gap(shot.segments, until, positions[[1, 2]]), abs=2e-4)
        if len(hits) and hits["j"][0] in (1, 2):
            assert abs(got) < 1e-9
        met["black"] += bool(len(hits)) and hits["j"][0] == BLACK
        met["none"] += not len(hits)
        met["near"] += 1e-6 < got <= ATTEMPT_GAP
    assert min(met.values()) >= 3


def test_nothing_moves_and_nothing_is_on():
    segments = np.zeros((1, cloth.SEGMENT))
    here = np.zeros(N_BALLS, bool)
    assert closest_approach(segments, 1, 1.0, np.zeros((N_BALLS, 2)), here, 0, R) == np.inf
    here[1] = True
    positions = np.zeros((N_BALLS, 2))
    positions[1] = 0.3, 0.4
    assert closest_approach(segments, 1, 1.0, positions, here, mask_of([1]), R) == pytest.approx(0.5 - 2 * R)
    assert CUE == 0
