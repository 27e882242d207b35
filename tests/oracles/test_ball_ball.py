"""Are the two oracles of a ball-ball impact right? Against each other, the paper's tables, closed forms,
symmetries and invariants."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest

from .ball_ball import ball_ball
from .motions import BALLS, NORTH, STILL, R, energy, heading, in_speeds, rolling, turned
from .paper_tables import PAPER_PARAMETERS, PAPER_ROWS, after_slip, incoming


def alciatore(s):
    """mu_bb of the slip speed, in the arithmetic of its argument."""
    return 9.951e-3 + 0.108 * (mpmath.exp(-1.088 * s) if isinstance(s, mpmath.mpf) else math.exp(-1.088 * s))


V, STRAIGHT = heading(2.0, 0.5), heading(2.0, 0.0)
BACK = np.array([0.0, -1.4, 0.0])
IMPACTS = {
    # name: v1, w1, v2, w2, e, mu_bb
    "roll": (V, rolling(V), STILL, STILL, 0.89, 0.05),
    "draw": (V, rolling(V, -1.0), STILL, STILL, 0.89, 0.05),
    "over-spun follow, side": (V, rolling(V, 1.6, 60.0), STILL, STILL, 0.94, alciatore),
    "both move": (V, rolling(V), np.array([0.4, -0.3, 0.0]), np.array([20.0, 5.0, -30.0]), 0.89, 0.05),
    "both roll head-on": (STRAIGHT, rolling(STRAIGHT), BACK, rolling(BACK), 0.94, 0.05),
    "cloth slip passes zero closely": (
        STRAIGHT,
        rolling(STRAIGHT),
        np.add(BACK, [1e-7, 0, 0]),
        rolling(BACK),
        0.94,
        0.05,
    ),
    "head-on": (STRAIGHT, rolling(STRAIGHT), STILL, STILL, 0.89, 0.05),
    "graze": (heading(2.0, 1.57), rolling(heading(2.0, 1.57)), STILL, STILL, 0.89, 0.05),
    "stun": (V, STILL, STILL, STILL, 0.89, alciatore),
    "nearly gearing": (V, np.array([1e-3, 0.0, V[0] / R * (1 + 1e-6)]), STILL, STILL, 0.89, 0.05),
    "e = 0": (V, rolling(V), STILL, STILL, 0.0, 0.05),
    "e = 1, mu 0.3": (V, rolling(V), STILL, STILL, 1.0, 0.3),
    "mu = 0": (V, rolling(V), STILL, STILL, 0.89, 0.0),
}


@pytest.mark.parametrize("name", IMPACTS)
def test_two_computations_of_the_ball_ball_impact_agree(name):
    v1, w1, v2, w2, e, mu_bb = IMPACTS[name]
    options = {**BALLS, "e": e, "mu_bb": mu_bb, "mu_s": 0.212}
    normal = turned(0.3, NORTH)[0]
    state = turned(0.3, v1, w1, v2, w2)
    fast = in_speeds(ball_ball(*state, normal, **options))
    slow = in_speeds(ball_ball(*state, normal, digits=20, **options))
    assert np.abs(fast - slow).max() <= 1e-12 * np.linalg.norm(v1)


@pytest.mark.parametrize("row", PAPER_ROWS, ids=lambda r: f"V0={r.v0}")
def test_the_papers_tables(row):
    v_c, v_o, angle_c, angle_o = after_slip(
        *ball_ball(*incoming(row), **PAPER_PARAMETERS), (1.0, 0.0), R=PAPER_PARAMETERS["R"]
    )
    assert abs(v_c - row.v_c) <= 1e-3 and abs(v_o - row.v_o) <= 1e-3
    assert abs(angle_c - row.angle_c) <= 0.02 and abs(angle_o - row.angle_o) <= 0.02


@pytest.mark.parametrize("e", [0.0, 0.5, 0.89, 1.0])
def test_without_friction_only_the_normal_velocities_change(e):
    v1, w1, v2, w2 = ball_ball(V, rolling(V), STILL, STILL, NORTH, **BALLS, e=e, mu_bb=0.0, mu_s=0.212)
    np.testing.assert_allclose(v1, [V[0], (1 - e) / 2 * V[1], 0.0], rtol=0, atol=1e-13)
    np.testing.assert_allclose(v2, [0.0, (1 + e) / 2 * V[1], 0.0], rtol=0, atol=1e-13)
    np.testing.assert_allclose(w1, rolling(V), rtol=0, atol=1e-11)
    assert not w2.any()


@pytest.mark.parametrize(("side", "mu"), [(0.0, 0.05), (0.0, 0.3), (0.9, 0.05), (-1.0, 0.2)])
def test_a_horizontal_slip_follows_the_closed_form_of_free_spheres(side, mu):
    w1 = np.array([0.0, 0.0, side * V[0] / R])
    slip = V[0] * (1 - side)
    pn = (1 + 0.89) / 2 * V[1]
    pt = min(mu * pn, slip / 7)
    v1, w1_after, v2, w2_after = ball_ball(V, w1, STILL, STILL, NORTH, **BALLS, e=0.89, mu_bb=mu, mu_s=0.212)
    np.testing.assert_allclose(v1, [V[0] - pt, V[1] - pn, 0.0], rtol=0, atol=1e-13)
    np.testing.assert_allclose(v2, [pt, pn, 0.0], rtol=0, atol=1e-13)
    np.testing.assert_allclose(R * w1_after, R * w1 + [0, 0, 2.5 * pt], rtol=0, atol=1e-13)
    np.testing.assert_allclose(R * w2_after, [0, 0, 2.5 * pt], rtol=0, atol=1e-13)


@pytest.mark.parametrize("share", [1.0, 0.2, -0.5])
def test_a_vertical_slip_without_cloth_friction_follows_the_closed_form(share):
    v = heading(2.0, 0.0)
    mu, e = 0.05, 0.89
    slip = -share * 2.0  # up, ball 1 relative to ball 2
    pn = (1 + e) / 2 * 2.0
    # the ball that is lifted moves, the other cannot: 6, not 7
    pt = -math.copysign(min(mu * pn, abs(slip) / 6), slip)
    v1, w1, v2, w2 = ball_ball(v, rolling(v, share), STILL, STILL, NORTH, **BALLS, e=e, mu_bb=mu, mu_s=0.0)
    np.testing.assert_allclose(v1, [0, 2.0 - pn, max(pt, 0.0)], rtol=0, atol=1e-13)
    np.testing.assert_allclose(v2, [0, pn, max(-pt, 0.0)], rtol=0, atol=1e-13)
    np.testing.assert_allclose(R * w1, [-share * 2.0 + 2.5 * pt, 0, 0], rtol=0, atol=1e-13)
    np.testing.assert_allclose(R * w2, [2.5 * pt, 0, 0], rtol=0, atol=1e-13)


def test_the_lifted_ball_keeps_its_vertical_velocity():
    v1, _, v2, _ = ball_ball(
        heading(2.0, 0.5),
        rolling(heading(2.0, 0.5)),
        STILL,
        STILL,
        NORTH,
        **BALLS,
        e=0.89,
        mu_bb=0.05,
        mu_s=0.21,
    )
    assert v2[2] == 0.0 and 0.02 * 2.0 < v1[2] < 0.05 * 2.0
    v1, _, v2, _ = ball_ball(
        heading(2.0, 0.5),
        rolling(heading(2.0, 0.5), -1),
        STILL,
        STILL,
        NORTH,
        **BALLS,
        e=0.89,
        mu_bb=0.05,
        mu_s=0.21,
    )
    assert v1[2] == 0.0 and 0.02 * 2.0 < v2[2] < 0.05 * 2.0


@pytest.mark.parametrize("seed", range(8))
def test_ball_ball_symmetries_and_invariants(seed):
    rng = np.random.default_rng(seed)
    v1, v2 = (np.append(rng.normal(size=2), 0.0) for _ in range(2))
    w1, w2 = rng.normal(size=(2, 3)) * 40
    normal = np.append(rng.normal(size=2), 0.0)
    normal *= math.copysign(1.0, (v1 - v2) @ normal) / np.linalg.norm(normal)
    options = {**BALLS, "e": 0.9, "mu_bb": alciatore, "mu_s": 0.212}
    out = ball_ball(v1, w1, v2, w2, normal, **options)
    assert energy(*out) < energy(v1, w1, v2, w2)
    swapped = ball_ball(v2, w2, v1, w1, -normal, **options)
    np.testing.assert_allclose(in_speeds(swapped), in_speeds((*out[2:], *out[:2])), rtol=0, atol=1e-12)
    mirror, spin_mirror = np.array([-1.0, 1.0, 1.0]), np.array([1.0, -1.0, -1.0])
    mirrored = ball_ball(
        mirror * v1, spin_mirror * w1, mirror * v2, spin_mirror * w2, mirror * normal, **options
    )
    back = [a * (spin_mirror if k % 2 else mirror) for k, a in enumerate(mirrored)]
    np.testing.assert_allclose(in_speeds(back), in_speeds(out), rtol=0, atol=1e-12)
    # The vertical spin is touched by the friction between the balls alone, which turns both balls alike.
    np.testing.assert_allclose(out[1][2] - w1[2], out[3][2] - w2[2], rtol=0, atol=1e-10)


def test_balls_that_do_not_approach_come_back_unchanged():
    state = (heading(1.0, 0.3), rolling(V), heading(2.0, 0.2), np.array([1.0, 2.0, 3.0]))
    for digits in (None, 25):
        out = ball_ball(*state, NORTH, **BALLS, e=0.9, mu_bb=0.05, mu_s=0.21, digits=digits)
        assert all(np.array_equal(a, b) for a, b in zip(out, state, strict=True))


def test_what_is_outside_the_model_is_refused():
    with pytest.raises(ValueError, match="5/7"):
        ball_ball(V, rolling(V), STILL, STILL, NORTH, **BALLS, e=0.9, mu_bb=0.9, mu_s=5.0)
    with pytest.raises(ValueError, match="vertical"):
        ball_ball(
            np.add(V, [0, 0, 0.1]), rolling(V), STILL, STILL, NORTH, **BALLS, e=0.9, mu_bb=0.05, mu_s=0.2
        )
