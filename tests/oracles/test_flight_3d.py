"""Is the oracle of flying balls right? Against closed forms, other oracles' impacts, symmetry, and itself with half
the step."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from snooker_env.physics.table import Table

from . import flight_3d, tiny_steps
from .ball_ball import ball_ball
from .ball_cushion import ball_cushion
from .flight_3d import RAIL, SETTLE, simulate, tilted
from .moreau import _finish, _row
from .motions import STILL, G, R, energy, in_speeds, rolling

SIN = 0.4
COS = math.sqrt(1.0 - SIN * SIN)
H = R * SIN
WALL = 1.0  # [m] the level of ``ONE_NOSE``: its edge is at WALL - R + R COS
EDGE = WALL - R + R * COS
ONE_NOSE = SimpleNamespace(
    noses=np.array([[0.0, 1.0, WALL, -5.0, 5.0]]), jaws=np.zeros((0, 6)), falls=np.zeros((0, 3))
)


def constants(**fields):
    """The constants of the package's preset "match", with changes; rolling balls stop sooner."""
    match = {"R": R, "g": G, "mu_s": 0.21, "mu_r": 0.1, "spin_decel": 22.0, "e_b": 0.94, "mu_bb": "marlow"}
    cushion = {"e_c": 0.98, "e_c_knee": 2.02, "e_c_power": 0.243, "e_j": None, "mu_c": 0.14, "sin_theta": SIN}
    return SimpleNamespace(**{**match, **cushion, "e_t": 0.5, **fields})


def shot(positions, velocities, spins=None, table=None, **fields):
    """Final positions, fates, log, and the states after each contact, in this order."""
    log, states = [], []
    spins = np.zeros((len(positions), 3)) if spins is None else spins
    step = {"dt": fields.pop("dt", 1e-4)}
    end, fates = simulate(
        positions,
        velocities,
        spins,
        physics=constants(**fields),
        table=table,
        log=log,
        watch=lambda time, balls: states.append((time, balls)),
        **step,
    )
    return end, fates, log, states


def velocity(ball):
    return ball[[flight_3d.VX, flight_3d.VY, flight_3d.VZ]]


def spin(ball):
    return ball[[flight_3d.WX, flight_3d.WY, flight_3d.WZ]]


def place(ball):
    return ball[[flight_3d.X, flight_3d.Y, flight_3d.Z]]


def kinds(log):
    return [entry[1] for entry in log]


# ---------------------------------------------------------------- air and bed


@pytest.mark.parametrize("e_t", [0.3, 0.5, 0.7])
def test_a_dropped_ball_bounces_at_the_known_times_to_the_known_heights(e_t):
    height = 0.3
    _end, fates, log, states = shot([[0.0, 0.0, height]], [[0.4, 0.0, 0.0]], e_t=e_t)
    down, time = math.sqrt(2.0 * G * height), math.sqrt(2.0 * height / G)
    for entry, (_, balls) in zip(log, states[1:], strict=True):
        assert entry[1] == "land" and abs(entry[0] - time) < 1e-11
        up = e_t * down if e_t * down >= SETTLE else 0.0
        assert abs(balls[0, flight_3d.VZ] - up) < 1e-10 and balls[0, flight_3d.Z] == 0.0
        down, time = up, time + 2.0 * up / G
    assert down == 0.0 and fates == ["table"] and len(log) >= 4


@pytest.mark.parametrize("slide", [False, True])
def test_a_bounce_grips_or_slides_and_the_spin_was_kept_in_the_air(slide):
    v, w = np.array([0.3, -0.5, 0.0]), np.array([40.0, 25.0, 60.0]) * (10.0 if slide else 0.5)
    (_, _), (_, after) = shot([[0.0, 0.0, 0.1]], [v], [w])[3][:2]
    down = math.sqrt(2.0 * G * 0.1)
    slip = np.array([v[0] - R * w[1], v[1] + R * w[0]])
    size = np.linalg.norm(slip)
    most = 0.21 * 1.5 * down
    assert (2.0 / 7.0 * size > most) == slide
    dv = -min(most, 2.0 / 7.0 * size) * slip / size
    np.testing.assert_allclose(velocity(after[0]), [*(v[:2] + dv), 0.5 * down], rtol=0, atol=1e-11)
    np.testing.assert_allclose(
        spin(after[0]), w + 2.5 / R * np.array([dv[1], -dv[0], 0.0]), rtol=0, atol=1e-8
    )
    np.testing.assert_allclose(place(after[0])[:2], v[:2] * math.sqrt(0.2 / G), rtol=0, atol=1e-11)


