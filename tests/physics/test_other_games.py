"""Are shots right on tables that are not snooker's? Every preset and some of one's own: pots by index,
bounds, energy, their own balls."""

import pickle

import numpy as np
import pytest

import snooker_env as sn
from snooker_env import EventKind, Pocket, Table
from snooker_env.envs.snooker import SnookerEnv
from snooker_env.envs.vector import SnookerVectorEnv
from snooker_env.physics.table import MOUTH
from tests.flights import calm
from tests.refusals import Z, refused

POOL_POCKETS = {
    "corner": Pocket.corner(mouth=0.12, shelf=0.02, fall_radius=0.065, cut=140, jaw_radius=0.004),
    "ball_radius": 0.025,
}
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
    """For every index: along the pocket's axis, from 0.3 m in front of the slate's edge, and 5 mm to either
    side."""
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
    """Sound positions anywhere between the noses, mouths included; the first ball struck, some of the others
    moving."""
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
        v, spins[k, 0] = sn.strike(
            rng.uniform(0.3, top), rng.uniform(-4, 4), *rng.uniform(-0.35, 0.35, 2), physics=physics
        )
        velocities[k, 0] = v[:2]
        if k % 3 == 0:
            velocities[k, 1] = rng.normal(0, 0.5, 2)
    return positions, velocities, spins, physics


@pytest.mark.parametrize("name", TABLES)
def test_no_shot_leaves_the_table_gains_energy_or_ends_where_no_ball_may_lie(name):
    table = TABLES[name]
    shots = random_shots(table, 60, 5, seed=1)
    physics = shots[-1]
    R, reach = physics.R, table.bounds - physics.R * np.array([-1, 1])
    potted = 0
    for p, v, w in zip(*shots[:3], strict=True):
        shot = sn.simulate(p, v, w, table, physics)
        times = np.union1d(shot.events["time"], np.linspace(0, shot.duration, 100))
        places, velocities, spins = shot.at(times)
        joules = 0.5 * (velocities**2).sum((1, 2)) + 0.2 * R * R * (spins**2).sum((1, 2))
        assert (np.diff(joules[calm(shot, times)]) <= 1e-9 * joules[0]).all()
        # outside the noses only in a mouth (the deepest shelf here is 5 cm)
        over = np.maximum(table.bounds[:, 0] - places, places - table.bounds[:, 1]).max(axis=2) > 1e-9
        outside = np.maximum(reach[:, 0] - places, places - reach[:, 1]).max(axis=2) > 1e-9
        if len(table.falls):
            far = (
                np.hypot(*(places[:, :, None] - table.falls[:, :2]).transpose(3, 0, 1, 2)) - table.falls[:, 2]
            )
            assert (
                far.min(axis=2)[outside].max(initial=-1) < 0.15
                and far.min(axis=2)[over].max(initial=-1) < 0.06
            )
        else:
            assert not outside.any()
        for k, t in enumerate(times):
            gone = shot.events["i"][(shot.events["kind"] == EventKind.POT) & (shot.events["time"] <= t)]
            here = np.delete(places[k], gone, axis=0)
            gaps = np.hypot(*(here[:, None] - here[None]).transpose(2, 0, 1)) + np.eye(len(here))
            assert gaps.min() > 2 * R - 1e-9
        potted += (shot.potted >= 0).sum()
        # where a ball came to rest it may lie
        again = sn.simulate(shot.positions, 0 * v, 0 * w, table, physics, on_table=shot.on_table)
        assert again.duration == 0.0
    assert (potted > 0) == (len(table.falls) > 0)


@pytest.mark.parametrize("name", WITH_POCKETS)
def test_wherever_balls_come_to_rest_they_may_lie_and_be_struck_again(name):
    """Soft shots at the pockets, many: some stop in the mouths. The positions are checked as input, those in
    the pockets left out."""
    table = TABLES[name]
    rng, physics = np.random.default_rng(2), physics_of(table)
    b = 3000
    k = rng.integers(len(table.falls), size=b)
    start = rng.uniform(-0.6, 0.6, (b, 2)) * (table.bounds[:, 1] - physics.R)
    to = table.falls[k, :2] - start + rng.normal(0, 0.03, (b, 2))
    far = np.hypot(*to.T)
    speed = np.sqrt(
        2 * physics.mu_r * physics.g * np.maximum(far - table.falls[k, 2] + rng.uniform(-0.05, 0.01, b), 0.01)
    )
    v = speed[:, None] * to / far[:, None]
    w = np.stack([-v[:, 1], v[:, 0], 0 * v[:, 0]], axis=1) / physics.R
    end = sn.simulate_batch(start[:, None], v[:, None], w[:, None], table, physics)
    lying = end.on_table[:, 0]
    assert lying.sum() > 0.2 * b
    table.check(end.positions[lying], physics.R)
    depth = np.maximum(
        table.bounds[:, 0] - end.positions[lying], end.positions[lying] - table.bounds[:, 1]
    ).max(axis=(1, 2))
    assert depth.max() > -physics.R  # some lie in a mouth
    if name == "rounded, with facings":  # deeper than on any snooker table
        assert depth.max() > 2 * MOUTH


