"""Are the oracles right? Each against a second computation that shares nothing with it, closed forms, symmetries and the paper's tables."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from .impact import PAPER_PARAMETERS, PAPER_ROWS, after_slip, ball_ball, ball_cushion, incoming, velocity_after_slip
from .tiny_steps import simulate

R, M, G = 0.02625, 0.1406, 9.81
BALLS = {"R": R, "M": M}
CUSHION = {"R": R, "M": M, "e": 0.98, "mu_w": 0.14, "mu_s": 0.212, "sin_theta": 0.4}
CLOTH = {"R": R, "M": M, "g": G, "mu_s": 0.212, "mu_r": 0.0127, "spin_decel": 22.0, "e": 0.89, "mu_bb": 0.05}
STILL = np.zeros(3)
NORTH = np.array([0.0, 1.0, 0.0])


def alciatore(s):
    """mu_bb of the slip speed, in the arithmetic of its argument."""
    return 9.951e-3 + 0.108 * (mpmath.exp(-1.088 * s) if isinstance(s, mpmath.mpf) else math.exp(-1.088 * s))


def heading(speed, cut):
    """Velocity at an angle to NORTH."""
    return speed * np.array([math.sin(cut), math.cos(cut), 0.0])


def rolling(v, share=1.0, side=0.0):
    """Spin of a ball that rolls with ``v`` (times ``share``), with vertical spin ``side``."""
    return np.array([-share / R * v[1], share / R * v[0], side])


def energy(*velocities_and_spins):
    """Kinetic energy over M; ``v, w`` alternate."""
    return sum((0.5 if k % 2 == 0 else 0.2 * R * R) * float(a @ a) for k, a in enumerate(velocities_and_spins))


def in_speeds(state):
    """v and R w of a result, one array."""
    return np.concatenate([np.asarray(a) * (R if k % 2 else 1.0) for k, a in enumerate(state)])


def turned(angle, *vectors):
    c, s = math.cos(angle), math.sin(angle)
    q = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return [q @ a for a in vectors]


# ---------------------------------------------------------------------------------------------------------- ball against ball

V, STRAIGHT = heading(2.0, 0.5), heading(2.0, 0.0)
BACK = np.array([0.0, -1.4, 0.0])
IMPACTS = {
    # name: v1, w1, v2, w2, e, mu_bb
    "roll": (V, rolling(V), STILL, STILL, 0.89, 0.05),
    "draw": (V, rolling(V, -1.0), STILL, STILL, 0.89, 0.05),
    "over-spun follow, side": (V, rolling(V, 1.6, 60.0), STILL, STILL, 0.94, alciatore),
    "both move": (V, rolling(V), np.array([0.4, -0.3, 0.0]), np.array([20.0, 5.0, -30.0]), 0.89, 0.05),
    "both roll head-on": (STRAIGHT, rolling(STRAIGHT), BACK, rolling(BACK), 0.94, 0.05),
    "cloth slip passes zero closely": (STRAIGHT, rolling(STRAIGHT), np.add(BACK, [1e-7, 0, 0]), rolling(BACK), 0.94, 0.05),
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
    v_c, v_o, angle_c, angle_o = after_slip(*ball_ball(*incoming(row), **PAPER_PARAMETERS), (1.0, 0.0), R=PAPER_PARAMETERS["R"])
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
    pt = -math.copysign(min(mu * pn, abs(slip) / 6), slip)  # the ball that is lifted moves, the other cannot: 6, not 7
    v1, w1, v2, w2 = ball_ball(v, rolling(v, share), STILL, STILL, NORTH, **BALLS, e=e, mu_bb=mu, mu_s=0.0)
    np.testing.assert_allclose(v1, [0, 2.0 - pn, max(pt, 0.0)], rtol=0, atol=1e-13)
    np.testing.assert_allclose(v2, [0, pn, max(-pt, 0.0)], rtol=0, atol=1e-13)
    np.testing.assert_allclose(R * w1, [-share * 2.0 + 2.5 * pt, 0, 0], rtol=0, atol=1e-13)
    np.testing.assert_allclose(R * w2, [2.5 * pt, 0, 0], rtol=0, atol=1e-13)


def test_the_lifted_ball_keeps_its_vertical_velocity():
    v1, _, v2, _ = ball_ball(heading(2.0, 0.5), rolling(heading(2.0, 0.5)), STILL, STILL, NORTH, **BALLS, e=0.89, mu_bb=0.05, mu_s=0.21)
    assert v2[2] == 0.0 and 0.02 * 2.0 < v1[2] < 0.05 * 2.0
    v1, _, v2, _ = ball_ball(heading(2.0, 0.5), rolling(heading(2.0, 0.5), -1), STILL, STILL, NORTH, **BALLS, e=0.89, mu_bb=0.05, mu_s=0.21)
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
    mirrored = ball_ball(mirror * v1, spin_mirror * w1, mirror * v2, spin_mirror * w2, mirror * normal, **options)
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
        ball_ball(np.add(V, [0, 0, 0.1]), rolling(V), STILL, STILL, NORTH, **BALLS, e=0.9, mu_bb=0.05, mu_s=0.2)


# ---------------------------------------------------------------------------------------------------------- ball against cushion


def perpendicular_cushion(v, u, e, mu_w, mu_s, sin_theta):
    """A perpendicular ball without side spin, exactly: (v_y, R w_x) after. The rates are constant between events.

    Along the cushion's tangent t2 (upwards) and the cloth the slips are q = -v sin + u and b = v + u.
    """
    s, c = sin_theta, math.sqrt(1 - sin_theta**2)

    def rates(f, b):
        n = s - f * c
        drive = -c - f * s + 2.5 * f
        g = -mu_s * n * (math.copysign(1.0, b) if abs(b) > 1e-12 else math.copysign(1.0, drive))
        if abs(b) <= 1e-12 and abs(drive) <= 3.5 * mu_s * n:
            g = -drive / 3.5
        return -c - f * s + g, 2.5 * (f + g)

    def friction(q, b):
        if abs(q) > 1e-12:
            return -math.copysign(mu_w, q)
        at = [(f, (lambda r: r[1] - s * r[0])(rates(f, b))) for f in (-mu_w, mu_w)]  # q' under either limit
        for f, slope in at:
            if f * slope < 0:
                return f  # it slips on, against this friction
        (f0, r0), (f1, r1) = at
        return f0 - r0 * (f1 - f0) / (r1 - r0)  # q' is linear in f while b has one sign: the friction that holds

    work, floor = 0.0, None
    for _ in range(20):
        q, b = u - s * v, v + u
        dv, du = rates(friction(q, b), b)
        falling = ((q, du - s * dv, "q"), (b, dv + du, "b"), (v, dv, "v"))
        ends = [(-x / dx, name) for x, dx, name in falling if abs(x) > 1e-12 and x * dx < 0]
        if floor is not None:  # c (v P + dv P^2 / 2) = floor - work
            ends = [t for t in ends if t[1] != "v"]
            a, k = 0.5 * dv * c, v * c
            ends.append(((-k - math.sqrt(k * k + 4 * a * (floor - work))) / (2 * a), "end"))
        p, name = min(ends)
        work += c * (v * p + 0.5 * dv * p * p)
        v, u = v + dv * p, u + du * p
        if name == "end":
            return v, u
        if floor is None and abs(v) < 1e-12:
            floor = (1 - e * e) * work
    raise AssertionError("no end")


@pytest.mark.parametrize(
    ("v", "roll", "e", "mu_w", "mu_s"),
    [
        (1.0, 1.0, 0.98, 0.14, 0.212),
        (3.0, 1.0, 0.8, 0.14, 0.21),
        (1.0, 0.0, 0.98, 0.14, 0.212),
        (1.0, -1.0, 0.9, 0.14, 0.212),
        (1.0, 1.0, 0.98, 0.3, 0.212),
        (1.0, 1.0, 0.98, 0.14, 0.8),  # the cloth contact sticks
    ],
)
def test_a_perpendicular_ball_follows_the_piecewise_linear_solution(v, roll, e, mu_w, mu_s):
    out_v, out_w = ball_cushion([0, v, 0], [-roll * v / R, 0, 0], NORTH, **{**CUSHION, "e": e, "mu_w": mu_w, "mu_s": mu_s})
    expected = perpendicular_cushion(v, -roll * v, e, mu_w, mu_s, 0.4)
    np.testing.assert_allclose([out_v[1], R * out_w[0]], expected, rtol=0, atol=1e-12 * v)
    assert abs(out_v[[0, 2]]).max() <= 1e-14 and abs(out_w[1:]).max() <= 1e-12


@pytest.mark.parametrize("speed", [0.3, 1.0, 4.0])
def test_a_perpendicular_rolling_ball_keeps_0_9107(speed):
    v, _ = ball_cushion([0, speed, 0], [-speed / R, 0, 0], NORTH, **CUSHION)
    assert abs(-v[1] / speed - 0.9107) <= 5e-5
    v, _ = ball_cushion([0, speed, 0], [-speed / R, 0, 0], NORTH, **{**CUSHION, "mu_s": 0.21})
    assert abs(-v[1] / speed - 0.9112) <= 5e-5


def smoothed_cushion(v, w, width, *, e, mu_w, mu_s, sin_theta):
    """The same impact with Coulomb's law smoothed to slip / hypot(slip, width), in the scalar components of physics.md 1.4."""
    s, c = sin_theta, math.sqrt(1 - sin_theta**2)

    def rates(_p, y):
        vx, vy, vz, wx, wy, wz = y[:6]  # spins times R
        qx, qz = vx + wy * s - wz * c, -vy * s + vz * c + wx
        slip = math.sqrt(qx * qx + qz * qz + width * width)
        fx, ft = -mu_w * qx / slip, -mu_w * qz / slip
        n = max(0.0, s - ft * c) * (math.exp(-vz / width) if vz > 0 else 1.0)
        bx, by = vx - wy, vy + wx
        b = math.sqrt(bx * bx + by * by + width * width)
        gx, gy = -mu_s * n * bx / b, -mu_s * n * by / b
        dv = (fx + gx, -c - ft * s + gy, -s + ft * c + n)
        return [*dv, 2.5 * (ft + gy), 2.5 * (s * fx - gx), -2.5 * c * fx, vy * c + vz * s]

    def run(y, gauge):
        gauge.terminal, gauge.direction = True, -1
        return solve_ivp(rates, (0, 100), y, "Radau", events=gauge, rtol=1e-9, atol=1e-12).y[:, -1]

    y = run([*v, *(R * np.asarray(w)), 0.0], lambda _p, y: y[1] * c + y[2] * s)
    target = (1 - e * e) * y[6]
    y = run(y, lambda _p, y: y[6] - target)
    return y[:3], y[3:6] / R