def test_a_strike_into_the_bed_leaves_at_once_by_the_bounce():
    _end, _fates, log, states = shot([[0.0, 0.0]], [[3.0, 0.0, -1.2]])
    assert log[0][:2] == (0.0, "land")
    np.testing.assert_allclose(velocity(states[1][1][0]), [3.0 - 0.21 * 1.8, 0.0, 0.6], rtol=0, atol=1e-12)


def test_a_weak_strike_stays_on_the_bed_and_is_rubbed():
    _end, _fates, log, states = shot([[0.0, 0.0]], [[3.0, 0.0, -0.05]])
    assert kinds(log) == ["land"]
    np.testing.assert_allclose(velocity(states[1][1][0]), [3.0 - 0.21 * 0.05, 0.0, 0.0], rtol=0, atol=1e-12)


# ---------------------------------------------------------------- two balls on the bed


@pytest.mark.parametrize(
    ("speed", "hop", "inches"), [(3.13, 1.70, 0.067), (5.36, 5.0, 0.196), (8.94, 13.8, 0.544)]
)
def test_a_rolling_ball_hops_off_a_square_hit(speed, hop, inches):
    """Alciatore, TP B-5: v_z = mu (1 + e) V / 2; hops in mm."""
    v = np.array([speed, 0.0, 0.0])
    fields = {"mu_bb": 0.06, "mu_r": 1e-9}  # it does not slow down on its way
    log, states = [], []
    with pytest.raises(RuntimeError, match="still move"):
        simulate(
            [[0.0, 0.0], [2.5 * R, 0.0]],
            [v, STILL],
            [rolling(v), STILL],
            physics=constants(**fields),
            dt=1e-4,
            max_time=0.5,
            log=log,
            watch=lambda time, balls: states.append(balls),
        )
    assert kinds(log)[0] == "ball"
    cue, other = states[1]
    up = 0.06 * 1.94 * speed / 2.0
    # the cloth's friction on the other ball takes part of the closing speed: up to mu_s mu / 2
    np.testing.assert_allclose(cue[flight_3d.VZ], up, rtol=0.01)
    np.testing.assert_allclose(other[flight_3d.VZ], 0.5 * cue[flight_3d.VZ], rtol=1e-12)
    height = 1e3 * cue[flight_3d.VZ] ** 2 / (2.0 * G)
    assert abs(height - hop) < 0.02 * hop and abs(height - 25.4 * inches) < 0.02 * hop


def test_a_soft_hit_lifts_no_ball():
    v = np.array([0.4, 0.0, 0.0])
    _end, _fates, log, states = shot([[0.0, 0.0], [0.1, 0.0]], [v, STILL], [rolling(v), STILL], mu_bb=0.06)
    assert "land" not in kinds(log) and all((balls[:, flight_3d.VZ] == 0.0).all() for _, balls in states)


def test_a_soft_shot_ends_as_on_a_flat_cloth():
    places, v = [[0.0, 0.0], [0.2, 0.01], [0.27, 0.024]], np.array([[0.5, 0.0, 0.0], STILL, STILL])
    w = np.array([[2.0, 25.0, 30.0], STILL, STILL])
    end, _fates, log, _ = shot(places, v, w, mu_bb=0.05, mu_r=0.0127)
    cloth = {
        "R": R,
        "M": 1.0,
        "g": G,
        "mu_s": 0.21,
        "mu_r": 0.0127,
        "spin_decel": 22.0,
        "e": 0.94,
        "mu_bb": 0.05,
    }
    flat = tiny_steps.simulate(places, v[:, :2], w, **cloth)
    assert kinds(log).count("ball") == len(log) >= 2
    np.testing.assert_allclose(end[:, :2], flat, rtol=0, atol=1e-9)


# ---------------------------------------------------------------- jumps


