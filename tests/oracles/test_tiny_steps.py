"""Is the integrator of tiny steps right? Against rolls and one impact known exactly, and against itself with
half the step."""

from __future__ import annotations

import math

import numpy as np
import pytest

from .ball_ball import ball_ball
from .motions import BALLS, STILL, G, M, R, rolling
from .paper_tables import velocity_after_slip
from .tiny_steps import simulate

CLOTH = {"R": R, "M": M, "g": G, "mu_s": 0.212, "mu_r": 0.0127, "spin_decel": 22.0, "e": 0.89, "mu_bb": 0.05}


def rest_of(position, v, w):
    """Closed form: where one ball comes to rest from any horizontal motion (a parabola while it slides, then
    a straight line)."""
    slip = v[:2] + R * np.array([-w[1], w[0]])
    speed = np.linalg.norm(slip)
    t = 2 * speed / (7 * CLOTH["mu_s"] * G)
    decel = CLOTH["mu_s"] * G * slip / speed if speed > 0 else np.zeros(2)
    rolls = velocity_after_slip(v, w, R=R)
    return (
        np.asarray(position)
        + v[:2] * t
        - 0.5 * decel * t * t
        + rolls * np.linalg.norm(rolls) / (2 * CLOTH["mu_r"] * G)
    )


def test_a_centre_ball_hit_slides_and_rolls_as_known():
    t = 2 * 2.0 / (7 * 0.212 * G)
    assert abs(t - 0.275) < 5e-4 and abs(2 * t - 0.5 * 0.212 * G * t * t - 0.471) < 5e-4
    rest = simulate([[0.1, 0.2]], [[2.0, 0.0]], [[0.0, 0.0, 0.0]], **CLOTH)
    np.testing.assert_allclose(rest, [rest_of([0.1, 0.2], np.array([2.0, 0, 0]), STILL)], rtol=0, atol=1e-7)


@pytest.mark.parametrize("seed", range(4))
def test_one_ball_on_any_curve_comes_to_rest_as_known(seed):
    rng = np.random.default_rng(seed)
    v, w = np.append(rng.normal(size=2) * 2, 0.0), rng.normal(size=3) * 80
    np.testing.assert_allclose(
        simulate([[0, 0]], [v[:2]], [w], **CLOTH), [rest_of([0, 0], v, w)], rtol=0, atol=1e-7
    )


@pytest.mark.parametrize("offset", [0.0, 0.01, 0.03, 0.0524])
def test_a_rolling_ball_meets_one_at_rest_as_known(offset):
    speed, gap = 2.0, 0.4
    run = gap - math.sqrt((2 * R) ** 2 - offset**2)
    v = np.array([math.sqrt(speed**2 - 2 * CLOTH["mu_r"] * G * run), 0.0, 0.0])
    meet, target = np.array([run, 0.0]), np.array([gap, offset])
    normal = np.append(target - meet, 0.0) / (2 * R)
    v1, w1, v2, w2 = ball_ball(v, rolling(v), STILL, STILL, normal, **BALLS, e=0.89, mu_bb=0.05, mu_s=0.212)
    v1[2] = v2[2] = 0.0
    log: list = []
    rest = simulate([[0, 0], target], [[speed, 0], [0, 0]], [[0, speed / R, 0], [0, 0, 0]], **CLOTH, log=log)
    assert len(log) == 1
    np.testing.assert_allclose(rest, [rest_of(meet, v1, w1), rest_of(target, v2, w2)], rtol=0, atol=1e-6)


