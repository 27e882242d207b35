"""Are wrong arguments, actions, states and options refused, and does that change nothing?"""

import copy
import json

import gymnasium
import numpy as np
import pytest

from snooker_env.envs.snooker import SnookerEnv
from snooker_env.tasks.options import NAMES
from tests.refusals import FIDELITY, INF, NAN, WRONG_FIDELITIES, case, make, refused

NOT_A_NAME = ("", 3, None, True, b"x")
NOT_A_TRUTH = (0, 1, None, "yes", 0.5, [True])
LAYOUTS = (
    "must be one of 'opened', 'held_out', 'break_off', 'line_up', 'colours', 'snookered', "
    '"pots:easy", "pots:medium", "pots:hard", "random:N" or "break_off:N" with N from 0 to 15'
)
NOISE = "must be one of 'none', 'professional', 'amateur', 'club', 'robot', 'olympiad' or a dict of"
REWARDS = "must be one of 'points', 'points_and_fouls', 'pots', 'legal'"
FLAGS = ("elevation", "placement", "decision", "trust", "nominate", "concede", "claim", "lot", "one_stroke")
DEVIATIONS = ("aim_deg", "speed_rel", "speed_abs", "offset_mm", "elevation_deg")
FRAME = {"task": "frame"}
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
    ({}, "table", "must be one of 'match', 'tight'", ("loose",)),
    ({}, "table", '"match", "tight"', (3, None)),
    *[({}, field, "must be True or False", NOT_A_TRUTH) for field in FLAGS],
    (FRAME, "trust", "must be True or False", (1, None, "yes")),
    (FRAME, "says", "must be a sequence of some of", ("lot", 3, None)),
    (FRAME, "opponent", "'none', 'random', 'ghost_ball', ", ("", "Random", 3, None, True, ["x"])),
    (FRAME, "opponent", "'none', 'random', 'ghost_ball', ", ("model",)),
    (FRAME, "opponent", "must be a model saved by Stable-Baselines3", ("missing.zip",)),
    (FRAME, "miss", "must be one of 'off', 'clear_path'", ("on", None, True)),
    (FRAME, "reward", "must be one of 'points', 'win'", ("pots", "wins")),
    (FRAME, "max_strokes", "must be an integer in [1,", (0, "9", True)),
    (FRAME, "one_stroke", 'must be False with task="frame"', (True,)),
    ({}, "max_strokes", 'must be 1000 with task="visit"', (None,)),
    ({}, "render_mode", "must be one of 'human', 'rgb_array', 'ansi'", ("", "Human", "depth_array")),
    ({}, "render_mode", "must be one of 'human', 'rgb_array', 'ansi'", (3, True, ["ansi"])),
    ({}, "opponent", "must be 'none' with task=\"visit\"", ("random",)),
    ({}, "miss", "must be 'off' with task=\"visit\"", ("clear_path",)),
    *[({}, field, 'must be False with task="visit"', (True,)) for field in FLAGS[2:8]],
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
    case(make(says=["lot"]), "lot", "True", 'must be False with task="visit"', "visit-says"),
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


ENVS = {
    "plain": {"layout": "random:3"},
    "long": {"layout": "break_off", "elevation": True, "placement": True},
}
ACTIONS = [
    case([0.0] * 3, "action", "shape (3,)", "must have shape ({size},)", "short"),
    case([0.0] * 8, "action", "shape (8,)", "must have shape ({size},)", "long"),
    case(0.0, "action", "shape ()", "must have shape ({size},)", "scalar"),
    case(None, "action", "None", "must have shape ({size},)", "none"),
    case(lambda n: [[0.0] * n], "action", "shape (1, ", "must have shape ({size},)", "row"),
    case(
        lambda n: [0.0] * (n - 1) + [1.0000001],
        "action",
        "1.0000001",
        "must be finite and within [-1, 1]",
        "above",
    ),
    case(lambda n: [-1.5] + [0.0] * (n - 1), "action", "-1.5", "must be finite and within [-1, 1]", "below"),
    case(lambda n: [NAN] + [0.0] * (n - 1), "action", "nan", "must be finite and within [-1, 1]", "nan"),
    case(lambda n: [0.0] * (n - 1) + [INF], "action", "inf", "must be finite and within [-1, 1]", "inf"),
    case(
        lambda n: np.array([-128] + [0] * (n - 1), np.int8),
        "action",
        "-128",
        "must be finite and within [-1, 1]",
        "lowest integer",
    ),
    case(lambda n: ["a"] * n, "action", "'a'", "must have shape", "text"),
    case(lambda n: np.zeros(n, complex), "action", "0", "must have shape", "complex"),
]


