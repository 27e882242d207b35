"""Do observations and infos say what lies on the table, and are they the caller's own?"""

import numpy as np
import pytest

from snooker_env import SnookerEnv
from snooker_env.game.balls import BLACK, CUE, N_BALLS, SPOTS, BallOn
from snooker_env.tasks import observations
from tests.refusals import refused
from tests.tables import INFO, drawn, table_state


def describe(env):
    """What the observation must say, from the state itself."""
    rows = []
    values = [0] + [1] * 15 + [2, 3, 4, 5, 6, 7]
    for ball in range(N_BALLS):
        x, y = env.positions[ball] if env.on_table[ball] else (0.0, 0.0)
        sequence = env.ball_on > 1 and ball == env.ball_on + 14
        may = {BallOn.RED: 1 <= ball < 16, BallOn.ANY_COLOUR: ball >= 16}.get(env.ball_on, sequence)
        rows.append([x / 0.889, y / 1.7845, env.on_table[ball], values[ball] / 7, may and env.on_table[ball]])
    on = [env.ball_on == k for k in range(8)]
    state = [env.on_table[1:16].sum() / 15, *on, env.in_hand, env.points / 155]
    return np.array(rows, np.float32), np.array(state, np.float32)


@pytest.mark.parametrize("layout", ["opened", "break_off", "colours", "random:6"])
def test_observations_say_where_the_balls_lie_and_what_is_on(layout):
    kinds = ("flat", "balls")
    flat, rows = (SnookerEnv(layout=layout, aim="target", observation=kind) for kind in kinds)
    assert set(rows.observation_space.spaces) == {"balls", "state"}
    for seed in range(6):
        a, b = flat.reset(seed=seed)[0], rows.reset(seed=seed)[0]
        while True:
            balls, state = describe(flat)
            assert np.array_equal(a, np.concatenate([b["balls"].ravel(), b["state"]]))
            assert np.abs(b["balls"] - balls).max() < 1e-6 and np.abs(b["state"] - state).max() < 1e-6
            assert flat.observation_space.contains(a) and rows.observation_space.contains(b)
            assert a.dtype == b["balls"].dtype == b["state"].dtype == np.float32
            if flat.over:
                break
            a, b = flat.step(np.zeros(4))[0], rows.step(np.zeros(4))[0]


OF_FRAMES = {"task": "frame", "opponent": "random", "max_strokes": 40}
SAID = {"says": ["nominate", "concede", "claim", "lot"], "miss": "clear_path"}
MASKED = {
    "opened": {},
    "colours": {"layout": "colours", "noise": "club"},
    "all that is said": OF_FRAMES | SAID,
    "match": OF_FRAMES | {"task": "match", "frames": 3, "layout": "random:0"},
}


@pytest.mark.parametrize("options", MASKED.values(), ids=MASKED)
def test_masked_observations_hold_the_flat_one_and_the_available_choices(options):
    """Also at the end, where at least one choice stays available: no learner divides by nothing."""
    flat, masked = (SnookerEnv(action="discrete", observation=kind, **options) for kind in ("flat", "masked"))
    assert set(masked.observation_space.spaces) == {"observations", "action_mask"}
    assert masked.observation_space["observations"] == flat.observation_space
    assert masked.observation_space["action_mask"].shape == (masked.action_space.n,)
    rng, kinds, ends = np.random.default_rng(0), set(), 0
    for seed in range(6):
        a, b = flat.reset(seed=seed)[0], masked.reset(seed=seed)[0]
        done = False
        while True:
            assert np.array_equal(a, b["observations"]) and a.dtype == b["observations"].dtype
            assert b["action_mask"].dtype == np.int8
            assert np.array_equal(b["action_mask"], masked.action_masks())
            assert np.array_equal(flat.action_masks(), masked.action_masks())
            assert masked.observation_space.contains(b)
            assert b["action_mask"].any()
            kinds.add(b["action_mask"].tobytes())
            if done:
                ends += 1
                break
            action = drawn(flat, rng)
            a, reward, terminated, truncated, info = flat.step(action)
            b, *others = masked.step(action)
            assert others == [reward, terminated, truncated, info]
            done = terminated or truncated
    assert ends == 6 and len(kinds) > 1


def test_infos_have_the_same_keys_and_types_at_all_times():
    env = SnookerEnv(aim="target", layout="random:6", noise="club")
    seen = {}
    for seed in range(25):
        infos = [env.reset(seed=seed)[1]]
        while not env.over:
            _, reward, terminated, truncated, info = env.step(np.array([0.3, 0, 0, 0]))
            assert type(reward) is float and type(terminated) is bool and truncated is False
            infos.append(info)
        for info in infos:
            assert {k: type(v) for k, v in info.items()} == INFO
            for k, v in info.items():
                seen.setdefault(k, set()).add(v)
    assert all(len(values) > 1 for values in seen.values()), seen  # none of them is a constant


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("kind", ["flat", "balls"])
def test_a_ball_at_rest_in_the_mouth_of_a_pocket_is_seen_where_it_lies(kind, side):
    """Past the noses."""
    env = SnookerEnv(observation=kind)
    table_state(env, {CUE: (0.0, 0.0), 1: (side * 0.897, side * 0.033), BLACK: SPOTS[BLACK]}, BallOn.RED)
    observation, _ = env.reset(options={"state": env.get_state()})
    assert env.observation_space.contains(observation)
    row = observation["balls"][1] if kind == "balls" else observation[5:10]
    assert np.allclose(row[:2], (side * 0.897 / 0.889, side * 0.033 / 1.7845), atol=1e-7, rtol=0)


def test_a_table_with_deeper_mouths_than_observations_reach_is_refused(monkeypatch):
    """On snooker's own table a ball can rest 11 mm past the noses."""
    monkeypatch.setattr(observations, "REACH", 1.014)
    SnookerEnv(table="match")
    monkeypatch.setattr(observations, "REACH", 1.012)
    ends = "past the noses, where observations end (one can 0.0117 m"
    refused(lambda: SnookerEnv(table="match"), "table", "match", ends)
