"""Does a pool draw an opponent for each table and frame, from its own stream, and keep it in the state?"""

import copy
import json

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.game.frame_columns import OPPONENT
from snooker_env.tasks import OpponentPool

SOFT = np.array([-0.9, 0.0, 0.0, 1.0])


def named(name, seen):
    """A callable that notes who played."""

    def play(observation, rng):
        seen.append(name)
        return SOFT

    return play


def frames(pool, n=1, **options):
    return sn.SnookerVectorEnv(n, threads=2, task="frame", layout="random:2", opponent=pool, **options)


def test_one_is_drawn_for_each_frame_in_proportion_to_the_weights():
    tables = frames(OpponentPool(["random", "ghost_ball", "random"], weights=[1, 2, 0]), 300)
    tables.reset(seed=0)
    tables.step(np.tile(SOFT, (300, 1)))
    drawn = np.bincount(tables.tables.game[:, OPPONENT], minlength=4)
    assert drawn[3] == 0 and 70 < drawn[1] < 130 and drawn[2] > 150


def test_he_plays_the_whole_frame():
    seen = []
    tables = frames(OpponentPool([named("a", seen), named("b", seen)]), max_strokes=30)
    by_frame = set()
    for seed in range(12):
        tables.reset(seed=seed)
        seen.clear()
        for _ in range(5):
            tables.step(SOFT[None])
        assert len(set(seen)) == 1
        by_frame |= set(seen)
    assert by_frame == {"a", "b"}


def test_the_same_seed_meets_the_same_opponent_alone_and_among_others():
    pool = ["random", "ghost_ball"]
    many = frames(OpponentPool(pool), 6)
    many.reset(seed=5)
    out = [many.step(np.tile(SOFT, (6, 1))) for _ in range(3)]
    for k in range(6):
        env = sn.SnookerEnv(task="frame", layout="random:2", opponent=OpponentPool(pool))
        env.reset(seed=5 + k)
        for observation, reward, terminated, _, _ in out:
            one = env.step(SOFT)
            assert np.array_equal(one[0], observation[k]) and one[1] == reward[k] and one[2] == terminated[k]
            if one[2]:
                break


def test_a_saved_state_keeps_the_opponent():
    pool = OpponentPool(["random", "ghost_ball"])
    for seed in range(6):
        env = sn.SnookerEnv(task="frame", layout="random:2", opponent=pool)
        env.reset(seed=seed)
        env.step(SOFT)
        if env.over:
            continue
        state = json.loads(json.dumps(env.get_state()))
        assert state["opponent"] in (0, 1, 2)
        again = sn.SnookerEnv(task="frame", layout="random:2", opponent=pool)
        again.set_state(state)
        first, second = env.step(SOFT), again.step(SOFT)
        assert np.array_equal(first[0], second[0]) and env.get_state() == again.get_state()


def test_members_may_be_added_while_frames_go_on():
    seen = []
    pool = OpponentPool([named("old", seen)])
    tables = frames(pool, 8, max_strokes=6)
    tables.reset(seed=0)
    pool.add(named("new", seen))
    pool.set_weight(0, 0.0)
    seen.clear()
    for _ in range(12):
        tables.step(np.tile(SOFT, (8, 1)))
    assert "new" in seen
    seen.clear()
    tables.reset(seed=100)
    tables.step(np.tile(SOFT, (8, 1)))
    assert set(seen) == {"new"} and copy.deepcopy(pool).weights == (0.0, 1.0)


def test_of_whom_nobody_could_be_drawn_is_refused_at_once():
    for wrong, says in (
        (lambda: OpponentPool([]), r"members = \[\]: must hold one"),
        (lambda: OpponentPool(["random"], weights=[0]), r"weights = \[0\]: must hold a number above 0"),
    ):
        with pytest.raises(ValueError, match=f"^{says}"):
            wrong()
    assert OpponentPool().members == ()
    assert OpponentPool(["random", "ghost_ball"], weights=[0, 1]).weights == (0.0, 1.0)


def test_a_wrong_member_is_named():
    with pytest.raises(
        ValueError,
        match=r"^members\[1\] of the OpponentPool: opponent = 'foo': must be one of 'none', 'random', 'ghost_ball', ",
    ):
        frames(OpponentPool(["random", "foo"]))
    tables = frames(pool := OpponentPool(["random"]), 2)
    pool.add("foo")
    with pytest.raises(ValueError, match=r"^members\[1\] of the OpponentPool: "):
        [(tables.reset(seed=seed), tables.step(np.tile(SOFT, (2, 1)))) for seed in range(5)]


def test_what_is_no_pool_is_refused():
    for wrong in (
        lambda: OpponentPool(["random"], weights=[]),
        lambda: OpponentPool(["random"], weights=[-1.0]),
    ):
        with pytest.raises(ValueError, match="weight"):
            wrong()
    for member in (OpponentPool(), "none", None):
        with pytest.raises(ValueError, match="member = "):
            OpponentPool([member])
    with pytest.raises(ValueError, match="opponent = 'nobody'"):
        frames(OpponentPool(["nobody"]))
    empty = frames(OpponentPool(), 2)
    with pytest.raises(ValueError, match="must have a member with a weight above 0"):
        [(empty.reset(seed=seed), empty.step(np.tile(SOFT, (2, 1)))) for seed in range(5)]
