"""Does ``Snooker-v0`` keep Gymnasium's contract, and is the game it plays snooker? Checkers, seeds, states, actions, noise, rules, play."""

import copy
import json
import math
import pickle
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env, data_equivalence

import snooker_env as sn
from snooker_env.envs import observations
from snooker_env.envs.actions import AIMS, MAX_ELEVATION, MAX_SPEED, MIN_SPEED, TARGET_SPAN
from snooker_env.envs.noise import LEVELS, Noise
from snooker_env.envs.rewards import REWARDS
from snooker_env.envs.snooker import SnookerEnv
from snooker_env.game.balls import BALL_RADIUS, BAULK_Y, BLACK, BLUE, CUE, D_RADIUS, N_BALLS, PINK, SPOTS, YELLOW, BallOn
from snooker_env.game.pots import POCKETS, pots
from snooker_env.game.ruling import Foul
from snooker_env.render import pygame_view

IDS = sorted(name for name in gymnasium.registry if name.startswith("Snooker"))
LAYOUTS = ("opened", "held_out", "break_off", "line_up", "colours", "random:0", "random:1", "random:15")
SPANS = (0.0, 0.25, 0.5, 1.0)
R = BALL_RADIUS


@pytest.fixture
def screen(monkeypatch):
    """A display that is none; shots are drawn without waiting for the clock."""
    pytest.importorskip("pygame")
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    shown = []

    def play(self, scenes, fps=30.0):
        shown.append((len(list(scenes)), fps))
        return True

    monkeypatch.setattr(pygame_view.Window, "play", play)
    return shown


