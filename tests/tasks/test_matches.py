"""How does a match go? Frames won, turns at the break, the next rack, rewards, the end, who breaks."""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.tasks.observations import FRAME_ENTRIES, SIZE
from tests.tables import begun, frame_env

NAMES = ("frames_won", "opponent_frames", "frames_needed", "broke")
FRAMES_SEEN = [SIZE + FRAME_ENTRIES.index(name) for name in NAMES]


def whole(seed, **options):
    """A random match: (rewards, infos, breakers, observations) of its steps."""
    env = frame_env(**{"task": "match", "layout": "pots:easy", "opponent": "random", "frames": 5} | options)
    shown, info = env.reset(seed=seed)
    rng, steps, over = np.random.default_rng(seed), [(0.0, info, env.frame.breaker, shown)], False
    while not over:
        shown, reward, terminated, truncated, info = env.step(rng.uniform(-1, 1, env.action_space.shape))
        steps.append((reward, info, env.frame.breaker, shown))
        over = terminated or truncated
    return steps, terminated, env


def test_the_players_break_in_turn_and_the_frame_that_decides_ends_it():
    seen = set()
    for seed in range(12):
        steps, terminated, env = whole(seed)
        last = steps[-1][1]
        assert terminated and {last["frames_won"], last["opponent_frames"]} >= {3}
        assert last["winner"] == int(last["opponent_frames"] == 3)
        first = env.get_state()["first_break"]
        for _, info, breaker, shown in steps:
            assert breaker == (first + info["frame"]) % 2
            won, lost = info["frames_won"], info["opponent_frames"]
            seen_frames = [won / (won + 1), lost / (lost + 1), 3 / 4, float(breaker == 0)]
            assert shown[FRAMES_SEEN] == pytest.approx(seen_frames)
        assert last["frame"] == last["frames_won"] + last["opponent_frames"] - 1
        seen.add((last["frames_won"], last["opponent_frames"]))
    assert len(seen) > 2


@pytest.mark.parametrize("reward", ["win", "frames"])
def test_rewards_add_up(reward):
    for seed in range(10):
        steps, _, _ = whole(seed, reward=reward, opponent="ghost_ball", noise="club")
        total, last = sum(step[0] for step in steps), steps[-1][1]
        if reward == "frames":
            assert total == last["frames_won"] - last["opponent_frames"]
        else:
            assert total == steps[-1][0] == (1.0 if last["winner"] == 0 else -1.0)


def test_a_frame_that_is_stopped_truncates_the_match():
    env = begun(frame_env(task="match", max_strokes=5))
    ends = [env.step([-1.0, 0, 0, 0.9, 0, 0, 0])[2:4] for _ in range(5)]
    assert ends == [(False, False)] * 4 + [(False, True)]


def test_reset_says_who_breaks_and_the_errors_do_not_depend_on_it():
    drawn = set()
    for seed in range(6):
        ends = {}
        for breaker in (None, 0, 1):
            env = frame_env(opponent="random", noise="club")
            env.reset(seed=seed, options={} if breaker is None else {"breaker": breaker})
            assert breaker in (None, env.frame.breaker)
            ends[breaker] = env.get_state()
        drawn.add(ends[None]["frame"]["breaker"])
        assert ends[None] == ends[ends[None]["frame"]["breaker"]]
    assert drawn == {0, 1}


def test_reset_says_who_breaks_on_many_tables_and_in_a_match():
    tables = sn.SnookerVectorEnv(4, task="match", opponent="ghost_ball", threads=1)
    for breakers in (1, [0, 1, 1, 0], np.array([1, 0, 1, 0])):
        tables.reset(seed=3, options={"breaker": breakers})
        assert [tables.tables.frame(k).breaker for k in range(4)] == np.broadcast_to(breakers, 4).tolist()
    pytest.importorskip("pettingzoo")
    match = sn.match_env()
    for breaker in (0, 1):
        match.reset(seed=1, options={"breaker": breaker})
        assert match.agent_selection == f"player_{breaker}"
