"""Is luck what it says: as played less the mean of the same stroke, with expectation 0, and is nothing disturbed by it?"""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.benchmark import TASKS, play_visits
from snooker_env.benchmark.luck_counter import Luck
from snooker_env.benchmark.playing import Decider, rounds, rows_of, tables_for
from snooker_env.benchmark.statistics import adjust
from snooker_env.game.frame_columns import POINTS
from snooker_env.game.layouts import layout, plan_of, split_bank
from snooker_env.planning.positions import of_tables
from snooker_env.players import FRAMES, VISITS
from snooker_env.players import luck as lucks
from snooker_env.players.luck import fresh_streams, mean_of_starts, value_of


@pytest.fixture
def seen(monkeypatch):
    """What is expected of the tables in each call, (strokes, 1 + draws): made by hand of balls, points and scores."""
    calls = []

    def by_hand(tables, out, options):
        calls.append(value_by_hand(tables).reshape(-1, 1 + lucks.DRAWS))
        return calls[-1].ravel()

    monkeypatch.setitem(lucks.EXPECTED, "by hand", by_hand)
    return calls


def value_by_hand(tables):
    scored = tables.lead() if hasattr(tables, "lead") else tables.game[:, POINTS]
    return tables.positions[:, 1:, 1].sum(axis=1) + 3.0 * scored


def test_luck_is_what_was_played_less_the_mean_of_fresh_errors(seen):
    envs, seeds = sn.SnookerVectorEnv(40, layout="opened", noise="club", cue="real", **VISITS), range(40)
    luck, sums = Luck(envs, "by hand"), np.zeros(40)
    for asked, *_ in rounds(envs, [*seeds], luck.watch(Decider("ghost_ball", envs, seeds, 0))):
        # the copy that keeps its stream plays what was played
        assert seen[-1][:, 0].tolist() == value_by_hand(envs.tables)[asked].tolist()
        sums[asked] += seen[-1][:, 0] - seen[-1][:, 1:].mean(axis=1)
        assert luck.sums == pytest.approx(sums, abs=1e-9)
    assert (seen[0].std(axis=1) > 0.0).all()
    # as played is a draw like the others: its rank among them is uniform
    ranks = np.concatenate([(one[:, :1] > one[:, 1:]).sum(axis=1) for one in seen])
    assert abs(ranks.mean() - lucks.DRAWS / 2) < 4.0 * np.sqrt(lucks.DRAWS**2 / 12 / len(ranks))


def test_both_sides_strokes_of_a_frame_are_seen_as_they_were_played(seen):
    options = TASKS["SnookerFrame-v0"].judged_options(**FRAMES).but(opponent="ghost_ball")
    envs, strokes = sn.SnookerVectorEnv(1, options), 0
    luck = Luck(envs, "by hand")
    for *_, info, _, _ in rounds(envs, [3], luck.watch(Decider("ghost_ball", envs, [3], 0))):
        assert seen[-1][:, 0].tolist() == value_by_hand(envs.tables).tolist()
        strokes = int(info["strokes"][0])
    assert len(seen) == strokes > 20
    assert luck.sums[0] == pytest.approx(sum((one[:, 0] - one[:, 1:].mean(axis=1))[0] for one in seen))


def test_fresh_errors_are_of_streams_that_nobody_else_draws():
    own = np.array([[5, 0], [5, 3], [2**63 + 5, 0]], np.uint64)
    fresh = fresh_streams(own)
    keys = fresh[:, :, 0].ravel().tolist()
    assert len(set(keys)) == 3 * lucks.DRAWS and min(keys) >= 2**32 and not fresh[:, :, 1].any()
    assert np.array_equal(fresh, fresh_streams(own))


@pytest.mark.parametrize("name", TASKS)
def test_counting_luck_changes_nothing_that_is_played(name):
    task, seeds = TASKS[name], TASKS[name].seeds(3)

    def rows(lucky):
        tables = tables_for(task, 3)
        return rows_of(task, tables, seeds, Decider("ghost_ball", tables, seeds, 0), lucky=lucky)

    with_luck, without = np.array(rows(True)), np.array(rows(False))
    assert np.array_equal(with_luck[:, :-1], without[:, :-1])
    assert with_luck[:, -1].any() and not without[:, -1].any()


def test_without_errors_only_the_table_dealt_is_luck():
    s = play_visits("ghost_ball", 4, layout="opened", noise="none")
    assert (s.luck[s.number == 0] != 0.0).all() and not s.luck[s.number > 0].any()
    assert not play_visits("ghost_ball", 4, layout="colours", noise="none").luck.any()


def test_the_mean_of_all_starts_is_that_of_the_tables_dealt():
    options = sn.Options(layout="held_out", noise="professional")
    plan = plan_of("held_out")
    assert len(split_bank("opened")[1]) == 2048
    envs = sn.SnookerVectorEnv(2000, options)
    envs.reset(seed=0)
    values = value_of(options)(of_tables(envs.tables))
    mean = mean_of_starts(options)
    assert mean is not None
    off = float(values.mean()) - mean
    assert abs(off) < 4.0 * values.std() / np.sqrt(2000) and abs(off) > 0.0
    dealt, _ = layout(plan, np.random.default_rng(0))
    assert dealt.shape == (22, 2) and mean_of_starts(options.but(layout="colours")) is None


def test_a_share_is_fitted_on_the_other_half_of_the_tables():
    rng = np.random.default_rng(0)
    luck = rng.normal(size=(2, 400))
    scores = 5.0 + 2.0 * luck + 0.1 * rng.normal(size=luck.shape)
    adjusted = adjust(scores, luck)
    assert adjusted.var() < 0.02 * scores.var()
    changed = scores.copy()
    changed[:, ::2] += 100.0 * luck[:, ::2]  # of the even tables: the share of the odd ones changes alone
    moved = adjust(changed, luck) - (changed - scores) - adjusted
    assert np.abs(moved[:, ::2]).max() < 1e-9 and np.abs(moved[:, 1::2]).max() > 1.0
    assert np.array_equal(adjust(scores, 0.0 * luck), scores)
    assert np.array_equal(adjust(scores[:, :1], luck[:, :1]), scores[:, :1])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("player", "visits", "most"),
    [("ghost_ball", 8000, 0.5), ("stroke_value", 2000, 0.5), ("planner", 1000, 1 / 3)],
)
def test_the_adjusted_mean_is_the_mean_and_varies_less(player, visits, most):
    s = play_visits(player, visits, first_seed=7_000_000, layout="opened", cue="real")
    points, luck = s.a_visit(s.points)[None], s.a_visit(s.luck)[None]
    adjusted = adjust(points, luck)
    off = (adjusted - points)[0]
    assert abs(off.mean()) < 3.3 * off.std() / np.sqrt(visits)
    assert adjusted.var() < most * points.var()
