"""Are the oracles of an impact right? Against closed forms and an exact piecewise solution."""

from __future__ import annotations

import math

import numpy as np
import pytest

from .ball_ball import ball_ball
from .ball_cushion import ball_cushion

R, M = 0.02625, 0.1406
BALLS, STILL, NORTH = {"R": R, "M": M}, np.zeros(3), np.array([0.0, 1.0, 0.0])
CUSHION = {"R": R, "M": M, "e": 0.98, "mu_w": 0.14, "mu_s": 0.212, "sin_theta": 0.4}
V = 2.0 * np.array([math.sin(0.5), math.cos(0.5), 0.0])


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
    v = 2.0 * NORTH
    mu, e = 0.05, 0.89
    slip = -share * 2.0  # up, ball 1 relative to ball 2
    pn = (1 + e) / 2 * 2.0
    # the ball that is lifted moves, the other cannot: 6, not 7
    pt = -math.copysign(min(mu * pn, abs(slip) / 6), slip)
    v1, w1, v2, w2 = ball_ball(
        v, np.array([-share * v[1] / R, 0.0, 0.0]), STILL, STILL, NORTH, **BALLS, e=e, mu_bb=mu, mu_s=0.0
    )
    np.testing.assert_allclose(v1, [0, 2.0 - pn, max(pt, 0.0)], rtol=0, atol=1e-13)
    np.testing.assert_allclose(v2, [0, pn, max(-pt, 0.0)], rtol=0, atol=1e-13)
    np.testing.assert_allclose(R * w1, [-share * 2.0 + 2.5 * pt, 0, 0], rtol=0, atol=1e-13)
    np.testing.assert_allclose(R * w2, [2.5 * pt, 0, 0], rtol=0, atol=1e-13)


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
