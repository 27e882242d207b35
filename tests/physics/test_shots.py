"""Is a whole shot right? Against an integrator of tiny steps, invariants after every event, and the shots that break other engines."""

import hashlib

import numpy as np
import pytest

import snooker_env as sn
from benchmarks import fuzz
from snooker_env import EventKind, Table
from snooker_env.game.balls import SPOTS
from tests.flights import calm

R = 0.02625
D = 2 * R
EXACT = np.nextafter(D, 1)


def struck(n, speed, aim, **tip):
    """Velocities and spins of n balls of which the first has just been struck."""
    v, w = np.zeros((n, 2)), np.zeros((n, 3))
    v3, w[0] = sn.strike(speed, aim, **tip)
    v[0] = v3[:2]
    return v, w


def gaps(shot, times):
    """Least gap [m] of any two balls in play at each time."""
    falls = {int(e["i"]): e["time"] for e in shot.events if e["kind"] == EventKind.POT}
    out = []
    for t, r in zip(times, shot.at(times)[0], strict=True):
        here = r[[i for i in range(len(r)) if t < falls.get(i, np.inf)]]
        far = np.hypot(*(here[:, None] - here[None]).transpose(2, 0, 1)) + 9 * np.eye(len(here))
        out.append(far.min() - D if len(here) > 1 else 9.0)
    return np.array(out)


def energies(shot):
    """Energy per mass just after the start and every event, but while a ball is in the air over a pocket."""
    times = np.concatenate([[0.0], shot.events["time"]])
    _, v, w = shot.at(times[calm(shot, times)])
    return 0.5 * (v**2).sum((1, 2)) + 0.2 * R * R * (w**2).sum((1, 2))


def check_shot(shot):
    """What holds for every shot."""
    times = shot.events["time"]
    assert (np.diff(times) >= 0).all()
    assert np.isfinite(shot.positions).all()
    if len(times):
        assert gaps(shot, times).min() > -1e-9
        e = energies(shot)
        assert (np.diff(e) <= 1e-12 * e[0]).all()
    _, v, w = shot.at(shot.duration)
    assert (v == 0).all()
    assert np.abs(w).max() < 1e-9


def random_table(rng, n):
    """n balls on the table, clear of each other and of cushions."""
    while True:
        p = rng.uniform([-0.85, -1.74], [0.85, 1.74], (n, 2))
        apart = np.hypot(*(p[:, None] - p[None]).transpose(2, 0, 1)) + 9 * np.eye(n)
        if apart.min() > D + 1e-3 and (np.abs(p[:, 1]) > 0.1).all():
            return p


# invariants


@pytest.mark.parametrize("fidelity", ["fast", "standard", "reference", "euler:50"])
@pytest.mark.parametrize("physics", ["paper", "match"])
def test_random_22_ball_shots(fidelity, physics):
    rng = np.random.default_rng(17)
    for _ in range(25):
        p = random_table(rng, 22)
        tip = rng.uniform(-0.35, 0.35, 2)
        start = struck(22, rng.uniform(0.5, 6), rng.uniform(-np.pi, np.pi), side=tip[0], top=tip[1])
        shot = sn.simulate(p, *start, "match", physics, fidelity)
        check_shot(shot)
        assert set(np.flatnonzero(~shot.on_table)) == set(np.flatnonzero(shot.potted >= 0))
        inside = np.abs(shot.positions[shot.on_table]) <= np.array([0.889, 1.7845]) - R + 1e-9
        mouth = np.abs(np.abs(shot.positions[shot.on_table][:, 1]) - [[0.0], [1.7845]]).min(0) < 0.13
        assert (inside.all(1) | mouth).all()


@pytest.mark.parametrize("speed", [2.0, 4.0, 6.0])
def test_break_off_from_the_touching_rack(speed):
    p = SPOTS.copy()
    for offset in (0.0, 0.013, 0.03):
        target = p[15] + [offset, 0]  # the near corner of the pack, past the blue
        shot = sn.simulate(p, *struck(22, speed, np.arctan2(*(target - p[0])[::-1]), side=0.2))
        check_shot(shot)
        moved = np.hypot(*(shot.positions - p).T) > 1e-3
        assert moved[:16].sum() >= 5
        assert len(shot.events) < 2000


