"""Does ``task="frame"`` keep Gymnasium's contract? The checker, spaces, infos, states, pictures."""

import inspect
import json

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env, data_equivalence

from snooker_env.envs.snooker import SnookerEnv
from snooker_env.game.balls import YELLOW, BallOn
from snooker_env.tasks import observations
from snooker_env.tasks.options import NAMES
from tests.tables import frame_env, viewed


@pytest.mark.parametrize("observation", observations.OBSERVATIONS)
@pytest.mark.parametrize("opponent", ["none", "random", "ghost_ball"])
def test_gymnasium_checks_it(observation, opponent):
    decision = observation != "masked"  # which is of discrete actions
    env = gymnasium.make(
        "Snooker-v0",
        task="frame",
        opponent=opponent,
        **viewed(observation),
        layout="random:2",
        decision=decision,
    )
    check_env(env.unwrapped, skip_render_check=True)
    assert env.spec.to_json()
    assert gymnasium.make(gymnasium.envs.registration.EnvSpec.from_json(env.spec.to_json())).spec == env.spec


def test_the_spaces_grow_and_those_of_a_visit_do_not():
    assert SnookerEnv().observation_space.shape == (121,) and SnookerEnv().action_space.shape == (4,)
    assert frame_env().observation_space.shape == (140,) and frame_env().action_space.shape == (7,)
    assert frame_env(miss="clear_path").observation_space.shape == (206,)
    assert frame_env(observation="balls").observation_space["state"].shape == (30,)
    assert "replaced" not in frame_env(observation="balls").observation_space.spaces
    assert frame_env(observation="balls", miss="clear_path").observation_space["replaced"].shape == (22, 3)
    discrete = {"action": "discrete", "observation": "masked", "decision": False, "placement": False}
    masked = frame_env(**discrete, nominate=True, concede=True, miss="clear_path").observation_space
    assert masked["observations"].shape == (206,) and masked["action_mask"].shape == (7 * 540 + 1,)
    assert frame_env(decision=False, placement=False).action_space.shape == (4,)
    assert len(observations.FRAME_ENTRIES) == 19


def test_the_default_layout_is_that_of_the_task():
    assert SnookerEnv().options.rules.plan.name == "opened"
    assert frame_env().options.rules.plan.name == "break_off"
    env = frame_env(layout="colours")
    env.reset(seed=0)
    assert env.ball_on == BallOn.YELLOW and not env.in_hand


def play(env, seed, steps=40):
    rng = np.random.default_rng(seed)
    out = [env.reset(seed=seed)]
    for _ in range(steps):
        out.append(env.reset() if env.over else env.step(rng.uniform(-1, 1, env.action_space.shape)))
    return out


@pytest.mark.parametrize("opponent", ["none", "random", "ghost_ball"])
def test_the_seed_decides_everything(opponent):
    runs = [play(frame_env(opponent=opponent, noise="club", layout="random:3"), seed) for seed in (1, 1, 2)]
    assert data_equivalence(runs[0], runs[1], exact=True)
    assert not data_equivalence(runs[0], runs[2], exact=True)


def test_who_breaks_is_drawn_from_the_seed():
    env = frame_env(opponent="ghost_ball")
    strokes = [env.reset(seed=seed)[1]["opponent_strokes"] for seed in range(30)]
    assert 5 < sum(n > 0 for n in strokes) < 25
    alone = frame_env()
    assert not any(alone.reset(seed=seed)[1]["opponent_strokes"] for seed in range(10))


def test_infos_have_the_same_keys_and_types_at_all_times():
    env = frame_env(opponent="random", layout="random:4")
    infos = [out[-1] for out in play(env, 3, 150)]
    assert len({tuple(sorted((k, type(v).__name__) for k, v in info.items())) for info in infos}) == 1
    assert {
        "score",
        "opponent_score",
        "opponent_strokes",
        "winner",
        "choice",
        "free_ball",
        "needs_snookers",
        "clock",
        "misses",
        "failures",
        "anywhere",
        "warned",
    } <= set(infos[0])
    assert {info["winner"] for info in infos} > {-1} and {info["choice"] for info in infos} == {True, False}


@pytest.mark.parametrize("opponent", ["none", "random", "ghost_ball"])
def test_a_saved_state_plays_on_bit_for_bit(opponent):
    options = {"opponent": opponent, "noise": "club", "miss": "clear_path", "layout": "random:6"}
    env = frame_env(**options)
    play(env, 5, 7)
    text = json.dumps(env.get_state())
    other = frame_env(**options)
    obs, _ = other.reset(options={"state": json.loads(text)})
    assert data_equivalence(obs, env.tables.observe(np.zeros(1, np.int64), 0)[0], exact=True)
    assert json.dumps(other.get_state()) == text
    for _ in range(30):
        if env.over:
            break
        action = np.random.default_rng(0).uniform(-1, 1, 7)
        assert data_equivalence(env.step(action), other.step(action), exact=True)
    assert json.dumps(other.get_state()) == json.dumps(env.get_state())


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda s: s.pop("frame"), "a dict without"),
        (lambda s: s["frame"].update(miss="clear_path"), "as this environment plays"),
        (lambda s: s["on_table"].__setitem__(YELLOW, False), "must hold the cue ball"),
        (lambda s: s["frame"].update(phase="end"), "phase"),
    ],
)
def test_states_that_are_not_sound_are_refused(change, message):
    env = frame_env()
    env.reset(seed=1)
    state = json.loads(json.dumps(env.get_state()))
    change(state)
    with pytest.raises(ValueError, match=message):
        env.set_state(state)


@pytest.mark.parametrize("mode", ["rgb_array", "ansi"])
def test_pictures(mode):
    if mode == "rgb_array":
        pytest.importorskip("pygame")
    env, plain = frame_env(render_mode=mode, opponent="ghost_ball"), frame_env(opponent="ghost_ball")
    env.reset(seed=1), plain.reset(seed=1)
    first = env.render()
    # looking changes nothing
    assert data_equivalence(env.step(np.zeros(7)), plain.step(np.zeros(7)), exact=True)
    assert not np.array_equal(first, env.render())
    assert mode != "ansi" or " - " in env.render()


def test_every_argument_is_documented():
    for name in (*NAMES, "render_mode", "render_size"):
        assert f"{name}" in SnookerEnv.__doc__
    assert set(inspect.signature(SnookerEnv).parameters) == {
        "options",
        "render_mode",
        "render_size",
        "keywords",
    }