@pytest.mark.parametrize("clears", [False, True])
def test_a_jump_shot_clears_a_ball_if_its_path_does(clears):
    away, speed, ahead = 0.2, 3.5 if clears else 1.6, 2.6
    up, v = 0.5 * speed, ahead - min(0.21 * 1.5 * speed, 2.0 / 7.0 * ahead)  # after the bed's friction
    t = np.linspace(0.0, 2.0 * up / G, 100_001)
    near = np.min(np.hypot(away - v * t, up * t - 0.5 * G * t * t)) > 2.0 * R
    assert near == clears
    log = shot([[0.0, 0.0], [away, 0.0]], [[ahead, 0.0, -speed], STILL])[2]
    landed = kinds(log).index("land", 1)
    assert ("ball" in kinds(log)[:landed]) == (not clears)


def test_two_balls_meet_in_the_air_as_free_spheres():
    _end, _fates, log, states = shot(
        [[0.0, 0.0, 0.3], [0.4, 0.01, 0.33]],
        [[1.5, 0.1, 0.5], [-1.0, 0.0, 0.3]],
        [[30.0, 50.0, -80.0], [0.0, -120.0, 10.0]],
        e_b=1.0,
        mu_bb=0.0,
    )
    assert kinds(log)[0] == "ball"
    time, (a, b) = states[1]
    fall = np.array([0.0, 0.0, -G * time])
    v1, v2 = np.array([1.5, 0.1, 0.5]) + fall, np.array([-1.0, 0.0, 0.3]) + fall
    n = (place(b) - place(a)) / (2.0 * R)
    assert abs(n @ n - 1.0) < 1e-12
    swap = ((v1 - v2) @ n) * n
    np.testing.assert_allclose([velocity(a), velocity(b)], [v1 - swap, v2 + swap], rtol=0, atol=1e-10)
    np.testing.assert_allclose(spin(b), [0.0, -120.0, 10.0], rtol=0, atol=1e-10)


@pytest.mark.parametrize("mu", [(0.03, 0.0, 0.0), (0.8, 0.0, 0.0), flight_3d.MARLOW])
def test_free_spheres_keep_momentum_and_angular_momentum_and_lose_energy(mu):
    rng = np.random.default_rng(4)
    n = np.array([0.6, 0.0, -0.8])
    v1, w1, v2, w2 = (*(k * rng.normal(size=3) for k in (1.0, 50.0)), rng.normal(size=3), STILL)
    v1 = v1 + 3.0 * n
    out = flight_3d.free(v1, w1, v2, w2, n, e=0.94, mu=mu, R=R)
    np.testing.assert_allclose(out[0] + out[2], v1 + v2, rtol=0, atol=1e-13)
    about_1 = [0.4 * R * R * (b + d) + 2.0 * R * np.cross(n, c) for b, c, d in ((w1, v2, w2), out[1:])]
    np.testing.assert_allclose(about_1[1], about_1[0], rtol=0, atol=1e-13)
    np.testing.assert_allclose((out[2] - out[0]) @ n, 0.94 * (v1 - v2) @ n, rtol=1e-12)
    assert energy(*out) < energy(v1, w1, v2, w2)
    slip, p = (np.cross(np.cross(n, v1 - v2 + R * np.cross(w1 + w2, n)), n), 0.97 * (v1 - v2) @ n)
    friction = out[0] - v1 + p * n
    size = np.linalg.norm(slip)
    if mu[1] == 0.0:
        np.testing.assert_allclose(friction, -min(mu[0] * p, size / 7.0) * slip / size, rtol=0, atol=1e-13)
    else:  # the closed form: ln(a exp(c s) + b) falls by 7 a c p
        s = math.log(
            (math.exp(-7.0 * mu[0] * mu[2] * p) * (mu[0] * math.exp(mu[2] * size) + mu[1]) - mu[1]) / mu[0]
        )
        np.testing.assert_allclose(friction, -(size - s / mu[2]) / 7.0 * slip / size, rtol=0, atol=1e-11)


# ---------------------------------------------------------------- one in the air, one on the bed


def meeting(seed, beta):
    """Two balls that meet at the angle beta, and the normal: ball 2 rests, rolls or slides."""
    rng = np.random.default_rng(seed)
    a = rng.uniform(0.0, 2.0 * math.pi)
    n = np.array([math.cos(beta) * math.cos(a), math.cos(beta) * math.sin(a), -math.sin(beta)])
    v1, w1 = 2.0 * rng.normal(size=3), 60.0 * rng.normal(size=3)
    v2 = np.append(rng.normal(size=2), 0.0) * (seed % 3 > 0)
    w2 = rolling(v2) if seed % 3 < 2 else 40.0 * rng.normal(size=3)
    closing = (v1 - v2) @ n
    return (v1 - 2.0 * min(closing, 0.0) * n, w1, v2, w2), n