@pytest.fixture
def strict():
    """Every warning is an error."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield


# Gymnasium's and Stable-Baselines3's own checkers


@pytest.mark.parametrize("name", IDS)
@pytest.mark.parametrize("render_mode", [None, "rgb_array", "ansi", "human"])
@pytest.mark.parametrize("observation", observations.OBSERVATIONS)
@pytest.mark.parametrize("aim", AIMS)
def test_gymnasium_checks_it(name, render_mode, observation, aim, screen, strict):
    env = gymnasium.make(name, observation=observation, render_mode=render_mode, aim=aim, layout="random:2").unwrapped
    every_mode = render_mode is None and aim == "absolute"  # this check builds the environment once more for each render mode
    check_env(env, skip_render_check=not every_mode)
    assert (len(screen) > 0) == (render_mode == "human")
    env.close()


ALLOWED = {"flat": set(), "balls": {"Your observation balls has an unconventional shape"}}
"""The one warning that Stable-Baselines3 gives: a table of balls is neither a vector nor an image. The observation is meant so."""


@pytest.mark.parametrize("name", IDS)
@pytest.mark.parametrize("observation", observations.OBSERVATIONS)
@pytest.mark.parametrize("longer", [{}, {"elevation": True, "placement": True, "layout": "break_off"}])
@pytest.mark.parametrize("render_mode", [None, "rgb_array", "ansi"])
def test_stable_baselines_checks_it(name, observation, longer, render_mode):
    checker = pytest.importorskip("stable_baselines3.common.env_checker")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        checker.check_env(gymnasium.make(name, observation=observation, render_mode=render_mode, **longer), warn=True)
    assert {str(w.message).partition(" (")[0] for w in caught} == ALLOWED[observation]


def test_the_checker_can_fail(strict):
    """The same check sees an observation that is kept and changed later, and a space that is left."""

    class Kept(SnookerEnv):
        def step(self, action):
            observation, *rest = super().step(action)
            return observation * 3.0, *rest

    with pytest.raises((AssertionError, UserWarning)):
        check_env(Kept(), skip_render_check=True)


@pytest.mark.parametrize("name", IDS)
@pytest.mark.parametrize(
    "arguments",
    [
        {},
        {"aim": "target", "observation": "balls", "noise": {"aim_deg": 0.1}, "physics": {"preset": "match", "mu_s": 0.2}, "table": "tight"},
        {"layout": "break_off", "placement": True, "elevation": True, "reward": "pots", "noise": "club", "fidelity": "euler:50"},
    ],
)
def test_a_spec_survives_json(name, arguments):
    env = gymnasium.make(name, **arguments)
    text = env.spec.to_json()
    spec = gymnasium.envs.registration.EnvSpec.from_json(json.dumps(json.loads(text)))
    assert spec == env.spec and spec.kwargs == arguments
    other = gymnasium.make(spec)
    assert other.observation_space == env.observation_space and other.action_space == env.action_space
    env.reset(seed=3), other.reset(seed=3)
    action = np.full(env.action_space.shape, 0.25, np.float32)
    assert data_equivalence(env.step(action), other.step(action), exact=True)


def test_it_is_made_by_either_name():
    assert "Snooker-v0" in IDS
    assert isinstance(gymnasium.make("snooker_env:Snooker-v0").unwrapped, SnookerEnv)
    assert gymnasium.make("Snooker-v0").unwrapped.spec.id == "Snooker-v0"


def test_rendering_gives_what_the_mode_says(screen):
    for mode, kind in [("rgb_array", np.ndarray), ("ansi", str), ("human", type(None))]:
        env = SnookerEnv(render_mode=mode, layout="random:2")
        env.reset(seed=1)
        first = env.render()
        assert isinstance(first, kind)
        if mode == "rgb_array":
            assert first.dtype == np.uint8 and first.ndim == 3 and first.shape[2] == 3 and first.std() > 10
        env.step(np.array([0, 0, 0, 0.3], np.float32))
        second = env.render()
        assert isinstance(second, kind)
        assert kind is type(None) or not np.array_equal(first, second)
        env.close()
    assert len(screen) == 1 and screen[0][0] > 20 and screen[0][1] == SnookerEnv.metadata["render_fps"]


def test_looking_changes_nothing(screen):
    """With or without pictures the same shots."""
    runs = []
    for mode in (None, "rgb_array", "ansi", "human"):
        env = SnookerEnv(render_mode=mode, noise="club", layout="random:4", aim="target")
        obs, _ = env.reset(seed=9)
        trail = [obs]
        for _ in range(4):
            trail.append(env.step(np.zeros(4))[0])
            if mode in ("rgb_array", "ansi"):
                env.render()
            if env.over:
                env.reset()
        runs.append(np.array(trail).tobytes())
        env.close()
    assert len(set(runs)) == 1


# Seeds


def play(env, seed, steps=6, actions=1):
    """The bytes of everything a run returns."""
    rng = np.random.default_rng(actions)
    out = [env.reset(seed=seed)]
    for _ in range(steps):
        out.append(env.step(rng.uniform(-1, 1, env.action_space.shape) * SPANS[2]))
        if out[-1][2]:
            out.append(env.reset())
    return pickle.dumps(jsonable(out))


def jsonable(x):
    """Arrays as bytes, so that equality is equality of bits."""
    if isinstance(x, np.ndarray):
        return (x.dtype.str, x.shape, x.tobytes())
    if isinstance(x, dict):
        return {k: jsonable(v) for k, v in x.items()}
    if isinstance(x, list | tuple):
        return [jsonable(v) for v in x]
    return x


@pytest.mark.parametrize("layout", LAYOUTS)
def test_the_same_seed_plays_the_same_game_bit_for_bit(layout):
    env = SnookerEnv(layout=layout, noise="club", aim="target")
    first = play(env, 5)
    assert play(env, 5) == first  # again in the same environment
    assert play(SnookerEnv(layout=layout, noise="club", aim="target"), 5) == first  # and in a new one
    assert play(env, 6) != first


@pytest.mark.parametrize("layout", LAYOUTS)
def test_different_seeds_start_from_different_tables(layout):
    env = SnookerEnv(layout=layout)
    starts = {env.reset(seed=seed)[0].tobytes() for seed in range(8)}
    assert len(starts) == 8
    assert len({env.reset()[0].tobytes() for _ in range(8)}) == 8  # nor does the same table come again and again
    assert env.reset(seed=3)[0].tobytes() in starts


def test_noise_is_drawn_from_the_seed_alone():
    env = SnookerEnv(noise="club")
    state = env.reset(seed=1) and env.get_state()
    ends = []
    for seed in (1, 2, 1):
        env.reset(options={"state": state | {"stream": [seed, 0]}})
        env.step(np.zeros(4))
        ends.append(env.positions.tobytes())
    assert ends[0] == ends[2] != ends[1]


def test_the_random_numbers_of_others_are_left_alone():
    """Neither numpy's nor Python's global generator is used or moved."""
    import random

    env = SnookerEnv(noise="club", layout="random:5", placement=True)
    runs = []
    for seed in (1, 2):
        np.random.seed(seed)  # noqa: NPY002 - the global generator is what is tested
        random.seed(seed)
        before = np.random.get_state()[1].tobytes(), np.random.get_state()[2], random.getstate()  # noqa: NPY002
        runs.append(play(env, 4))
        assert (np.random.get_state()[1].tobytes(), np.random.get_state()[2], random.getstate()) == before  # noqa: NPY002
    assert runs[0] == runs[1]


# Observations and infos


@pytest.mark.parametrize("observation", observations.OBSERVATIONS)
def test_what_is_returned_is_the_callers_own(observation):
    """Spoiling every array and info that was returned changes nothing that comes later."""
    clean, spoiled = (SnookerEnv(observation=observation, noise="club", layout="random:3") for _ in range(2))
    want, got = clean.reset(seed=2), spoiled.reset(seed=2)
    rng = np.random.default_rng(0)
    for _ in range(8):
        assert data_equivalence(want, got, exact=True)
        for array in got[0].values() if isinstance(got[0], dict) else [got[0]]:
            array[:] = 0.123
        got[-1].clear()
        state = spoiled.get_state()
        state["positions"][0][0] = 0.5
        state["on_table"][1] = False
        state["stream"][1] = 7
        state["rng"]["state"]["state"] = 0
        if clean.over:
            want, got = clean.reset(), spoiled.reset()
        else:
            action = rng.uniform(-1, 1, 4)
            want, got = clean.step(action), spoiled.step(action)


def describe(env):
    """What the observation must say, from the state itself."""
    rows = []
    values = [0] + [1] * 15 + [2, 3, 4, 5, 6, 7]
    for ball in range(N_BALLS):
        x, y = env.positions[ball] if env.on_table[ball] else (0.0, 0.0)
        sequence = env.ball_on > 1 and ball == env.ball_on + 14
        may = {BallOn.RED: 1 <= ball < 16, BallOn.ANY_COLOUR: ball >= 16}.get(env.ball_on, sequence)
        rows.append([x / 0.889, y / 1.7845, env.on_table[ball], values[ball] / 7, may and env.on_table[ball]])
    state = [env.on_table[1:16].sum() / 15, *(env.ball_on == k for k in range(8)), env.in_hand, env.points / 155]
    return np.array(rows, np.float32), np.array(state, np.float32)


@pytest.mark.parametrize("layout", LAYOUTS)
def test_observations_say_where_the_balls_lie_and_what_is_on(layout):
    flat, rows = SnookerEnv(layout=layout, aim="target"), SnookerEnv(layout=layout, aim="target", observation="balls")
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


INFO = {
    "points": float, "break": float, "foul": bool, "penalty": int, "pots": int, "fouls": int, "first_ball": int, "ball_on": int,
    "events": int, "seconds": float,
}  # fmt: skip


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


# Saved states, copies


def shots(env, n=5):
    """The next n shots, whatever happens: a new visit after an end."""
    out = []
    rng = np.random.default_rng(8)
    for _ in range(n):
        out.append(env.reset() if env.over else env.step(rng.uniform(-0.3, 0.3, env.action_space.shape)))
    return pickle.dumps(jsonable(out)), env.points, env.positions.tobytes(), json.dumps(env.get_state())


def midway(seed=0, **arguments):
    """An environment in mid-visit: after a pot, with a colour on."""
    env = SnookerEnv(**{"aim": "target", "noise": "club", "layout": "random:6"} | arguments)
    for k in range(seed, seed + 200):
        env.reset(seed=k)
        env.step(np.array([0.0, 0, 0, 0, *[0.0] * (env.action_space.shape[0] - 4)]))
        if not env.over:
            return env
    raise AssertionError("no pot in 200 shots")


@pytest.mark.parametrize("arguments", [{}, {"observation": "balls"}, {"placement": True, "elevation": True}])
def test_a_saved_state_plays_on_bit_for_bit(arguments):
    env = midway(**arguments)
    text = json.dumps(env.get_state())
    assert env.ball_on == BallOn.ANY_COLOUR and env.points > 0
    last = observations.observe(env.observation, env.positions, env.on_table, env.ball_on, env.on, env.in_hand, env.points)
    want = shots(env)
    for how in ("set_state", "reset", "elsewhere", "seeded"):
        other = env if how in ("set_state", "reset") else SnookerEnv(aim="target", noise="club", layout="random:6", **arguments)
        if how == "set_state":
            other.set_state(json.loads(text))
        else:
            obs, info = other.reset(options={"state": json.loads(text)}, seed=77 if how == "seeded" else None)
            assert data_equivalence(obs, last, exact=True)
            assert info["break"] == other.points and info["ball_on"] == BallOn.ANY_COLOUR and info["points"] == 0.0
        assert json.dumps(other.get_state()) == text
        assert shots(other) == want


def test_a_finished_visit_can_be_saved_too():
    env = midway()
    while not env.over:
        env.step(np.array([-1, 0, 0, 1.0]))
    state = json.loads(json.dumps(env.get_state()))
    other = SnookerEnv(aim="target", noise="club", layout="random:6")
    with pytest.raises(ValueError, match=r"state\.over = True"):  # there is no shot to play from it
        other.reset(options={"state": state})
    other.set_state(state)
    assert other.over
    with pytest.raises(gymnasium.error.ResetNeeded):
        other.step(np.zeros(4))


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))], ids=["deepcopy", "pickle"])
@pytest.mark.parametrize("render_mode", [None, "rgb_array", "human"])
def test_copies_play_on_alike_and_apart(copied, render_mode, screen):
    env = midway(render_mode=render_mode)
    twin = copied(env)
    assert twin.table is env.table  # no copy of what never changes
    assert shots(twin) == (want := shots(copied(env)))
    assert json.dumps(env.get_state()) == json.dumps(copied(env).get_state())  # the twins' shots left it alone
    assert shots(env) == want
    for one in (env, twin):
        one.close()


def test_a_wrapped_environment_is_copied_with_its_state():
    env = gymnasium.make("Snooker-v0", noise="club", layout="random:6")
    env.reset(seed=1)
    for twin in (copy.deepcopy(env), pickle.loads(pickle.dumps(env))):
        assert json.dumps(twin.unwrapped.get_state()) == json.dumps(env.unwrapped.get_state())
        assert shots(twin.unwrapped) == shots(copy.deepcopy(env).unwrapped)


def test_a_reset_is_needed_first_and_after_the_end():
    env = SnookerEnv(layout="random:3")
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(np.zeros(4))
    env.reset(seed=1)
    while not env.over:
        env.step(np.array([-1, 0, 0, 0.9]))
    before = json.dumps(env.get_state())
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(np.zeros(4))
    assert json.dumps(env.get_state()) == before
    env.reset()
    env.step(np.zeros(4))


# What an action means


def table_state(env, places, ball_on, points=0, **fields):
    """Put balls {id: (x, y)} and nothing else on the table."""
    positions, on_table = SPOTS.copy(), [False] * N_BALLS
    for ball, place in places.items():
        positions[ball], on_table[ball] = place, True
    if not env.np_random_seed:
        env.reset(seed=1)
    state = env.get_state() | {"positions": positions.tolist(), "on_table": on_table, "ball_on": int(ball_on), "points": points}
    env.set_state(state | {"in_hand": False, "over": False} | fields)


def after_strike(env, action):
    """The cue ball's velocity and spin as it leaves the tip."""
    env.step(np.array(action, np.float32))
    _, v, w = env.last_shot.at(0.0)
    return v[CUE], w[CUE]


