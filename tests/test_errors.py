"""Is wrong input refused? Each time a ValueError that names the field, the value and what is allowed; nothing is repaired or changed."""

import copy
import json
import re
import warnings

import gymnasium
import numpy as np
import pytest

import snooker_env as sn
from snooker_env.envs.noise import Noise
from snooker_env.envs.snooker import SnookerEnv
from snooker_env.game import balls

Z = (0.0, 0.0, 0.0)
NAN, INF = float("nan"), float("inf")


def case(call, field, value, allowed, name=None):
    """One line of the tables below."""
    return pytest.param(call, field, value, allowed, id=name or f"{field}={value}"[:70])


def refused(call, field, value, allowed):
    """The call raises ValueError whose message names all three; a warning would be a half repair, so it counts as one."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(ValueError) as info:
            call()
    message = str(info.value)
    assert type(info.value) is ValueError
    assert message.startswith(field), f"does not name {field}: {message}"
    rest = message[len(field) :]
    assert re.match(r"(\[[\d, ]+\])* = ", rest), f"does not read 'field = value: what is allowed': {message}"
    assert value in rest, f"does not show {value!r}: {message}"
    assert allowed in rest, f"does not say {allowed!r}: {message}"


# What collide_balls, collide_cushion and simulate take


def impact(**changes):
    args = {"v1": (1, 0, 0), "w1": Z, "v2": Z, "w2": Z, "normal": (1, 0, 0)} | changes
    return lambda: sn.collide_balls(**args)


def cushion(**changes):
    args = {"v": (1, 0, 0), "w": Z, "normal": (1, 0, 0)} | changes
    return lambda: sn.collide_cushion(**args)


def shot(**changes):
    args = {"positions": [(0.0, 0.0), (0.3, 0.0)], "velocities": [(1.0, 0.0), (0.0, 0.0)], "spins": np.zeros((2, 3))} | changes
    return lambda: sn.simulate(**args)


def batch(**changes):
    args = {
        "positions": [[(0.0, 0.0), (0.3, 0.0)]] * 3, "velocities": [[(1.0, 0.0), (0.0, 0.0)]] * 3, "spins": np.zeros((3, 2, 3)),
    } | changes  # fmt: skip
    return lambda: sn.simulate_batch(**args)


def strike(**changes):
    args = {"speed": 2.0, "aim": 0.3} | changes
    return lambda: sn.strike(**args)


WIDTHS = {"positions": 2, "velocities": 2, "spins": 3}


def put(x, y):
    return [(0.0, 0.0), (x, y)]


def make(**fields):
    return lambda: SnookerEnv(**fields)


VECTORS = [
    case(call(**{field: wrong}), field, value, allowed, f"{who}-{field}-{label}")
    for call, who, fields in [(impact, "balls", ("v1", "w1", "v2", "w2", "normal")), (cushion, "cushion", ("v", "w", "normal"))]
    for field in fields
    for label, wrong, value, allowed in [
        ("short", (1.0, 0.0), "shape (2,)", "must have shape (3,)"),
        ("row", [(1.0, 0.0, 0.0)], "shape (1, 3)", "must have shape (3,)"),
        ("scalar", 1.0, "shape ()", "must have shape (3,)"),
        ("nan", (1.0, NAN, 0.0), "nan", "must be finite"),
        ("inf", (-INF, 0.0, 0.0), "-inf", "must be finite"),
        ("none", None, "None", "must be real numbers of shape (3,)"),
        ("name", "abc", "'abc'", "must be real numbers of shape (3,)"),
        ("complex", (1j, 0.0, 0.0), "1j", "must be real numbers of shape (3,)"),
        ("ragged", [(1.0, 2.0), 0.0, 0.0], "[(1.0, 2.0), 0.0, 0.0]", "must be real numbers of shape (3,)"),
    ]
]

NORMALS = [
    case(call(normal=normal), "normal", value, "must be a horizontal unit vector", f"{who}-{value}")
    for call, who in [(impact, "balls"), (cushion, "cushion")]
    for normal, value in [
        ((2.0, 0.0, 0.0), "(2.0, 0.0, 0.0)"), ((0.0, 0.0, 0.0), "(0.0, 0.0, 0.0)"), ((0.0, 0.0, 1.0), "(0.0, 0.0, 1.0)"),
        ((0.6, 0.8, 0.001), "(0.6, 0.8, 0.001)"), ((1.00001, 0.0, 0.0), "(1.00001, 0.0, 0.0)"), ((1e200, 0.0, 0.0), "(1e+200, 0.0, 0.0)"),
    ]
]  # fmt: skip

FIDELITY = 'must be "fast", "standard", "reference" or "euler:N" with N in [1, 10000000]'
FIDELITIES = [
    case(call(fidelity=wrong), "fidelity", repr(wrong), FIDELITY, f"{who}-{wrong!r}")
    for call, who in [(impact, "balls"), (cushion, "cushion"), (shot, "shot"), (batch, "batch"), (make, "env")]
    for wrong in [
        "euler:0", "euler:-1", "euler:x", "Euler:10", "", None, 3, "euler", "euler:", "euler:1.5", "euler: 5", "euler:10000001",
        "euler:\u0663", "fast ", "FAST", ("fast",), ["fast"], b"fast", True,
    ]
]  # fmt: skip

LAYOUTS = [
    case(shot(positions=[(0.0, 0.0)]), "velocities", "shape (2, 2)", "must have shape (1, 2)"),
    case(shot(velocities=[(1.0, 0.0)]), "velocities", "shape (1, 2)", "must have shape (2, 2)"),
    case(shot(velocities=np.zeros((2, 3))), "velocities", "shape (2, 3)", "must have shape (2, 2)"),
    case(shot(spins=np.zeros((2, 2))), "spins", "shape (2, 2)", "must have shape (2, 3)"),
    case(shot(spins=np.zeros((3, 3))), "spins", "shape (3, 3)", "must have shape (2, 3)"),
    case(shot(positions=np.zeros((2, 3))), "positions", "shape (2, 3)", "must have shape (n, 2)"),
    case(shot(positions=np.zeros((1, 2, 2))), "positions", "shape (1, 2, 2)", "must have shape (n, 2)"),
    case(shot(positions=0.0), "positions", "shape ()", "must have shape (n, 2)"),
    case(shot(positions=[]), "positions", "shape (0,)", "must have shape (n, 2)", "no balls"),
    case(shot(**{k: np.zeros((0, n)) for k, n in WIDTHS.items()}), "positions", "shape (0, 2)", "at least one ball", "empty table"),
    case(shot(positions=put(NAN, 0.0)), "positions[1, 0]", "nan", "must be finite"),
    case(shot(positions=put(0.3, INF)), "positions[1, 1]", "inf", "must be finite"),
    case(shot(velocities=[(1.0, 0.0), (0.0, -INF)]), "velocities[1, 1]", "-inf", "must be finite"),
    case(shot(spins=[(0.0, 0.0, NAN), Z]), "spins[0, 2]", "nan", "must be finite"),
    case(shot(positions=put(0.05, 0.0)), "positions", "balls 0 and 1", "overlap by 0.0025 m, at most 1e-06 is allowed", "overlap"),
    case(shot(positions=put(0.0, 0.0)), "positions", "balls 0 and 1", "overlap by 0.0525 m", "one place"),
    case(shot(positions=put(0.0525 - 1.1e-6, 0.0)), "positions", "balls 0 and 1", "overlap by 1.1e-06 m, at most 1e-06 is allowed", "just"),
    case(shot(positions=put(1.5, 0.0)), "positions", "(1.5, 0.0)", "must be on the table, |x| <= 0.86275, |y| <= 1.75825"),
    case(shot(positions=put(0.0, -2.0)), "positions", "(0.0, -2.0)", "must be on the table"),
    case(shot(positions=put(1e300, 0.3)), "positions", "(1e+300, 0.3)", "must be on the table"),
    case(shot(positions=put(0.87, 0.5)), "positions", "(0.87, 0.5)", "overlaps the cushion at x = 0.889"),
    case(shot(positions=put(-0.862752, 0.5)), "positions", "(-0.862752, 0.5)", "overlaps the cushion at x = -0.889"),
    case(shot(positions=put(0.2, 1.77)), "positions", "(0.2, 1.77)", "overlaps the cushion at y = 1.7845"),
    case(shot(positions=put(0.2, -1.77)), "positions", "(0.2, -1.77)", "overlaps the cushion at y = -1.7845"),
    case(shot(positions=put(0.889, 1.7845)), "positions", "(0.889, 1.7845)", "is over a pocket"),
    case(shot(positions=put(0.895, 0.0)), "positions", "(0.895, 0.0)", "is over a pocket"),
    case(shot(positions=put(0.885, 0.05)), "positions", "(0.885, 0.05)", "overlaps jaw"),
    case(shot(on_table=[True]), "on_table", "bool array of shape (1,)", "must be bool of shape (2,)"),
    case(shot(on_table=[[True, True]]), "on_table", "bool array of shape (1, 2)", "must be bool of shape (2,)"),
    case(shot(on_table=[1, 0]), "on_table", "int64 array of shape (2,)", "must be bool of shape (2,)"),
    case(shot(on_table=[1.0, 0.0]), "on_table", "float64 array", "must be bool of shape (2,)"),
    case(shot(on_table="yes"), "on_table", "array of shape ()", "must be bool of shape (2,)"),
    case(shot(on_table=[[True], True]), "on_table", "[[True], True]", "must be bool of shape (2,)"),
    *[
        case(shot(max_events=wrong), "max_events", repr(wrong), "must be an integer in [1, 2147483648]", f"max_events={wrong!r}")
        for wrong in (0, -1, 1.5, 100.0, True, "many", None, NAN, 2**31 + 1)
    ],
    *[
        case(call(table=wrong), "table", repr(wrong), '"match", "tight"', f"{who}-table={wrong!r}")
        for call, who in [(shot, "shot"), (batch, "batch")]
        for wrong in (3, True, ["match"], {"name": "match"}, b"match")
    ],
    *[
        case(call(table=wrong), "table", repr(wrong), "must be one of 'match', 'tight'", f"{who}-table={wrong!r}")
        for call, who in [(shot, "shot"), (batch, "batch"), (lambda table: lambda: sn.Table.preset(table), "preset")]
        for wrong in ("", "Match", "loose", "unbounded")
    ],
    case(lambda: sn.Table.preset(None), "table", "None", "must be one of 'match', 'tight'"),
    case(batch(positions=[(0.0, 0.0), (0.3, 0.0)]), "positions", "shape (2, 2)", "must have shape (b, n, 2)"),
    case(batch(velocities=np.zeros((2, 2, 2))), "velocities", "shape (2, 2, 2)", "must have shape (3, 2, 2)"),
    case(batch(spins=np.zeros((3, 2))), "spins", "shape (3, 2)", "must have shape (3, 2, 3)"),
    case(batch(positions=[put(0.3, 0.0), put(0.3, 0.0), put(0.02, 0.0)]), "positions[2]", "balls 0 and 1", "overlap by 0.0325 m"),
    case(batch(positions=[put(0.3, 0.0), put(0.905, 0.5), put(0.3, 0.0)]), "positions[1][1]", "(0.905, 0.5)", "must be on the table"),
    case(batch(positions=[put(0.3, 0.0), put(0.3, NAN), put(0.3, 0.0)]), "positions[1, 1, 1]", "nan", "must be finite"),
    case(batch(on_table=[True, True]), "on_table", "bool array of shape (2,)", "must be bool of shape (3, 2)"),
    case(batch(**{k: np.zeros((2, 0, n)) for k, n in WIDTHS.items()}), "positions", "shape (2, 0, 2)", "at least one ball", "empty tables"),
    *[
        case(batch(threads=wrong), "threads", repr(wrong), "must be an integer in [1, 1024]", f"threads={wrong!r}")
        for wrong in (0, -2, 1.0, "2", True, 1025)
    ],
    case(batch(max_events=0), "max_events", "0", "must be an integer in [1, 2147483648]", "batch-max_events"),
    *[
        case(call(physics={name: 0.0}), f"physics.{name}", "0.0", "must be > 0 to simulate a shot", f"{who}-frictionless {name}")
        for call, who in [(shot, "shot"), (batch, "batch")]
        for name in ("mu_s", "mu_r")
    ],
]

STRIKES = [
    *[
        case(strike(**{field: wrong}), field, repr(wrong), allowed, f"strike-{field}={wrong!r}")
        for field, allowed, wrongs in [
            ("speed", "must be a finite number in [0, inf)", (-1.0, -1e-300, NAN, INF)),
            ("elevation", "must be a finite number in [0, 1.5]", (-0.01, 1.51, NAN, INF)),
            ("aim", "must be a finite number", (NAN, INF)),
            ("side", "must be a finite number", (NAN, -INF)),
            ("top", "must be a finite number", (NAN, INF)),
        ]
        for wrong in (*wrongs, "1", None, True, [1.0, 2.0], 1j, b"1")
    ],
    case(strike(side=0.6), "(side, top)", "(0.6, 0.0)", "0.6 R is a miscue, must be within 0.5 R of the ball's centre", "miscue"),
    case(strike(side=-0.4, top=0.4), "(side, top)", "(-0.4, 0.4)", "miscue, must be within 0.5 R", "miscue of the pair"),
    case(strike(top=-0.5001), "(side, top)", "(0.0, -0.5001)", "miscue, must be within 0.5 R", "just a miscue"),
    case(strike(side=0.4, physics={"max_offset": 0.3}), "(side, top)", "(0.4, 0.0)", "within 0.3 R", "miscue of other physics"),
]

RANGES = {
    "R": ("(0, 1]", 0, -1, 1.1), "M": ("(0, inf)", 0, -0.1), "g": ("(0, inf)", 0, -9.81), "mu_s": ("[0, 1]", -0.1, 1.1),
    "mu_r": ("[0, 1]", -0.01, 1.01), "spin_decel": ("[0, inf)", -1), "e_b": ("[0, 1]", -0.1, 1.01), "e_c": ("[0, 1]", -0.1, 1.01),
    "e_c_knee": ("[0, inf)", -1), "e_c_slope": ("[0, inf)", -1), "mu_c": ("[0, 1]", -0.1, 2), "sin_theta": ("[0, 0.95]", -0.1, 0.96),
    "end_mass_ratio": ("[0, inf)", -1), "max_offset": ("(0, 0.999]", 0, 1.0),
}  # fmt: skip
SHARE = "must be a finite number in [0, 1]"
MU_BB = 'must be a number in [0, 1], "marlow", or (a, b, c) with a, b, c >= 0 and a + b <= 1'
WAYS = {
    "Physics": lambda name, value: lambda: sn.Physics(**{name: value}),
    "preset": lambda name, value: lambda: sn.Physics.preset("match", **{name: value}),
    "dict": lambda name, value: strike(physics={name: value}),
    "env": lambda name, value: lambda: SnookerEnv(physics={name: value}),
}
PHYSICS = [
    *[
        case(way(name, wrong), f"physics.{name}", repr(wrong), f"must be a finite number in {allowed}", f"{how}-{name}={wrong!r}")
        for how, way in WAYS.items()
        for name, (allowed, *wrongs) in RANGES.items()
        for wrong in (*wrongs, *((NAN, INF, "0.1", None, True, [0.1]) if how == "Physics" else (NAN,)))
    ],
    *[
        case(way("mu_bb", wrong), "physics.mu_bb", repr(wrong), allowed, f"{how}-mu_bb={wrong!r}")
        for how, way in WAYS.items()
        for wrong, allowed in [
            (-0.1, SHARE), (1.1, SHARE), (NAN, SHARE), (None, SHARE),
            ("Marlow", MU_BB), ((0.1, 0.2), MU_BB), ((0.5, 0.6, 1.0), MU_BB), ([0.1] * 4, MU_BB),
        ]
    ],
    *[case(lambda v=v: sn.Physics(mu_bb=v), "physics.mu_bb", str(bad), "must be a finite number in [0, inf)", f"mu_bb={v}")
      for v, bad in [((-0.1, 0.1, 1.0), -0.1), ((0.1, -0.1, 1.0), -0.1), ((0.1, 0.1, -1.0), -1.0), ((0.1, NAN, 1.0), NAN)]],
    *[
        case(call(wrong), "physics", repr(wrong), "must be one of 'paper', 'match'", f"{who}-{wrong!r}")
        for who, call in [
            ("preset", lambda n: lambda: sn.Physics.preset(n)), ("of", lambda n: lambda: sn.Physics.of(n)),
            ("strike", lambda n: strike(physics=n)),
            ("shot", lambda n: shot(physics=n)), ("impact", lambda n: impact(physics=n)), ("cushion", lambda n: cushion(physics=n)),
            ("batch", lambda n: batch(physics=n)), ("env", lambda n: lambda: SnookerEnv(physics=n)),
            ("key", lambda n: lambda: sn.Physics.of({"preset": n})),
        ]
        for wrong in ("", "Paper", "real")
    ],
    *[
        case(lambda w=wrong: sn.Physics.of(w), "physics", repr(wrong), "must be None, a preset's name, a dict of overrides, or a Physics")
        for wrong in (3, ["paper"], ("paper",), True, 0.5, b"paper")
    ],
    case(lambda: sn.Physics.preset("paper", mu=0.1), "physics field", "'mu'", "must be one of 'R', 'M', 'g', 'mu_s'", "preset-unknown"),
    case(lambda: sn.Physics.of({"mu": 0.1}), "physics field", "'mu'", "must be one of 'R'", "of-unknown"),
    case(lambda: SnookerEnv(physics={"mu": 0.1}), "physics field", "'mu'", "must be one of 'R'", "env-unknown"),
    case(lambda: sn.Physics.of({"name": "match"}), "physics field", "'name'", "must be one of 'R'"),
    case(lambda: sn.Physics.of({"cls": 1}), "physics field", "'cls'", "must be one of 'R'"),
    case(lambda: sn.Physics.of({1: 0.1}), "physics field", "1", "must be one of 'R'"),
]  # fmt: skip


def moved(**fields):
    return lambda: sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], [Z]).at(**fields)


TIMES = [
    case(moved(t=-0.5), "t", "-0.5", "must not be negative"),
    case(moved(t=[0.1, -1e-12]), "t", "-1e-12", "must not be negative"),
    case(moved(t=NAN), "t[0]", "nan", "must be finite"),
    case(moved(t=[0.0, INF]), "t[1]", "inf", "must be finite"),
    case(moved(t=[[0.1]]), "t", "shape (1, 1)", "must have shape (n,)"),
    case(moved(t="soon"), "t", "soon", "must be real numbers of shape (n,)"),
    case(moved(t=1j), "t", "1j", "must be real numbers of shape (n,)"),
]

REAL = "must be real numbers of shape (3,)"
DTYPES = [
    case(impact(v1=["1", "0", "0"]), "v1", "'1'", REAL, "numbers as text"),
    case(impact(v1=[True, False, False]), "v1", "True", REAL, "truth values"),
    case(impact(v1=np.array([1 + 2j, 0, 0])), "v1", "1.+2.j", REAL, "complex array"),
    case(impact(v1=[10**400, 0, 0]), "v1", "1000", REAL, "int beyond float64"),
    case(strike(speed=10**400), "speed", "1000", "must be a finite number", "speed beyond float64"),
    case(strike(speed=np.True_), "speed", "True", "must be a finite number", "numpy bool"),
    case(shot(fidelity="euler:" + "9" * 5000), "fidelity", "'euler:9999", FIDELITY, "endless N"),
    case(lambda: sn.Table("x", np.zeros((1, 2)), np.zeros((0, 6)), np.zeros((0, 3))), "table.noses", "shape (1, 2)",
         "must have shape (n, 5)", "own table of wrong shape"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "field", "value", "allowed"), [*VECTORS, *NORMALS])
def test_wrong_vectors_of_an_impact(call, field, value, allowed):
    refused(call, field, value, allowed)


@pytest.mark.parametrize(("call", "field", "value", "allowed"), FIDELITIES)
def test_wrong_fidelities(call, field, value, allowed):
    refused(call, field, value, allowed)


@pytest.mark.parametrize(("call", "field", "value", "allowed"), [*LAYOUTS, *TIMES, *DTYPES])
def test_wrong_shots(call, field, value, allowed):
    refused(call, field, value, allowed)


@pytest.mark.parametrize(("call", "field", "value", "allowed"), STRIKES)
def test_wrong_strikes(call, field, value, allowed):
    refused(call, field, value, allowed)


@pytest.mark.parametrize(("call", "field", "value", "allowed"), PHYSICS)
def test_wrong_physics(call, field, value, allowed):
    refused(call, field, value, allowed)


def test_an_unknown_field_of_physics_itself_is_refused_as_python_does():
    with pytest.raises(TypeError, match="mu_ball"):
        sn.Physics(mu_ball=0.1)


def test_physics_cannot_be_changed_and_its_range_ends_are_allowed():
    with pytest.raises(AttributeError):
        sn.Physics().e_b = 0.5
    sn.Physics(R=1, mu_s=0, mu_r=1, spin_decel=0, e_b=1, e_c=0, mu_c=1, sin_theta=0.95, end_mass_ratio=0, max_offset=0.999, mu_bb=(0, 1, 0))


# The environment


NOT_A_NAME = ("", 3, None, True, b"x")
ENV = [
    *[
        case(make(**{field: wrong}), field, repr(wrong), allowed, f"{field}={wrong!r}")
        for field, allowed, wrongs in [
            ("task", "must be one of 'visit', 'frame'", ("frames", "Visit", ["visit"], {})),
            ("aim", "must be one of 'absolute', 'target'", ("relative", "Target", ["target"], {})),
            ("action", "must be one of 'box', 'discrete'", ("plain", "Box", ["box"], {})),
            ("observation", "must be one of 'flat', 'balls'", ("pixels", "Flat", ["flat"], {})),
            ("reward", "must be one of 'points', 'points_and_fouls', 'pots'", ("score", "Points", ["points"], {})),
            ("layout", "must be one of 'opened', 'held_out', 'break_off', 'line_up', 'colours', 'snookered', "
             '"pots:easy", "pots:medium", "pots:hard" or "random:N" with N from 0 to 15',
             ("Opened", "Default", "pots", "pots:", "pots:Easy", "random", "random:", "random:-1", "random:3.0", "random: 3", "random:x")),
            ("noise", "must be one of 'none', 'professional', 'amateur', 'club', 'olympiad' or a dict of ['aim_deg'", ("pro",)),
        ]
        for wrong in (*NOT_A_NAME, *wrongs)
    ],
    *[
        case(make(**{field: wrong}), field, repr(wrong), "must be True or False", f"{field}={wrong!r}")
        for field in ("elevation", "placement", "decision")
        for wrong in (0, 1, None, "yes", 0.5, [True])
    ],
    *[
        case(make(render_mode=wrong), "render_mode", repr(wrong), "must be one of 'human', 'rgb_array', 'ansi'", f"render_mode={wrong!r}")
        for wrong in ("", "Human", "depth_array", 3, True, ["ansi"])
    ],
    *[
        case(make(**{field: wrong}), field, repr(wrong), f'must be {plain!r} with task="visit"', f"visit-{field}")
        for field, wrong, plain in (("opponent", "random", "none"), ("miss", "clear_path", "off"), ("decision", True, False))
    ],
    *[
        case(make(task="frame", opponent=wrong), "opponent", repr(wrong), "'none', 'random', 'ghost_ball', a path to a model (.zip)")
        for wrong in ("", "Random", "model", 3, None, True, ["random"])
    ],
    case(make(task="frame", opponent="missing.zip"), "opponent", "'missing.zip'", "must be a model saved by Stable-Baselines3"),
    *[case(make(task="frame", miss=w), "miss", repr(w), "must be one of 'off', 'clear_path'", f"miss={w!r}") for w in ("on", None, True)],
    *[case(make(task="frame", reward=w), "reward", repr(w), "must be one of 'points', 'win'") for w in ("pots", "wins")],
    case(make(reward="win"), "reward", "'win'", "must be one of 'points', 'points_and_fouls', 'pots'", "visit-win"),
    case(make(table="loose"), "table", "'loose'", "must be one of 'match', 'tight'", "env-table"),
    case(make(table=3), "table", "3", '"match", "tight"', "env-table=3"),
    case(make(table=None), "table", "None", 'must be "match", "tight" or a Table'),
    case(make(physics={"R": 0.03}), "physics.R", "0.03", "must be 0.02625 in Snooker-v0"),
    *[
        case(make(noise={name: wrong}), f"noise.{name}", repr(wrong), "must be a finite number in [0, inf)", f"noise.{name}={wrong!r}")
        for name in ("aim_deg", "speed_rel", "speed_abs", "offset_mm", "elevation_deg")
        for wrong in (-0.1, NAN, INF, "0.1", None, True)
    ],
    case(make(noise={"aim": 0.1}), "noise field", "'aim'", "must be one of 'aim_deg', 'speed_rel', 'speed_abs', 'offset_mm'"),
    case(make(noise={3: 0.1}), "noise field", "3", "must be one of 'aim_deg'"),
    *[case(make(noise=w), "noise", repr(w), "must be one of", f"noise={w!r}") for w in ([], ["none"])],
    *[case(make(layout=w), "layout", repr(w), "must be one of", f"layout={w!r}") for w in ([], {})],
    case(make(layout="random:16"), "layout", "random:16", "with N from 0 to 15"),
    case(make(layout="random:\u0663"), "layout", "random:", "with N from 0 to 15", "arabic digits"),
    case(make(physics={"mu_s": 0.0}), "physics.mu_s", "0.0", "must be > 0", "env-frictionless"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "field", "value", "allowed"), ENV)
def test_wrong_arguments_of_the_environment(call, field, value, allowed):
    refused(call, field, value, allowed)


def test_every_argument_of_the_environment_is_in_the_table_of_errors():
    import inspect

    named = {p.values[1].split(".")[0].split()[0] for p in [*ENV, *PHYSICS, *FIDELITIES]}
    assert set(inspect.signature(SnookerEnv.__init__).parameters) - {"self"} <= named
    with pytest.raises(TypeError, match="foul_play"):
        SnookerEnv(foul_play=True)
    with pytest.raises(TypeError):
        SnookerEnv("visit")


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
    case(lambda n: [0.0] * (n - 1) + [1.0000001], "action", "1.0000001", "must be finite and within [-1, 1]", "above"),
    case(lambda n: [-1.5] + [0.0] * (n - 1), "action", "-1.5", "must be finite and within [-1, 1]", "below"),
    case(lambda n: [NAN] + [0.0] * (n - 1), "action", "nan", "must be finite and within [-1, 1]", "nan"),
    case(lambda n: [0.0] * (n - 1) + [INF], "action", "inf", "must be finite and within [-1, 1]", "inf"),
    case(lambda n: np.array([-128] + [0] * (n - 1), np.int8), "action", "-128", "must be finite and within [-1, 1]", "lowest integer"),
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
    refused(lambda: env.step(wrong(size) if callable(wrong) else wrong), field, value, allowed.format(size=size))
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
    case(lambda s: with_positions(s, b3=(1.5, 0.0)), "state.positions[3]", "(1.5, 0.0)", "must be on the table"),
    case(lambda s: with_positions(s, b3=(0.889, 0.0)), "state.positions[3]", "(0.889, 0.0)", "is over a pocket"),
    case(lambda s: with_positions(s, b3=(0.88, 0.6)), "state.positions[3]", "(0.88, 0.6)", "overlaps the cushion"),
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
    case(lambda s: {"stream": [1, -2]}, "state.stream[1]", "-2", "must be an integer in [0, 18446744073709551615]"),
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
    refused(lambda: env.set_state(state) if how == "set_state" else env.reset(options={"state": state}), field, value, allowed)


@pytest.mark.parametrize("key", ["positions", "on_table", "ball_on", "in_hand", "points", "over", "stream", "rng"])
def test_a_state_with_a_part_missing(saved, key):
    state = {k: v for k, v in saved.items() if k != key}
    refused(lambda: SnookerEnv().set_state(state), "state", "'rng'" if key != "rng" else "'over'", f"missing ['{key}']")


@pytest.mark.parametrize("change", [{"ball_on": 99}, {"points": "x"}, {"stream": [0]}, {"rng": {}}])
def test_a_refused_state_leaves_the_environment_as_it_was(saved, change):
    env = SnookerEnv(layout="random:5")
    env.reset(seed=11)
    before = json.dumps(env.get_state())
    with pytest.raises(ValueError):
        env.set_state(saved | change)
    assert json.dumps(env.get_state()) == before


@pytest.mark.parametrize(
    ("options", "field", "value", "allowed"),
    [
        case({"sate": 1}, "options", "'sate'", "must be one of 'state'"),
        case({"state": {}}, "state", "[]", "must be a state of get_state(); missing ['ball_on', 'in_hand', 'on_table'", "empty state"),
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


# Nothing is changed in place, nothing repaired


def frozen(*arrays):
    """Read-only copies: writing into them would raise."""
    out = [np.array(a, float) for a in arrays]
    for a in out:
        a.setflags(write=False)
    return out


def test_inputs_of_an_impact_are_left_as_they_are():
    args = frozen((1, 0.2, 0), (3, 4, 5), (-0.5, 0, 0), (1, 2, 3), (1, 0, 0))
    before = [a.tobytes() for a in args]
    one, two = sn.collide_balls(*args), sn.collide_balls(*args)
    assert all(np.array_equal(a, b) for a, b in zip(one, two, strict=True))
    one[0][:] = 7.0
    sn.collide_cushion(args[0], args[1], args[4])[0][:] = 7.0
    assert [a.tobytes() for a in args] == before
    apart = sn.collide_balls(*frozen((-1, 0, 0), Z, Z, Z, (1, 0, 0)))  # no impact: still fresh arrays
    apart[0][:] = 7.0
    assert sn.collide_balls((-1, 0, 0), Z, Z, Z, (1, 0, 0))[0].tolist() == [-1, 0, 0]


@pytest.mark.parametrize("many", [False, True])
def test_inputs_of_a_shot_are_left_as_they_are(many):
    r, v, w = frozen([(0.0, 0.0), (0.3, 0.01)], [(2.0, 0.0), (0.0, 0.0)], np.ones((2, 3)))
    here = np.array([True, True])
    here.setflags(write=False)
    if many:
        r, v, w, here = (np.broadcast_to(a, (3, *a.shape)) for a in (r, v, w, here))  # no memory of their own: writing would show
        before = [a.copy() for a in (r, v, w, here)]
        out = sn.simulate_batch(r, v, w, on_table=here, events=True)
    else:
        before = [a.copy() for a in (r, v, w, here)]
        out = sn.simulate(r, v, w, on_table=here)
        times = np.array([0.0, 0.5])
        out.at(times)[0][:] = 9.0
        assert times.tolist() == [0.0, 0.5] and not np.any(out.at(0.5)[0] == 9.0)
    assert all(np.array_equal(a, b) for a, b in zip((r, v, w, here), before, strict=True))
    assert not np.array_equal(out.positions, r)
    for mine in (out.positions, out.on_table, out.potted):
        assert not any(np.shares_memory(mine, a) for a in (r, v, w, here))


def test_any_real_dtype_and_memory_order_gives_the_same_shot():
    r, v, w = np.array([(0.0, 0.0), (0.5, 0.0625)]), np.array([(2.0, 0.0), (0.0, 0.0)]), np.ones((2, 3))
    want = sn.simulate(r, v, w).positions
    for change in (np.asfortranarray, list, lambda a: a.astype(np.float32), lambda a: a.astype(">f8"), lambda a: a[::-1][::-1]):
        assert np.array_equal(sn.simulate(change(r), change(v), change(w)).positions, want)
    whole = sn.simulate(np.zeros((1, 2), np.int32), np.array([(1, 0)], np.uint8), np.zeros((1, 3), np.int64)).positions
    assert np.array_equal(whole, sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], [Z]).positions)


def test_dicts_given_as_arguments_are_left_as_they_are():
    physics, noise = {"preset": "match", "mu_s": 0.2}, {"aim_deg": 0.1}
    env = SnookerEnv(physics=physics, noise=noise, layout="random:1")
    state = env.reset(seed=1) and env.get_state()
    options = {"state": copy.deepcopy(state)}
    env.reset(options=options)
    env.step(np.zeros(4, np.float32))
    assert physics == {"preset": "match", "mu_s": 0.2} and noise == {"aim_deg": 0.1}
    assert options == {"state": state}
    sn.Physics.of(physics)
    assert physics == {"preset": "match", "mu_s": 0.2}
    assert env.physics.e_b == 0.94 and env.physics.mu_s == 0.2 and env.noise == Noise(aim_deg=0.1)


def test_actions_and_states_given_are_left_as_they_are_and_not_kept():
    env = SnookerEnv(layout="random:4")
    env.reset(seed=2)
    action = np.zeros(4, np.float32)
    action.setflags(write=False)
    positions, here = np.array(env.get_state()["positions"]), np.array(env.get_state()["on_table"])
    state = env.get_state() | {"positions": positions, "on_table": here}
    env.set_state(state)
    before = positions.copy()
    env.step(action)
    assert np.array_equal(positions, before) and here.all() == np.array(env.get_state()["on_table"]).all()
    env.set_state(state)
    positions[:] = 0.0
    here[:] = False
    assert np.array_equal(env.positions, before) and env.on_table.any()


def test_balls_off_the_table_may_lie_anywhere():
    """What is not on the table is not looked at: no overlap, no place is wrong for it, and it stays where it is."""
    places = [(0.0, 0.0), (0.0, 0.0), (5.0, 5.0)]
    shot = sn.simulate(places, [(0.0, 1.0), (9.0, 0.0), (0.0, 0.0)], np.zeros((3, 3)), on_table=[True, False, False])
    assert shot.positions[1:].tolist() == [[0.0, 0.0], [5.0, 5.0]] and shot.on_table.tolist() == [True, False, False]


def test_what_is_just_allowed_is_played():
    touching = [(0.0, 0.0), (0.0525 - 0.9e-6, 0.0)]
    assert sn.simulate(touching, np.zeros((2, 2)), np.zeros((2, 3))).duration == 0.0
    wall = balls.HALF_WIDTH - balls.BALL_RADIUS
    assert sn.simulate([(wall + 0.9e-6, 0.5)], np.zeros((1, 2)), np.zeros((1, 3))).duration == 0.0
    sn.strike(0.0, 1e6, side=0.3, top=-0.4, elevation=1.5)
    assert sn.collide_cushion((1, 0, 0), Z, (1 + 5e-7, 0, 0))[0][0] < 0
    assert sn.simulate(touching[:1], [(1.0, 0.0)], [Z], table=None, max_events=2**31).positions[0, 0] > 1.0


def test_too_few_events_are_an_error_of_the_simulation_with_advice():
    end = r"max_events \(after 1 events; the last was ROLL of 0 and -1 at 0\.138690 s"
    with pytest.raises(sn.SimulationError, match=r"shot 0 did not come to rest.*" + end):
        sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], [Z], max_events=1)
    with pytest.raises(sn.SimulationError, match=r"shot 1 did not come to rest.*max_events"):
        sn.simulate_batch([[(0.0, 0.0)]] * 2, [[(0.0, 0.0)], [(1.0, 0.0)]], np.zeros((2, 1, 3)), max_events=1)


def test_table_names_are_those_of_the_presets():
    for name in ("match", "tight"):
        table = sn.Table.preset(name)
        assert table.name == name and sn.Table.of(name) is table is sn.Table.of(table)
        with pytest.raises(ValueError, match="read-only"):
            table.noses[0, 0] = 1.0
