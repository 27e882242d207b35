"""Does a ball whose resistance grows with its speed roll as its equation of motion says? Against independent
integrations of dv/dt = -(mu_r g + roll_drag v^2)."""

import numpy as np
import pytest

import snooker_env as sn
from benchmarks._common import invariants
from benchmarks.fuzz import allowed
from snooker_env import EventKind, Table
from snooker_env.physics.impact import contact
from tests.physics.test_shots import check_shot, random_table

R, G, MU_R = 0.02625, 9.81, 0.0127
DECEL = MU_R * G
LAG = 2e-6
"""m that a ball in a piece may be behind its place."""
LAWS = [(MU_R, 0.015), (0.0043, 0.0151), (MU_R, 1e-5), (0.05, 0.3), (1e-3, 1.0)]


def rolled(v, drag, start=(0.0, 0.0), table=None, **fields):
    w = (-v[1] / R, v[0] / R, 0.0)
    return sn.simulate([start], [v], [w], table, {"roll_drag": drag, **fields})


def integrated(speed, decel, drag, n=4000):
    """Times, ways and speeds from ``speed`` to rest by the Runge-Kutta method of fourth order in equal steps of
    the speed: dt = -dv / (decel + drag v^2), dx = v dt."""
    v = np.linspace(speed, 0.0, n + 1)
    h = -speed / n
    rates = lambda v: np.stack([-np.ones_like(v), -v]) / (decel + drag * v * v)  # noqa: E731
    steps = h / 6 * (rates(v[:-1]) + 4 * rates(v[:-1] + h / 2) + rates(v[1:]))
    t, x = np.concatenate([np.zeros((2, 1)), np.cumsum(steps, axis=1)], axis=1)
    return t, x, v


def most_off(v, decel, drag):
    """By how much the speed in a piece is below the ball's at the most [m/s]."""
    bends = 2 * drag * v * (decel + drag * v * v)
    return bends ** (1 / 3) * (81 * LAG / 2) ** (2 / 3) / 6


@pytest.mark.parametrize(("mu_r", "drag"), LAWS)
def test_time_and_place_of_rest_and_the_way_there(mu_r, drag):
    rng = np.random.default_rng(1)
    for speed in (1e-3, 0.05, *rng.uniform(0.1, 7, 8)):
        turn = rng.uniform(-np.pi, np.pi)
        ahead = np.array([np.cos(turn), np.sin(turn)])
        shot = rolled(speed * ahead, drag, mu_r=mu_r)
        t, x, v = integrated(speed, mu_r * G, drag, 20_000)
        assert shot.positions[0] == pytest.approx(x[-1] * ahead, rel=1e-11, abs=1e-13)
        assert shot.duration == pytest.approx(t[-1], rel=1e-11)
        t, x, v = t[::10], x[::10], v[::10]
        r, u, w = shot.at(t)
        behind = x - r[:, 0] @ ahead
        assert behind.min() > -1e-10 and behind.max() < 1.01 * LAG
        assert np.abs(r[:, 0] @ (-ahead[1], ahead[0])).max() < 1e-13 * max(1.0, x[-1])
        slower = v - u[:, 0] @ ahead
        assert slower.max() < most_off(speed, mu_r * G, drag) > -2.9 * slower.min()
        assert w[:, 0, :2] * R == pytest.approx(u[:, 0, ::-1] * (-1, 1), abs=1e-12)
        assert set(shot.events["kind"][:-1]) <= {EventKind.BEND} and shot.events["kind"][-1] == EventKind.STOP


def test_how_many_pieces_a_roll_takes():
    for speed, least, most in ((0.05, 1, 1), (0.3, 4, 6), (1.0, 20, 24), (5.0, 115, 130)):
        assert least <= len(rolled((speed, 0.0), 0.015).events) <= most
    # one is enough where 4/81 drag v^4 (1 + drag v^2 / decel) / decel^2 is below the bound
    slow = (81 * LAG * DECEL**2 / (4 * 0.015)) ** 0.25
    assert [len(rolled((share * slow, 0.0), 0.015).events) > 1 for share in (0.999, 1.001)] == [False, True]


def test_without_drag_nothing_changes_and_a_tiny_one_changes_little():
    plain = rolled((1.0, 1.0), 0.0)
    named = sn.simulate([(0, 0)], [(1.0, 1.0)], [(-1 / R, 1 / R, 0)], None)
    for shot in (named, rolled((1.0, 1.0), 5e-324), rolled((1.0, 1.0), 1e-18)):
        assert np.array_equal(shot.segments, plain.segments)
    for tiny in (1e-16, 1e-15, 1e-12):
        shot = rolled((1.0, 1.0), tiny)
        assert shot.positions == pytest.approx(plain.positions, rel=max(1e-14, 20 * tiny))
        assert len(shot.events) == 1


def test_a_ball_in_the_way_is_met_when_the_path_comes_there():
    rng = np.random.default_rng(4)
    for _ in range(30):
        speed = rng.uniform(0.3, 5)
        t, x, v = integrated(speed, DECEL, 0.015, 20_000)
        way, side = rng.uniform(0.02, 0.95) * x[-1], rng.uniform(-1.2, 1.2)
        other = (way + 2 * R * np.cos(side), 2 * R * np.sin(side))
        if np.hypot(*other) < 2.1 * R:
            continue
        balls = [(0, 0), other], [(speed, 0), (0, 0)], [(0, speed / R, 0), (0, 0, 0)]
        shot = sn.simulate(*balls, None, {"roll_drag": 0.015})
        hit = shot.events["time"][shot.events["kind"] == EventKind.BALL_BALL][0]
        then = np.interp(way, x, v)
        assert -1e-7 < hit - np.interp(way, x, t) < 1.05 * LAG / then


def test_shots_of_many_balls_keep_their_laws():
    rng, table = np.random.default_rng(6), Table.preset("match")
    code = contact.parse_fidelity("standard")
    p = np.array([random_table(rng, 10) for _ in range(40)])
    v, w = rng.uniform(-3, 3, (40, 10, 2)), rng.uniform(-60, 60, (40, 10, 3))
    v[:20, 1:], w[:20, 1:] = 0.0, 0.0
    for field, value in (("roll_drag", 0.015), ("roll_drag", 0.3), ("nap", 0.001), ("nap", -0.03)):
        physics = sn.Physics.preset("match", **{field: value})
        found = invariants.play((p, v, w, np.ones((40, 10), bool)), physics, table, code)
        assert (found.status == 0).all()
        worst = dict(zip(invariants.NAMES, found.worst.max(0), strict=True))
        assert (found.worst.max(0) <= allowed("standard")).all(), worst
        check_shot(sn.simulate(p[0], v[0], w[0], "match", physics))
