"""Is no ball ever dealt into a cushion, a jaw or a pocket, and is a table that does not fit refused?"""

import copy
import pickle
from functools import partial

import numpy as np
import pytest

import snooker_env as sn
from snooker_env import SnookerEnv, SnookerVectorEnv, Table
from snooker_env.game.layouts import LAYOUTS, bank, deal_tables, split_bank
from snooker_env.geometry import BALL_RADIUS
from snooker_env.tasks.options import fit_plan
from tests.refusals import refused
from tests.tables import begun

MATCH = Table.preset("match")
EVERY = (*LAYOUTS, "random:15", "pots:easy")
NONE = {"jaws": np.zeros((0, 6)), "falls": np.zeros((0, 3))}


def changed(name="mine", **changes):
    """The match table with some of its parts changed, each by a function of it."""
    parts = {part: getattr(MATCH, part) for part in ("noses", "jaws", "falls")}
    return Table(name, **parts | {part: change(np.array(parts[part])) for part, change in changes.items()})


def put(row, column, value):
    def change(rows):
        rows[row, column] = value
        return rows

    return change


def walls(half_width, half_length):
    """Noses on four sides, without a gap."""
    x, y = half_width, half_length
    return np.array([(0, -1, x, -9, 9), (0, 1, x, -9, 9), (1, -1, y, -9, 9), (1, 1, y, -9, 9)])


FIT = {
    "match": MATCH,
    "tight": Table.preset("tight"),
    "same as match": changed(),
    "no jaws": changed(jaws=lambda rows: rows[:0]),
    "no pockets": Table("mine", walls(0.889, 1.7845), **NONE),
    "corner falls a little larger": changed(falls=lambda rows: rows * (1.0, 1.0, 1.1)),
    "sharp jaws": changed(jaws=lambda rows: np.insert(np.delete(rows, 2, axis=1), 2, 0.02, axis=1)),
    "jaws of tight": changed(jaws=lambda rows: Table.preset("tight").jaws),
}


def test_some_opened_tables_do_not_fit_other_pockets():
    """The tests below can see it: the bank was played on the match table, where balls rest in the mouths."""
    assert 3 < len(fit_plan("opened", Table.preset("tight")).unfit) < 100
    assert fit_plan("opened", MATCH).unfit == ()


@pytest.mark.parametrize("layout", EVERY)
@pytest.mark.parametrize("name", FIT)
def test_every_layout_fits_every_table_that_is_accepted(name, layout):
    env = begun(SnookerVectorEnv(256, table=FIT[name], layout=layout), 11)
    FIT[name].check(env.tables.positions, BALL_RADIUS, "positions", env.tables.on_table)


def test_others_stand_in_for_the_opened_tables_that_do_not_fit_and_no_other_deal_changes():
    plan = fit_plan("opened", Table.preset("tight"))
    differ = np.flatnonzero((plan.tables != bank("opened")).any((1, 2)))
    assert set(differ) <= set(plan.unfit) and len(differ) >= len(plan.unfit) - 1
    for part in split_bank("opened"):
        for k in set(differ) & set(part):
            assert any(np.array_equal(plan.tables[k], bank("opened")[j]) for j in part)
    streams = np.arange(8000, dtype=np.uint64).reshape(-1, 2)
    dealt = []
    for each in (plan, fit_plan("opened", MATCH)):
        positions, on_table = np.zeros((len(streams), 22, 2)), np.zeros((len(streams), 22), bool)
        deal_tables(np.arange(len(streams)), each.code, each.tables, streams.copy(), positions, on_table)
        dealt.append(positions)
    other = (dealt[0] != dealt[1]).any((1, 2))
    assert 0 < other.sum() < 40
    for copied in (copy.deepcopy(plan), pickle.loads(pickle.dumps(plan))):
        assert copied.unfit == plan.unfit and np.array_equal(copied.tables, plan.tables)


BED = "in Snooker-v0, whose layouts are made for that bed (found"
ROOM = "must leave a ball's centre free in |x| <= 0.86275, |y| <= 1.75825 in Snooker-v0, whose layouts put balls there"
PEG = (0, 0, 0.01, 1, 0, -1)
REFUSED = {
    "narrower": (Table("mine", walls(0.7, 1.7845), **NONE), f"x = -0.889 {BED} -0.7)"),
    "wider": (Table("mine", walls(1.067, 1.7845), **NONE), f"x = -0.889 {BED} -1.067)"),
    "longer": (Table("mine", walls(0.889, 2.0), **NONE), f"y = -1.7845 {BED} -2)"),
    "shorter": (Table("match", walls(0.889, 1.7), **NONE), f"y = -1.7845 {BED} -1.7)"),
    "one nose inside": (changed(noses=put(3, 2, 0.8)), f"x = 0.889 {BED} 0.889, 0.8)"),
    "three sides": (changed(noses=lambda rows: rows[:5]), f"y = 1.7845 {BED} none)"),
    "no noses": (Table("unbounded", np.zeros((0, 5)), **NONE), f"x = -0.889 {BED} none)"),
    "a jaw on the bed": (changed(jaws=put(5, 0, 0.8)), f"{ROOM}: jaws[5], its whole circle, reaches"),
    "a peg on the blue spot": (changed(jaws=lambda rows: np.vstack([rows, PEG])), ROOM),
    "a hole on the bed": (
        changed(falls=lambda rows: np.vstack([rows, (0.3, 0.2, 0.05)])),
        f"{ROOM}: falls[6]",
    ),
    "a middle pocket too far in": (changed(falls=put(2, 0, 0.9)), f"{ROOM}: falls[2]"),
}


@pytest.mark.parametrize("make", [SnookerEnv, partial(SnookerVectorEnv, 2), sn.match_env])
@pytest.mark.parametrize(("table", "says"), REFUSED.values(), ids=REFUSED)
def test_a_table_that_the_layouts_do_not_fit_is_refused_by_name(make, table, says):
    allowed = says if says.startswith(ROOM) else f"must have its noses at {says}"
    refused(lambda: make(table=table), "table", repr(table.name), allowed)


def test_shots_on_a_table_of_ones_own_are_played_on_it():
    """A copy of the match table gives the same rewards and places as the preset, one without pockets none."""
    ends = []
    for table in ("match", changed("unbounded"), FIT["no pockets"]):
        env = begun(SnookerVectorEnv(64, table=table, layout="random:10"), 3)
        rewards = env.step(np.random.default_rng(0).uniform(-1, 1, (64, 4)).astype(np.float32))[1]
        ends.append((rewards, env.tables.positions.copy()))
    assert np.array_equal(ends[0][0], ends[1][0]) and np.array_equal(ends[0][1], ends[1][1])
    assert not np.array_equal(ends[0][1], ends[2][1])
