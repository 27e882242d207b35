"""Does a ball whose resistance grows with its speed roll as its equation of motion says? Against independent
integrations of dv/dt = -(mu_r g + roll_drag v^2)."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import snooker_env as sn
from benchmarks._common import invariants
from benchmarks.fuzz import allowed
from snooker_env import EventKind, Table
from snooker_env.physics.cloth import AX, AY, ROLL, SEGMENT_BALL, SEGMENT_STATE, T0, VX, VY, X, Y
from snooker_env.physics.impact import contact
from snooker_env.tasks.kernel_arrays import CueLaw
from snooker_env.tasks.lines import new_work
from snooker_env.tasks.pot_aim import solved_aim
from tests.kernels import from_python
from tests.oracles import tiny_steps
from tests.physics.test_shots import check_shot, random_table, struck

R, G, MU_R = 0.02625, 9.81, 0.0127
DECEL = MU_R * G
LAG = 2e-6
"""m that a ball in a piece may be behind its place."""
LAWS = [(MU_R, 0.015), (0.0043, 0.0151), (MU_R, 1e-5), (0.05, 0.3), (1e-3, 1.0)]


def rolled(v, drag, start=(0.0, 0.0), table=None, **fields):
    w = (-v[1] / R, v[0] / R, 0.0)
    return sn.simulate([start], [v], [w], table, {"roll_drag": drag, **fields})


def velocity_before(shot, ball, time):
    """Velocity (2,) of a ball just before its event at that time."""
    row = shot.segments[(shot.segments[:, SEGMENT_BALL] == ball) & (shot.segments[:, T0] < time)][-1]
    return row[[VX, VY]] + row[[AX, AY]] * (time - row[T0])


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


def test_pieces_begin_where_the_ball_is_and_end_at_its_speed():
    for speed in (0.4, 5.0):
        shot = rolled((0.0, speed), 0.015)
        t, x, v = integrated(speed, DECEL, 0.015, 20_000)
        ends = shot.events["time"][:-1]
        # (between the steps of the integration: a cubic, by both places and speeds)
        k = np.searchsorted(t, ends) - 1
        h, s = t[k + 1] - t[k], (ends - t[k]) / (t[k + 1] - t[k])
        place = x[k] + (x[k + 1] - x[k]) * s * s * (3 - 2 * s)
        place += h * s * (1 - s) * (v[k] * (1 - s) - v[k + 1] * s)
        assert shot.at(ends)[0][:, 0, 1] == pytest.approx(place, abs=1e-11)
        last = np.array([velocity_before(shot, 0, end)[1] for end in ends])
        assert last == pytest.approx(np.interp(ends, t, v), abs=1e-8)
        jumps = last - shot.at(ends)[1][:, 0, 1]
        assert jumps.min() > 0 and jumps.max() < most_off(speed, DECEL, 0.015)


def test_how_many_pieces_a_roll_takes():
    for speed, least, most in ((0.05, 1, 1), (0.3, 4, 6), (1.0, 20, 24), (5.0, 115, 130)):
        assert least <= len(rolled((speed, 0.0), 0.015).events) <= most


def test_one_piece_to_rest_is_enough_where_it_strays_by_no_more():
    """A slow ball's: 4/81 drag v^4 (1 + drag v^2 / decel) / decel^2 is below the bound."""
    drag = 0.015
    slow = (81 * LAG * DECEL**2 / (4 * drag)) ** 0.25
    assert len(rolled((0.999 * slow, 0.0), drag).events) == 1 < len(rolled((1.001 * slow, 0.0), drag).events)


def test_the_speed_never_rises():
    for speed, drag in ((0.3, 0.015), (3.0, 0.03), (50.0, 1.0)):
        shot = rolled((speed, 0.0), drag)
        v = shot.at(np.linspace(0, shot.duration, 20_001))[1][:, 0, 0]
        assert np.diff(v).max() <= 1e-14 * speed


def test_without_drag_nothing_changes_and_a_tiny_one_changes_little():
    plain = rolled((1.0, 1.0), 0.0)
    named = sn.simulate([(0, 0)], [(1.0, 1.0)], [(-1 / R, 1 / R, 0)], None)
    for shot in (named, rolled((1.0, 1.0), 5e-324), rolled((1.0, 1.0), 1e-18)):
        assert np.array_equal(shot.segments, plain.segments)
    for tiny in (1e-16, 1e-15, 1e-12):
        shot = rolled((1.0, 1.0), tiny)
        assert shot.positions == pytest.approx(plain.positions, rel=max(1e-14, 20 * tiny))
        assert len(shot.events) == 1


