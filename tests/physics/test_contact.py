"""Does a ball that lies at a nose, an arc or a facing stay on the table, whatever its spin? And what is said of one that does not?"""

import numpy as np
import pytest

import snooker_env as sn
from benchmarks import fuzz
from benchmarks._common import invariants
from snooker_env import Table, simulation
from snooker_env.physics.engine import Status
from snooker_env.physics.impact import contact

ONCE_LOST = {
    "along the nose on to the arc": (
        "match",
        (0.8627500000000002, -0.10918499267057788),
        (-1.2616299763651636e-16, -0.6867993706395235),
        (-65.8744884755337, 88.97522259106857, 54.57121794455416),
    ),
    "a spin on the spot at a facing": (
        "pool9",
        (-0.5474992876727734, 1.241424999999999),
        (0.0, 0.0),
        (-114.81115743507378, -65.3133852508739, 72.06993360002431),
    ),
}
"""States of contact, each with its table. The first ball once went 16 cm deep into the cushion and came out again, the second 1.6 mm."""


def depth(table, place, R):
    """How deep a ball is in the nearest nose, arc or facing, found by points 0.1 mm apart on each [m], to 50 nm."""
    deepest = -np.inf
    for axis, side, level, low, high in table.noses:
        along = np.linspace(low, high, int((high - low) / 1e-4))
        edge = np.column_stack([np.full_like(along, side * level), along])
        deepest = max(deepest, R - np.hypot(*((edge if axis == 0 else edge[:, ::-1]) - place).T).min())
    for x, y, radius, ux, uy, cos_half in table.jaws:
        half = np.arccos(cos_half)
        turn = np.arctan2(uy, ux) + np.linspace(-half, half, 2 + int(2 * half * radius / 1e-4))
        dx, dy = x + radius * np.cos(turn) - place[0], y + radius * np.sin(turn) - place[1]
        deepest = max(deepest, R - np.hypot(dx, dy).min())
    return deepest


@pytest.mark.parametrize("case", ONCE_LOST)
def test_a_ball_in_contact_is_handed_from_one_piece_of_the_cushion_to_the_next(case):
    name, place, v, w = ONCE_LOST[case]
    table = Table.preset(name)
    shot = sn.simulate([place], [v], [w], table, sn.Physics.preset("match", **table.ball))
    R = table.ball["R"]
    places = shot.at(np.union1d(shot.events["time"], np.linspace(0, shot.duration, 50)))[0][:, 0]
    assert max(depth(table, at, R) for at in places) < 1e-9
    table.check(shot.positions, R, on_table=shot.on_table)


OTHERS = [pytest.param(name, marks=pytest.mark.slow) for name in ("tight", "uk8", "pool9", "carom")]


@pytest.mark.parametrize("name", ["match", "rectangle", *OTHERS])
def test_balls_held_at_the_boundary_keep_every_law(name):
    """At noses, arcs, facings and their seams, at rest or slow, with any spin: four batches of the fuzz's scene, 800 shots a table."""
    for k in range(4):
        rng = np.random.default_rng([77, k])
        table = fuzz.rectangle(rng) if name == "rectangle" else Table.preset(name)
        physics = sn.Physics.preset("match", **{"R": 0.02625} | table.ball)
        p = fuzz.layouts(rng, "held", 1 + k % 2, table, R=physics.R)
        v, w = fuzz.motions(rng, "held", p, physics.R)
        shots = p, v, w, np.ones(p.shape[:2], bool)
        found = invariants.play(shots, physics, table, contact.parse_fidelity("standard"))
        assert (found.status == Status.OK).all()
        assert (found.worst <= fuzz.allowed("standard")).all()


NOSES = np.array([(0, 1, 0.5, -0.2, 0.2), (1, 1, 1.0, -1.0, 1.0)])
OPEN = Table("open", NOSES, np.zeros((0, 6)), np.zeros((0, 3)))
"""A nose with nothing beyond its ends."""


def test_a_ball_that_leaves_the_table_is_an_error():
    rolling = [(0.0, 0.0)], [(1.0, 0.55)], [(-0.55 / 0.02625, 1.0 / 0.02625, 0.0)]
    with pytest.raises(sn.SimulationError, match="shot 0 holds a ball that left the table"):
        sn.simulate(*rolling, OPEN)
    state = [np.array([a]) for a in (*rolling, [True])]
    out = simulation._run(state, sn.Physics(), OPEN, contact.parse_fidelity("standard"), 1000)
    assert out.status.tolist() == [Status.ASTRAY]
    assert sn.simulate(*rolling, None).on_table.all()  # unbounded cloth has no outside


@pytest.mark.parametrize(
    ("name", "place"),
    [
        ("match", (0.889, 0.5)),
        ("match", (0.87, 0.11)),
        ("pool9", (-0.5475, 1.25)),
        ("match", (3.0, -8.0)),
        ("carom", (0.0, 1.43)),
    ],
)
def test_wherever_a_ball_has_gone_astray_the_next_event_finds_it(name, place):
    """In a nose, an arc, a facing, outside: put there behind the back of every check, moving and at rest after it."""
    table = Table.preset(name)
    physics = sn.Physics.preset("match", **table.ball)
    state = [np.array([a]) for a in ([place], [(1e-3, 1e-3)], [(0.0, 0.0, 0.0)], [True])]
    out = simulation._run(state, physics, table, contact.parse_fidelity("standard"), 1000)
    assert out.status.tolist() == [Status.ASTRAY]
