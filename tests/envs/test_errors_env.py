"""Are wrong arguments, actions, states and options of the environment refused, and does that change
nothing?"""

import copy
import json

import gymnasium
import numpy as np
import pytest

from snooker_env.envs.snooker import SnookerEnv
from snooker_env.tasks.options import NAMES
from tests.refusals import FIDELITY, INF, NAN, WRONG_FIDELITIES, case, make, refused

NOT_A_NAME = ("", 3, None, True, b"x")
ENV = [
    *[
        case(make(**{field: wrong}), field, repr(wrong), allowed, f"{field}={wrong!r}")
        for field, allowed, wrongs in [
            ("task", "must be one of 'visit', 'frame'", ("frames", "Visit", ["visit"], {})),
            ("aim", "must be one of 'absolute', 'target'", ("relative", "Target", ["target"], {})),
            ("action", "must be one of 'box', 'discrete'", ("plain", "Box", ["box"], {})),
            ("observation", "must be one of 'flat', 'balls'", ("pixels", "Flat", ["flat"], {})),
            (
                "reward",
                "must be one of 'points', 'points_and_fouls', 'pots', 'legal'",
                ("score", "Points", ["points"], {}),
            ),
            (
                "layout",
                "must be one of 'opened', 'held_out', 'break_off', 'line_up', 'colours', 'snookered', "
                '"pots:easy", "pots:medium", "pots:hard", "random:N" or "break_off:N" with N from 0 to 15',
                (
                    "Opened",
                    "Default",
                    "pots",
                    "pots:",
                    "pots:Easy",
                    "random",
                    "random:",
                    "random:-1",
                    "random:3.0",
                    "random: 3",
                    "random:x",
                ),
            ),
            (
                "noise",
                "must be one of 'none', 'professional', 'amateur', 'club', 'robot', 'olympiad' "
                "or a dict of ['aim_deg'",
                ("pro",),
            ),
        ]
        for wrong in (*NOT_A_NAME, *wrongs)
    ],
    *[
        case(make(**{field: wrong}), field, repr(wrong), "must be True or False", f"{field}={wrong!r}")
        for field in ("elevation", "placement", "decision", "trust", "nominate", "concede", "claim", "lot")
        for wrong in (0, 1, None, "yes", 0.5, [True])
    ],
    *[
        case(make(task="frame", says=w), "says", repr(w), "must be a sequence of some of", f"says={w!r}")
        for w in ("lot", 3, None)
    ],
    case(make(task="frame", says=["shout"]), "says", "'shout'", "must be one of 'nominate', 'decision'"),
    case(make(says=["lot"]), "lot", "True", 'must be False with task="visit"', "visit-says"),
    *[
        case(
            make(render_mode=wrong),
            "render_mode",
            repr(wrong),
            "must be one of 'human', 'rgb_array', 'ansi'",
            f"render_mode={wrong!r}",
        )
        for wrong in ("", "Human", "depth_array", 3, True, ["ansi"])
    ],
    *[
        case(
            make(**{field: wrong}),
            field,
            repr(wrong),
            f'must be {plain!r} with task="visit"',
            f"visit-{field}",
        )
        for field, wrong, plain in (
            ("opponent", "random", "none"),
            ("miss", "clear_path", "off"),
            ("decision", True, False),
            ("trust", True, False),
            ("nominate", True, False),
            ("concede", True, False),
            ("claim", True, False),
            ("lot", True, False),
            ("frames", 5, 7),
            ("game", "six_red", "snooker"),
            ("time_to_play", 5.0, 9.0),
        )
    ],
    *[
        case(make(task="frame", opponent=wrong), "opponent", repr(wrong), "'none', 'random', 'ghost_ball', ")
        for wrong in ("", "Random", "model", 3, None, True, ["random"])
    ],
    *[
        case(make(task="frame", trust=w), "trust", repr(w), "must be True or False", f"frame-trust={w!r}")
        for w in (1, None, "yes")
    ],
    case(
        make(task="frame", opponent="missing.zip"),
        "opponent",
        "'missing.zip'",
        "must be a model saved by Stable-Baselines3",
    ),
    *[
        case(make(task="frame", miss=w), "miss", repr(w), "must be one of 'off', 'clear_path'", f"miss={w!r}")
        for w in ("on", None, True)
    ],
    *[
        case(make(task="frame", reward=w), "reward", repr(w), "must be one of 'points', 'win'")
        for w in ("pots", "wins")
    ],
    *[
        case(
            make(task="frame", max_strokes=w),
            "max_strokes",
            repr(w),
            "must be an integer in [1,",
            f"strokes={w}",
        )
        for w in (0, "9", True)
    ],
    case(
        make(max_strokes=None), "max_strokes", "None", 'must be 1000 with task="visit"', "visit-max_strokes"
    ),
    *[
        case(make(one_stroke=w), "one_stroke", repr(w), "must be True or False", f"one_stroke={w!r}")
        for w in (1, None, "yes")
    ],
    case(
        make(task="frame", one_stroke=True),
        "one_stroke",
        "True",
        'must be False with task="frame"',
        "frame-one_stroke",
    ),
    case(
        make(reward="win"),
        "reward",
        "'win'",
        "must be one of 'points', 'points_and_fouls', 'pots', 'legal'",
        "visit-win",
    ),
    case(make(table="loose"), "table", "'loose'", "must be one of 'match', 'tight'", "env-table"),
    case(make(table=3), "table", "3", '"match", "tight"', "env-table=3"),
    case(make(table=None), "table", "None", 'must be "match", "tight" or a Table'),
    case(make(physics={"R": 0.03}), "physics.R", "0.03", "must be 0.02625 in Snooker-v0"),
    *[
        case(
            make(noise={name: wrong}),
            f"noise.{name}",
            repr(wrong),
            "must be a finite number in [0, inf)",
            f"noise.{name}={wrong!r}",
        )
        for name in ("aim_deg", "speed_rel", "speed_abs", "offset_mm", "elevation_deg")
        for wrong in (-0.1, NAN, INF, "0.1", None, True)
    ],
    case(
        make(noise={"aim": 0.1}),
        "noise field",
        "'aim'",
        "must be one of 'aim_deg', 'speed_rel', 'speed_abs', 'offset_mm'",
    ),
    case(make(noise={3: 0.1}), "noise field", "3", "must be one of 'aim_deg'"),
    *[case(make(noise=w), "noise", repr(w), "must be one of", f"noise={w!r}") for w in ([], ["none"])],
    *[case(make(layout=w), "layout", repr(w), "must be one of", f"layout={w!r}") for w in ([], {})],
    case(make(layout="random:16"), "layout", "random:16", "with N from 0 to 15"),
    case(make(layout="random:\u0663"), "layout", "random:", "with N from 0 to 15", "arabic digits"),
    case(make(physics={"mu_s": 0.0}), "physics.mu_s", "0.0", "must be > 0", "env-frictionless"),
    *[case(make(fidelity=w), "fidelity", repr(w), FIDELITY, f"env-{w!r}") for w in WRONG_FIDELITIES],
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
