"""Are the tasks of the benchmark what they promise: frozen options, and tables that nobody trains on?"""

import dataclasses

import gymnasium
import numpy as np
import pytest
from gymnasium.envs.registration import EnvSpec
from gymnasium.utils.env_checker import check_env, data_equivalence

import snooker_env as sn
from snooker_env._lib.registration import ENTRY_POINTS, FORMS
from snooker_env.benchmark import COLUMNS, HELD_OUT_SEED, TASKS, play_visits
from snooker_env.benchmark.playing import Repeater, play_episodes, rows_of, tables_for
from snooker_env.benchmark.tasks import FREE, tables_of
from snooker_env.game import layout
from snooker_env.game.frame_columns import OPPONENT
from snooker_env.game.layouts import HELD_OUT, STORED_IN
from snooker_env.players import BoundPlayer, Strokes

IDS = tuple(TASKS)


def many(name, n, **options):
    return gymnasium.make_vec(name, num_envs=n, vectorization_mode="vector_entry_point", **options)


def test_every_registered_id_but_snooker_is_a_task_or_a_form_of_one():
    assert set(ENTRY_POINTS) == {"Snooker-v0", *FORMS, *TASKS}
    for name in TASKS:
        assert name == gymnasium.make(name).unwrapped.TASK and TASKS[name].id == name
        assert name == many(name, 2).TASK


@pytest.mark.parametrize("form", FORMS)
def test_a_form_is_break_with_its_options(form):
    """As scripts make it that know an id alone: one table, many in a loop, many at once."""
    one = gymnasium.make(form)
    assert one.spec.kwargs == FORMS[form] and one.spec == EnvSpec.from_json(one.spec.to_json())
    assert one.unwrapped.options == TASKS["SnookerBreak-v0"].options(**FORMS[form])
    assert ("Discrete" in type(one.action_space).__name__) == (one.unwrapped.options.action == "discrete")
    native, loop = many(form, 3), gymnasium.make_vec(form, num_envs=3, vectorization_mode="sync")
    assert native.options == one.unwrapped.options
    assert native.action_space == loop.action_space and native.observation_space == loop.observation_space
    native.action_space.seed(0)
    a, b = native.reset(seed=1)[0], loop.reset(seed=1)[0]
    for _ in range(4):
        assert data_equivalence(a, b, exact=True)
        actions = native.action_space.sample()
        (a, *played), (b, *other) = native.step(actions), loop.step(actions)
        assert data_equivalence(tuple(played[:3]), tuple(other[:3]), exact=True)
    with pytest.raises(ValueError, match=r"^noise = 'none': must be left out: SnookerBreak-v0 freezes it"):
        gymnasium.make(form, noise="none")


@pytest.mark.parametrize("name", [*IDS, *FORMS])
@pytest.mark.filterwarnings("error")
def test_gymnasium_accepts_it(name):
    check_env(gymnasium.make(name, disable_env_checker=True).unwrapped, skip_render_check=True)


@pytest.mark.parametrize("name", [*IDS, *FORMS])
@pytest.mark.filterwarnings("error")
def test_stable_baselines_accepts_it(name):
    checker = pytest.importorskip("stable_baselines3.common.env_checker")
    checker.check_env(gymnasium.make(name).unwrapped, warn=True)


@pytest.mark.parametrize("name", IDS)
def test_what_is_frozen_is_refused(name):
    task = TASKS[name]
    assert set(task.frozen_options) | set(FREE) == set(sn.Options.__dataclass_fields__) - {"rules"}
    for option, value in task.frozen_options.items():
        with pytest.raises(ValueError, match=f"^{option} = .*: must be left out: {name} freezes it at"):
            gymnasium.make(name, **{option: value})
    with pytest.raises(ValueError, match=r"^noise = 'none': must be left out: "):
        many(name, 2, noise="none")
    with pytest.raises(ValueError, match=r"^options = a Options: must be left out"):
        gymnasium.make(name, options=sn.Options())
    with pytest.raises(TypeError, match="unexpected keyword argument 'colour'"):
        gymnasium.make(name, colour="red")


def test_an_escape_is_one_stroke_whose_reward_is_1_if_it_is_legal():
    envs = many("SnookerEscape-v0", 300, autoreset_mode="Disabled")
    envs.reset(seed=7)
    actions = envs.action_space.sample() * [1, 0.2, 0.2, 1]
    _, rewards, terminated, truncated, infos = envs.step(actions.astype(np.float32))
    assert terminated.all() and not truncated.any()
    assert np.array_equal(rewards, ~infos["foul"]) and 0 < rewards.sum() < 300
    env = gymnasium.make("SnookerEscape-v0").unwrapped
    env.reset(seed=7)
    out = env.step(actions[0].astype(np.float32))
    assert out[1] == rewards[0] and out[2] is True
    state = env.get_state()
    assert state["over"] is True