SMOOTHED = {
    # name: v, w, mu_w, largest difference at a width of 1e-6 of the speed
    "slips throughout": (heading(1.5, 0.7), rolling(heading(1.5, 0.7), 1.0, 20.0), 0.14, 1e-6),
    "backspin and side: sticks, cloth slip vanishes": (heading(5.5, 0.0), rolling(heading(5.5, 0.0), -0.5, -63.0), 0.2, 3e-6),
    "sticks, then slips again": (np.array([0.925, 1.415, 0.0]), np.array([10.93, -10.59, 13.76]), 0.14, 3e-5),
    "sticks to the end": (heading(1.0, 0.4), np.array([8.0, 9.0, 3.0]), 0.4, 3e-6),
    "lifted, comes down": (heading(1.0, 0.2), rolling(heading(1.0, 0.2)), 0.8, 3e-6),
}


@pytest.mark.parametrize("name", SMOOTHED)
def test_the_cushion_impact_is_the_limit_of_smoothed_friction(name):
    v, w, mu_w, tolerance = SMOOTHED[name]
    options = {"e": 0.9, "mu_w": mu_w, "mu_s": 0.212, "sin_theta": 0.2 if mu_w == 0.8 else 0.4}
    out = ball_cushion(v, w, NORTH, **BALLS, **options)
    speed = np.linalg.norm(v)
    smooth = smoothed_cushion(v, w, 1e-6 * speed, **options)
    assert np.abs(in_speeds(out) - in_speeds(smooth)).max() <= tolerance * speed