@pytest.mark.parametrize("seed", range(12))
def test_level_balls_meet_as_on_the_bed_if_the_other_ball_is_pressed(seed):
    (v1, w1, v2, w2), n = meeting(seed, 0.0)
    v1[2] = 0.0
    v1 += max(0.0, 0.3 - (v1 - v2) @ n) * n
    slip_up = (v1 - v2 + R * np.cross(w1 + w2, n))[2]
    if slip_up > 0.0:  # ball 1 would be pressed: turn its spin over
        w1 = w1 - 2.0 * slip_up / R * np.cross(n, np.array([0.0, 0.0, 1.0]))
    for mu in ((0.06, 0.0, 0.0), flight_3d.MARLOW):
        expected = ball_ball(
            v1,
            w1,
            v2,
            w2,
            n,
            R=R,
            M=1.0,
            e=0.94,
            mu_bb=lambda s, mu=mu: mu[0] + mu[1] * math.exp(-mu[2] * s),
            mu_s=0.21,
        )
        *got, press = tilted(v1, w1, v2, w2, n, e=0.94, mu=mu, mu_s=0.21, R=R)
        np.testing.assert_allclose(in_speeds(got), in_speeds(expected), rtol=0, atol=3e-9)
        assert abs(press - expected[0][2]) < 3e-9 and press > 0.0


def test_level_balls_meet_as_free_ones_if_the_other_ball_is_lifted():
    (v1, w1, v2, _), n = meeting(5, 0.0)
    v1[2] = 1.0  # it rubs upwards
    w1[:2] = 0.0
    got = tilted(v1, w1, v2, STILL, n, e=0.94, mu=(0.06, 0.0, 0.0), mu_s=0.21, R=R)
    expected = flight_3d.free(v1, w1, v2, STILL, n, e=0.94, mu=(0.06, 0.0, 0.0), R=R)
    np.testing.assert_allclose(in_speeds(got[:4]), in_speeds(expected), rtol=0, atol=1e-9)
    assert got[2][2] > 0.0 > got[4]


@pytest.mark.parametrize("beta", [0.1, 0.6, 1.2, math.pi / 2])
def test_without_friction_the_tilted_impact_is_known(beta):
    (v1, w1, v2, w2), n = meeting(1, beta)
    v1, w1, v2, w2, press = tilted(v1, w1, v2, w2, n, e=0.94, mu=(0.0, 0.0, 0.0), mu_s=0.0, R=R)
    before = meeting(1, beta)[0]
    p = 1.94 * ((before[0] - before[2]) @ n) / (1.0 + math.cos(beta) ** 2)
    level = np.array([n[0], n[1], 0.0])
    np.testing.assert_allclose(v1, before[0] - p * n, rtol=0, atol=1e-10)
    np.testing.assert_allclose(v2, before[2] + p * level, rtol=0, atol=1e-10)
    np.testing.assert_allclose([w1, w2], [before[1], before[3]], rtol=0, atol=1e-12)
    assert press == 0.0


def by_small_steps(balls, n, e, mu, mu_s, steps):
    """Routh by explicit steps of Newton and Euler, with vectors: friction as it is at the start of each, soft near
    zero slip. A rough check that shares nothing with ``tilted``."""
    v1, w1, v2, w2 = (np.array(a) for a in balls)
    down, up = np.array([0.0, 0.0, -1.0]), np.array([0.0, 0.0, 1.0])
    soft = 1e-3
    dp = ((v1 - v2) @ n) / steps
    work, most = 0.0, None
    while most is None or work > (1.0 - e * e) * most:
        closing = (v1 - v2) @ n
        if closing <= 0.0 and most is None:
            most = work
        slip = v1 + R * np.cross(w1, n) - v2 - R * np.cross(w2, -n)
        slip = slip - (slip @ n) * n
        push = -n * dp - mu * dp * slip / max(np.linalg.norm(slip), soft)
        reaction = max(0.0, push[2] - v2[2])  # what holds it at v_z = 0
        cloth = v2 + R * np.cross(w2, down)
        rub = -mu_s * reaction * np.array([cloth[0], cloth[1], 0.0]) / max(np.hypot(*cloth[:2]), soft)
        v1, w1 = v1 + push, w1 + 2.5 / R * np.cross(n, push)
        v2 = v2 - push + reaction * up + rub
        w2 = w2 + 2.5 / R * (np.cross(-n, -push) + np.cross(down, rub))
        work += closing * dp
    return v1, w1, v2, w2