def speed_of(a):
    return MIN_SPEED + (a + 1) / 2 * (MAX_SPEED - MIN_SPEED)


@pytest.mark.parametrize("side", [0.0, 1.0, -1.0, 0.5])
@pytest.mark.parametrize("aim", [-1.0, -0.75, -0.3, 0.0, 0.1, 0.5, 0.99])
def test_absolute_aim_is_the_direction_in_which_the_ball_leaves(side, aim):
    """Also with side spin: the squirt is compensated, so the cue itself points elsewhere."""
    env = SnookerEnv(render_mode="ansi")
    table_state(env, {CUE: (0.1, -0.5), 1: (0.6, 1.2)}, BallOn.RED)
    v, w = after_strike(env, [0.0, side, 0.0, aim])
    direction = math.pi * float(np.float32(aim))
    assert math.remainder(math.atan2(v[1], v[0]) - direction, 2 * math.pi) == pytest.approx(0.0, abs=1e-9)
    assert np.hypot(*v) == pytest.approx(speed_of(0.0), rel=1e-12)
    # right side turns the ball anticlockwise as seen from above: w = (5/2) v b / R^2 [TP A.30]
    assert w[2] == pytest.approx(2.5 * speed_of(0.0) * 0.5 * side / R, rel=1e-12)


def test_squirt_is_what_is_compensated():
    """With the same action, but no end mass to speak of in the formula, the cue's own direction is another one."""
    heavy, light = (SnookerEnv(physics={"end_mass_ratio": ratio}) for ratio in (5.0, 1e9))
    cues = []
    for env in (heavy, light):
        cues.append(env.actions.shot([0, 1, 0, 0.25], SPOTS, np.ones(N_BALLS, bool), 2)[3])
    assert cues[1] == pytest.approx(math.pi / 4, abs=1e-8)
    assert cues[0] - cues[1] == pytest.approx(-math.atan(2.5 * 0.5 * math.sqrt(0.75) / (1 + 5 + 2.5 * 0.75)), abs=1e-8)


@pytest.mark.parametrize(("a", "speed"), [(-1.0, 0.2), (1.0, 7.0), (0.0, 3.6), (-0.5, 1.9)])
def test_speed_is_linear_between_its_ends(a, speed):
    env = SnookerEnv(render_mode="ansi")
    table_state(env, {CUE: (0.1, -0.5), 1: (0.6, 1.2)}, BallOn.RED)
    assert np.hypot(*after_strike(env, [a, 0, 0, 0.3])[0]) == pytest.approx(speed, rel=1e-12)