def test_same_input_same_bits_single_batch_and_threads():
    rng = np.random.default_rng(5)
    p = np.array([random_table(rng, 22) for _ in range(24)])
    v, w = np.zeros((24, 22, 2)), np.zeros((24, 22, 3))
    for k in range(24):
        v[k], w[k] = struck(22, rng.uniform(1, 6), rng.uniform(-3, 3), side=0.2, top=-0.2)
    one = sn.simulate_batch(p, v, w, threads=1, events=True)
    two = sn.simulate_batch(p, v, w, threads=2, events=True)
    ends = (b.positions.tobytes() + b.potted.tobytes() + b.duration.tobytes() for b in (one, two))
    digest = [hashlib.sha256(end).hexdigest() for end in ends]
    assert digest[0] == digest[1]
    for k in range(24):
        shot = sn.simulate(p[k], v[k], w[k])
        assert (shot.positions == one.positions[k]).all()
        assert (shot.potted == one.potted[k]).all()
        assert shot.duration == one.duration[k]
        assert (shot.events == one.events[k]).all()


def test_a_long_log_is_complete_in_both_calls():
    """More events than the first guess of the log holds: nothing is lost, in single and in batch."""
    p = np.array([(0.0, 0.0), (EXACT, 0.0)])
    v, w = np.zeros((2, 2)), np.zeros((2, 3))
    w[0] = 0, 300.0, 0  # spin holds the ball against the other: a lasting contact
    shot = sn.simulate(p, v, w, table=None, physics={"e_b": 0.0})
    batch = sn.simulate_batch(p[None], v[None], w[None], None, {"e_b": 0.0}, events=True)
    assert len(shot.events) == len(batch.events[0]) == batch.event_count[0]
    assert (shot.positions == batch.positions[0]).all()
    check_shot(shot)


# contacts at gap zero


@pytest.mark.parametrize("gap", [0.0, 1e-15, 1e-12, 1e-9])
@pytest.mark.parametrize("away", [np.pi, 2.0, np.pi / 2 + 1e-9, np.pi / 2])
def test_a_touching_ball_played_away_from_stays(gap, away):
    p = np.array([(0.0, 0.0), (EXACT + gap, 0.0)])
    for tip in ({}, {"side": 0.3}, {"top": 0.4}, {"top": -0.4}):
        for turn in (1, -1):
            balls = p, *struck(2, 2.0, turn * away, **tip)
            shot = sn.simulate(*balls, table=None, physics={"end_mass_ratio": 1e9})
            if tip.get("top") == -0.4 or (tip.get("side") and away < 2.0):
                check_shot(shot)  # it may come back to the ball; it only must not be dragged along at once
                continue
            assert (shot.positions[1] == p[1]).all()
            assert not (shot.events["kind"] == EventKind.BALL_BALL).any()


@pytest.mark.parametrize("gap", [0.0, 1e-15, 1e-12, 1e-9])
def test_a_ball_frozen_to_a_cushion(gap):
    y = 0.5
    p = np.array([(0.889 - R - gap, y)])
    into = sn.simulate(p, [(1.0, 1.0)], [(0, 0, 0)])
    assert into.events["kind"][0] == EventKind.CUSHION
    assert into.events["time"][0] <= 1e-9
    along = sn.simulate(p, [(0.0, -1.0)], [(1 / R, 0, 0)])
    edge = along.events["time"][along.events["kind"] == EventKind.DROP]
    assert along.at(edge)[0][0, 0, 0] == pytest.approx(p[0, 0], abs=1e-9)
    away = sn.simulate(p, [(-1.0, 0.0)], [(0, 0, 0)])
    assert away.events["kind"][0] == EventKind.ROLL
    # its spin drives it into the cushion as it runs along
    pressed = sn.simulate(p, [(0.0, -1.0)], [(1 / R, 40.0, 0)])
    for shot in (into, along, away, pressed):
        check_shot(shot)
        r = shot.at(np.linspace(0, shot.duration, 500))[0][:, 0]
        along_the_nose = (np.abs(r[:, 1]) > 0.12) & (np.abs(r[:, 1]) < 1.65)  # elsewhere a pocket opens
        assert (r[along_the_nose, 0] <= 0.889 - R + 1e-9).all()
    # pinned against the cushion
    between = sn.simulate(np.array([p[0], p[0] - [EXACT, 0]]), [(0, 0), (2.0, 0.0)], np.zeros((2, 3)))
    check_shot(between)