@pytest.mark.parametrize("name", IDS)
def test_judged_tables_are_not_those_of_training(name):
    """No seed is used twice; on generated layouts they are those that the rules keep for judging."""
    task = TASKS[name]
    seeds = task.seeds(30)
    assert len(set(seeds)) == 30 and min(seeds) >= HELD_OUT_SEED == 1_000_000
    trained, judged = task.options().layout, task.judged_options().layout
    assert judged == task.judged_layout
    if trained in STORED_IN:
        assert STORED_IN[judged] == (STORED_IN[trained][0], True) and not STORED_IN[trained][1]
        dealt, held_out = (
            {layout(name, np.random.default_rng(seed))[0].round(6).tobytes() for seed in some}
            for name, some in ((trained, range(300)), (judged, seeds))
        )
        assert len(held_out) == 30 and not dealt & held_out
    else:
        assert judged == trained and len(task.seeds(task.episodes)) == task.episodes


def test_a_frame_lost_before_the_first_stroke_counts_as_lost_and_asks_for_no_decision():
    class Counted(BoundPlayer):
        asked = 0

        def play(self, positions, seeds):
            assert not positions.over.any()
            Counted.asked += len(positions)
            return Strokes(np.column_stack([np.full((len(seeds), 1), 2.0), np.zeros((len(seeds), 4))]))

    easy = dataclasses.replace(TASKS["SnookerFrame-v0"], judged_layout="pots:easy")
    seeds = list(range(40))
    played = play_episodes(easy, Counted(), seeds)
    rows = [dict(zip(COLUMNS, row, strict=True)) for row in played.rows]
    at_once = [row for row in rows if not row["strokes"]]
    lost = [row for row in at_once if row["score"] == 0]
    assert 4 <= len(lost) <= 36 and all(row["opponent_points"] > 0 for row in lost)
    assert (
        all(row["ended"] for row in at_once) and len(at_once) - len(lost) <= 3
    )  # won by a foul of the opponent
    assert Counted.asked == played.decisions == sum(row["strokes"] for row in rows) > 0
    assert list(map(len, played.strokes)) == [row["strokes"] for row in rows]
    assert rows_of(easy, tables_for(easy, 40), seeds, Repeater(played.strokes, 8)) == played.rows


def test_a_frame_meets_one_of_four_players_and_the_same_again():
    met = []
    for _ in range(2):
        envs = tables_for(TASKS["SnookerFrame-v0"], 8)
        envs.reset(seed=list(range(8)))
        while not (drawn := envs.tables.game[:, OPPONENT]).all():
            envs.step(np.zeros((8, envs.action_space.shape[1])))
        met.append(drawn.tolist())
    assert met[0] == met[1] and set(met[0]) <= {1, 2, 3, 4} and len(set(met[0])) > 1
    with pytest.raises(ValueError, match=r"members\[1\] of the OpponentPool: opponent = 'nobody'"):
        sn.SnookerEnv(task="frame", opponent="random,nobody")


def test_a_player_plays_alike_however_actions_are_read_and_whatever_is_seen():
    forms = {}, {"aim": "target", "observation": "balls"}, {"action": "discrete", "observation": "masked"}
    played = [play_visits("ghost_ball", 3, layout="colours", **form).points.tolist() for form in forms]
    assert played[0] == played[1] == played[2] and sum(played[0]) > 0


@pytest.mark.slow
def test_no_table_comes_twice_or_mirrored():
    seeds = tables_of("held_out", 100)
    assert seeds == tuple(sorted(set(seeds))) and seeds[0] == HELD_OUT_SEED
    tables = sn.SnookerVectorEnv(100, layout="held_out")
    tables.reset(seed=seeds)
    reds = np.sort(np.abs(tables.tables.positions[:, 1:16, 0]), axis=1)
    apart = np.abs(reds[:, None] - reds[None]).max(axis=2) + np.eye(100)
    assert apart.min() > 1e-6
    with pytest.raises(ValueError, match=f"visits = {100 * HELD_OUT}: must be at most {HELD_OUT} "):
        tables_of("held_out", 100 * HELD_OUT)