@pytest.mark.parametrize(
    ("side", "top", "b", "t"),
    [(1, 0, 0.5, 0), (0, 1, 0, 0.5), (0, -1, 0, -0.5), (1, 1, math.sqrt(0.125), math.sqrt(0.125)), (-0.6, 0.8, -0.3, 0.4),
     (0.9, -1, 0.45 / math.sqrt(1.81), -0.5 / math.sqrt(1.81)), (0.5, 0.25, 0.25, 0.125)],
)  # fmt: skip
def test_the_tip_stays_on_the_disc_within_the_miscue_limit(side, top, b, t):
    """A pair outside is drawn back along its own direction, one inside is as it is."""
    env = SnookerEnv(render_mode="ansi")
    table_state(env, {CUE: (0.1, -0.5), 1: (0.6, 1.2)}, BallOn.RED)
    _, w = after_strike(env, [0.0, side, top, 0.0])
    scale = 2.5 * speed_of(0.0) / R
    cue = -env.actions.shot([0, side, top, 0], env.positions, env.on_table, 2)[3]  # how far the cue is turned against the squirt
    assert cue == pytest.approx(math.atan(2.5 * b * math.sqrt(1 - b * b) / (1 + 30 + 2.5 * (1 - b * b))), abs=1e-4)
    assert w[2] / scale == pytest.approx(b, abs=1e-4)
    assert w[1] / scale == pytest.approx(t, abs=1e-4)  # rolling along +x is a positive turn about +y
    assert np.hypot(*w[1:]) / scale <= 0.5 * (1 + 1e-12)


@pytest.mark.parametrize(("a", "degrees"), [(-1.0, 0.0), (0.0, 15.0), (1.0, 30.0)])
def test_elevation_lengthens_the_action_and_takes_speed(a, degrees):
    env = SnookerEnv(elevation=True, render_mode="ansi")
    assert env.action_space.shape == (5,) and SnookerEnv().action_space.shape == (4,)
    table_state(env, {CUE: (0.1, -0.5), 1: (0.6, 1.2)}, BallOn.RED)
    v, w = after_strike(env, [0.0, 1.0, 0.0, 0.0, a])
    angle = math.radians(degrees)
    assert math.radians(30) == MAX_ELEVATION
    assert np.hypot(*v) == pytest.approx(speed_of(0.0) * math.cos(angle), rel=1e-12)
    assert w[2] == pytest.approx(2.5 * speed_of(0.0) / R * 0.5 * math.cos(angle), rel=1e-12)
    assert w[0] == pytest.approx(2.5 * speed_of(0.0) / R * 0.5 * math.sin(angle), rel=1e-3, abs=1e-9)  # the masse part


def test_elevation_of_nothing_is_the_short_action():
    long, short = SnookerEnv(elevation=True, layout="random:4"), SnookerEnv(layout="random:4")
    for seed in range(5):
        long.reset(seed=seed), short.reset(seed=seed)
        a = np.random.default_rng(seed).uniform(-1, 1, 4)
        assert np.array_equal(long.step([*a, -1.0])[0], short.step(a)[0])


@pytest.mark.parametrize("elevation", [False, True])
@pytest.mark.parametrize(("a", "b"), [(0.0, -1.0), (0.0, 1.0), (-0.5, 0.0), (0.25, 0.5), (-0.8, -1.0)])
def test_placement_puts_the_ball_in_hand_where_it_says(a, b, elevation):
    env = SnookerEnv(layout="break_off", placement=True, elevation=elevation, render_mode="ansi")
    assert env.action_space.shape == (6 + elevation,)
    obs, _ = env.reset(seed=1)
    assert obs[-2] == 1.0  # in hand
    before = env.positions[CUE].copy()
    env.step(np.array([-1.0, 0, 0, 0.5, *[-1.0] * elevation, a, b]))
    placed = env.last_shot.at(0.0)[0][CUE]
    depth = D_RADIUS * math.sqrt(1 - a * a) * (b + 1) / 2
    want = (D_RADIUS * a, BAULK_Y - depth)
    if np.hypot(*(SPOTS[16:19] - want).T).min() > 2 * R + 1e-5:
        assert placed == pytest.approx(want, abs=1e-12)
    else:  # the brown's spot is taken: the nearest place where it is clear of it
        assert 2 * R < np.hypot(*(placed - SPOTS[18])) < 2 * R + 1e-5
    assert np.hypot(placed[0], placed[1] - BAULK_Y) <= D_RADIUS + 1e-12 and placed[1] <= BAULK_Y
    assert not np.array_equal(placed, before)


def test_placement_is_for_a_ball_in_hand_only():
    env = SnookerEnv(layout="random:4", placement=True, render_mode="ansi")
    ends = set()
    for place in ((0.0, 0.0), (0.7, -0.3), (-1.0, 1.0)):
        env.reset(seed=3)
        here = env.positions[CUE].copy()
        ends.add(env.step([0, 0, 0, 0.2, *place])[0].tobytes())
        assert np.array_equal(env.last_shot.at(0.0)[0][CUE], here)
    assert len(ends) == 1
    plain = SnookerEnv(layout="break_off", render_mode="ansi")  # without placement the ball lies where the layout put it
    plain.reset(seed=3)
    here = plain.positions[CUE].copy()
    plain.step([0, 0, 0, 0.5])
    assert np.array_equal(plain.last_shot.at(0.0)[0][CUE], here)


@pytest.mark.parametrize("a", [1.0, -1.0, 0.99, -0.99])
@pytest.mark.parametrize("b", [-1.0, 0.0, 1.0])
def test_no_placement_overlaps_a_ball(a, b):
    """The yellow and the green stand on the D's corners."""
    env = SnookerEnv(layout="break_off", placement=True, render_mode="ansi")
    env.reset(seed=1)
    env.step([-1.0, 0, 0, 0.5, a, b])
    start = env.last_shot.at(0.0)[0]
    assert np.hypot(*(start[1:] - start[CUE]).T).min() >= 2 * R - 1e-6


def straight(rng):
    """A straight pot: object ball, cue ball, direction, all clear of the cushions."""
    while True:
        pocket = POCKETS[rng.integers(6)]
        turn = rng.uniform(-0.35, 0.35)
        c, s = math.cos(turn), math.sin(turn)
        d = np.array([pocket[2] * c - pocket[3] * s, pocket[2] * s + pocket[3] * c])
        ball = pocket[:2] - rng.uniform(0.25, 0.6) * d
        cue = ball - rng.uniform(0.2, 0.5) * d
        if (np.abs([ball, cue]) < (0.8, 1.65)).all():
            return ball, cue, math.atan2(d[1], d[0])