def test_extremes_end():
    for speed, drag, mu_r in (
        (1000.0, 1.0, 1e-3),
        (1000.0, 1e-9, 1e-3),
        (1e-9, 1.0, 1.0),
        (1e-13, 1.0, MU_R),
    ):
        shot = rolled((speed, 0.0), drag, mu_r=mu_r)
        t, x, _ = integrated(speed, mu_r * G, drag, 400_000)
        assert shot.positions[0, 0] == pytest.approx(x[-1] if speed > 1e-12 else 0.0, rel=1e-6)
        assert shot.duration == pytest.approx(t[-1] if speed > 1e-12 else 0.0, rel=1e-6)
        assert len(shot.events) < 10_000


def test_a_ball_that_slides_has_none_and_rolls_as_one_that_begins_there():
    plain, drags = (
        sn.simulate([(0, 0)], [(2.0, 0)], np.zeros((1, 3)), None, {"roll_drag": k}) for k in (0.0, 0.015)
    )
    begins = plain.events["time"][0]
    assert drags.events["time"][0] == begins and drags.events["kind"][0] == EventKind.ROLL
    assert np.array_equal(plain.at(0.9 * begins)[0], drags.at(0.9 * begins)[0])
    t, x, _ = integrated(10 / 7, DECEL, 0.015)
    assert drags.positions[0, 0] - plain.at(begins)[0][0, 0] == pytest.approx(x[-1], rel=1e-11)
    assert drags.duration - begins == pytest.approx(t[-1], rel=1e-11)


def test_left_is_the_mirror_of_right_to_the_bit():
    for y in (0.3, 1.4):
        one, two = (rolled((2.1 * s, y), 0.015, (0.1 * s, 0.2), "match") for s in (1, -1))
        assert np.array_equal(one.events["time"], two.events["time"]) and len(one.events) > 10
        assert np.array_equal(one.positions * (-1, 1), two.positions)


def test_a_ball_in_the_way_is_met_when_the_path_comes_there():
    rng = np.random.default_rng(4)
    for _ in range(30):
        speed = rng.uniform(0.3, 5)
        t, x, v = integrated(speed, DECEL, 0.015, 20_000)
        way, side = rng.uniform(0.02, 0.95) * x[-1], rng.uniform(-1.2, 1.2)
        other = (way + 2 * R * np.cos(side), 2 * R * np.sin(side))
        if np.hypot(*other) < 2.1 * R:
            continue
        shot = sn.simulate(
            [(0, 0), other], [(speed, 0), (0, 0)], [(0, speed / R, 0), (0, 0, 0)], None, {"roll_drag": 0.015}
        )
        hit = shot.events["time"][shot.events["kind"] == EventKind.BALL_BALL][0]
        then = np.interp(way, x, v)
        assert -1e-7 < hit - np.interp(way, x, t) < 1.05 * LAG / then
        assert velocity_before(shot, 0, hit)[0] == pytest.approx(then, abs=most_off(speed, DECEL, 0.015))


@pytest.mark.parametrize("seed", range(9))
def test_agrees_with_tiny_steps(seed):
    """2 to 4 balls on unbounded cloth: at rest within 1 mm. What the speed in a piece errs by, 1e-4 of it, is
    twice as much of the way."""
    rng = np.random.default_rng([seed, 7])
    n = 2 + seed % 3
    while True:
        p = rng.uniform(-0.3, 0.3, (n, 2))
        if (np.hypot(*(p[:, None] - p[None]).transpose(2, 0, 1)) + 9 * np.eye(n)).min() > 2 * R + 5e-3:
            break
    to = p[1] - p[0]
    aim = np.arctan2(to[1], to[0]) + rng.uniform(-0.5, 0.5) * 2 * R / np.hypot(*to)
    v, w = struck(n, rng.uniform(0.5, 4.0), aim, side=rng.uniform(-0.3, 0.3), top=rng.uniform(0.0, 0.4))
    constants = {"mu_s": 0.21, "mu_r": MU_R, "spin_decel": 22.0, "roll_drag": 0.02, "mu_bb": 0.05}
    want = tiny_steps.simulate(p, v, w, R=R, M=0.1406, g=G, e=0.89, **constants, dt=2e-4)
    shot = sn.simulate(p, v, w, None, constants, "reference")
    assert np.abs(shot.positions - want).max() < 1e-3
    without = sn.simulate(p, v, w, None, constants | {"roll_drag": 0.0})
    assert np.abs(without.positions - want).max() > 0.01
    check_shot(shot)


