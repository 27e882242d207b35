"""Does ``Snooker-v0`` keep Gymnasium's contract? Checkers of two libraries, names, specs, pictures."""

import json
import warnings
from itertools import product

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env, data_equivalence

import snooker_env as sn
from snooker_env import SnookerEnv, SnookerVectorEnv, match_env
from snooker_env._lib.registration import FORMS
from snooker_env.benchmark.tasks import FREE
from snooker_env.tasks import observations
from snooker_env.tasks.box_actions import AIMS
from snooker_env.tasks.options import Options
from tests.envs.one_by_one import same
from tests.tables import viewed

IDS = sorted(name for name in gymnasium.registry if name.startswith("Snooker") and name not in FORMS)
SHOWN = ("rgb_array", "ansi", "human")


def free(name, arguments):
    """Those of the arguments that an id leaves free: the benchmark's tasks freeze the game itself."""
    some = (*FREE, "render_mode")
    if name in ("SnookerFrame-v0", "SnookerSafety-v0") and arguments.get("observation") == "pots":
        arguments = arguments | {"observation": "default"}  # pots are shown in visits
    return {key: value for key, value in arguments.items() if name == "Snooker-v0" or key in some}


@pytest.fixture
def no_display(monkeypatch):
    """As on a server."""
    pytest.importorskip("pygame")
    for variable in ("SDL_VIDEODRIVER", "DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setattr("sys.platform", "linux")


@pytest.mark.parametrize(
    ("name", "render_mode"),
    [
        *((name, None) for name in IDS),
        *product(("Snooker-v0",), SHOWN),
        pytest.param("SnookerFrame-v0", "human", marks=pytest.mark.slow),
    ],
)
@pytest.mark.parametrize(
    ("observation", "aim"), list(zip(observations.OBSERVATIONS, (*AIMS, "absolute", "pot"), strict=True))
)
def test_gymnasium_checks_it(name, render_mode, observation, aim, screen, strict):
    arguments = {**viewed(observation), "render_mode": render_mode, "aim": aim, "layout": "random:2"}
    env = gymnasium.make(name, **free(name, arguments)).unwrapped
    # this check builds the environment once more for each render mode
    every_mode = render_mode is None and aim == "absolute"
    check_env(env, skip_render_check=not every_mode)
    if not every_mode:  # it opens the window too, where the opponent breaks
        assert (len(screen) > 0) == (render_mode == "human")
    env.close()


@pytest.mark.parametrize("name", IDS)
def test_gymnasium_checks_it_on_a_server_without_a_display(name, no_display, strict):
    """It makes and resets an environment of each mode, "human" too."""
    check_env(gymnasium.make(name, **free(name, {"layout": "random:2"})).unwrapped)


def test_a_window_without_a_display_is_refused_at_the_first_stroke(no_display):
    """Before anything is played; the environment can be used on where there is a display."""
    for env, size in ((SnookerEnv(render_mode="human"), 4), (match_env(render_mode="human"), 7)):
        env.reset(seed=1)
        before = env.get_state()
        with pytest.raises(RuntimeError, match=r'^a window \(render_mode="human"\) needs a display, and'):
            env.step(np.zeros(size, np.float32))
        assert data_equivalence(env.get_state(), before)


ALLOWED = {"balls": {"Your observation balls has an unconventional shape"}}
"""Stable-Baselines3 warns of a table of balls, which is neither a vector nor an image, but meant so."""


@pytest.mark.parametrize(
    ("name", "render_mode"),
    [("Snooker-v0", None), ("Snooker-v0", "rgb_array"), ("Snooker-v0", "ansi")]
    + [
        pytest.param(name, None, marks=[pytest.mark.slow] * ("Frame" not in name))
        for name in IDS
        if name != "Snooker-v0"
    ],
)
@pytest.mark.parametrize("observation", observations.OBSERVATIONS)
@pytest.mark.parametrize("longer", [{"elevation": True, "placement": True, "layout": "break_off"}])
def test_stable_baselines_checks_it(name, observation, longer, render_mode):
    checker = pytest.importorskip("stable_baselines3.common.env_checker")
    if observation == "masked":  # of discrete actions, which have no longer form
        longer = {key: value for key, value in longer.items() if key == "layout"}
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        arguments = free(name, {**viewed(observation), "render_mode": render_mode, **longer})
        checker.check_env(gymnasium.make(name, **arguments), warn=True)
    # (the garbage collector may close files of earlier tests meanwhile, and say so)
    checked = [w for w in caught if not issubclass(w.category, ResourceWarning)]
    allowed = ALLOWED.get(observation, set())
    if observation == "balls" and gymnasium.make(name).unwrapped.options.miss != "off":
        allowed = allowed | {"Your observation replaced has an unconventional shape"}
    assert {str(w.message).partition(" (")[0] for w in checked} == allowed


SPECS = [
    {},
    {"aim": "target", "observation": "balls", "noise": {"aim_deg": 0.1}, "table": "tight"}
    | {"physics": {"preset": "match", "mu_s": 0.2}},
    {"layout": "break_off", "placement": True, "elevation": True, "reward": "pots", "noise": "club"}
    | {"fidelity": "euler:50"},
    {"action": "discrete", "observation": "masked", "layout": "colours"},
]


@pytest.mark.parametrize(
    ("name", "arguments"), [*product(["Snooker-v0"], SPECS), *((name, {"aim": "target"}) for name in IDS)]
)
def test_a_spec_survives_json(name, arguments):
    arguments = free(name, arguments)
    env = gymnasium.make(name, **arguments)
    text = env.spec.to_json()
    spec = gymnasium.envs.registration.EnvSpec.from_json(json.dumps(json.loads(text)))
    assert spec == env.spec and spec.kwargs == arguments
    other = gymnasium.make(spec)
    assert other.observation_space == env.observation_space and other.action_space == env.action_space
    env.reset(seed=3), other.reset(seed=3)
    action = np.full(env.action_space.shape, 0.25, np.float32) if env.action_space.shape else 67
    assert data_equivalence(env.step(action), other.step(action), exact=True)


def test_it_is_made_by_either_name():
    assert "Snooker-v0" in IDS
    assert isinstance(gymnasium.make("snooker_env:Snooker-v0").unwrapped, SnookerEnv)
    assert gymnasium.make("Snooker-v0").unwrapped.spec.id == "Snooker-v0"


def test_text_says_how_the_game_stands():
    visit = SnookerEnv(render_mode="ansi", layout="break_off")
    visit.reset(seed=1)
    assert "break 0   on: red   reds: 15" in visit.render()
    match = match_env(render_mode="ansi", task="match", frames=3)
    match.reset(seed=1)
    assert "frames 0 - 0   0 - 0   player 1, break 0   on: red" in match.render()


@pytest.mark.parametrize(("mode", "kind"), [("rgb_array", np.ndarray), ("ansi", str), ("human", type(None))])
def test_rendering_gives_what_the_mode_says_and_changes_nothing(mode, kind, screen):
    env, blind = (SnookerEnv(render_mode=m, layout="random:2", noise="club") for m in (mode, None))
    env.reset(seed=1), blind.reset(seed=1)
    first, action = env.render(), np.array([0, 0, 0, 0.3], np.float32)
    assert isinstance(first, kind)
    if mode == "rgb_array":
        assert first.dtype == np.uint8 and first.ndim == 3 and first.shape[2] == 3 and first.std() > 10
    assert data_equivalence(env.step(action), blind.step(action), exact=True)
    second = env.render()
    assert isinstance(second, kind) and (mode == "human" or not np.array_equal(first, second))
    assert data_equivalence(env.get_state(), blind.get_state(), exact=True)
    if mode == "human":
        assert len(screen) == 1 and screen[0][0] > 20 and screen[0][1] == 30


def test_options_are_checked_once_and_taken_by_every_environment():
    keywords = {"task": "frame", "layout": "random:2", "noise": "club", "says": ["decision"]}
    options = Options(**keywords)
    many = SnookerVectorEnv(2, options), SnookerVectorEnv(2, **keywords)
    for one, other in ((SnookerEnv(options), SnookerEnv(**keywords)), many):
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


def test_recorders_film_a_picture_a_step(tmp_path):
    env = gymnasium.wrappers.RecordVideo(
        gymnasium.make("Snooker-v0", render_mode="rgb_array", one_stroke=True),
        tmp_path / "films",
        lambda _: True,
    )
    env.reset(seed=0)
    env.step(env.action_space.sample())
    pictures = len(env.recorded_frames)
    env.close()
    assert pictures == 2 and len(list(tmp_path.glob("films/*.mp4"))) == 1