def test_target_aim_of_nothing_pots_a_straight_ball():
    """a = 0 is the line of the best pot: any straight pot goes in, 3 degrees off it does not."""
    env = SnookerEnv(aim="target", render_mode="ansi")
    rng = np.random.default_rng(3)
    tried = astray = 0
    for _ in range(40):
        ball, cue, direction = straight(rng)
        black = (0.0, 0.3) if ball[1] * cue[1] > 0.05 else (-0.6, 1.4)
        if np.hypot(*(np.array([cue, ball]) - black).T).min() < 0.3:
            continue
        table_state(env, {CUE: cue, 1: ball, BLACK: black}, BallOn.RED)
        before = env.get_state()
        info = env.step([-0.4, 0.0, -0.3, 0.0])[4]
        v = env.last_shot.at(0.0)[1][CUE]
        assert math.remainder(math.atan2(v[1], v[0]) - direction, 2 * math.pi) == pytest.approx(0.0, abs=1e-6)
        assert info["pots"] == 1 and info["first_ball"] == 1
        assert env.last_shot.potted[1] >= 0
        for a in (-1.0, 1.0):
            env.set_state(before)
            tried, astray = tried + 1, astray + (env.step([-0.4, 0.0, -0.3, a])[4]["pots"] == 0)
            v = env.last_shot.at(0.0)[1][CUE]
            assert math.remainder(math.atan2(v[1], v[0]) - direction - a * TARGET_SPAN, 2 * math.pi) == pytest.approx(0.0, abs=1e-6)
    assert tried > 50 and astray > 0.8 * tried


def test_target_aim_without_a_pot_is_at_the_nearest_ball_on():
    env = SnookerEnv(aim="target")
    table_state(env, {CUE: (0.0, 1.0), 1: (0.0, 1.7), 2: (0.1, 1.74)}, BallOn.RED)  # towards the top cushion: no pot there
    assert len(pots(env.positions, env.on_table, env.on)) == 0
    assert env.actions.shot([0, 0, 0, 0.0], env.positions, env.on_table, env.on)[3] == pytest.approx(math.pi / 2, abs=1e-12)
    assert env.actions.shot([0, 0, 0, -0.5], env.positions, env.on_table, env.on)[3] == pytest.approx(math.pi / 2 - TARGET_SPAN / 2)


# Noise


def test_noise_has_the_deviations_that_it_says():
    """20 000 draws: a standard deviation is known to 0.5 %, a mean to 0.7 % of one."""
    noise = Noise(aim_deg=0.2, speed_rel=0.03, speed_abs=0.04, offset_mm=0.4, elevation_deg=0.5)
    rng = np.random.default_rng(7)
    shot = (2.0, 0.1, -0.2, 0.7, 0.3)
    draws = np.array([noise.draw(rng, *shot, R) for _ in range(20_000)])
    sigma = [math.hypot(0.03 * 2.0, 0.04), 0.4e-3 / R, 0.4e-3 / R, math.radians(0.2), math.radians(0.5)]
    assert draws.std(axis=0) == pytest.approx(sigma, rel=0.025)
    assert np.abs((draws.mean(axis=0) - shot) / sigma).max() < 0.035
    assert np.abs(np.corrcoef(draws.T) - np.eye(5)).max() < 0.035
    normal = (draws - shot) / sigma
    assert (np.abs(normal) > 1).mean(axis=0) == pytest.approx([0.3173] * 5, abs=0.015)
    assert (np.abs(normal) > 3).mean(axis=0) == pytest.approx([0.0027] * 5, abs=0.002)


@pytest.mark.parametrize("name", LEVELS)
def test_each_level_is_as_wide_as_written(name):
    wide = {"none": 0, "professional": 0.025, "amateur": 0.05, "club": 0.1, "olympiad": 0.125}[name]
    rng = np.random.default_rng(1)
    draws = np.array([LEVELS[name].draw(rng, 3.0, 0, 0, 1.0, 0.2, R) for _ in range(4000)])
    assert np.degrees(draws[:, 3].std()) == pytest.approx(wide, rel=0.05, abs=1e-12)
    fast = {"none": 0, "professional": 0.0525, "amateur": 0.075, "club": 0.12, "olympiad": 0.075}[name]
    assert draws[:, 0].std() == pytest.approx(fast, rel=0.05)


def test_speed_and_elevation_are_never_negative():
    rng = np.random.default_rng(1)
    draws = np.array([Noise(speed_abs=1.0, elevation_deg=5.0).draw(rng, 0.2, 0, 0, 0, 0.0, R) for _ in range(500)])
    assert draws[:, 0].min() == 0.0 < draws[:, 0].max() and draws[:, 4].min() == 0.0 < draws[:, 4].max()


def test_noise_reaches_the_table():
    """Executed aim and speed, read from the shots themselves, spread as the level says."""
    env = SnookerEnv(noise={"aim_deg": 0.5, "speed_rel": 0.05}, render_mode="ansi")
    table_state(env, {CUE: (0.1, -0.5), 1: (0.6, 1.2)}, BallOn.RED)
    state = env.get_state()
    velocities = []
    for k in range(400):
        env.set_state(state | {"stream": [k, 0]})
        velocities.append(after_strike(env, [-0.9, 0, 0, 0.25])[0])
    v = np.array(velocities)
    assert np.degrees(np.arctan2(v[:, 1], v[:, 0])).std() == pytest.approx(0.5, rel=0.12)
    assert np.hypot(*v.T).std() / speed_of(-0.9) == pytest.approx(0.05, rel=0.12)


def test_no_noise_draws_nothing():
    env = SnookerEnv(layout="random:3")
    env.reset(seed=1)
    before = env.get_state()
    env.step(np.zeros(4))
    assert env.get_state()["stream"] == before["stream"] and env.get_state()["rng"] == before["rng"]
    noisy = SnookerEnv(layout="random:3", noise={"offset_mm": 1e-9})
    noisy.reset(seed=1)
    noisy.step(np.zeros(4))
    assert noisy.get_state()["stream"] == [before["stream"][0], before["stream"][1] + 3]
    assert Noise().silent and not any(Noise(**{f: 1e-9}).silent for f in Noise.__dataclass_fields__)


