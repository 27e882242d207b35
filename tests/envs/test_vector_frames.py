"""Do native vector frames play, bit for bit, what ``SyncVectorEnv`` plays, with all that goes with them?"""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env import SnookerEnv, SnookerVectorEnv
from snooker_env.tasks.options import Options
from tests.envs.test_vector import MODES, check_equal, same
from tests.tables import acting


def policy(observation, rng):
    """An opponent in Python that draws from its generator and reads its observation."""
    return np.clip(
        rng.uniform(-1.0, 1.0, 7) * (1.0, 0.3, 0.3, 0.5, 1.0, 1.0, 1.0) + 0.01 * observation[0], -1.0, 1.0
    )


FULL = {"says": ["decision"], "placement": True, "aim": "target", "noise": "club"}
GHOST = {"opponent": "ghost_ball"}
MASKED = {"action": "discrete", "observation": "masked", "layout": "random:1"}
OPTIONS = {
    "alone": {"layout": "opened", "miss": "clear_path"},
    "alone, few balls": {"layout": "random:0", "aim": "target", "noise": "professional", "max_strokes": 25},
    "random": FULL | {"opponent": "random", "layout": "random:1", "miss": "clear_path"},
    "ghost_ball": GHOST | {"layout": "random:1", "aim": "target", "observation": "balls", "reward": "win"},
    "ghost_ball breaks": FULL | GHOST | {"max_episode_steps": 4},
    "player": FULL | {"opponent": acting(policy), "layout": "random:0", "max_strokes": 15},
    "discrete": {"opponent": "random", "layout": "colours", "action": "discrete", "noise": "amateur"}
    | {"max_strokes": 30},
    "masked": GHOST | MASKED | {"says": ["nominate", "concede"], "miss": "clear_path", "max_strokes": 20},
    "masked, alone": MASKED | {"max_strokes": 12, "max_episode_steps": 9},
    "discrete, ghost_ball": GHOST | {"layout": "random:2", "action": "discrete", "max_episode_steps": 5},
}


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("options", OPTIONS.values(), ids=OPTIONS)
def test_they_equal_sync_vector_env(mode, options, monkeypatch):
    monkeypatch.setattr("snooker_env.tasks.threads.CHUNK", 4)
    ends, *_, infos = check_equal(9, mode, 45, threads=3, task="frame", **options)
    strokes = sum(info["opponent_strokes"].sum() for info in infos)
    assert ends > 0 or options["layout"] == "opened"
    assert (strokes > 100) == ("opponent" in options)


def test_an_error_of_an_opponent_asks_for_a_reset():
    def failing(observation, rng):
        raise KeyError("no turn")

    env = SnookerVectorEnv(4, task="frame", opponent=acting(failing))
    with pytest.raises(RuntimeError, match="no turn"):
        env.reset(seed=3)
    with pytest.raises(Exception, match=r"reset\(\) before step"):
        env.step(np.zeros((4, 4)))


VISIT = {"noise": "club", "aim": "target", "layout": "random:6"}
FRAME = FULL | {"task": "frame", "opponent": "random", "miss": "clear_path", "layout": "random:3"}


@pytest.mark.parametrize("options", [VISIT, FRAME])
def test_states_go_from_one_table_to_many_and_back(options):
    one, many = SnookerEnv(**options), SnookerVectorEnv(3, **options)
    one.reset(seed=4)
    rng, size = np.random.default_rng(0), one.action_space.shape
    if "task" in options:
        for _ in range(6):
            one.step(rng.uniform(-1, 1, size))
    state = one.get_state()
    many.reset(options={"states": [state] * 3})
    assert many.get_state() == [state] * 3
    a = rng.uniform(-1, 1, size)
    want, got = one.step(a), many.step(np.tile(a, (3, 1)))
    assert all(np.array_equal(row, want[0]) for row in got[0]) and got[1].tolist() == [want[1]] * 3
    assert many.get_state()[2] == one.get_state() and many.call("frame")[1] == one.frame
    many.reset(seed=1, options={"state": state})
    one.set_state(many.get_state()[1])
    assert one.get_state() == many.get_state()[1]
    for wrong in ({"states": [state]}, {"layout": 3}):
        with pytest.raises(ValueError, match="options"):
            many.reset(options=wrong)


def test_options_are_checked_once_and_taken_by_every_environment():
    keywords = {"task": "frame", "layout": "random:2", "noise": "club", "says": ["decision"]}
    options = Options(**keywords)
    for one, other in (
        (SnookerEnv(options), SnookerEnv(**keywords)),
        (SnookerVectorEnv(2, options), SnookerVectorEnv(2, **keywords)),
    ):
        assert one.options == other.options == options and same(one.reset(seed=2), other.reset(seed=2))
    assert Options().but(task="frame") == Options(task="frame")
    assert Options(task="frame").but(task="visit").rules.plan.name == "opened"
    level = {"aim_deg": 0.1}
    frozen = Options(noise=level)
    level["aim_deg"] = 5.0  # what is given may change: what is played does not
    assert frozen.rules.noise.aim_deg == frozen.but(aim="target").rules.noise.aim_deg == 0.1
    assert hash(frozen) == hash(Options(noise={"aim_deg": 0.1}))
    changed = options.but(noise="none")
    assert changed.noise == "none" and options.noise == "club" and changed.rules.noise.silent
    with pytest.raises(AttributeError):
        options.noise = "none"  # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(ValueError, match=r"options = an Options: must be None with the keywords \['layout'"):
        SnookerEnv(options, layout="colours")
    for make in (SnookerEnv, lambda **k: SnookerVectorEnv(2, **k), Options):
        with pytest.raises(TypeError, match="layuot"):
            make(layuot="colours")


def test_a_match_takes_them_too():
    pytest.importorskip("pettingzoo")
    env = sn.match_env(Options(task="frame", layout="random:2", aim="target"))
    assert env.action_space("player_0").shape == (4,)
    assert sn.match_env().action_space("player_0").shape == (7,)