@pytest.mark.parametrize("kind", ENVS)
@pytest.mark.parametrize(("wrong", "field", "value", "allowed"), ACTIONS)
def test_wrong_actions_change_nothing(kind, wrong, field, value, allowed):
    env = SnookerEnv(noise="club", **ENVS[kind])
    env.reset(seed=1)
    before = json.dumps(env.get_state())
    size = env.action_space.shape[0]
    refused(
        lambda: env.step(wrong(size) if callable(wrong) else wrong), field, value, allowed.format(size=size)
    )
    assert json.dumps(env.get_state()) == before


@pytest.fixture(scope="module")
def saved():
    env = SnookerEnv(layout="random:5")
    env.reset(seed=5)
    return env.get_state()


def with_positions(state, **places):
    positions = copy.deepcopy(state["positions"])
    for ball, place in places.items():
        positions[int(ball[1:])] = list(place)
    return {"positions": positions}


STATES = [
    case(lambda s: {"positions": s["positions"][:21]}, "state.positions", "shape (21, 2)", "(22, 2)"),
    case(lambda s: with_positions(s, b3=(NAN, 0.0)), "state.positions[3, 0]", "nan", "must be finite"),
    case(lambda s: {"on_table": [1] * 22}, "state.on_table", "int64", "must be bool of shape (22,)"),
    case(lambda s: {"on_table": [True] * 21}, "state.on_table", "shape (21,)", "must be bool of shape (22,)"),
    case(lambda s: {"positions": "x"}, "state.positions", "'x'", "(22, 2)"),
    case(
        lambda s: with_positions(s, b3=(1.5, 0.0)), "state.positions[3]", "(1.5, 0.0)", "must be on the table"
    ),
    case(
        lambda s: with_positions(s, b3=(0.889, 0.0)), "state.positions[3]", "(0.889, 0.0)", "is over a pocket"
    ),
    case(
        lambda s: with_positions(s, b3=(0.88, 0.6)),
        "state.positions[3]",
        "(0.88, 0.6)",
        "overlaps the cushion",
    ),
    case(lambda s: with_positions(s, b3=s["positions"][2]), "state.positions", "balls 2 and 3", "overlap"),
    case(lambda s: {"ball_on": 8}, "state.ball_on", "8", "must be"),
    case(lambda s: {"ball_on": "red"}, "state.ball_on", "'red'", "must be"),
    case(lambda s: {"ball_on": 7}, "state.ball_on", "BLACK", "while reds are on the table"),
    case(lambda s: {"ball_on": -1}, "state.ball_on", "NOTHING", "must"),
    case(lambda s: {"points": -3}, "state.points", "-3", "must be an integer"),
    case(lambda s: {"points": 2.7}, "state.points", "2.7", "must be an integer"),
    case(lambda s: {"points": None}, "state.points", "None", "must be an integer"),
    case(lambda s: {"in_hand": "no"}, "state.in_hand", "'no'", "must be True or False"),
    case(lambda s: {"over": 2}, "state.over", "2", "must be True or False"),
    case(lambda s: {"stream": None}, "state.stream", "None", "must be two integers"),
    case(lambda s: {"stream": [1, 2, 3]}, "state.stream", "[1, 2, 3]", "must be two integers"),
    case(
        lambda s: {"stream": [1, -2]},
        "state.stream[1]",
        "-2",
        "must be an integer in [0, 18446744073709551615]",
    ),
    case(lambda s: {"stream": [2**64, 0]}, "state.stream[0]", "18446744073709551616", "must be an integer"),
    case(lambda s: {"rng": None}, "state.rng", "None", "must be"),
    case(lambda s: {"rng": {}}, "state.rng", "{}", "must be"),
    case(lambda s: {"on_table": [False, *s["on_table"][1:]]}, "state.on_table", "False", "cue ball"),
    case(lambda s: {"spin": 1}, "state", "'spin'", "must be", "unknown key"),
]


@pytest.mark.parametrize("how", ["set_state", "reset"])
@pytest.mark.parametrize(("change", "field", "value", "allowed"), STATES)
def test_wrong_states(saved, how, change, field, value, allowed):
    env = SnookerEnv(layout="random:5")
    state = copy.deepcopy(saved)
    state |= change(state)
    refused(
        lambda: env.set_state(state) if how == "set_state" else env.reset(options={"state": state}),
        field,
        value,
        allowed,
    )


@pytest.mark.parametrize(
    "key", ["positions", "on_table", "ball_on", "in_hand", "points", "over", "stream", "rng"]
)
def test_a_state_with_a_part_missing(saved, key):
    state = {k: v for k, v in saved.items() if k != key}
    refused(
        lambda: SnookerEnv().set_state(state),
        "state",
        f"a dict without ['{key}']",
        "must be a state of get_state() here",
    )


@pytest.mark.parametrize(
    ("options", "field", "value", "allowed"),
    [
        case({"sate": 1}, "options", "'sate'", "must be one of 'state'"),
        case(
            {"state": {}},
            "state",
            "a dict without ['ball_on', 'in_hand', 'on_table'",
            "must be a state of get_state() here",
            "empty state",
        ),
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
