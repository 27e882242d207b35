"""Are wrong arguments, actions, states and options refused, and does that change nothing?"""

import json
from functools import partial
from typing import ClassVar

import gymnasium
import numpy as np
import pytest

import snooker_env as sn
from snooker_env import Options, SnookerEnv, SnookerVectorEnv
from snooker_env.players import SeenPlayer
from snooker_env.tasks.options import NAMES
from tests.refusals import FIDELITY, INF, NAN, WRONG_FIDELITIES, case, make, refused
from tests.tables import begun

NOT_A_NAME = ("", 3, None, True, b"x")
NOT_A_TRUTH = (0, 1, None, "yes", 0.5, [True])
LAYOUTS = (
    "must be one of 'opened', 'held_out', 'safety', 'held_out_safety', 'escape', 'held_out_escape', 'break_off', "
    "'line_up', 'colours', 'snookered', "
    '"pots:easy", "pots:medium", "pots:hard", "random:N" or "break_off:N" with N from 0 to 15'
)
NOISE = "must be one of 'none', 'professional', 'amateur', 'club', 'robot', 'olympiad' or a dict of"
REWARDS = "must be one of 'points', 'points_and_fouls', 'pots', 'legal'"
FLAGS = ("elevation", "placement", "trust", "one_stroke")
DEVIATIONS = ("aim_deg", "speed_rel", "speed_abs", "offset_mm", "elevation_deg")
OPPONENTS = "'none', 'random', 'ghost_ball', "
RENDER_MODES = "must be one of 'human', 'rgb_array', 'ansi'"
FRAME, DISCRETE = {"task": "frame"}, {"action": "discrete"}
WRONG = [
    ({}, "task", "must be one of 'visit', 'frame'", (*NOT_A_NAME, "frames", "Visit", ["visit"], {})),
    ({}, "aim", "must be one of 'absolute', 'target'", (*NOT_A_NAME, "relative", "Target", ["target"], {})),
    ({}, "action", "must be one of 'box', 'discrete'", (*NOT_A_NAME, "plain", "Box", ["box"], {})),
    ({}, "observation", "must be one of 'flat', 'balls'", (*NOT_A_NAME, "pixels", "Flat", ["flat"], {})),
    ({}, "reward", REWARDS, (*NOT_A_NAME, "score", "Points", ["points"], {}, "win")),
    ({}, "layout", LAYOUTS, (*NOT_A_NAME, "Opened", "Default", "pots", "pots:", "pots:Easy", "random")),
    ({}, "layout", LAYOUTS, ("random:", "random:-1", "random:3.0", "random: 3", "random:x", "random:16")),
    ({}, "layout", "must be one of", ([], {})),
    ({}, "noise", NOISE, (*NOT_A_NAME, "pro")),
    ({}, "noise", "must be one of", ([], ["none"])),
    ({}, "fidelity", FIDELITY, WRONG_FIDELITIES),
    ({}, "conditions", "must be one of 'fixed', 'drawn'", ("random", True, 1, None)),
    ({}, "observe_conditions", 'must be False with conditions="fixed": there is nothing to observe', (True,)),
    ({}, "cue", "must be one of 'free', 'real'", (*NOT_A_NAME, "Real", ["real"], {})),
    ({}, "table", "must be one of 'match', 'tight'", ("loose",)),
    ({}, "table", '"match", "tight"', (3, None)),
    *[({}, field, "must be True or False", NOT_A_TRUTH) for field in FLAGS[1:]],
    (
        {},
        "elevation",
        "must be True or False, or degrees in [5, 70]",
        (0, 1, None, "yes", [True], -0.5, 70.1, NAN, INF),
    ),
    (FRAME, "trust", "must be True or False", (1, None, "yes")),
    (FRAME, "says", "must be a sequence of some of", ("lot", 3, None)),
    (FRAME, "opponent", OPPONENTS, ("", "Random", "model", 3, None, True, ["x"])),
    (FRAME, "opponent", "must be a model saved by Stable-Baselines3", ("missing.zip",)),
    (FRAME, "miss", "must be one of 'off', 'clear_path'", ("on", None, True)),
    (FRAME, "reward", "must be one of 'points', 'win'", ("pots", "wins", "frames")),
    (FRAME, "max_strokes", "must be an integer in [1, 1000000000]", (0, -1, 1.5, "9", True, 10**9 + 1, NAN)),
    ({"task": "match"}, "one_stroke", 'must be False with task="match"', (True,)),
    (FRAME, "frames", 'must be 7 with task="frame"', (5,)),
    (FRAME, "game", "must be one of", ("pool",)),
    (FRAME | {"game": "shoot_out"}, "miss", "must be", ("clear_path",)),
    (FRAME | {"game": "six_red"}, "time_to_play", "must be", (5.0,)),
    (FRAME | {"game": "shoot_out"}, "time_to_play", "must be", (0.0, 15.001)),  # none would be in time
    (FRAME | DISCRETE, "says", 'must not hold "decision"', (("decision",),)),
    ({"task": "match"}, "frames", "must be odd", (2,)),
    ({"task": "match"}, "frames", "must be", (0, True, "7")),
    (DISCRETE, "elevation", "must be False", (True,)),
    (DISCRETE, "placement", "must be False", (True,)),
    ({}, "observation", 'must be "flat" or "balls" with action="box": a Box has no masks', ("masked",)),
    (FRAME, "observation", 'must be "flat" or "balls" with action="box": a Box has no masks', ("masked",)),
    ({}, "max_strokes", 'must be 1000 with task="visit"', (None, 50)),
    ({}, "render_mode", RENDER_MODES, ("", "Human", "depth_array", 3, True, ["ansi"])),
    ({}, "opponent", "must be 'none' with task=\"visit\"", ("random",)),
    ({}, "miss", "must be 'off' with task=\"visit\"", ("clear_path",)),
    *[({}, field, 'must be False with task="visit"', (True,)) for field in FLAGS[2:3]],
    ({}, "frames", 'must be 7 with task="visit"', (5,)),
    ({}, "game", "must be 'snooker' with task=\"visit\"", ("six_red",)),
    ({}, "time_to_play", 'must be 9.0 with task="visit"', (5.0,)),
]
ENV = [
    *[
        case(make(**options, **{field: w}), field, repr(w), allowed, f"{options}{field}={w!r}")
        for options, field, allowed, wrongs in WRONG
        for w in wrongs
    ],
    *[
        case(make(noise={name: w}), f"noise.{name}", repr(w), "must be a finite number in [0, inf)")
        for name in DEVIATIONS
        for w in (-0.1, NAN, INF, "0.1", None, True)
    ],
    case(make(task="frame", says=["shout"]), "says", "'shout'", "must be one of 'nominate', 'decision'"),
    case(make(says=["lot"]), "says", "('lot',)", 'must be () with task="visit"', "visit-says"),
    case(make(physics={"R": 0.03}), "physics.R", "0.03", "must be 0.02625 in Snooker-v0"),
    case(make(physics={"mu_s": 0.0}), "physics.mu_s", "0.0", "must be > 0"),
    case(make(noise={"aim": 0.1}), "noise field", "'aim'", "must be one of 'aim_deg', 'speed_rel'"),
    case(make(noise={3: 0.1}), "noise field", "3", "must be one of 'aim_deg'"),
    case(make(layout="random:\u0663"), "layout", "random:", "with N from 0 to 15", "arabic digits"),
]


