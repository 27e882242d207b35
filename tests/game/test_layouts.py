"""Do the layouts stand as they promise, for every seed, and only from the seed?"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.make_tables.safety import LIKELY
from snooker_env import SnookerVectorEnv
from snooker_env.game import layouts
from snooker_env.game.balls import GREEN, SPOTS, YELLOW
from snooker_env.game.layouts import BANKS, bank, split_bank
from snooker_env.game.pots import pots
from snooker_env.game.snookered import is_snookered
from snooker_env.geometry import BALL_RADIUS, BAULK_Y, HALF_LENGTH, HALF_WIDTH, POCKET_PLACES
from snooker_env.planning import Positions, prospects_of
from snooker_env.tasks.noise import Spread

NAMES = ["break_off", "line_up", "colours", "random:0", "random:6", "random:15"]


def gaps(positions, on_table):
    """Gaps between the cue ball and each other ball on the table, and the least between those."""
    placed = positions[on_table]
    distances = np.hypot(*(placed[:, None] - placed[None]).T) - 2 * BALL_RADIUS
    np.fill_diagonal(distances, np.inf)
    return distances


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_every_layout_is_playable(name, seed):
    positions, on_table = layouts.layout(name, np.random.default_rng(seed))
    assert positions.shape == (22, 2) and positions.dtype == np.float64 and on_table.shape == (22,)
    assert on_table.dtype == np.bool_
    assert on_table[0] and np.all(on_table[YELLOW:])
    assert np.array_equal(positions[YELLOW:], SPOTS[YELLOW:])
    distances = gaps(positions, on_table)
    assert distances.min() > -1e-12
    assert distances[0].min() >= layouts.GAP - 1e-12
    if name != "break_off":
        assert distances.min() >= layouts.GAP - 1e-12
    sprinkled = positions[:16][on_table[:16]] if name.startswith("random") else positions[:1]
    reach = np.array([HALF_WIDTH, HALF_LENGTH]) - BALL_RADIUS - layouts.CUSHION_GAP
    assert np.all(np.abs(sprinkled) <= reach)
    assert all(np.hypot(*(POCKET_PLACES - place).T).min() >= layouts.POCKET_GAP for place in sprinkled)


def test_where_the_break_off_and_the_line_up_lie():
    """From one place: beside the brown, on the side that the stream decides."""
    places = [tuple(layouts.layout("break_off", np.random.default_rng(seed))[0][0]) for seed in range(60)]
    usual = tuple(SPOTS[0].tolist())
    assert usual == (0.18, BAULK_Y) and set(places) == {usual, (-0.18, BAULK_Y)}
    assert 20 < places.count(usual) < 40
    positions, _ = layouts.layout("line_up", np.random.default_rng(0))
    on_line = np.sort(np.append(positions[1:16, 1], SPOTS[19:22, 1]))
    assert np.all(positions[1:16, 0] == 0.0)
    assert np.diff(on_line).min() > 4 * BALL_RADIUS
    assert abs(on_line).max() < HALF_LENGTH - 3 * BALL_RADIUS


# Snookers and single pots


@pytest.mark.parametrize("seed", range(5))
def test_snookered_is_what_it_says(seed):
    positions, on_table = layouts.layout("snookered", np.random.default_rng(seed))
    assert is_snookered(positions, on_table, 0xFFFE)[0]
    assert 1 <= on_table[1:YELLOW].sum() <= 3 and on_table[0] and on_table[YELLOW:].all()
    assert np.array_equal(positions[YELLOW:], SPOTS[YELLOW:])
    assert gaps(positions, on_table).min() >= layouts.GAP - 1e-12
    moved = positions.copy()
    moved[16:] += 10.0  # without the colours it would be no snooker
    assert not is_snookered(moved, on_table, 0xFFFE)[0]


@pytest.mark.parametrize("difficulty", ["easy", "medium", "hard"])
def test_single_pots_are_as_hard_as_they_say(difficulty):
    low, high = layouts.POT_WINDOWS[difficulty]
    for seed in range(40):
        positions, on_table = layouts.layout(f"pots:{difficulty}", np.random.default_rng(seed))
        assert np.flatnonzero(on_table).tolist() == [0, 1]
        assert low <= pots(positions, on_table, 2)[0, 5] < high
        assert gaps(positions, on_table).min() >= layouts.GAP - 1e-12


# Stored tables


@pytest.mark.parametrize("name", ["safety", "held_out_safety"])
def test_no_pot_is_on_where_a_safety_is_asked_for(name):
    env = SnookerVectorEnv(60, layout=name, cue="real", noise="professional", threads=1)
    env.reset(seed=1)
    at, rules = Positions.of(env), env.options.rules
    made_for = Spread(np.radians(0.063))  # the error that the tables were chosen for
    chances = prospects_of(at, made_for, most=16, rails=rules.rails)[1]
    assert 0.05 < chances.max() <= LIKELY
    assert at.on_table[:, [0, *range(YELLOW, 22)]].all() and (at.on_table[:, 1:YELLOW].sum(axis=1) >= 3).all()
    for positions, on_table in zip(at.positions, at.on_table, strict=True):
        assert np.array_equal(positions[~on_table], SPOTS[~on_table])
        assert gaps(positions, on_table).min() > -1e-6
        assert not is_snookered(positions, on_table, 0xFFFE)[0]


@pytest.mark.parametrize(("name", "seed"), [("escape", 0), ("escape", 1), ("held_out_escape", 2)])
def test_an_escape_is_from_a_snooker(name, seed):
    positions, on_table = layouts.layout(name, np.random.default_rng(seed))
    assert is_snookered(positions, on_table, 0xFFFE)[0] and 1 <= on_table[1:YELLOW].sum() <= 3
    assert np.allclose(positions[YELLOW:], SPOTS[YELLOW:], rtol=0.0, atol=1e-6)
    assert gaps(positions, on_table).min() >= layouts.GAP - 1e-6


@pytest.mark.parametrize("name", BANKS)
def test_no_stored_table_is_of_both_parts(name):
    tables, (trained, held_out) = bank(name), split_bank(name)
    assert len(held_out) == BANKS[name] and trained.stop == held_out.start and trained.start == 0
    parts = (np.abs(tables[part.start : part.stop, 0]).round(7) for part in (trained, held_out))
    cues = [np.sort(part, axis=1) for part in parts]
    assert not set(map(tuple, cues[0].tolist())) & set(map(tuple, cues[1].tolist()))


def test_a_stored_table_is_dealt_as_it_is_or_mirrored():
    plan, seen = layouts.plan_of("held_out_safety"), set()
    for seed in range(20):
        positions, on_table = layouts.layout(plan, np.random.default_rng(seed))
        swapped = positions.copy() * (-1.0, 1.0)
        swapped[[YELLOW, GREEN]] = swapped[[GREEN, YELLOW]]
        for mirrored, made in ((False, positions), (True, swapped)):
            same = (plan.tables[split_bank("safety")[1]][:, on_table] == made[on_table]).all((1, 2))
            if same.any():
                seen.add(mirrored)
                stored = plan.tables[split_bank("safety")[1]][same][0, :, 0]
                assert np.array_equal(on_table, ~np.isnan(stored))
                break
        else:
            raise AssertionError(seed)
    assert seen == {False, True}
