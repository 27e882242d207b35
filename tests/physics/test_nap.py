"""Does a ball that rolls over the nap go where its equation of motion takes it? Against an independent integration of that equation."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import snooker_env as sn
from snooker_env import EventKind
from snooker_env.physics import cloth
from snooker_env.physics.impact import contact
from snooker_env.tasks.kernel_arrays import CueLaw
from snooker_env.tasks.lines import new_work
from snooker_env.tasks.pot_aim import solved_aim
from tests.kernels import from_python

R, DECEL = 0.02625, 0.0127 * 9.81


def rolled(v, nap, start=(0.0, 0.0), table=None):
    return sn.simulate([start], [v], [(-v[1] / R, v[0] / R, 0.0)], table, {"nap": nap})


def integrated(v, nap, times):
    """Place and velocity at ``times``, then the time and place of rest, of dv/dt = -decel v/|v| + nap y by
    DOP853.

    The last ``end`` m/s are a ball's that has turned to the nap: the place is theirs to end^2 / decel.
    """
    end = 1e-8

    def rate(_, z):
        speed = np.hypot(z[2], z[3])
        return z[2], z[3], -DECEL * z[2] / speed, -DECEL * z[3] / speed + nap

    def slow(_, z):
        return np.hypot(z[2], z[3]) - end

    slow.terminal = True
    exact = {"dense_output": True, "rtol": 1e-12, "atol": 1e-14}
    out = solve_ivp(rate, (0, 1e4), (0, 0, *v), "DOP853", events=slow, **exact)
    within = np.minimum(times, out.t[-1])
    return out.sol(within).T, out.t[-1], out.y[:2, -1], end / (DECEL - abs(nap))


def rolls(n, seed, share):
    """(v, nap): any direction, 0.02 to 4 m/s, |nap| up to ``share`` of the resistance."""
    rng = np.random.default_rng(seed)
    for _ in range(n):
        speed, turn = 4 * rng.uniform(0.07, 1) ** 2, rng.uniform(-np.pi, np.pi)
        yield speed * np.array([np.sin(turn), np.cos(turn)]), DECEL * share * rng.uniform(-1, 1)


@pytest.mark.parametrize("share", [0.04, 0.9])
def test_stop_place_stop_time_and_the_way_there(share):
    most = 0
    for v, nap in rolls(25, 1, share):
        shot = rolled(v, nap)
        times = np.linspace(0, shot.duration, 400)
        path, stop, place, late = integrated(v, nap, times)
        assert shot.positions[0] == pytest.approx(place, abs=1e-10)
        assert 0 <= shot.duration - stop <= late + 1e-9
        r, u, w = shot.at(times)
        assert np.abs(r[:, 0] - path[:, :2]).max() < 2.1e-6  # the pieces' bound
        assert np.abs(u[:-1, 0] - path[:-1, 2:]).max() < (2e-4 if share < 0.1 else 1e-3)
        assert w[:, 0, :2] * R == pytest.approx(u[:, 0, ::-1] * (-1, 1), abs=1e-12)
        assert set(shot.events["kind"][:-1]) <= {EventKind.BEND} and shot.events["kind"][-1] == EventKind.STOP
        x, y, ax, ay = shot.segments[-2, [cloth.VX, cloth.VY, cloth.AX, cloth.AY]]
        # the piece to rest is straight, as the search for its contacts takes it
        assert abs(x * ay - y * ax) < 1e-14 * np.hypot(x, y)
        most = max(most, len(shot.events))
    assert 20 < most < (120 if share < 0.1 else 400)


def test_along_the_nap_is_one_piece_in_closed_form():
    for v, nap in ((0.7, 0.002), (-0.7, 0.002), (0.7, -0.002), (-0.7, -0.1)):
        shot = rolled((0.0, v), nap)
        slows = DECEL - nap * np.sign(v)
        assert shot.events["kind"].tolist() == [EventKind.STOP]
        assert shot.positions[0] == pytest.approx([0, 0.5 * v * abs(v) / slows], abs=1e-14)
        assert shot.duration == pytest.approx(abs(v) / slows, rel=1e-14)
    for nap in (0.001, -0.001, 0.02):  # straight across it a ball drifts by v^2 nap / (4 (decel^2 - nap^2))
        shot = rolled((0.5, 0.0), nap)
        assert shot.positions[0, 1] == pytest.approx(0.25 * nap / (4 * (DECEL**2 - nap**2)), rel=1e-12)
        shots = (sn.simulate([(0, 0)], [(2.0, 0)], np.zeros((1, 3)), None, {"nap": n}) for n in (0.0, nap))
        slid = [shot.at(0.1) for shot in shots]
        assert np.array_equal(slid[0][0], slid[1][0])  # while it slides it does not feel it


def test_without_a_nap_nothing_changes_and_a_tiny_one_changes_little():
    for v, _ in rolls(10, 3, 0.1):
        plain, named = rolled(v, 0.0), sn.simulate([(0, 0)], [v], [(-v[1] / R, v[0] / R, 0)], None)
        tiny = rolled(v, 1e-15)
        assert np.array_equal(plain.segments, named.segments)
        slowing = -DECEL * v / np.sqrt(v[0] * v[0] + v[1] * v[1])
        # to the bit
        assert plain.segments[0, [cloth.VX, cloth.VY, cloth.AX, cloth.AY]].tolist() == [*v, *slowing]
        assert tiny.positions == pytest.approx(plain.positions, abs=1e-10) and len(tiny.events) == 1
    assert rolled((1.0, 1.0), 5e-324).positions == pytest.approx(rolled((1.0, 1.0), 0.0).positions, abs=1e-14)


def test_a_ball_that_the_nap_presses_along_a_cushion_stays_within_a_millimetre_of_it():
    """Not nearer: the engine's slowest parting, 2 mm/s, is much beside a nap of 0.001 m/s^2."""
    rail = 1.7845 - R
    for speed in (0.2, 0.4, 0.6):
        shot = rolled((speed, 0.0), 0.001, (-0.7, rail), "match")
        off = rail - shot.at(np.linspace(0, shot.duration, 2000))[0][:, 0, 1]
        assert off.min() > -1e-9 and off.max() < 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("field", [{"nap": 0.003}, {"roll_drag": 0.03}, {}])
def test_a_solved_aim_allows_for_nap_and_drag(field):
    """A slow pot across the table into a middle pocket."""
    aim_for = from_python(solved_aim)
    physics = sn.Physics(**field)
    balls, pocket = np.array([(-0.62, 0.05), (-0.12, 0.03)]), np.array([0.889, 0.0])
    line = (pocket - balls[1]) / np.linalg.norm(pocket - balls[1])
    ghost = balls[1] - 2 * R * line
    code, steps = contact.parse_fidelity("standard")
    work = new_work()

    def missed_by(solved_for):
        law = CueLaw(solved_for.pack(), physics.end_mass_ratio, code, steps, 0.5, np.empty(0))
        places = balls, np.ones(2, bool), 1, tuple(pocket), tuple(ghost)
        aim = aim_for(*places, (1.2, 0.0, 0.0, 0.0), law, work)
        v, w = sn.strike(1.2, aim, physics=physics)
        shot = sn.simulate(balls, [v[:2], (0, 0)], [w, (0, 0, 0)], None, physics)
        return np.hypot(*(shot.at(np.linspace(0, shot.duration, 40_000))[0][:, 1] - pocket).T).min()

    assert missed_by(physics) < (1e-4 if "nap" in field else 2e-5)
    assert "nap" not in field or missed_by(sn.Physics()) > 3e-3