def bounced(r, v, w, physics, table, most=12):
    """One ball's place at rest on a table with four noses, by DOP853 from phase to phase."""
    slides, slows, drag = physics.mu_s * G, physics.mu_r * G, physics.roll_drag
    half = table.bounds[:, 1] - physics.R
    z, hits = np.array([*r, *v, *w]), 0
    while True:
        slip = lambda z: np.array([z[2] - physics.R * z[5], z[3] + physics.R * z[4]])  # noqa: E731
        sliding = bool(np.hypot(*slip(z)) > 1e-9)

        def rate(_, z, sliding=sliding, slip=slip):
            if sliding:
                u = slip(z)
                a = -slides * u / np.hypot(*u)
                turns = 2.5 / physics.R * np.array([a[1], -a[0]])
            else:
                speed = np.hypot(z[2], z[3])
                a = -(slows + drag * speed * speed) * z[2:4] / speed
                turns = np.array([-a[1], a[0]]) / physics.R
            return [z[2], z[3], *a, *turns, 0.0]

        ends = [lambda _, z, s=sliding, slip=slip: np.hypot(*(slip(z) if s else z[2:4])) - 1e-9]
        for axis in (0, 1):
            for side in (-1, 1):
                ends.append(lambda _, z, axis=axis, side=side: side * z[axis] - half[axis])
        for end in ends:
            end.terminal, end.direction = True, 1
        ends[0].direction = -1
        out = solve_ivp(rate, (0, 1e3), z, "DOP853", events=ends, rtol=1e-11, atol=1e-13)
        which = next(k for k, at in enumerate(out.t_events) if len(at))
        z = out.y[:, -1].copy()
        # spin about the vertical decays by itself
        z[6] = np.sign(z[6]) * max(0.0, abs(z[6]) - physics.spin_decel * out.t[-1])
        if which == 0 and not sliding:
            return z[:2], hits
        if which == 0:
            z[4], z[5] = -z[3] / physics.R, z[2] / physics.R
            continue
        hits += 1
        normal = np.zeros(3)
        normal[(which - 1) // 2] = (-1, 1)[(which - 1) % 2]
        after, spin = sn.collide_cushion(np.array([*z[2:4], 0.0]), z[4:], normal, physics, "reference")
        z[2:4], z[4:] = after[:2], spin
        assert hits < most


@pytest.mark.parametrize("seed", range(6))
def test_a_ball_off_cushions_ends_where_the_integrated_one_does(seed):
    rng = np.random.default_rng([seed, 11])
    table = Table.preset("carom")
    physics = sn.Physics(R=table.ball_radius, mu_r=0.0043, roll_drag=0.0151, tables=False)
    speed, turn = rng.uniform(1.5, 5), rng.uniform(-np.pi, np.pi)
    v = speed * np.array([np.cos(turn), np.sin(turn)])
    w = np.array([-v[1] / physics.R, v[0] / physics.R, rng.uniform(-30, 30)])
    want, hits = bounced((0.1, 0.2), v, w, physics, table)
    shot = sn.simulate([(0.1, 0.2)], [v], [w], table, physics, "reference")
    assert (shot.events["kind"] == EventKind.CUSHION).sum() == hits > 1
    assert np.hypot(*(shot.positions[0] - want)) < 1e-3


def test_shots_of_many_balls_keep_their_laws():
    rng, table = np.random.default_rng(6), Table.preset("match")
    code = contact.parse_fidelity("standard")
    for drag in (0.015, 0.3):
        physics = sn.Physics.preset("match", roll_drag=drag)
        p = np.array([random_table(rng, 10) for _ in range(40)])
        v, w = rng.uniform(-3, 3, (40, 10, 2)), rng.uniform(-60, 60, (40, 10, 3))
        v[:20, 1:], w[:20, 1:] = 0.0, 0.0
        found = invariants.play((p, v, w, np.ones((40, 10), bool)), physics, table, code)
        assert (found.status == 0).all()
        worst = dict(zip(invariants.NAMES, found.worst.max(0), strict=True))
        assert (found.worst.max(0) <= allowed("standard")).all(), worst
        for k in range(4):
            check_shot(sn.simulate(p[k], v[k], w[k], "match", physics))


def test_a_roll_is_straight():
    shot = rolled((1.0, 0.4), 0.015)
    rows = shot.segments[:-1]
    assert (rows[:, SEGMENT_STATE] != ROLL).any() and len(rows) == len(shot.events)
    (x, y), end = rows[:, [X, Y]].T, shot.positions[0]
    assert np.abs(x * end[1] - y * end[0]).max() < 1e-12


def test_a_solved_aim_holds_with_drag():
    aim_for = from_python(solved_aim)
    physics = sn.Physics(roll_drag=0.03)
    balls, pocket = np.array([(-0.62, 0.05), (-0.12, 0.03)]), np.array([0.889, 0.0])
    line = (pocket - balls[1]) / np.linalg.norm(pocket - balls[1])
    code, steps = contact.parse_fidelity("standard")
    law = CueLaw(physics.pack(), physics.end_mass_ratio, code, steps, 0.5, np.empty(0))
    aim = aim_for(
        balls,
        np.ones(2, bool),
        1,
        tuple(pocket),
        tuple(balls[1] - 2 * R * line),
        (1.2, 0.0, 0.0, 0.0),
        law,
        new_work(),
    )
    v, w = sn.strike(1.2, aim, physics=physics)
    shot = sn.simulate(balls, [v[:2], (0, 0)], [w, (0, 0, 0)], None, physics)
    assert np.hypot(*(shot.at(np.linspace(0, shot.duration, 40_000))[0][:, 1] - pocket).T).min() < 2e-5