@pytest.mark.parametrize(("call", "field", "value", "allowed"), ENV)
def test_wrong_arguments_of_the_environment(call, field, value, allowed):
    refused(call, field, value, allowed)


def test_every_argument_of_the_environment_is_in_the_table_of_errors():
    named = {p.values[1].split(".")[0].split()[0] for p in ENV}
    assert {*NAMES, "render_mode"} <= named
    with pytest.raises(TypeError, match="foul_play"):
        SnookerEnv(foul_play=True)
    refused(lambda: SnookerEnv("visit"), "options", "'visit'", "must be an Options or None")


MATCHES = partial(sn.MatchVectorEnv, 2)
OTHERS = [
    (SnookerVectorEnv, {"options": "frame"}, "options = 'frame': must be an Options or None"),
    (SnookerVectorEnv, {"threads": 0}, "threads"),
    (SnookerVectorEnv, {"max_episode_steps": 0}, "max_episode_steps"),
    (SnookerVectorEnv, {"render_mode": "human"}, "render_mode"),
    (SnookerVectorEnv, {"autoreset_mode": "never"}, ".*never"),
    (SnookerVectorEnv, {"num_envs": 0}, "num_envs"),
    (MATCHES, {"seats": ({},)}, "seats = .*must be None, or two dicts"),
    (
        MATCHES,
        {"seats": ({}, {"layout": "line_up"})},
        r"key of seats\[1\] = 'layout': must be one of 'action'",
    ),
    (MATCHES, {"seats": ({"noise": "club"}, {"noise": "xx"})}, r"seats\[1\]\.noise = 'xx': must be"),
    (MATCHES, {"opponent": "random"}, "options = .*opponent='random'"),
    (MATCHES, {"autoreset_mode": "SameStep"}, "autoreset_mode = "),
    (sn.match_env, {"reward": "pots"}, "reward = "),
    (sn.match_env, {"render_mode": "x"}, "render_mode = "),
    (sn.match_env, {"options": Options()}, ".*a match has two players"),
    (sn.match_env, {"options": Options(task="frame", opponent="random")}, ".*a match has two players"),
    (sn.match_env, {"task": "frame", "frames": 3}, 'frames = 3: must be 7 with task="frame"'),
]