def test_a_three_cushion_shot_on_the_carom_table():
    """The cue ball meets one ball, at least three cushions, and then the other; nothing is potted on a table
    without pockets."""
    table = Table.preset("carom")
    physics = physics_of(table)
    v, w = sn.strike(3.5, 2.84, side=0.3, top=0.2, physics=physics)
    balls = [(0.25, -0.9), (0.45, 0.35), (-0.4, -0.75)]
    shot = sn.simulate(balls, [v[:2], (0, 0), (0, 0)], [w, Z, Z], "carom", physics)
    kinds = shot.events[(shot.events["i"] == 0) & (shot.events["kind"] <= EventKind.JAW)]
    met = kinds["j"][kinds["kind"] == EventKind.BALL_BALL]
    last = np.flatnonzero((kinds["kind"] == EventKind.BALL_BALL) & (kinds["j"] != met[0]))[0]
    assert (kinds["kind"][:last] == EventKind.CUSHION).sum() >= 3
    assert (shot.potted == -1).all() and shot.on_table.all()
    assert (np.abs(shot.positions) <= table.bounds[:, 1] - physics.R + 1e-9).all()


def test_a_ball_at_the_rail_of_a_wide_table_is_on_it():
    """Noses at 1.067 m: a ball at 0.95 was refused when the bounds were snooker's."""
    wide = Table.rectangular(4.0, 2 * 1.067)
    assert sn.simulate([(0.95, 0.3)], [(0.0, 0.0)], [Z], wide).positions.tolist() == [[0.95, 0.3]]
    sn.simulate(
        [(1.067 - 0.02625, 1.99 - 0.02625)], [(0.0, 0.0)], [Z], Table.rectangular(4.0, 2 * 1.067, pockets=0)
    )
    refused(
        lambda: sn.simulate([(1.05, 0.3)], [(0.0, 0.0)], [Z], wide),
        "positions[0]",
        "(1.05, 0.3)",
        "overlaps the cushion at x = 1.067",
    )


@pytest.mark.parametrize("name", ["uk8", "pool9", "carom"])
def test_a_table_is_played_with_the_balls_that_it_is_made_for(name):
    table = TABLES[name]
    one = [(0.0, 0.0)], [(0.2, 1.0)], [Z]
    says = f'must be {table.ball_radius} on table "{name}", which is made for it: write physics={{"R": {table.ball_radius}}}'
    refused(lambda: sn.simulate(*one, name), "physics.R", "0.02625", says)
    refused(lambda: sn.simulate(*one, table, "match"), "physics.R", "0.02625", says)
    refused(lambda: sn.simulate_batch([one[0]], [one[1]], [one[2]], name), "physics.R", "0.02625", says)
    for physics in ({"R": table.ball_radius}, sn.Physics.preset("match", **table.ball)):
        assert sn.simulate(*one, name, physics).duration > 1.0
    assert pickle.loads(pickle.dumps(table)) is table


def test_a_table_of_ones_own_may_name_its_ball():
    own = pickle.loads(pickle.dumps(TABLES["square, 4 pockets"]))
    assert own.ball == {"R": 0.025} and own.pockets == (
        "bottom left",
        "bottom right",
        "top right",
        "top left",
    )
    refused(
        lambda: sn.simulate([(0, 0)], [(1, 0)], [Z], own),
        "physics.R",
        "0.02625",
        'must be 0.025 on table "rectangular"',
    )


@pytest.mark.parametrize("field", ["R", "M"])
@pytest.mark.parametrize("value", [[0.025, 0.026], (0.1, 0.2, 0.3), np.array([0.025, 0.025])])
def test_balls_of_unequal_size_or_mass_are_refused_with_a_reason(field, value):
    says = "must be one number: all balls of a shot are equal (docs/physics/limits.md)"
    for call in (
        lambda: sn.Physics(**{field: value}),
        lambda: sn.Physics.preset("match", **{field: value}),
        lambda: sn.simulate([(0, 0), (0.3, 0)], [(1, 0), (0, 0)], [Z, Z], None, {field: value}),
    ):
        refused(call, f"physics.{field}", repr(value), says)


