"""How does a shot end, and what is at its ends? Rest for ever, spin that nothing stops, the fastest and slowest balls, no balls."""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env import EventKind, Table
from tests.physics.test_shots import check_shot, random_table

Z = (0.0, 0.0, 0.0)


def test_after_the_end_everything_is_at_rest_however_late_one_asks():
    p = [(0.0, 0.0), (0.3, 0.01), (0.8, 1.7), (0.0, 5.0)]
    v = [(2.0, 0.5), (0.0, 0.0), (0.6, 0.6), (0.0, 0.0)]
    w = [(0, 0, 80.0), (0, 0, 0), (0, 0, 0), (9.0, 9.0, 9.0)]
    shot = sn.simulate(p, v, w, on_table=[True, True, True, False])
    assert shot.potted.tolist() == [-1, -1, 3, -1]
    for t in (shot.duration, shot.duration + 1e-9, 100.0, 1e9, 1e300):
        r, v, w = shot.at(t)
        assert np.array_equal(r, shot.positions) and not v.any() and not w.any()
    assert r[3].tolist() == [0.0, 5.0]  # what was never on the table lies where it was given
    many = shot.at([0.0, 100.0])
    assert np.array_equal(many[0][1], shot.positions) and many[1][0].any() and not many[1][1].any()
    assert not many[2][1].any()
    fall = shot.events["time"][shot.events["kind"] == EventKind.POT][0]
    assert np.array_equal(shot.at(fall)[0][2], shot.positions[2]) and not shot.at(fall)[1][2].any()
    assert shot.at(fall - 1e-6)[1][2].any()
    corner = Table.preset("match").falls[3]
    assert np.hypot(*(shot.positions[2] - corner[:2])) == pytest.approx(corner[2], abs=1e-12)


def test_a_spin_has_ended_at_the_very_end_of_the_shot():
    for spin in np.random.default_rng(2).uniform(1, 90, 30):
        shot = sn.simulate([(0.0, 0.0)], [(0.0, 0.0)], [(0.0, 0.0, spin)])
        assert shot.duration == pytest.approx(spin / 22) and not shot.at(shot.duration)[2].any()
        assert shot.at(shot.duration - 1e-9)[2].any()


def test_without_spin_decay_a_shot_ends_when_nothing_moves_and_spin_stays():
    spinning = sn.simulate([(0.0, 0.0)], [(0.0, 0.0)], [(0.0, 0.0, 30.0)], physics={"spin_decel": 0.0})
    assert spinning.duration == 0.0 and spinning.at(1e6)[2].tolist() == [[0.0, 0.0, 30.0]]
    spinning = [(0.0, 0.0, 30.0)]
    shot = sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], spinning, physics={"spin_decel": 0.0}, table=None)
    last = sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], np.zeros((1, 3)), physics={"spin_decel": 0.0}, table=None)
    assert shot.duration == last.duration == shot.events["time"][-1] > 5
    for t in (shot.duration, 100.0, 1e9):
        r, v, w = shot.at(t)
        assert np.array_equal(r, shot.positions) and not v.any() and w.tolist() == [[0.0, 0.0, 30.0]]
    slow = sn.simulate([(0.0, 0.0)], [(0.0, 0.0)], [(0.0, 0.0, 30.0)], physics={"spin_decel": 1.0})
    assert slow.duration == 30.0


def test_the_fastest_and_the_slowest_balls():
    """Shots at the bounds of speed and spin keep their energy and stay apart; a speed that no path shows does not move a ball."""
    rng = np.random.default_rng(3)
    for table in ("match", None):
        p = random_table(rng, 6)
        v, w = rng.uniform(-1, 1, (6, 2)), rng.uniform(-1, 1, (6, 3))
        check_shot(sn.simulate(p, 1000 * v / np.abs(v).max(), 1e5 * w / np.abs(w).max(), table))
    for speed in (5e-324, 1e-300, 1e-160, 1e-13):
        shot = sn.simulate([(0.1, 0.2)], [(speed, -speed)], [(speed, 0.0, speed)])
        assert shot.positions.tolist() == [[0.1, 0.2]] and shot.duration < 1e-10 and not shot.at(1.0)[1].any()
        v, w = sn.collide_cushion((speed, 0, 0), Z, (1, 0, 0))
        assert np.isfinite(v).all() and np.isfinite(w).all() and abs(v[0]) <= speed
        out = sn.collide_balls((speed, 0, 0), Z, Z, Z, (1, 0, 0))
        assert all(
            np.isfinite(a).all() and np.abs(a[:2]).max() <= max(speed, 100 * speed * k)
            for k, a in enumerate(out)
        )
    still, moves = (sn.simulate([(0.0, 0.0)], [(s, 0.0)], np.zeros((1, 3))).events for s in (1e-13, 1e-9))
    assert len(still) == 0 and len(moves) == 2
    assert sn.simulate([(-0.0, 0.0)], [(-0.0, 0.0)], np.full((1, 3), -0.0)).duration == 0.0


def test_no_tables_at_all_are_played_too():
    none = sn.simulate_batch(np.zeros((0, 2, 2)), np.zeros((0, 2, 2)), np.zeros((0, 2, 3)), events=True)
    assert none.positions.shape == (0, 2, 2) and none.events == [] and none.duration.shape == (0,)
    shot = sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], np.zeros((1, 3)))
    assert [a.shape for a in shot.at([])] == [(0, 1, 2), (0, 1, 2), (0, 1, 3)]