@pytest.mark.parametrize(("make", "arguments", "says"), OTHERS)
def test_wrong_arguments_of_many_tables_and_of_matches(make, arguments, says):
    if make is not SnookerVectorEnv:
        pytest.importorskip("pettingzoo")
    with pytest.raises(ValueError, match=f"^{says}"):
        make(**arguments)


PLAYED = {
    "plain": lambda: SnookerEnv(noise="club", layout="random:3"),
    "long": lambda: SnookerEnv(noise="club", layout="break_off", elevation=True, placement=True),
    "choices": lambda: SnookerEnv(action="discrete"),
    "many": lambda: SnookerVectorEnv(3, noise="club"),
    "many choices": lambda: SnookerVectorEnv(3, action="discrete"),
    "match": lambda: sn.match_env(),
    "matches": lambda: sn.MatchVectorEnv(2, threads=1),
}
BOUNDS = "must be finite and within [-1, 1]; gymnasium.wrappers.ClipAction clips"


def wrong_actions(n):
    """(action, what the message shows, what it allows) where n numbers are wanted."""
    zeros, shape = [0.0] * (n - 1), f"must have shape ({n},)"
    return [
        ([0.0] * 3, "shape (3,)", shape),
        ([0.0] * 8, "shape (8,)", shape),
        (0.0, "shape ()", shape),
        (None, "None", shape),
        ([[0.0] * n], "shape (1, ", shape),
        ([*zeros, 1.00000101], "1.00000101", BOUNDS),
        ([-1.5, *zeros], "-1.5", BOUNDS),
        ([NAN, *zeros], "nan", BOUNDS),
        ([*zeros, INF], "inf", BOUNDS),
        (np.array([-128] + [0] * (n - 1), np.int8), "-128", BOUNDS),
        (["a"] * n, "'a'", "must have shape"),
        (np.zeros(n, complex), "0", "must have shape"),
    ]


WRONG_ACTIONS = [
    *[("plain", action, "action", *says) for action, *says in wrong_actions(4)],
    *[("long", action, "action", *says) for action, *says in wrong_actions(7)],
    *[("choices", w, "action", "", "an integer in [0, 540)") for w in (-1, 540, 0.5, None, "3", [1, 2])],
    *[("match", w, "action", "", "must") for w in (np.zeros(4), np.full(7, 1.1), np.full(7, NAN))],
    ("matches", [[0.0] * 7, [2.0] * 7], "actions[1]", "2.0", "must be finite"),
    ("many", [[0.0] * 4, [0.0] * 4, [0.0, NAN, 0.0, 0.0]], "actions[2]", "[0.0, nan, 0.0, 0.0]", BOUNDS),
    ("many", [[0.0] * 4, [0.0, 0.0, 0.0, 1.0001], [0.0] * 4], "actions[1]", "1.0001", BOUNDS),
    ("many", [[-INF, 0.0, 0.0, 0.0], [2.0] * 4, [0.0] * 4], "actions[0]", "-inf", BOUNDS),
    ("many", np.zeros((2, 4)), "actions", "shape (2, 4)", "must have shape (3, 4)"),
    ("many", np.zeros((3, 5)), "actions", "shape (3, 5)", "must have shape (3, 4)"),
    *[("many", w, "actions", "", "must have shape") for w in (np.zeros(4), None, [[0.0] * 4, [0.0]])],
    *[("many", w, "actions", "", "real numbers") for w in ([["a"] * 4] * 3, np.zeros((3, 4), bool))],
    ("many choices", np.array([0, 540, 1]), "actions[1]", "540", "must be in [0, 540)"),
    ("many choices", np.zeros((3, 4)), "actions", "", "must be 3 integers"),
]


