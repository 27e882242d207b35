"""Does a ball over a pocket move as a free sphere does? One impact with a nose by small steps, one fall, and what once went wrong."""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env import EventKind
from snooker_env.physics import pocket
from snooker_env.physics.columns import P_E_J, P_MU_C
from snooker_env.physics.impact import free
from tests.kernels import from_python

R, G, SIN = 0.02625, 9.81, 0.4
FALL = np.array([[0.0, 0.0, 0.1]])
NO_JAWS = np.zeros((0, 6))


def by_small_steps(v, w, n, physics, steps=2000):
    """Velocity and spin of a free sphere pressed on a fixed body at R n: normal impulse in equal parts, Coulomb friction at each."""
    part = (1.0 + physics.e_j) * (v @ n) / steps
    for _ in range(steps):
        slip = v + np.cross(w, R * n)
        slip -= (slip @ n) * n
        size = np.linalg.norm(slip)
        rub = -min(physics.mu_c * part, size / 3.5) * slip / size if size > 0 else np.zeros(3)
        v, w = v - part * n + rub, w + np.cross(R * n, rub) / (0.4 * R * R)
    return v, w


@pytest.mark.parametrize("mu", [0.0, 0.14, 1.0])
def test_the_impact_with_a_nose_is_that_of_a_free_sphere_in_small_steps(mu):
    strike, rng = from_python(free.against), np.random.default_rng(0)
    for _ in range(20):
        physics, turn = sn.Physics(e_j=rng.uniform(), mu_c=mu), rng.uniform(0, 2 * np.pi)
        sin_phi = rng.uniform()
        n = np.array([np.cos(turn), np.sin(turn)])
        at = np.append(np.sqrt(1 - sin_phi**2) * n, sin_phi)
        v, w = rng.normal(size=3) * 2, rng.normal(size=3) * 100
        v *= np.sign(v @ at)
        after, spin = strike(tuple(v), tuple(w), tuple(at), physics.mu_c, physics.e_j, physics.R)
        want_v, want_w = by_small_steps(v, w, at, physics)
        assert after == pytest.approx(tuple(want_v), abs=1e-9)
        assert np.array(spin) * R == pytest.approx(want_w * R, abs=1e-9)


def test_a_nose_does_not_pull():
    """The ball falls away from the jaw's nose faster than it grazes towards it: it once took up to 29 % more energy from it."""
    strike, v, w, phys = from_python(free.against), (0.1, 0.9, -0.5), (1.0, 2.0, 3.0), sn.Physics().pack()
    assert strike(v, w, (0.8, 0.0, 0.6), phys[P_MU_C], phys[P_E_J], R) == (v, w)
    v = np.array([0.901733236439002, 0.4275468027601705])
    start = np.array([0.8877296491479747, -0.005912648120832327]) - 1e-3 * v
    shot = sn.simulate([start], [v], [(-v[1] / R, v[0] / R, 0.0)])
    drop, jaw = shot.events[:2]
    assert (drop["kind"], jaw["kind"]) == (EventKind.DROP, EventKind.JAW)
    assert np.array_equal(shot.at(drop["time"])[2], shot.at(jaw["time"])[2])


def test_a_free_fall_ends_when_the_ball_is_below_the_noses():
    fly, physics = from_python(pocket.fly), sn.Physics()
    end, _, time, r, v = fly((0.0, 0.01, 0.0), (0.3, 0.1, 0.0), (-0.1, 0.0), FALL, 0, NO_JAWS, physics.pack())
    assert end == pocket.LOST
    assert time == pytest.approx(np.sqrt(2 * (1 - SIN) * R / G), abs=pocket.STEP)
    wanted = 0.3 * time, 0.01 + 0.1 * time, 0.5 * G * time**2, 0.3, 0.1, G * time
    assert r + v == pytest.approx(wanted, abs=1e-12)


@pytest.mark.parametrize("name", ["match", "tight", "uk8", "pool9"])
def test_no_leg_of_a_flight_gains_energy(name):
    """Kinetic and potential together. And a ball that meets a jaw gets there with the velocity that brought
    it, not with what the edge makes of it at the end of the step: its path once had 9 times the difference
    more."""
    table = sn.Table.preset(name)
    physics, fly, strike = sn.Physics(**table.ball), from_python(pocket.fly), from_python(free.against)
    rng = np.random.default_rng(0)
    gap, R, phys, ends, short = from_python(pocket.jaw_gap), physics.R, physics.pack(), [], 0
    for _ in range(1500):
        k = int(rng.integers(len(table.falls)))
        fx, fy, radius = table.falls[k]
        turn = np.arctan2(-fy if abs(fy) > 0.1 else 0.0, -fx) + rng.uniform(-1.2, 1.2)
        x, y = fx + radius * np.cos(turn), fy + radius * np.sin(turn)
        way, speed = turn + np.pi + rng.uniform(-1.4, 1.4), rng.uniform(0.4, 5)
        r, v = (x, y, 0.0), (speed * np.cos(way), speed * np.sin(way), 0.0)
        spin, entered = tuple(rng.normal(0, 50, 3)), (x - fx, y - fy)
        for _ in range(20):
            (x, y, z), (vx, vy, u) = r, v
            had = 0.5 * (vx * vx + vy * vy + u * u) - G * z
            end, jaw, time, r, v = fly(r, v, entered, table.falls, k, table.jaws, phys)
            has = 0.5 * (v[0] ** 2 + v[1] ** 2 + v[2] ** 2) - G * r[2]
            assert has <= had + 1e-12 * speed**2
            size = np.sqrt(vx * vx + vy * vy + u * u)
            # within one step: a straight line
            if end == pocket.JAW and pocket.SHORTEST < time < min(pocket.STEP, pocket.STRIDE / size):
                short += 1
                assert (r[0] - x, r[1] - y) == pytest.approx((vx * time, vy * time), abs=1e-12)
                assert v[:2] == (vx, vy)
            ends.append(end)
            if end != pocket.JAW:
                break
            _, nx, ny, sin_phi, _ = gap(r, table.jaws, jaw, R, table.ball["sin_theta"])
            cos_phi, up = np.sqrt(1.0 - sin_phi * sin_phi), (v[0], v[1], -v[2])
            normal = nx * cos_phi, ny * cos_phi, sin_phi
            (vx, vy, u), spin = strike(up, spin, normal, phys[P_MU_C], phys[P_E_J], R)
            v = vx, vy, -u
    assert all(ends.count(end) > 10 for end in (pocket.JAW, pocket.LOST, pocket.BACK))
    assert short > 10