@pytest.mark.parametrize("seed", range(6))
def test_cushion_symmetries_and_invariants(seed):
    rng = np.random.default_rng(seed)
    v = heading(rng.uniform(0.3, 4.0), rng.uniform(-1.4, 1.4))
    w = rolling(v, rng.choice([1.0, 0.0, -0.5])) + rng.normal(size=3) * 10
    out = ball_cushion(v, w, NORTH, **CUSHION)
    assert energy(*out) < energy(v, w) and out[0][1] < 0.0 and out[0][2] == 0.0
    turned_out = ball_cushion(*turned(1.1, v, w, NORTH), **CUSHION)
    np.testing.assert_allclose(in_speeds(turned(-1.1, *turned_out)), in_speeds(out), rtol=0, atol=1e-12)
    mirror, spin_mirror = np.array([-1.0, 1.0, 1.0]), np.array([1.0, -1.0, -1.0])
    mirrored = ball_cushion(mirror * v, spin_mirror * w, NORTH, **CUSHION)
    np.testing.assert_allclose(in_speeds((mirrored[0] * mirror, mirrored[1] * spin_mirror)), in_speeds(out), rtol=0, atol=1e-12)


def test_a_ball_that_leaves_the_cushion_comes_back_unchanged():
    v, w = heading(1.0, 2.0), np.array([1.0, 2.0, 3.0])
    out = ball_cushion(v, w, NORTH, **CUSHION)
    assert np.array_equal(out[0], v) and np.array_equal(out[1], w)