@pytest.mark.parametrize(("kind", "action", "field", "value", "allowed"), WRONG_ACTIONS)
def test_wrong_actions_change_nothing(kind, action, field, value, allowed):
    if "match" in kind:
        pytest.importorskip("pettingzoo")
    env = PLAYED[kind]()
    env.reset(seed=1)
    before = json.dumps(env.get_state())
    refused(lambda: env.step(action), field, value, allowed)
    assert json.dumps(env.get_state()) == before


def _vector_env(action):
    envs = SnookerVectorEnv(2, threads=1)
    envs.reset(seed=1)
    envs.step([[0.0] * 4, action])
    return envs.get_state()


def _sb3(action):
    envs = pytest.importorskip("snooker_env.sb3").SnookerVecEnv(2, seed=1, threads=1)
    envs.reset()
    envs.step(np.array([[0.0] * 4, action]))
    return envs.tables.get_state()


def _match(action):
    pytest.importorskip("pettingzoo")
    env = sn.match_env()
    env.reset(seed=1)
    env.step([*action, 0.0, 0.0, 0.0])
    return env.get_state()


def _matches(action):
    envs = sn.MatchVectorEnv(2, threads=1)
    envs.reset(seed=1)
    envs.step([[*action, 0.0, 0.0, 0.0]] * 2)
    return envs.get_state()


def _one(action, **options):
    env = SnookerEnv(**options)
    env.reset(seed=1)
    env.step(action)
    return env.get_state()


def _opponent(action):
    env = SnookerEnv(task="frame", opponent=SeenPlayer(_Same(action), {"task": "frame"}))
    env.reset(seed=1, options={"breaker": 0})
    env.step([0.0] * 4)
    return env.get_state()


class _Same:
    """A player of observations that always answers the same."""

    options: ClassVar = {"aim": "absolute"}

    def __init__(self, action):
        self.action = action

    def act(self, observations, masks, seeds):
        return [self.action] * len(seeds)


def _player(action):
    position = sn.Position(cue=(0.0, 0.9), black=(0.4, 1.3))
    return [part.tolist() for part in sn.player(_Same(action)).at({}).play(position, [7]).parts[:1]]


def _planner(action):
    position = sn.Position(cue=(0.0, 0.9), black=(0.4, 1.3))
    return sn.Planner({}).play(position, [0], [action]).afterstates.positions.tolist()


WAYS = {
    "one table": _one,
    "target": lambda action: _one(action, aim="target"),
    "long": lambda action: _one([*action, 0.0, 0.0], layout="break_off", placement=True),
    "many": _vector_env,
    "SB3": _sb3,
    "match": _match,
    "matches": _matches,
    "opponent": _opponent,
    "player": _player,
    "planner": _planner,
}
"""Every way by which an action in [-1, 1] comes in, and what it leaves."""


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("component", range(4))
def test_rounding_outside_the_bounds_is_clipped_and_more_is_refused(way, component):
    def action(x):
        a = [-0.5, 0.0, 0.0, 0.25]
        a[component] = x
        return a

    for end in (-1.0, 1.0):
        at_the_end = WAYS[way](action(end))
        assert WAYS[way](action(end * (1.0 + 1e-6))) == at_the_end
        assert WAYS[way](np.array(action(end * 1.0000005), np.float32)) == at_the_end  # as of a network
        if component < 3 and way != "SB3":  # nor is it deaf; SB3 deals a new table after a miss
            assert WAYS[way](action(end * 0.99)) != at_the_end
    for wrong in (1.0000011, -1.0000011, NAN):
        with pytest.raises(
            ValueError, match=r"must be finite and within \[-1, 1\]; gymnasium\.wrappers\.ClipAction"
        ):
            WAYS[way](action(wrong))