def test_a_noisy_tip_is_drawn_back_too():
    """However wide the noise, no shot is a miscue that raises."""
    env = SnookerEnv(layout="random:2", noise={"offset_mm": 30.0}, render_mode="ansi")
    for seed in range(20):
        env.reset(seed=seed)
        v, w = after_strike(env, [0, 1, 0, 0.3])
        assert np.hypot(w[2], np.hypot(*w[:2])) <= 2.5 * np.hypot(*v) / R * 0.5 * (1 + 1e-9)


def test_a_noisy_elevation_stays_playable():
    env = SnookerEnv(layout="random:2", noise={"elevation_deg": 90.0})
    for seed in range(30):
        env.reset(seed=seed)
        env.step(np.zeros(4))


# Rules in a visit

BESIDE = (0.55, 0.0)
"""A place straight before the middle right pocket; the cue ball of ``pot`` comes from the left."""
STUN = np.array([-0.55, 0.0, -0.35, 0.0])


def pot(env, *balls, action=STUN):
    """Move one ball to where it is potted dead straight with ``STUN`` (the others stay), and play that."""
    state = env.get_state()
    for ball in balls:
        state["positions"][ball] = list(BESIDE)
    state["positions"][CUE] = [0.3, 0.0]
    env.set_state(state)
    return env.step(action)


def racked(**arguments):
    """A whole table with the reds in their triangle."""
    env = SnookerEnv(**arguments)
    places = {ball: SPOTS[ball] for ball in range(1, N_BALLS)} | {CUE: (0.3, 0.0)}
    table_state(env, places, BallOn.RED)
    return env


def test_the_highest_break():
    """Fifteen reds, each with the black, then the colours: 147 points, a clearance, and every step of it as the rules say."""
    env = racked()
    total = 0
    for red in range(1, 16):
        assert env.ball_on == BallOn.RED
        _, reward, terminated, truncated, info = pot(env, red)
        total += 1
        assert (reward, terminated, truncated) == (1.0, False, False)
        assert (info["points"], info["break"], info["foul"], info["pots"], info["first_ball"]) == (1.0, total, False, 1, red)
        assert info["ball_on"] == BallOn.RED and env.ball_on == BallOn.ANY_COLOUR
        assert not env.on_table[red] and env.on_table[16:].all() and env.on_table[1:16].sum() == 15 - red
        _, reward, terminated, truncated, info = pot(env, BLACK)
        total += 7
        assert (reward, terminated, info["points"], info["break"], info["first_ball"]) == (7.0, False, 7.0, total, BLACK)
        assert info["ball_on"] == BallOn.ANY_COLOUR and info["pots"] == 1
        assert env.on_table[16:].all() and np.array_equal(env.positions[BLACK], SPOTS[BLACK])  # back on its spot
    for colour in range(YELLOW, BLACK + 1):
        assert env.ball_on == colour - 14
        obs, reward, terminated, truncated, info = pot(env, colour)
        total += colour - 14
        assert reward == colour - 14 and info["break"] == total and not info["foul"] and not truncated
        assert not env.on_table[colour] and env.on_table[1:].sum() == BLACK - colour
        assert terminated == (colour == BLACK)
    assert total == 147 == env.points and env.ball_on == BallOn.NOTHING and env.over
    assert obs[-1] == np.float32(147 / 155) and not obs[111:119].any() and env.observation_space.contains(obs)
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(STUN)


@pytest.mark.parametrize("colour", range(YELLOW, BLACK + 1))
def test_any_colour_after_a_red_is_worth_its_value_and_comes_back(colour):
    env = racked()
    pot(env, 1)
    _, reward, terminated, _, _ = pot(env, colour)
    assert reward == colour - 14 and not terminated and env.ball_on == BallOn.RED
    assert env.on_table[colour] and np.allclose(env.positions[colour], SPOTS[colour], atol=1e-12)


def test_the_last_colour_after_the_last_red_comes_back_before_the_sequence():
    env = SnookerEnv()
    places = {ball: SPOTS[ball] for ball in range(YELLOW, N_BALLS)} | {CUE: (0.3, 0.0), 1: BESIDE}
    table_state(env, places, BallOn.RED)
    pot(env, 1)
    assert env.ball_on == BallOn.ANY_COLOUR
    pot(env, YELLOW)
    assert env.on_table[YELLOW] and env.ball_on == BallOn.YELLOW and not env.over and env.points == 3


def test_a_miss_ends_the_visit_without_a_foul():
    env = racked()
    pot(env, 1)
    table_state(env, {CUE: (0.0, -0.5), 2: (0.0, 0.6), BLACK: (0.6, 1.0)}, BallOn.RED, points=8)
    _, reward, terminated, truncated, info = env.step([-0.8, 0.0, 0.0, 0.5])
    assert (reward, terminated, truncated, info["foul"], info["penalty"], info["first_ball"]) == (0.0, True, False, False, 0, 2)
    assert info["break"] == 8.0 == env.points and info["fouls"] == 0 and env.on_table[[CUE, 2, BLACK]].all()


@pytest.mark.parametrize(("ball", "penalty"), [(16, 4), (17, 4), (18, 4), (19, 5), (20, 6), (21, 7)])
def test_a_wrong_ball_first_is_a_foul_of_its_value(ball, penalty):
    env = SnookerEnv(reward="points_and_fouls")
    table_state(env, {CUE: (0.0, -0.5), 2: (0.6, 0.6), ball: (0.0, 0.3)}, BallOn.RED, points=5)
    _, reward, terminated, _, info = env.step([-0.6, 0.0, 0.0, 0.5])
    assert (reward, terminated, info["foul"], info["penalty"], info["first_ball"]) == (-penalty, True, True, penalty, ball)
    assert info["fouls"] == Foul.WRONG_FIRST and info["points"] == 0.0 and info["break"] == 5.0


def test_no_contact_is_a_foul():
    env = SnookerEnv(reward="points_and_fouls")
    table_state(env, {CUE: (0.0, -0.5), PINK: (0.6, 0.6)}, BallOn.PINK)
    _, reward, terminated, _, info = env.step([-0.9, 0.0, 0.0, 1.0])
    assert (reward, terminated, info["penalty"], info["first_ball"], info["fouls"]) == (-6.0, True, 6, -1, Foul.NO_CONTACT)