@pytest.mark.parametrize("seed", range(6))
def test_the_tilted_impact_agrees_with_rough_explicit_steps(seed):
    balls, n = meeting(seed, (0.1, 0.5, 0.9, 1.3)[seed % 4])
    got = tilted(*balls, n, e=0.94, mu=(0.06, 0.0, 0.0), mu_s=0.21, R=R)
    expected = by_small_steps(balls, n, 0.94, 0.06, 0.21, 3000)
    np.testing.assert_allclose(in_speeds(got[:4]), in_speeds(expected), rtol=0, atol=3e-3)


@pytest.mark.parametrize("seed", range(24))
def test_the_tilted_impact_has_converged_keeps_its_laws_and_loses_energy(seed):
    beta = np.random.default_rng(100 + seed).uniform(0.0, 1.5)
    balls, n = meeting(seed, beta)
    mu = (0.06, 0.0, 0.0) if seed % 2 else flight_3d.MARLOW
    fine, coarse = (tilted(*balls, n, e=0.94, mu=mu, mu_s=0.21, R=R, steps=k) for k in (40_000, 20_000))
    unit = np.abs(in_speeds(balls)).max()
    np.testing.assert_allclose(in_speeds(coarse[:4]), in_speeds(fine[:4]), rtol=0, atol=2e-8 * unit)
    assert energy(*fine[:4]) < energy(*balls) * (1.0 + 1e-9)
    push = fine[0] - balls[0]  # what ball 1 has got: its spin comes from the same impulse, at R n
    np.testing.assert_allclose(R * (fine[1] - balls[1]), 2.5 * np.cross(n, push), rtol=0, atol=1e-11)
    normal, friction = -push @ n, np.linalg.norm(push - (push @ n) * n)
    assert normal > 0.0 and friction <= (mu[0] + mu[1]) * normal * (1.0 + 1e-9) and fine[2][2] >= 0.0
    if seed % 2:  # another oracle's steps, of the first order
        across = np.cross(n, [0.0, 0.0, 1.0]) / math.cos(beta)
        x, y, up = np.eye(3)
        rows = [np.concatenate([_row(d, n), -_row(d, -n)]) for d in (across, np.cross(across, n))]
        rows += [np.concatenate([np.zeros(6), _row(d, -up)]) for d in (x, y, up)]
        rows = np.array([*rows, -np.concatenate([_row(n, n), -_row(n, -n)])])
        state = np.concatenate([balls[0], R * balls[1], balls[2], R * balls[3]])
        other = _finish(rows, state, mu[0], 0.21, 0.94, R, 20_000)
        np.testing.assert_allclose(in_speeds(fine[:4]), in_speeds(other), rtol=0, atol=1e-4 * unit)


# ---------------------------------------------------------------- noses, rails, pockets


def off_a_nose(v, w, m, e):
    """A free sphere and a fixed body, in closed form."""
    p = (1.0 + e) * (v @ m)
    slip = v + R * np.cross(w, m)
    slip -= (slip @ m) * m
    push = -p * m - min(0.14 * p, 2.0 / 7.0 * np.linalg.norm(slip)) * slip / np.linalg.norm(slip)
    return v + push, w + 2.5 / R * np.cross(m, push)


@pytest.mark.parametrize("above", [False, True])
def test_a_flying_ball_meets_the_edge_from_below_or_above(above):
    v0, w = np.array([1.5, 0.4, 0.2]), np.array([20.0, -60.0, 100.0])
    z0 = R if above else 0.0
    _end, _fates, log, states = shot([[EDGE - 0.05, 0.0, z0]], [v0], [w], ONE_NOSE)
    assert kinds(log)[0] == "cushion"
    time, (ball,) = states[1]
    x, _y, z = place(ball)
    np.testing.assert_allclose(
        [x, z], [EDGE - 0.05 + 1.5 * time, z0 + 0.2 * time - 0.5 * G * time**2], rtol=0, atol=1e-12
    )
    assert (z > H) == above and abs(math.hypot(EDGE - x, H - z) - R) < 1e-12
    m = np.array([EDGE - x, 0.0, H - z]) / R
    v1, w1 = off_a_nose(v0 - [0.0, 0.0, G * time], w, m, 0.98)
    np.testing.assert_allclose(velocity(ball), v1, rtol=0, atol=1e-10)
    np.testing.assert_allclose(spin(ball), w1, rtol=0, atol=1e-7)


