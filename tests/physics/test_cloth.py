"""Does a lone ball move as the closed forms say? Slide, roll, spin, curve; the cue; positions between events."""

import numpy as np
import pytest

import snooker_env as sn

R, g, mu_s, mu_r = 0.02625, 9.81, 0.21, 0.0127


def alone(v, w, **fields):
    return sn.simulate([(0.0, 0.0)], [v], [w], table=None, physics=fields or None)


@pytest.mark.parametrize("top", [-1.5, -0.8, 0.0, 0.5, 1.0, 2.5])
@pytest.mark.parametrize("side", [0.0, 40.0])
@pytest.mark.parametrize("angle", [0.0, 0.7, np.pi / 2, 2.4])
def test_draw_stun_follow_and_massé(top, side, angle):
    """Final velocity v0 - (2/7) u0, the place where rolling starts and where the ball stops, for any spin,
    also about the direction of motion (a curve). A wrong sign in the cloth's friction hides from top spin and
    shows at once in draw."""
    d, n = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    v0 = 1.7 * d
    w_h = top * 1.7 / R * n + 25.0 * d  # 25 rad/s about the direction of motion: the path must curve
    u0 = v0 + R * np.array([-w_h[1], w_h[0]])
    shot = alone(v0, (*w_h, side))
    T = 2 * np.linalg.norm(u0) / (7 * mu_s * g)
    v_roll = v0 - 2 / 7 * u0
    r_roll = v0 * T - 0.5 * mu_s * g * T * T * u0 / np.linalg.norm(u0)
    speed = np.linalg.norm(v_roll)
    assert shot.events["time"][0] == pytest.approx(T, rel=1e-12)
    r, v, w = shot.at(T)
    assert r[0] == pytest.approx(r_roll, abs=1e-13)
    assert v[0] == pytest.approx(v_roll, abs=1e-13)
    assert w[0, :2] * R == pytest.approx([-v_roll[1], v_roll[0]], abs=1e-13)
    assert shot.positions[0] == pytest.approx(r_roll + v_roll * speed / (2 * mu_r * g), abs=1e-12)
    assert shot.duration == pytest.approx(max(T + speed / (mu_r * g), abs(side) / 22), rel=1e-12)
    mid_r, mid_v, _ = shot.at(T / 2)
    assert mid_v[0] == pytest.approx(v0 - mu_s * g * T / 2 * u0 / np.linalg.norm(u0), abs=1e-13)
    bend = np.cross(np.append(v0, 0), np.append(mid_r[0], 0))[2]
    assert np.sign(bend) == np.sign(-(v0[0] * u0[1] - v0[1] * u0[0]))


@pytest.mark.parametrize("sign", [-1, 1])
def test_spin_about_the_vertical_decays_in_every_state(sign):
    """22 rad/s^2 while sliding, rolling and at rest; a ball spinning on the spot does not move (eq. 21)."""
    shot = alone((1.0, 0.0), (0, 0, sign * 60.0))
    for t in (0.05, 0.5, 2.0):
        assert shot.at(t)[2][0, 2] == pytest.approx(sign * (60 - 22 * t))
    assert shot.at(3.0)[2][0, 2] == 0.0
    still = alone((0, 0), (0, 0, sign * 44.0))
    assert still.duration == pytest.approx(2.0)
    assert (still.positions == 0).all()
    assert len(still.events) == 0


def test_strike():
    v, w = sn.strike(2.0, 0.3, top=0.4)
    assert v == pytest.approx([2 * np.cos(0.3), 2 * np.sin(0.3), 0])
    assert w == pytest.approx([-v[1] / R, v[0] / R, 0])  # 0.4 R above the centre the ball rolls at once
    v, w = sn.strike(2.0, 0.0, side=0.3)
    assert w == pytest.approx([0, 0, 2.5 * 2 * 0.3 / R])  # right side: anticlockwise from above
    squirt = np.arctan(2.5 * 0.3 * np.sqrt(1 - 0.09) / (1 + 30 + 2.5 * (1 - 0.09)))  # TP A.31
    assert np.arctan2(v[1], v[0]) == pytest.approx(squirt)  # ... and the ball leaves to the left
    assert np.linalg.norm(v) == pytest.approx(2.0)
    assert sn.strike(2.0, 0.0, top=-0.5)[1][1] == pytest.approx(-2.5 * 2 * 0.5 / R)  # back spin
    v, w = sn.strike(2.0, 0.0, side=0.4, elevation=0.5)
    # right side with the butt raised swerves the ball to the right: spin about +x drives the contact point to
    # the left
    assert w[0] > 0
    assert sn.simulate([(0, 0)], [v[:2]], [w], table=None).positions[0, 1] < -0.05


def test_at_is_continuous_and_ends_at_rest():
    shot = sn.simulate([(0, 0), (0.3, 0.01)], [(3, 0), (0, 0)], [(0, -50, 20), (0, 0, 0)], table=None)
    times = np.linspace(0, shot.duration * 1.1, 4001)
    r, v, w = shot.at(times)
    assert np.hypot(*np.diff(r, axis=0).transpose(2, 0, 1)).max() <= 3.0 * (times[1] - times[0]) * 1.01
    assert (v[-1] == 0).all()
    assert (w[-1] == 0).all()
    assert r[-1] == pytest.approx(shot.positions, abs=1e-12)
    one = shot.at(float(times[77]))
    assert [a.shape for a in one] == [(2, 2), (2, 2), (2, 3)]
    assert all((a == b[77]).all() for a, b in zip(one, (r, v, w), strict=True))