SHOTS = {
    # name: positions, first ball's velocity, its spin
    "thin, fast, 2 balls": ([[0, 0], [0.5, 0.05]], [6.0, 0.0], [0.0, 0.0, 90.0]),
    "draw into 3": ([[0, 0], [0.5, 0.01], [0.62, 0.05]], [4.0, 0.1], [0.0, -80.0, 10.0]),
    "follow, the cue ball comes again": ([[0, 0], [0.4, 0.0], [0.8, 0.002]], [2.5, 0.0], [3.0, 120.0, 0.0]),
    "4 balls": ([[0, 0], [0.5, 0.02], [0.58, 0.08], [0.62, -0.05]], [5.0, 0.0], [10.0, 190.0, -40.0]),
    "touching cluster": (
        [[0, 0], [0.3, 0.005], [0.3 + 2 * R, 0.005], [0.3 + R, 0.005 + R * math.sqrt(3)]],
        [3.0, 0.0],
        [0.0, 0.0, 0.0],
    ),
}


@pytest.mark.parametrize("name", SHOTS)
def test_halving_the_step_changes_nothing(name):
    positions, v, w = SHOTS[name]
    rest = np.zeros((len(positions) - 1, 2))
    spins = np.vstack([w, np.zeros((len(positions) - 1, 3))])
    results, counts = [], []
    for dt in (1e-4, 5e-5, 2.3e-5):
        log: list = []
        results.append(simulate(positions, np.vstack([v, rest]), spins, **CLOTH, dt=dt, log=log))
        counts.append(len(log))
    assert counts[0] == counts[1] == counts[2] >= 1
    assert max(np.abs(r - results[2]).max() for r in results[:2]) <= 1e-6


def test_a_shot_turned_is_the_turned_shot():
    positions, v, w = SHOTS["4 balls"]
    c, s = math.cos(0.7), math.sin(0.7)
    q = np.array([[c, -s], [s, c]])
    velocities, spins = np.zeros((4, 2)), np.zeros((4, 3))
    velocities[0], spins[0] = v, w
    plain = simulate(positions, velocities, spins, **CLOTH)
    spins_turned = spins.copy()
    spins_turned[:, :2] = spins[:, :2] @ q.T
    np.testing.assert_allclose(
        simulate(positions @ q.T, velocities @ q.T, spins_turned, **CLOTH), plain @ q.T, rtol=0, atol=1e-6
    )


def test_a_graze_within_one_step_is_not_missed():
    # how deep the balls would pass through each other; over in 0.46 mm of the way, a quarter of a step of 2
    # mm
    depth = 1e-6
    positions = [[0, 0], [0.5, 2 * R - depth]]
    log: list = []
    fine, coarse = (
        simulate(positions, [[4.0, 0], [0, 0]], [[0, 4.0 / R, 0], [0, 0, 0]], **CLOTH, dt=dt, log=log)
        for dt in (1e-5, 5e-4)
    )
    assert len(log) == 2
    np.testing.assert_allclose(coarse, fine, rtol=0, atol=1e-6)


def test_the_given_impact_is_used_and_vertical_velocities_are_dropped():
    spins_met = []

    def swap(v1, w1, v2, w2, normal):
        np.testing.assert_allclose(normal, [1.0, 0.0, 0.0], rtol=0, atol=1e-12)
        spins_met.append((w1[2], w2[2]))
        return np.add(v2, [0, 0, 7.0]), w1, np.add(v1, [0, 0, 7.0]), w2

    log: list = []
    rest = simulate(
        [[0, 0], [0.3, 0]],
        [[1.0, 0], [0, 0]],
        [[0, 1 / R, 30.0], [0, 0, -3.0]],
        **CLOTH,
        impact=swap,
        log=log,
    )
    decel, way = CLOTH["mu_r"] * G, 0.3 - 2 * R
    v = np.array([math.sqrt(1 - 2 * decel * way), 0.0, 0.0])
    # The first ball keeps its spin and not its speed, the second the other way round.
    np.testing.assert_allclose(
        rest, [rest_of([way, 0], STILL, rolling(v)), rest_of([0.3, 0], v, STILL)], rtol=0, atol=1e-7
    )
    (time, first, second), *more = log
    assert (first, second, more) == (0, 1, []) and abs(time - (1 - v[0]) / decel) <= 1e-10
    np.testing.assert_allclose(spins_met, [(30.0 - CLOTH["spin_decel"] * time, 0.0)], rtol=0, atol=1e-8)