@pytest.fixture(scope="module")
def saved():
    env = begun(SnookerEnv(layout="random:5"), 5)
    return env.get_state()


def with_ball(k, state, place):
    return {"positions": [*state["positions"][:k], list(place), *state["positions"][k + 1 :]]}


HERE = "must be a state of get_state() here"
BALL = "state.positions[3]"
STATES = [
    case(lambda s: {"positions": s["positions"][:21]}, "state.positions", "shape (21, 2)", "(22, 2)"),
    case(lambda s: with_ball(3, s, (NAN, 0.0)), "state.positions[3, 0]", "nan", "must be finite"),
    case(lambda s: {"on_table": [1] * 22}, "state.on_table", "int64", "must be bool of shape (22,)"),
    case(lambda s: with_ball(3, s, (1.5, 0.0)), BALL, "(1.5, 0.0)", "must be on the table"),
    case(lambda s: with_ball(3, s, (0.889, 0.0)), BALL, "(0.889, 0.0)", "is over a pocket"),
    case(lambda s: with_ball(3, s, (0.88, 0.6)), BALL, "(0.88, 0.6)", "overlaps the cushion"),
    case(lambda s: with_ball(3, s, s["positions"][2]), "state.positions", "balls 2 and 3", "overlap"),
    case(lambda s: with_ball(9, s, (0.0, 1e300)), "state.positions[9]", "1e+300", "must be within 1000 m"),
    case(lambda s: {"ball_on": 8}, "state.ball_on", "8", "must be"),
    case(lambda s: {"ball_on": 7}, "state.ball_on", "black", "while reds are on the table"),
    case(lambda s: {"ball_on": -1}, "state.ball_on", "nothing", "must"),
    case(lambda s: {"points": 2.7}, "state.points", "2.7", "must be an integer"),
    case(lambda s: {"in_hand": "no"}, "state.in_hand", "'no'", "must be True or False"),
    case(lambda s: {"over": 2}, "state.over", "2", "must be True or False"),
    case(lambda s: {"stream": [1, 2, 3]}, "state.stream", "[1, 2, 3]", "must be two integers"),
    case(lambda s: {"stream": [1, -2]}, "state.stream[1]", "-2", f"must be an integer in [0, {2**64 - 1}]"),
    case(lambda s: {"stream": [2**64, 0]}, "state.stream[0]", str(2**64), "must be an integer"),
    case(lambda s: {"rng": {}}, "state.rng", "{}", "must be"),
    case(lambda s: {"on_table": [False, *s["on_table"][1:]]}, "state.on_table", "False", "cue ball"),
    case(lambda s: {"spin": 1}, "state", "'spin'", "must be", "unknown key"),
]


@pytest.mark.parametrize("how", ["set_state", "reset"])
@pytest.mark.parametrize(("change", "field", "value", "allowed"), STATES)
def test_wrong_states(saved, how, change, field, value, allowed):
    env, state = SnookerEnv(layout="random:5"), saved | change(saved)
    call = {"set_state": lambda: env.set_state(state), "reset": lambda: env.reset(options={"state": state})}
    refused(call[how], field, value, allowed)


@pytest.mark.parametrize(
    ("options", "field", "value", "allowed"),
    [
        case({"sate": 1}, "options", "'sate'", "must be one of 'state'"),
        case({"state": {}}, "state", "a dict without ['ball_on', 'in_hand', 'on_table'", HERE, "empty state"),
        case({3: 1}, "options", "3", "must be one of 'state'"),
        case({"state": None}, "state", "None", "must be a state of get_state()"),
        case({"state": 3}, "state", "3", "must be a state of get_state()"),
        case(["state"], "options", "['state']", "must be"),
    ],
)
def test_wrong_options(options, field, value, allowed):
    refused(lambda: SnookerEnv().reset(options=options), field, value, allowed)


@pytest.mark.parametrize("seed", [-1, "x", 1.5])
def test_wrong_seeds_are_refused_by_gymnasium(seed):
    with pytest.raises((gymnasium.error.Error, ValueError, TypeError)):
        SnookerEnv().reset(seed=seed)