# ---------------------------------------------------------------------------------------------------------- tiny steps


def rest_of(position, v, w):
    """Closed form: where one ball comes to rest from any horizontal motion (a parabola while it slides, then a straight line)."""
    slip = v[:2] + R * np.array([-w[1], w[0]])
    speed = np.linalg.norm(slip)
    t = 2 * speed / (7 * CLOTH["mu_s"] * G)
    decel = CLOTH["mu_s"] * G * slip / speed if speed > 0 else np.zeros(2)
    rolls = velocity_after_slip(v, w, R=R)
    return np.asarray(position) + v[:2] * t - 0.5 * decel * t * t + rolls * np.linalg.norm(rolls) / (2 * CLOTH["mu_r"] * G)


def test_a_centre_ball_hit_slides_and_rolls_as_known():
    t = 2 * 2.0 / (7 * 0.212 * G)
    assert abs(t - 0.275) < 5e-4 and abs(2 * t - 0.5 * 0.212 * G * t * t - 0.471) < 5e-4
    rest = simulate([[0.1, 0.2]], [[2.0, 0.0]], [[0.0, 0.0, 0.0]], **CLOTH)
    np.testing.assert_allclose(rest, [rest_of([0.1, 0.2], np.array([2.0, 0, 0]), STILL)], rtol=0, atol=1e-7)


@pytest.mark.parametrize("seed", range(4))
def test_one_ball_on_any_curve_comes_to_rest_as_known(seed):
    rng = np.random.default_rng(seed)
    v, w = np.append(rng.normal(size=2) * 2, 0.0), rng.normal(size=3) * 80
    np.testing.assert_allclose(simulate([[0, 0]], [v[:2]], [w], **CLOTH), [rest_of([0, 0], v, w)], rtol=0, atol=1e-7)


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
    "touching cluster": ([[0, 0], [0.3, 0.005], [0.3 + 2 * R, 0.005], [0.3 + R, 0.005 + R * math.sqrt(3)]], [3.0, 0.0], [0.0, 0.0, 0.0]),
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
    np.testing.assert_allclose(simulate(positions @ q.T, velocities @ q.T, spins_turned, **CLOTH), plain @ q.T, rtol=0, atol=1e-6)


def test_a_graze_within_one_step_is_not_missed():
    depth = 1e-6  # how deep the balls would pass through each other; over in 0.46 mm of the way, a quarter of a step of 2 mm
    positions = [[0, 0], [0.5, 2 * R - depth]]
    log: list = []
    fine, coarse = (
        simulate(positions, [[4.0, 0], [0, 0]], [[0, 4.0 / R, 0], [0, 0, 0]], **CLOTH, dt=dt, log=log) for dt in (1e-5, 5e-4)
    )  # fmt: skip
    assert len(log) == 2
    np.testing.assert_allclose(coarse, fine, rtol=0, atol=1e-6)


def test_the_given_impact_is_used_and_vertical_velocities_are_dropped():
    spins_met = []

    def swap(v1, w1, v2, w2, normal):
        np.testing.assert_allclose(normal, [1.0, 0.0, 0.0], rtol=0, atol=1e-12)
        spins_met.append((w1[2], w2[2]))
        return np.add(v2, [0, 0, 7.0]), w1, np.add(v1, [0, 0, 7.0]), w2

    log: list = []
    rest = simulate([[0, 0], [0.3, 0]], [[1.0, 0], [0, 0]], [[0, 1 / R, 30.0], [0, 0, -3.0]], **CLOTH, impact=swap, log=log)
    decel, way = CLOTH["mu_r"] * G, 0.3 - 2 * R
    v = np.array([math.sqrt(1 - 2 * decel * way), 0.0, 0.0])
    # The first ball keeps its spin and not its speed, the second the other way round.
    np.testing.assert_allclose(rest, [rest_of([way, 0], STILL, rolling(v)), rest_of([0.3, 0], v, STILL)], rtol=0, atol=1e-7)
    (time, first, second), *more = log
    assert (first, second, more) == (0, 1, []) and abs(time - (1 - v[0]) / decel) <= 1e-10
    np.testing.assert_allclose(spins_met, [(30.0 - CLOTH["spin_decel"] * time, 0.0)], rtol=0, atol=1e-8)
