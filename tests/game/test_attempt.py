"""Is the closest approach of the cue ball to a ball on exact?"""

import numpy as np
import pytest
from scipy import ndimage

import snooker_env as sn
from snooker_env.game import attempt
from snooker_env.game.attempt import ATTEMPT_GAP
from snooker_env.game.balls import BLACK, CUE, N_BALLS, YELLOW, BallOn, mask_of
from snooker_env.game.shut_in import shut_in
from snooker_env.geometry import BALL_RADIUS as R
from snooker_env.geometry import HALF_LENGTH, HALF_WIDTH
from snooker_env.physics import cloth
from snooker_env.physics.table import Table
from snooker_env.tasks.box_actions import MAX_SPEED, MIN_SPEED
from tests.game.geometry_cases import lie
from tests.kernels import from_python
from tests.tables import frame_state

closest_approach = from_python(attempt.closest_approach)
nearest_on_piece = from_python(attempt.nearest_on_piece)


def test_one_piece_against_dense_sampling():
    rng = np.random.default_rng(3)
    for _ in range(100):
        d, v, a = rng.normal(0, 0.5, 2), rng.normal(0, 1, 2), rng.normal(0, 2, 2) * (rng.random() < 0.8)
        T = rng.uniform(0.01, 2)
        t = np.linspace(0, T, 20001)[:, None]
        sampled = np.hypot(*(d + v * t + 0.5 * a * t * t).T).min()
        got = nearest_on_piece(*d, *v, *a, T)
        assert got <= sampled + 1e-12 and got == pytest.approx(sampled, abs=1e-3)


def sampled_gap(segments, until, places):
    """The smallest gap from the cue ball's path, at 2,000 instants of each piece, to balls at ``places``."""
    own = segments[segments[:, cloth.SEGMENT_BALL] == CUE]
    ends = np.minimum(np.append(own[1:, cloth.T0], np.inf), np.minimum(own[:, cloth.T_END], until))
    best = np.inf
    for piece, end in zip(own, ends, strict=True):
        if end >= piece[cloth.T0]:
            t = np.linspace(0.0, end - piece[cloth.T0], 2000)[:, None]
            path = piece[[cloth.X, cloth.Y]] + piece[[cloth.VX, cloth.VY]] * t
            path = path + 0.5 * piece[[cloth.AX, cloth.AY]] * t * t
            best = min(best, np.hypot(*(path[:, None] - places).T).min())
    return best - 2 * R


def test_shots_off_cushions_against_dense_sampling():
    """Two reds that are on, and a black that may be struck first; side, top and several cushions."""
    rng, met = np.random.default_rng(4), {"black": 0, "none": 0, "near": 0}
    positions, on_table = lie({CUE: (0.1, -1.2), 1: (0.5, 1.3), 2: (-0.6, 0.9), BLACK: (0.0, 0.5)})
    for _ in range(80):
        velocities, spins = np.zeros((N_BALLS, 2)), np.zeros((N_BALLS, 3))
        v, spins[CUE] = sn.strike(*rng.uniform((0.5, 0, -0.3, -0.3), (5, 2 * np.pi, 0.3, 0.3)))
        velocities[CUE] = v[:2]
        shot = sn.simulate(positions, velocities, spins, on_table=on_table)
        hits = shot.events[(shot.events["kind"] == 0) & (shot.events["i"] == CUE)]
        until = hits["time"][0] if len(hits) else shot.duration
        path = shot.segments, len(shot.segments), until
        got = closest_approach(*path, positions, on_table, mask_of([1, 2]), R)
        assert got == pytest.approx(sampled_gap(shot.segments, until, positions[[1, 2]]), abs=2e-4)
        if len(hits) and hits["j"][0] in (1, 2):
            assert abs(got) < 1e-9
        met["black"] += bool(len(hits)) and hits["j"][0] == BLACK
        met["none"] += not len(hits)
        met["near"] += 1e-6 < got <= ATTEMPT_GAP
    assert min(met.values()) >= 2


# Where no ball on can be hit


