"""Is the oracle of flying balls right? Against closed forms, and itself with half the step; its impacts against the others'."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from snooker_env.physics.table import Table

from . import flight_3d
from .ball_ball import ball_ball
from .flight_3d import SETTLE, simulate
from .moreau import moreau_tilted
from .motions import STILL, G, R, in_speeds, rolling

SIN = 0.4
COS = math.sqrt(1.0 - SIN * SIN)
H = R * SIN
WALL = 1.0  # [m] the level of ``ONE_NOSE``: its edge is at WALL - R + R COS
EDGE = WALL - R + R * COS
ONE_NOSE = SimpleNamespace(
    noses=np.array([[0.0, 1.0, WALL, -5.0, 5.0]]), jaws=np.zeros((0, 6)), falls=np.zeros((0, 3))
)
MATCH = {
    "R": R,
    "g": G,
    "mu_s": 0.21,
    "mu_r": 0.1,
    "spin_decel": 22.0,
    "e_b": 0.94,
    "mu_bb": "marlow",
    "e_t": 0.5,
}
MATCH |= {"e_c": 0.98, "e_c_knee": 2.02, "e_c_power": 0.243, "e_j": None, "mu_c": 0.14, "sin_theta": SIN}


def shot(positions, velocities, spins, table=None, dt=1e-4, **fields):
    """Final positions, fates, log, and (time, balls) after each contact, with the constants of "match"."""
    log, states, physics = [], [], SimpleNamespace(**{**MATCH, **fields})
    more = {"table": table, "dt": dt, "log": log, "watch": lambda *state: states.append(state)}
    end, fates = simulate(positions, velocities, spins, physics=physics, **more)
    return end, fates, log, states[1:]


def parts(ball):
    """Place, velocity and spin."""
    return (ball[list(columns)] for columns in ((0, 1, 7), (2, 3, 8), (4, 5, 6)))


@pytest.mark.parametrize("e_t", [0.3, 0.7])
@pytest.mark.parametrize("slide", [False, True])
def test_a_dropped_ball_bounces_as_known_and_grips_or_slides(slide, e_t):
    v, w = np.array([0.3, -0.5, 0.0]), np.array([40.0, 25.0, 60.0]) * (10.0 if slide else 0.5)
    _end, fates, log, states = shot([[0.0, 0.0, 0.3]], [v], [w], e_t=e_t)
    down, time = math.sqrt(2.0 * G * 0.3), math.sqrt(0.6 / G)
    slip = np.array([v[0] - R * w[1], v[1] + R * w[0]])
    size, most = np.linalg.norm(slip), 0.21 * (1.0 + e_t) * down
    assert (2.0 / 7.0 * size > most) == slide
    dv = -min(most, 2.0 / 7.0 * size) * slip / size
    _, after, spin = parts(states[0][1][0])
    np.testing.assert_allclose(after, [*(v[:2] + dv), e_t * down], rtol=0, atol=1e-11)
    np.testing.assert_allclose(spin, w + 2.5 / R * np.array([dv[1], -dv[0], 0.0]), rtol=0, atol=1e-8)
    for entry, (_, balls) in zip(log, states, strict=True):
        assert entry[1] == "land" and abs(entry[0] - time) < 1e-11
        up = e_t * down if e_t * down >= SETTLE else 0.0
        assert abs(balls[0, flight_3d.VZ] - up) < 1e-10 and balls[0, flight_3d.Z] == 0.0
        down, time = up, time + 2.0 * up / G
    assert down == 0.0 and fates == ["table"]


@pytest.mark.parametrize("above", [False, True])
def test_a_flying_ball_meets_the_edge_of_a_nose_as_a_free_sphere_a_fixed_body(above):
    v, w, z0 = np.array([1.5, 0.4, 0.2]), np.array([20.0, -60.0, 100.0]), R if above else 0.0
    _end, _fates, log, states = shot([[EDGE - 0.05, 0.0, z0]], [v], [w], ONE_NOSE)
    assert log[0][1] == "cushion"
    time, (ball,) = states[0]
    (x, _y, z), after, spin = parts(ball)
    there = [EDGE - 0.05 + 1.5 * time, z0 + 0.2 * time - 0.5 * G * time**2]
    np.testing.assert_allclose([x, z], there, rtol=0, atol=1e-12)
    assert (z > H) == above and abs(math.hypot(EDGE - x, H - z) - R) < 1e-12
    m, v = np.array([EDGE - x, 0.0, H - z]) / R, v - [0.0, 0.0, G * time]
    p = 1.98 * (v @ m)
    slip = v + R * np.cross(w, m)
    slip -= (slip @ m) * m
    push = -p * m - min(0.14 * p, 2.0 / 7.0 * np.linalg.norm(slip)) * slip / np.linalg.norm(slip)
    np.testing.assert_allclose(after, v + push, rtol=0, atol=1e-10)
    np.testing.assert_allclose(spin, w + 2.5 / R * np.cross(m, push), rtol=0, atol=1e-7)


@pytest.mark.parametrize("beta", [0.0, 0.1, 0.6, math.pi / 2])
def test_an_impact_from_above_is_known_without_friction_and_level(beta):
    n = np.array([0.6 * math.cos(beta), 0.8 * math.cos(beta), -math.sin(beta)])
    v1, w1, v2, w2 = (
        2.0 * n,
        np.array([-90.0, 30.0, 40.0]),
        np.array([0.2, -0.4, 0.0]),
        np.array([3.0, 9.0, -7.0]),
    )
    out = moreau_tilted(v1, w1, v2, w2, n, e=0.94, mu=(0.0, 0.0, 0.0), mu_s=0.0, R=R, steps=4000)
    p = 1.94 * ((v1 - v2) @ n) / (1.0 + math.cos(beta) ** 2)
    known = v1 - p * n, w1, v2 + p * n * (1.0, 1.0, 0.0), w2
    np.testing.assert_allclose(in_speeds(out[:4]), in_speeds(known), rtol=0, atol=1e-10)
    if beta == 0.0:  # its topspin presses the other ball
        for mu in ((0.06, 0.0, 0.0), flight_3d.MARLOW):
            law = lambda s, mu=mu: mu[0] + mu[1] * math.exp(-mu[2] * s)  # noqa: E731
            want = ball_ball(v1, w1, v2, w2, n, R=R, M=1.0, e=0.94, mu_bb=law, mu_s=0.21)
            *got, press = moreau_tilted(v1, w1, v2, w2, n, e=0.94, mu=mu, mu_s=0.21, R=R)
            np.testing.assert_allclose(in_speeds(got), in_speeds(want), rtol=0, atol=3e-9)
            assert abs(press - want[0][2]) < 3e-9 and press > 0.0


@pytest.mark.parametrize("seed", range(4))
def test_halving_the_step_changes_nothing(seed):
    """Three balls near the middle pocket, some in the air, with any spin."""
    rng, ends, logs = np.random.default_rng(seed), [], []
    places = np.array([[0.6, 0.25, 0.0], [0.72, 0.3, 0.0], [0.66, 0.36, 0.0]]) + 0.02 * rng.normal(
        size=(3, 3)
    )
    places[:, 2] = np.where(rng.random(3) < 0.5, 0.0, 0.06 * rng.random(3))
    v, w = rng.normal(size=(3, 3)) * [1.5, 1.0, 0.8], rng.normal(size=(3, 3)) * 60.0
    v[0] += 2.0 * (places[1] - places[0]) / 0.12
    v[:, 2] *= places[:, 2] > 0.0
    v[0, 2] -= 0.7
    for dt in (4e-4, 2e-4):
        end, fates, log, _ = shot(places, v, w, Table.preset("match"), dt)
        ends.append(end)
        logs.append([entry[1:] for entry in log] + fates)
    assert logs[0] == logs[1]
    np.testing.assert_allclose(ends[0], ends[1], rtol=0, atol=1e-6)


def test_a_ball_off_the_rail_bounces_there_or_is_off():
    still = [[0.0, 0.0, 0.0]]
    _, _, log, states = shot([[EDGE + 0.02, 0.0, 0.2]], [[-0.09, 0.0, 0.0]], still, ONE_NOSE)
    down = math.sqrt(2.0 * G * (0.2 - H - R))
    (_, _, z), (vx, _, up), _ = parts(states[0][1][0])
    np.testing.assert_allclose(
        [log[0][0], z, vx, up], [down / G, H + R, -0.45 / 7.0, 0.5 * down], rtol=0, atol=1e-10
    )
    assert log[0][1] == "rail" and "land" in {entry[1] for entry in log}
    end, fates, _, _ = shot([[0.5, 0.0]], [[4.0, 0.0, 2.0]], still, ONE_NOSE)
    assert fates == ["off"] and abs(end[0, 0] - EDGE - flight_3d.RAIL) < 1e-12


def test_a_rolling_ball_meets_one_at_rest_and_both_come_to_rest_as_known():
    """Without flight; a ball from any state stops at v T - mu_s g T^2 u / 2 + |v_r| v_r / (2 mu_r g)."""
    v = np.array([1.3, 0.9, 0.0])
    target = 0.4 * np.array([0.8, 0.6])
    end, _, log, states = shot([[0.0, 0.0], target], [v, STILL], [rolling(v), STILL], flight=False)
    assert [entry[1] for entry in log] == ["ball"]
    for ball, place in zip(states[0][1], end, strict=True):
        (x, y, _), v, w = parts(ball)
        slip = v[:2] + R * np.array([-w[1], w[0]])
        size = np.linalg.norm(slip)
        t, rolls = 2.0 * size / (7.0 * 0.21 * G), v[:2] - 2.0 / 7.0 * slip
        way = v[:2] * t - 0.5 * 0.21 * G * t * t * slip / size + rolls * np.linalg.norm(rolls) / (0.2 * G)
        np.testing.assert_allclose(place, [x + way[0], y + way[1], 0.0], rtol=0, atol=1e-7)