def test_restitution_falls_with_the_speed_along_the_normal():
    (_, _), (time, (ball,)) = shot([[EDGE - 0.1, 0.0, H]], [[6.0, 0.0, 0.0]], table=ONE_NOSE, mu_c=0.0)[3][:2]
    x, _y, z = place(ball)
    m = np.array([EDGE - x, 0.0, H - z]) / R
    v = np.array([6.0, 0.0, -G * time])
    e = 0.98 * (v @ m / 2.02) ** -0.243
    np.testing.assert_allclose(velocity(ball), v - (1.0 + e) * (v @ m) * m, rtol=0, atol=1e-10)


@pytest.mark.parametrize(("mu_c", "lifts"), [(0.5, True), (0.14, False)])
def test_a_nose_lifts_a_ball_on_the_bed_by_its_friction(mu_c, lifts):
    """Topspin rubs the nose downwards; its friction lifts the ball if mu_c cos_theta > sin_theta."""
    w = np.array([0.0, 5.0 * 3.0 / R, 0.0])
    _end, _fates, log, states = shot([[WALL - R, 0.0]], [[3.0, 0.0, 0.0]], [w], ONE_NOSE, mu_c=mu_c)
    assert kinds(log)[0] == "cushion" and states[1][1][0, flight_3d.VX] < 0.0
    e = 0.98 * (3.0 / 2.02) ** -0.243
    v, w = ball_cushion(
        [3.0, 0.0, 0.0], w, [1.0, 0.0, 0.0], R=R, M=1.0, e=e, mu_w=mu_c, mu_s=0.21, sin_theta=SIN
    )
    assert (v[2] >= SETTLE) == lifts
    np.testing.assert_allclose(velocity(states[1][1][0]), [v[0], v[1], v[2] * lifts], rtol=0, atol=1e-12)
    np.testing.assert_allclose(spin(states[1][1][0]), w, rtol=0, atol=1e-9)


def test_a_ball_that_flies_over_the_rail_is_off():
    end, fates, log, _ = shot([[0.5, 0.0]], [[4.0, 0.0, 2.0]], table=ONE_NOSE)
    assert fates == ["off"] and kinds(log) == ["off"]
    np.testing.assert_allclose(end[0, 0], EDGE + RAIL, rtol=0, atol=1e-12)


def test_a_ball_that_lands_on_the_rail_bounces_there():
    log, states = shot([[EDGE + 0.02, 0.0, 0.2]], [[-0.09, 0.0, 0.0]], table=ONE_NOSE)[2:]
    assert kinds(log)[0] == "rail"
    time, (ball,) = states[1]
    down = math.sqrt(2.0 * G * (0.2 - H - R))
    np.testing.assert_allclose([time, place(ball)[2]], [down / G, H + R], rtol=0, atol=1e-10)
    np.testing.assert_allclose(velocity(ball)[[0, 2]], [-0.09 * 5.0 / 7.0, 0.5 * down], rtol=0, atol=1e-10)
    assert "land" in kinds(log)  # it goes on over the edge and comes back to the bed


def test_a_ball_that_settles_on_the_rail_is_off():
    _end, fates, log, _ = shot([[EDGE + 0.02, 0.0, 0.2]], [[0.0, 0.0, 0.0]], table=ONE_NOSE)
    assert fates == ["off"] and set(kinds(log)) == {"rail", "off"} and kinds(log).count("rail") == 5


MATCH = Table.preset("match")