MOUTH = (
    [(0.862749999, 0.109185)],
    [(4.96568143491017, -0.9211408927790105)],
    [(544.6435139163872, 685.8299623356976, 140.11961898623017)],
)


def test_a_ball_that_comes_out_of_a_middle_pocket_s_mouth_meets_the_nose():
    """Struck off a jaw beyond the nose's line, then driven back into the cushion by its spin: it once went 17 mm into the nose."""
    shot = sn.simulate(*MOUTH, physics={"e_b": 0.5, "e_c": 0.0, "mu_bb": 0.0, "spin_decel": 2.0})
    r = shot.at(np.linspace(0, shot.duration, 3000))[0][:, 0]
    along_the_nose = (np.abs(r[:, 1]) > 0.12) & (np.abs(r[:, 1]) < 1.65)
    assert along_the_nose.sum() > 100
    assert (r[along_the_nose, 0] <= 0.889 - R + 1e-9).all()


def jaw_touching_place(jaw):
    cx, cy, radius, ux, uy, _ = jaw
    return np.array([cx, cy]) + (radius + R) * (1 + 1e-15) * np.array([ux, uy])


@pytest.mark.parametrize("k", range(12))
def test_a_ball_frozen_to_a_jaw(k):
    jaw = Table.preset("match").jaws[k]
    p = jaw_touching_place(jaw)
    n = -jaw[3:5]
    for direction in (n, -n, np.array([-n[1], n[0]]), n + np.array([-n[1], n[0]])):
        shot = sn.simulate([p], [1.5 * direction], [(0, 0, 20)])
        check_shot(shot)
        if direction @ n > 0.5:
            assert shot.events["kind"][0] == EventKind.JAW
    d = p / np.hypot(*p)
    # a ball resting in the jaws
    struck_there = sn.simulate([p - (D + 0.1) * d, p], [1.5 * d, (0, 0)], np.zeros((2, 3)))
    check_shot(struck_there)
    assert struck_there.events["kind"][0] == EventKind.BALL_BALL


def test_two_balls_at_once_follow_the_written_rule():
    """Ties: the lower ball first. Mirrored, the other one is first; both orders give nearly the mirrored result."""
    p = np.array([(-0.3, 0.0), (0.0, R + 1e-4), (0.0, -R - 1e-4)])
    shot = sn.simulate(p, *struck(3, 2.0, 0.0), table=None)
    hits = shot.events[shot.events["kind"] == EventKind.BALL_BALL]
    assert hits["time"][0] == hits["time"][1]
    assert (hits["i"][:2].tolist(), hits["j"][:2].tolist()) == ([0, 0], [1, 2])
    check_shot(shot)


# pockets


def test_a_ball_may_lie_still_in_the_mouth_of_a_pocket():
    """Found in random play: half a millimetre clear of the jaw and of the fall, 10.4 mm past the line of the noses."""
    place = (0.899444997865469, 0.03449467907672166)
    shot = sn.simulate([place, (0.0, 0.0)], [(0.0, 0.0)] * 2, np.zeros((2, 3)))
    assert shot.on_table.all() and tuple(shot.positions[0]) == place
    for wrong in [(0.9145, 0.03449), (0.899444997865469, 0.033), (0.899444997865469, 0.036), (0.91, 0.5)]:
        says = r"positions\[0\] = .*(must be on the table|over a pocket|overlaps)"
        with pytest.raises(ValueError, match=says):
            sn.simulate([wrong, (0.0, 0.0)], [(0.0, 0.0)] * 2, np.zeros((2, 3)))


@pytest.mark.parametrize(
    ("number", "index", "why"),
    [
        (4770, 114, "it lay in a mouth narrower than a ball, behind the ends of both jaws"),
        (4030, 64, "a ball held by edge and jaw met another at once, without end"),
        (4030, 134, "the same"),
    ],
)
def test_a_shot_at_which_the_fuzz_of_a_million_once_failed_comes_to_rest(number, index, why):
    drawn = fuzz.batch(6, number)
    places, velocities = (part[index] for part in drawn.states())
    world = drawn.spins[index], drawn.table, drawn.physics, "standard"
    shot = sn.simulate(places, velocities, *world, max_events=40_000)
    assert shot.duration > 0.0, why
