"""Is the oracle of a ball-cushion impact right? Against an exact piecewise solution, smoothed friction,
symmetries and invariants."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from .ball_cushion import ball_cushion
from .motions import BALLS, NORTH, M, R, energy, heading, in_speeds, rolling, turned

CUSHION = {"R": R, "M": M, "e": 0.98, "mu_w": 0.14, "mu_s": 0.212, "sin_theta": 0.4}


def perpendicular_cushion(v, u, e, mu_w, mu_s, sin_theta):
    """A perpendicular ball without side spin, exactly: (v_y, R w_x) after. The rates are constant between
    events.

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
        # q' is linear in f while b has one sign: the friction that holds
        return f0 - r0 * (f1 - f0) / (r1 - r0)

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
    out_v, out_w = ball_cushion(
        [0, v, 0], [-roll * v / R, 0, 0], NORTH, **{**CUSHION, "e": e, "mu_w": mu_w, "mu_s": mu_s}
    )
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
    """The same impact with Coulomb's law smoothed to slip / hypot(slip, width), in the scalar components of
    physics.md 1.4."""
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
    "backspin and side: sticks, cloth slip vanishes": (
        heading(5.5, 0.0),
        rolling(heading(5.5, 0.0), -0.5, -63.0),
        0.2,
        3e-6,
    ),
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
    np.testing.assert_allclose(
        in_speeds((mirrored[0] * mirror, mirrored[1] * spin_mirror)), in_speeds(out), rtol=0, atol=1e-12
    )


def test_a_ball_that_leaves_the_cushion_comes_back_unchanged():
    v, w = heading(1.0, 2.0), np.array([1.0, 2.0, 3.0])
    out = ball_cushion(v, w, NORTH, **CUSHION)
    assert np.array_equal(out[0], v) and np.array_equal(out[1], w)