@pytest.mark.parametrize(("start", "v", "fate", "kind"), [
    # the top right pocket: down into it, against its back, and over it
    ((0.85, 1.745, 0.02), (0.6, 0.6, 0.0), "potted", "pot"),
    ((0.80, 1.695, 0.0), (6.0, 6.0, 0.25), "potted", "pot"),
    ((0.80, 1.695, 0.0), (6.0, 6.0, 1.0), "off", "off"),
])  # fmt: skip
def test_a_ball_flies_into_a_pocket(start, v, fate, kind):
    end, fates, log, _ = shot([start], [v], table=MATCH)
    assert fates == [fate] and kinds(log) == [kind]
    assert log[0][3] == (3 if fate == "potted" else -1)
    dx, dy, radius = end[0, 0] - MATCH.falls[3, 0], end[0, 1] - MATCH.falls[3, 1], MATCH.falls[3, 2]
    if v[2] == 0.0:
        assert abs(end[0, 2]) < 1e-12 and math.hypot(dx, dy) < radius
    elif fate == "potted":
        assert abs(math.hypot(dx, dy) - radius) < 1e-12 and 0.0 < end[0, 2] < H


def test_a_flying_ball_meets_a_jaw_as_an_arc():
    v0, w = np.array([2.0, 0.6, 0.4]), np.array([10.0, 20.0, 30.0])
    log, states = shot([[0.772, 1.701, 0.005]], [v0], [w], MATCH)[2:]
    assert kinds(log)[0] == "jaw"
    time, (ball,) = states[1]
    jaw = MATCH.jaws[log[0][3]]
    x, y, z = place(ball)
    to = np.array([jaw[0] - x, jaw[1] - y, 0.0])
    far = np.linalg.norm(to)
    m = np.append(to[:2] / far * (far - jaw[2] - R + R * COS), H - z) / R
    assert abs(np.linalg.norm(m) - 1.0) < 1e-11
    v1, w1 = off_a_nose(v0 - [0.0, 0.0, G * time], w, m, 0.98)
    np.testing.assert_allclose(velocity(ball), v1, rtol=0, atol=1e-9)
    np.testing.assert_allclose(spin(ball), w1, rtol=0, atol=1e-6)


# ---------------------------------------------------------------- whole shots


def random_shot(seed):
    """Three balls near the middle pocket, some in the air, with any spin."""
    rng = np.random.default_rng(seed)
    places = np.array([[0.6, 0.25, 0.0], [0.72, 0.3, 0.0], [0.66, 0.36, 0.0]]) + 0.02 * rng.normal(
        size=(3, 3)
    )
    places[:, 2] = np.where(rng.random(3) < 0.5, 0.0, 0.06 * rng.random(3))
    v = rng.normal(size=(3, 3)) * [1.5, 1.0, 0.8]
    v[0] += 2.0 * (places[1] - places[0]) / 0.12
    v[:, 2] *= places[:, 2] > 0.0
    v[0, 2] -= 0.7
    return places, v, rng.normal(size=(3, 3)) * 60.0


def test_energy_never_rises_in_40_shots():
    seen, fallen = {}, set()
    for seed in range(40):
        _end, fates, log, states = shot(*random_shot(seed), MATCH, dt=4e-4)
        had = np.full(3, math.inf).sum()
        for _time, balls in states:
            here = balls[balls[:, flight_3d.MODE] <= flight_3d.AIR]
            has = sum(energy(velocity(b), spin(b)) + G * b[flight_3d.Z] for b in here)
            assert has <= had * (1.0 + 1e-9)
            had = has
        for kind in kinds(log):
            seen[kind] = seen.get(kind, 0) + 1
        fallen |= set(fates)
    assert {"ball", "cushion", "land", "rail", "jaw", "pot"} <= set(seen) and {"table", "potted"} <= fallen


@pytest.mark.parametrize("seed", range(8))
def test_halving_the_step_changes_nothing(seed):
    ends, logs = [], []
    for dt in (4e-4, 2e-4):
        end, fates, log, _ = shot(*random_shot(seed), MATCH, dt=dt)
        ends.append(end)
        logs.append([entry[1:] for entry in log] + fates)
    assert logs[0] == logs[1]
    np.testing.assert_allclose(ends[0], ends[1], rtol=0, atol=1e-6)


@pytest.mark.parametrize("seed", range(4))
def test_a_mirrored_shot_is_the_mirror_of_the_shot(seed):
    places, v, w = random_shot(seed)
    end, fates, log, _ = shot(places, v, w, MATCH, dt=4e-4)
    mirror = np.array([-1.0, 1.0, 1.0])
    end2, fates2, log2, _ = shot(places * mirror, v * mirror, w * -mirror, MATCH, dt=4e-4)
    assert fates == fates2 and kinds(log) == kinds(log2)
    np.testing.assert_allclose(end2, end * mirror, rtol=0, atol=1e-6)