def test_an_in_off_is_a_foul_though_a_red_went_too():
    """A straight pot with top spin: the cue ball follows into the same pocket."""
    env = SnookerEnv(reward="points_and_fouls")
    table_state(env, {CUE: (0.5, 0.0), 1: (0.7, 0.0), 2: (-0.5, 0.5), BLACK: (0.0, 1.0)}, BallOn.RED)
    obs, reward, terminated, _, info = env.step([-0.2, 0.0, 1.0, 0.0])
    assert (reward, terminated, info["foul"], info["penalty"], info["pots"], info["points"]) == (-4.0, True, True, 4, 1, 0.0)
    assert info["fouls"] == Foul.CUE_POTTED and not env.on_table[CUE] and not env.on_table[1]
    assert obs[-2] == 1.0 and env.in_hand and np.all(obs[:3] == 0.0)


def test_two_balls_potted():
    """Two reds count two; a colour that goes with a red is a foul and comes back."""
    pair = {1: (0.83, 0.0), 2: (0.83 - 0.0526, 0.0), CUE: (0.3, 0.0)}
    rest = {3: (-0.6, 0.9)} | {ball: SPOTS[ball] for ball in range(YELLOW, N_BALLS)}
    env = SnookerEnv(reward="points_and_fouls")
    table_state(env, pair | rest, BallOn.RED)
    _, reward, terminated, _, info = env.step([0.3, 0.0, 0.0, 0.0])
    assert (reward, terminated, info["points"], info["pots"]) == (2.0, False, 2.0, 2) and env.ball_on == BallOn.ANY_COLOUR
    table_state(env, {PINK: pair[1], 2: pair[2], CUE: pair[CUE]} | {k: v for k, v in rest.items() if k != PINK}, BallOn.RED)
    _, reward, terminated, _, info = env.step([-0.4, 0.0, 0.0, 0.0])
    assert info["fouls"] & Foul.WRONG_POT and info["penalty"] == 6 and (reward, terminated) == (-6.0, True)
    assert env.on_table[PINK] and np.array_equal(env.positions[PINK], SPOTS[PINK])


@pytest.mark.parametrize("ball_on", [BallOn.BLACK, BallOn.RED])
def test_clearing_the_table_ends_the_visit(ball_on):
    env = SnookerEnv()
    ball = BLACK if ball_on == BallOn.BLACK else 1
    table_state(env, {CUE: (0.3, 0.0), ball: BESIDE}, ball_on, points=20)
    _, reward, terminated, truncated, info = env.step(STUN)
    assert (reward, terminated, truncated, info["foul"]) == (float(ball_on), True, False, False)
    assert info["break"] == 20 + ball_on and not env.on_table[1:].any() and env.ball_on == BallOn.NOTHING


def test_a_foul_on_the_last_black_ends_it_too():
    env = SnookerEnv(reward="points_and_fouls")
    table_state(env, {CUE: (0.3, 0.0), BLACK: (-0.4, 1.0)}, BallOn.BLACK, points=20)
    _, reward, terminated, _, info = env.step([-0.9, 0, 0, -0.4])
    assert (reward, terminated, info["penalty"]) == (-7.0, True, 7) and env.over


@pytest.mark.parametrize(("name", "rewards"), [("points", (7, 0, 0)), ("points_and_fouls", (7, 0, -7)), ("pots", (1, 0, 0))])
def test_reward_kinds(name, rewards):
    assert set(REWARDS) == {"points", "points_and_fouls", "pots"}
    env = SnookerEnv(reward=name)
    got = []
    for places, action in [
        ({BLACK: BESIDE}, STUN),  # a pot
        ({BLACK: (0.6, 0.3)}, [-0.9, 0, 0, math.atan2(0.3, 0.3) / math.pi]),  # a miss
        ({BLACK: (0.6, 0.3)}, [-0.9, 0, 0, 1.0]),  # a foul
    ]:
        table_state(env, {CUE: (0.3, 0.0), YELLOW: (-0.6, -1.2), 1: (-0.6, 1.5)} | places, BallOn.ANY_COLOUR)
        got.append(env.step(np.array(action, np.float32))[1])
    assert got == list(rewards) and all(type(r) is float for r in got)


# A touching ball

AWAY, INTO, GRAZE = 1.0, 0.0, 0.5


def touching(gap=0.0, ball=1, others=None, ball_on=BallOn.RED):
    """The cue ball touches a ball on its right."""
    env = SnookerEnv(reward="points_and_fouls")
    table_state(env, {CUE: (0.0, 0.3), ball: (2 * R + gap, 0.3)} | (others or {BLUE: (0.4, 1.2)}), ball_on)
    return env


@pytest.mark.parametrize("aim", [AWAY, GRAZE, 0.75])
@pytest.mark.parametrize("gap", [0.0, 5e-7, -5e-7])
def test_playing_away_from_a_touching_ball_on_is_fair_and_leaves_it(aim, gap):
    env = touching(gap)
    before = env.positions[1].copy()
    _, reward, terminated, _, info = env.step([-0.9, 0.0, 0.0, aim])
    assert (reward, terminated, info["foul"], info["fouls"]) == (0.0, True, False, 0)
    assert np.array_equal(env.positions[1], before)
    assert info["first_ball"] == -1


def test_a_gap_that_can_be_seen_is_no_touch():
    env = touching(2e-6)
    assert env.step([-0.9, 0, 0, AWAY])[4]["fouls"] == Foul.NO_CONTACT
    env = touching(2e-6)
    assert env.step([-0.9, 0, 0, INTO])[4]["fouls"] == 0


@pytest.mark.parametrize("aim", [INTO, 0.2, -0.3])
@pytest.mark.parametrize("gap", [
    0.0, -5e-7,
    5e-7,
])  # fmt: skip
def test_playing_into_a_touching_ball_is_a_push(aim, gap):
    env = touching(gap)
    before = env.positions[1].copy()
    _, reward, terminated, _, info = env.step([-0.6, 0.0, 0.0, aim])
    assert info["foul"] and info["fouls"] & Foul.PUSH and (reward, terminated) == (-4.0, True)
    assert not np.array_equal(env.positions[1], before)


