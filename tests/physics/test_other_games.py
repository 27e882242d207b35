"""Are shots right on tables that are not snooker's? Every preset and some of one's own: pots by index, bounds, energy, their own balls."""

import numpy as np
import pytest

import snooker_env as sn
from benchmarks._common import invariants
from benchmarks.fuzz import allowed
from snooker_env import Pocket, Table
from snooker_env.envs.vector import SnookerVectorEnv
from snooker_env.physics.impact import contact
from snooker_env.physics.table import MOUTH

CORNER = Pocket.corner(mouth=0.12, shelf=0.02, fall_radius=0.065, cut=140, jaw_radius=0.004)
POOL_POCKETS = {"corner": CORNER, "ball_radius": 0.025}
TABLES = {name: Table.preset(name) for name in ("match", "tight", "uk8", "pool9", "carom")} | {
    "square, 4 pockets": Table.rectangular(1.5, 1.5, pockets=4, **POOL_POCKETS),
    "wider than long": Table.rectangular(
        1.0, 1.6, **POOL_POCKETS, middle=Pocket.middle(mouth=0.13, shelf=0.0, fall_radius=0.07, cut=100)
    ),
    "rounded, with facings": Table.rectangular(
        2.0,
        1.0,
        corner=Pocket.corner(mouth=0.15, shelf=0.05, fall_radius=0.07, jaw_radius=0.03),
        middle=Pocket.middle(mouth=0.15, shelf=0.05, fall_radius=0.07, jaw_radius=0.03),
    ),
    "no pockets, any ball": Table.rectangular(1.2, 0.8, pockets=0),
}
WITH_POCKETS = [name for name, table in TABLES.items() if len(table.falls)]


def physics_of(table, name="match"):
    return sn.Physics.preset(name, **table.ball)


def rolling(v, R):
    return np.array([-v[1] / R, v[0] / R, 0.0])


@pytest.mark.parametrize("speed", [0.7, 3.0])
@pytest.mark.parametrize("name", WITH_POCKETS)
def test_a_straight_roll_into_a_pocket_is_potted_there(name, speed):
    """For every index: along the pocket's axis, from 0.3 m in front of the slate's edge, and 5 mm to either side."""
    table = TABLES[name]
    physics, names = physics_of(table), {"left": -1, "right": 1, "bottom": -1, "middle": 0, "top": 1}
    assert len(table.pockets) == len(table.falls)
    for k, (x, y, radius) in enumerate(table.falls):
        end, side = table.pockets[k].split()
        axis = np.array([names[side], names[end]], float)
        axis /= np.hypot(*axis)
        for off in (-0.005, 0.0, 0.005):
            start = (x, y) - (radius + 0.3) * axis + off * np.array([-axis[1], axis[0]])
            shot = sn.simulate([start], [speed * axis], [rolling(speed * axis, physics.R)], table, physics)
            assert shot.potted.tolist() == [k], (name, table.pockets[k], off)


def random_shots(table, n_shots, n_balls, seed, top=6.0):
    """Sound positions anywhere between the noses, mouths included; the first ball struck, some of the others moving."""
    rng, physics = np.random.default_rng(seed), physics_of(table)
    high = table.bounds[:, 1] - physics.R
    positions = np.zeros((n_shots, n_balls, 2))
    for shot in positions:
        for k in range(n_balls):
            while True:
                shot[k] = rng.uniform(-high, high)
                apart = np.hypot(*(shot[:k] - shot[k]).T).min(initial=9.0)
                if apart > 2 * physics.R and not table.unfit(shot[None, k : k + 1], physics.R):
                    break
    velocities, spins = np.zeros((n_shots, n_balls, 2)), np.zeros((n_shots, n_balls, 3))
    for k in range(n_shots):
        stroke = rng.uniform(0.3, top), rng.uniform(-4, 4), *rng.uniform(-0.35, 0.35, 2)
        v, spins[k, 0] = sn.strike(*stroke, physics=physics)
        velocities[k, 0] = v[:2]
        if k % 3 == 0:
            velocities[k, 1] = rng.normal(0, 0.5, 2)
    return positions, velocities, spins, physics


@pytest.mark.parametrize("name", TABLES)
def test_no_shot_leaves_the_table_gains_energy_or_ends_where_no_ball_may_lie(name):
    table = TABLES[name]
    p, v, w, physics = random_shots(table, 60, 5, seed=1)
    shots = p, v, w, np.ones(p.shape[:2], bool)
    found = invariants.play(shots, physics, table, contact.parse_fidelity("standard"))
    assert (found.status == 0).all() and (found.worst <= allowed("standard")).all()
    end = sn.simulate_batch(p, v, w, table, physics)
    again = sn.simulate_batch(end.positions, 0 * v, 0 * w, table, physics, on_table=end.on_table)
    assert (again.duration == 0.0).all()
    assert (end.potted >= 0).any() == (len(table.falls) > 0)


@pytest.mark.parametrize("name", WITH_POCKETS)
def test_wherever_balls_come_to_rest_they_may_lie_and_be_struck_again(name):
    """Soft shots at the pockets, many: some stop in the mouths. The positions are checked as input, those in the pockets left out."""
    table = TABLES[name]
    rng, physics = np.random.default_rng(2), physics_of(table)
    b = 3000
    k = rng.integers(len(table.falls), size=b)
    start = rng.uniform(-0.6, 0.6, (b, 2)) * (table.bounds[:, 1] - physics.R)
    to = table.falls[k, :2] - start + rng.normal(0, 0.03, (b, 2))
    far = np.hypot(*to.T)
    run = np.maximum(far - table.falls[k, 2] + rng.uniform(-0.05, 0.01, b), 0.01)
    speed = np.sqrt(2 * physics.mu_r * physics.g * run)
    v = speed[:, None] * to / far[:, None]
    w = np.stack([-v[:, 1], v[:, 0], 0 * v[:, 0]], axis=1) / physics.R
    end = sn.simulate_batch(start[:, None], v[:, None], w[:, None], table, physics)
    lying = end.on_table[:, 0]
    assert lying.sum() > 0.2 * b
    table.check(end.positions[lying], physics.R)
    places, (low, high) = end.positions[lying], table.bounds.T
    depth = np.maximum(low - places, places - high).max(axis=(1, 2))
    assert depth.max() > -physics.R  # some lie in a mouth
    if name == "rounded, with facings":  # deeper than on any snooker table
        assert depth.max() > 2 * MOUTH


def test_snooker_is_played_on_a_rectangular_table_of_its_size():
    """With the match table's pockets it is the match table, made for its ball or for any; without pockets nothing is potted."""
    ends = []
    own = (Table.rectangular(3.569, 1.778, ball_radius=radius) for radius in (None, 0.02625))
    for table in ("match", *own):
        env = SnookerVectorEnv(32, table=table, layout="random:10")
        env.reset(seed=3)
        ends.append(env.step(np.random.default_rng(0).uniform(-1, 1, (32, 4)).astype(np.float32))[:2])
    assert all(np.array_equal(a, b) for end in ends[1:] for a, b in zip(end, ends[0], strict=True))