def ring(radius, at=(0.0, 0.0), turn=0.0, balls=range(YELLOW, N_BALLS)):
    """Balls evenly around a place, the first of them in the direction ``turn``."""
    angles = turn + 2 * np.pi * np.arange(len(balls)) / len(balls)
    each = zip(balls, angles, strict=True)
    return {i: (at[0] + radius * np.cos(a), at[1] + radius * np.sin(a)) for i, a in each}


def is_shut_in(places, on):
    table = Table.preset("match")
    return bool(shut_in(*lie(places), mask_of(on), table.noses, table.jaws, R))


def flooded(places, on, reach, h=0.006):
    """Whether no ball on is reached by flooding a grid from the cue ball; balls not on bar a disc of ``reach``."""
    far = np.array([HALF_WIDTH, HALF_LENGTH]) - R
    x, y = np.meshgrid(*(np.arange(-a, a, h) for a in far), indexing="ij")
    away = {ball: np.hypot(x - at[0], y - at[1]) for ball, at in places.items()}
    free = np.all([away[ball] >= reach for ball in places if ball != CUE and ball not in on], axis=0)
    rooms, _ = ndimage.label(free)
    mine = rooms.ravel()[np.where(free, away[CUE], 9.0).argmin()]
    return not any((free & (rooms == mine) & (away[ball] < 2 * R + 2 * h)).any() for ball in on)


def test_who_is_shut_in_against_a_flood():
    """Random crowds: with thinner balls a flood says who is shut in at least, with thicker ones who is free."""
    rng, found = np.random.default_rng(6), [0, 0]
    for trial in range(30):
        side = (HALF_WIDTH - R) * rng.choice([-1, 1]) if trial % 2 else rng.uniform(-0.8, 0.8)
        places = {CUE: (side, rng.uniform(-1.5, 1.5))}
        for ball in (*range(YELLOW, N_BALLS), 1, 2):
            for _ in range(60):
                at = np.array(places[CUE]) + rng.normal(0, 0.06 if ball > 2 else 0.3, 2)
                apart = min(np.hypot(*(at - other)) for other in places.values())
                if apart >= 2 * R and np.all(np.abs(at) <= (HALF_WIDTH - R, HALF_LENGTH - R)):
                    places[ball] = tuple(at)
                    break
        on = [ball for ball in (1, 2) if ball in places]
        if on and flooded(places, on, 2 * R - 0.006):
            assert is_shut_in(places, on)
            found[0] += 1
        elif on and not flooded(places, on, 2 * R + 0.003):
            assert not is_shut_in(places, on)
            found[1] += 1
    assert min(found) >= 4


CAGES = [{CUE: (0, 0), 1: (0, 1)} | ring(0.0526), {CUE: (0, 0), 1: (0, 1)} | ring(0.07, turn=0.2)]


@pytest.mark.parametrize("cage", CAGES)
@pytest.mark.parametrize(
    ("speed", "aim", "miss"), [(2.5, 92.0, False), (0.3, 90.0, True), (6.0, -90.0, True)]
)
def test_a_shut_in_striker_attempts_what_would_reach_a_ball_on_without_the_balls_between(
    cage, speed, aim, miss
):
    """S3 R14(a). Straight away the cue ball would come back to the red; it is not played toward it."""
    env = frame_state(sn.match_env(aim="absolute", miss="attempt"), cage, {"ball_on": BallOn.RED})
    a = 2 * (speed - MIN_SPEED) / (MAX_SPEED - MIN_SPEED) - 1
    env.step(np.array([a, 0, 0, aim / 180, 0, 0, 0], np.float32))
    assert env.frame.phase == "choice" and env.frame.scores[1] >= 4
    assert env.frame.miss_called == miss


def test_a_striker_who_can_get_out_must_come_near():
    """One ball less in the cage: there is a way over cushions, so the blow at the balls between is a miss."""
    cage = {ball: at for ball, at in (CAGES[0] | ring(0.09)).items() if ball != 19}
    env = frame_state(sn.match_env(aim="absolute", miss="attempt"), cage, {"ball_on": BallOn.RED})
    env.step(np.array([0.7, 0, 0, 0.5, 0, 0, 0], np.float32))
    assert env.frame.miss_called