def test_a_touching_ball_that_is_not_on_does_not_count():
    """Touching the black with a red on: playing away and missing is a foul, striking a red is not."""
    places = {1: (-0.5, 0.3), BLUE: (0.4, 1.2)}
    env = touching(0.0, BLACK, places)
    assert env.step([-0.8, 0.0, 0.0, AWAY])[4]["fouls"] == 0
    env = touching(0.0, BLACK, places)
    info = env.step([-0.9, 0.0, 0.0, 0.75])[4]
    assert info["fouls"] == Foul.NO_CONTACT and info["penalty"] == 4
    env = touching(0.0, BLACK, places)
    info = env.step([-0.6, 0.0, 0.0, INTO])[4]
    assert info["fouls"] & Foul.PUSH and info["penalty"] == 7


def test_from_a_touching_red_another_ball_may_be_struck():
    """The touching red is on and counts as struck, so the blue may be played onto."""
    env = touching(0.0, 1, {BLUE: (-0.5, 0.3)})
    info = env.step([-0.8, 0.0, 0.0, AWAY])[4]
    assert info["fouls"] == 0 and info["first_ball"] == BLUE


# Vector environments


def make_noisy():
    return gymnasium.make("Snooker-v0", noise="club", layout="random:4", aim="target")


@pytest.mark.parametrize("kind", ["sync", "async"])
def test_vector_environments_play_as_single_ones(kind):
    if kind == "sync":
        vector = gymnasium.vector.SyncVectorEnv([make_noisy] * 2)
    else:
        sn.warmup()
        vector = gymnasium.vector.AsyncVectorEnv([make_noisy] * 2, context="fork")
    singles = [make_noisy() for _ in range(2)]
    try:
        got, infos = vector.reset(seed=10)
        want = [env.reset(seed=10 + k)[0] for k, env in enumerate(singles)]
        assert np.array_equal(got, want)
        over = [False, False]
        ends = 0
        for _ in range(12):
            got, rewards, terminated, truncated, infos = vector.step(np.zeros((2, 4), np.float32))
            for k, env in enumerate(singles):
                if over[k]:  # NEXT_STEP: the step after the end is the reset
                    obs, info = env.reset()
                    reward, over[k] = 0.0, False
                else:
                    obs, reward, over[k], _, info = env.step(np.zeros(4, np.float32))
                ends += over[k]
                assert np.array_equal(got[k], obs) and rewards[k] == reward and terminated[k] == over[k] and not truncated[k]
                assert all(infos[name][k] == info[name] for name in INFO)
        assert ends > 1
        assert infos["seconds"].dtype == infos["break"].dtype == np.float64 and infos["foul"].dtype == bool
    finally:
        vector.close()


def test_the_observation_at_the_end_is_given_with_the_reset():
    """SAME_STEP: the returned observation is the new table's, ``final_obs`` the old one's."""
    mode = gymnasium.vector.AutoresetMode.SAME_STEP
    vector = gymnasium.vector.SyncVectorEnv([make_noisy] * 2, autoreset_mode=mode)
    singles = [make_noisy() for _ in range(2)]
    vector.reset(seed=20)
    for k, env in enumerate(singles):
        env.reset(seed=20 + k)
    ended = 0
    for _ in range(10):
        got, _, terminated, _, infos = vector.step(np.zeros((2, 4), np.float32))
        for k, env in enumerate(singles):
            obs, _, over, _, info = env.step(np.zeros(4, np.float32))
            if over:
                ended += 1
                assert np.array_equal(infos["final_obs"][k], obs) and infos["final_info"]["seconds"][k] == info["seconds"]
                obs, _ = env.reset()
                assert not np.array_equal(infos["final_obs"][k], obs)
            assert np.array_equal(got[k], obs) and terminated[k] == over
    assert ended > 1
    vector.close()


# Random play


def check_table(env, before, info):
    """After a shot: nothing lost, nothing doubled, nothing overlapping, nothing outside."""
    here = env.on_table
    places = env.positions[here]
    gaps = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1))[np.triu_indices(len(places), 1)]
    assert np.isfinite(env.positions).all()
    assert gaps.size == 0 or gaps.min() >= 2 * R - 1e-6
    env.table.check(env.positions, R, on_table=here)
    assert env.points <= 155
    lost = before & ~here
    assert not (here & ~before)[1:].any()
    potted = env.last_shot.potted >= 0
    assert not (lost & ~potted)[1:].any() and not (potted & ~before).any()
    assert lost[1:16].tolist() == potted[1:16].tolist()  # a red in a pocket never comes back
    if here.any() and env.ball_on != BallOn.NOTHING:
        gone = before[16:] & ~here[16:]
        assert gone.sum() <= 1 and (not gone.any() or (info["ball_on"] == 2 + gone.argmax() and not info["foul"] and info["points"]))
    assert env.over or here[CUE]
    assert env.over == (not info["points"]) or not here[1:].any()
    assert info["break"] == env.points


@pytest.mark.parametrize("layout", LAYOUTS)
def test_random_play_loses_no_ball(layout):
    """Some 40 visits a layout, wild shots and good ones, level and raised cues, noise, all three rewards."""
    rng = np.random.default_rng(LAYOUTS.index(layout))
    strokes = most = 0
    for aim in AIMS:
        arguments = {"aim": aim, "layout": layout, "noise": "club", "fidelity": "fast", "elevation": aim == "absolute"}
        env = SnookerEnv(placement=layout == "break_off", reward="points_and_fouls", **arguments)
        obs, _ = env.reset(seed=LAYOUTS.index(layout))
        for _ in range(19):
            if env.over:
                obs, _ = env.reset()
            while not env.over:
                assert env.observation_space.contains(obs)
                before = env.on_table.copy()
                action = rng.uniform(-1, 1, env.action_space.shape)
                if aim == "target":
                    action[:4] = rng.uniform(-0.6, 0.3), 0.0, rng.uniform(-0.8, 0.5), 0.0
                obs, reward, *_, info = env.step(action)
                assert env.observation_space.contains(obs)
                assert reward == info["points"] - info["penalty"]
                check_table(env, before, info)
                strokes += 1
                most = max(most, env.points)
    assert strokes >= 38
    assert most > 0 or layout == "break_off"