OTHER = [
    "uk8",
    "pool9",
    "carom",
    TABLES["square, 4 pockets"],
    Table.rectangular(3.569, 1.778, ball_radius=0.025, name="small balls"),
]


@pytest.mark.parametrize(
    "make", [SnookerEnv, lambda **how: SnookerVectorEnv(2, **how), lambda **how: sn.match_env(**how)]
)
@pytest.mark.parametrize("table", OTHER)
def test_snooker_is_not_played_on_other_games_tables(make, table):
    other = Table.of(table)
    allowed = 'must be "match", "tight" or a Table of snooker\'s bed in Snooker-v0'
    says = f"{allowed}: this one is made for balls of radius {other.ball_radius:g} m"
    refused(lambda: make(table=table), "table", repr(other.name), says)


def test_snooker_is_played_on_a_rectangular_table_of_its_size():
    """With the match table's pockets it is the match table, made for its ball or for any; without pockets
    nothing is potted."""
    ends = []
    for table in (
        "match",
        Table.rectangular(3.569, 1.778),
        Table.rectangular(3.569, 1.778, ball_radius=0.02625),
    ):
        env = SnookerVectorEnv(32, table=table, layout="random:10")
        env.reset(seed=3)
        ends.append(env.step(np.random.default_rng(0).uniform(-1, 1, (32, 4)).astype(np.float32))[:2])
    assert all(np.array_equal(a, b) for end in ends[1:] for a, b in zip(end, ends[0], strict=True))
    says = "must have its noses at x = -0.889 in Snooker-v0"
    refused(lambda: SnookerEnv(table=Table.rectangular(3.569, 1.7)), "table", "'rectangular'", says)


def test_a_flight_over_a_pocket_ignores_the_jaws_of_the_others():
    """The same with the other pockets' jaws and without: a facing run on straight passes the opposite middle
    pocket of this table."""
    corner = Pocket.corner(mouth=0.15, shelf=0.03, fall_radius=0.075)
    table = Table.rectangular(
        2.0,
        1.0,
        ball_radius=0.02625,
        corner=corner,
        middle=Pocket.middle(mouth=0.11, shelf=0.0, fall_radius=0.06),
    )
    k = sn.POCKETS.index("middle right")
    arcs = table.jaws[:, :2] + table.jaws[:, 2:3] * table.jaws[:, 3:5]
    own = table.jaws[np.hypot(*(arcs - table.falls[k, :2]).T) < 0.3]
    rng, physics, n = np.random.default_rng(0), physics_of(table), 1500
    angle, off, speed = rng.uniform(-1.2, 1.2, n), rng.uniform(-0.035, 0.035, n), rng.uniform(1.5, 8, n)
    way = np.stack([np.cos(angle), np.sin(angle)], 1)
    p = (0.5, 0.0) - 0.25 * way + off[:, None] * np.stack([-way[:, 1], way[:, 0]], 1)
    v = speed[:, None] * way
    w = np.stack([-v[:, 1], v[:, 0], 0 * speed], 1) / physics.R
    # no gaps at the other pockets: through an open one a ball would leave the table
    noses = table.noses.copy()
    noses[:2, 3:], noses[2, 3], noses[3, 4], noses[4:, 3:] = (-1.0, 1.0), -1.0, 1.0, (-0.5, 0.5)
    tables = table, Table("its jaws alone", noses, own, table.falls)
    logs = [
        sn.simulate_batch(p[:, None], v[:, None], w[:, None], each, physics, events=True).events
        for each in tables
    ]

    def flight(log):
        """The first flight of all, if it is over that pocket: times and kinds from the DROP to the RETURN or
        POT."""
        start = int((log["kind"] == EventKind.DROP).argmax())
        if log["kind"][start] != EventKind.DROP or log["j"][start] != k:
            return None
        end = start + int(np.isin(log["kind"][start:], (EventKind.RETURN, EventKind.POT)).argmax())
        return log["time"][start : end + 1].tolist(), log["kind"][start : end + 1].tolist()

    flights = [(flight(a), flight(b)) for a, b in zip(*logs, strict=True)]
    # neither has met another pocket before
    same = [(a, b) for a, b in flights if a and b and a[0][0] == b[0][0]]
    assert len(own) == 4 and len(same) > 400 and sum(a[1][-1] == EventKind.RETURN for a, _ in same) > 10
    assert all(a == b for a, b in same)
