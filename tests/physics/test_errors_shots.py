"""Are wrong impacts, shots and strikes refused, and what is just allowed played? A ValueError names field,
value and what is allowed."""

import numpy as np
import pytest

import snooker_env as sn
from snooker_env import simulation
from snooker_env.geometry import BALL_RADIUS, HALF_WIDTH
from tests.refusals import (
    FIDELITY,
    INF,
    NAN,
    WRONG_FIDELITIES,
    Z,
    batch,
    case,
    cushion,
    impact,
    refused,
    shot,
    strike,
)

WIDTHS = {"positions": 2, "velocities": 2, "spins": 3}


def put(x, y):
    return [(0.0, 0.0), (x, y)]


VECTORS = [
    case(call(**{field: wrong}), field, value, allowed, f"{who}-{field}-{label}")
    for call, who, fields in [
        (impact, "balls", ("v1", "w1", "v2", "w2", "normal")),
        (cushion, "cushion", ("v", "w", "normal")),
    ]
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
        (
            "masked",
            np.ma.array([1.0, 0.0, 0.0], mask=[False, True, False]),
            "masked",
            "must be real numbers of shape (3,)",
        ),
        (
            "objects",
            np.array([1.0, 0.0, 0.0], object),
            "array([1.0, 0.0, 0.0], dtype=object)",
            "must be real numbers of shape (3,)",
        ),
    ]
]

SPEED, SPIN = "must be finite, within 1,000 m/s of zero", "must be finite, within 100,000 rad/s of zero"
SPEED_IMPACT, SPIN_IMPACT = (
    "must be finite, within 1e+06 m/s of zero",
    "must be finite, within 1e+09 rad/s of zero",
)
HUGE = [
    *[
        case(
            call(**{field: np.eye(3)[k] * wrong}),
            f"{field}[{k}]",
            repr(float(wrong)),
            allowed,
            f"{who}-{field}[{k}]={wrong:g}",
        )
        for call, who, fields in [
            (impact, "balls", ("v1", "w1", "v2", "w2")),
            (cushion, "cushion", ("v", "w")),
        ]
        for field in fields
        for allowed, low in [(SPIN_IMPACT, 1e9) if field.startswith("w") else (SPEED_IMPACT, 1e6)]
        for k in range(3)
        for wrong in (np.nextafter(low, np.inf), -1.1 * low, 1e25, -1e200)
    ],
    *[
        case(
            call(**{field: first(np.array([moved]))}),
            f"{field}[{at}{k}]",
            repr(moved[k]),
            allowed,
            f"{who}-{field}={moved[k]:g}",
        )
        for call, who, at, first in [
            (shot, "shot", "0, ", lambda a: np.concatenate([a, 0 * a])),
            (
                batch,
                "batch",
                "1, 0, ",
                lambda a: np.array([np.zeros((2, a.shape[1])), [*a, *(0 * a)], np.zeros((2, a.shape[1]))]),
            ),
        ]
        for field, allowed, moved, k in [
            ("velocities", SPEED, (1e25, 0.0), 0),
            ("velocities", SPEED, (0.0, -1e200), 1),
            ("velocities", SPEED, (0.0, 1000.1), 1),
            ("spins", SPIN, (0.0, 0.0, 1e25), 2),
            ("spins", SPIN, (-100_001.0, 0.0, 0.0), 0),
        ]
    ],
    case(
        shot(positions=[(0.0, 0.0), (1e7, 0.0)], table=None),
        "positions[1, 0]",
        "10000000.0",
        "must be finite, within 1e+06 m of zero",
    ),
    case(
        shot(velocities=np.array([["1e4000", 0], [0, 0]], np.longdouble)),
        "velocities[0, 0]",
        "inf",
        "must be finite",
        "longdouble",
    ),
    case(
        shot(
            positions=np.broadcast_to((0.1, 0.1), (4097, 2)),
            velocities=np.zeros((4097, 2)),
            spins=np.zeros((4097, 3)),
        ),
        "positions",
        "shape (4097, 2)",
        "at most 4096",
        "too many balls",
    ),
]

NORMALS = [
    case(call(normal=normal), "normal", value, "must be a horizontal unit vector", f"{who}-{value}")
    for call, who in [(impact, "balls"), (cushion, "cushion")]
    for normal, value in [
        ((2.0, 0.0, 0.0), "(2.0, 0.0, 0.0)"),
        ((0.0, 0.0, 0.0), "(0.0, 0.0, 0.0)"),
        ((0.0, 0.0, 1.0), "(0.0, 0.0, 1.0)"),
        ((0.6, 0.8, 0.001), "(0.6, 0.8, 0.001)"),
        ((1.00001, 0.0, 0.0), "(1.00001, 0.0, 0.0)"),
        ((1e200, 0.0, 0.0), "(1e+200, 0.0, 0.0)"),
    ]
]

FIDELITIES = [
    case(call(fidelity=wrong), "fidelity", repr(wrong), FIDELITY, f"{who}-{wrong!r}")
    for call, who in [(impact, "balls"), (cushion, "cushion"), (shot, "shot"), (batch, "batch")]
    for wrong in WRONG_FIDELITIES
]

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
    case(
        shot(**{k: np.zeros((0, n)) for k, n in WIDTHS.items()}),
        "positions",
        "shape (0, 2)",
        "at least one ball",
        "empty table",
    ),
    case(shot(positions=put(NAN, 0.0)), "positions[1, 0]", "nan", "must be finite"),
    case(shot(positions=put(0.3, INF)), "positions[1, 1]", "inf", "must be finite"),
    case(shot(velocities=[(1.0, 0.0), (0.0, -INF)]), "velocities[1, 1]", "-inf", "must be finite"),
    case(shot(spins=[(0.0, 0.0, NAN), Z]), "spins[0, 2]", "nan", "must be finite"),
    case(
        shot(positions=put(0.05, 0.0)),
        "positions",
        "balls 0 and 1",
        "overlap by 0.0025 m, at most 1e-06 is allowed",
        "overlap",
    ),
    case(shot(positions=put(0.0, 0.0)), "positions", "balls 0 and 1", "overlap by 0.0525 m", "one place"),
    case(
        shot(positions=put(0.0525 - 1.1e-6, 0.0)),
        "positions",
        "balls 0 and 1",
        "overlap by 1.1e-06 m, at most 1e-06 is allowed",
        "just",
    ),
    case(
        shot(positions=put(1.5, 0.0)),
        "positions",
        "(1.5, 0.0)",
        "must be on the table, |x| <= 0.86275, |y| <= 1.75825",
    ),
    case(shot(positions=put(0.0, -2.0)), "positions", "(0.0, -2.0)", "must be on the table"),
    case(
        shot(positions=put(1e300, 0.3)), "positions[1, 0]", "1e+300", "must be finite, within 1e+06 m of zero"
    ),
    case(shot(positions=put(1e5, 0.3)), "positions", "(100000.0, 0.3)", "must be on the table"),
    case(shot(positions=put(0.87, 0.5)), "positions", "(0.87, 0.5)", "overlaps the cushion at x = 0.889"),
    case(
        shot(positions=put(-0.862752, 0.5)),
        "positions",
        "(-0.862752, 0.5)",
        "overlaps the cushion at x = -0.889",
    ),
    case(shot(positions=put(0.2, 1.77)), "positions", "(0.2, 1.77)", "overlaps the cushion at y = 1.7845"),
    case(shot(positions=put(0.2, -1.77)), "positions", "(0.2, -1.77)", "overlaps the cushion at y = -1.7845"),
    case(shot(positions=put(0.889, 1.7845)), "positions", "(0.889, 1.7845)", "is over a pocket"),
    case(shot(positions=put(0.895, 0.0)), "positions", "(0.895, 0.0)", "is over a pocket"),
    case(shot(positions=put(0.885, 0.05)), "positions", "(0.885, 0.05)", "overlaps jaw"),
    case(shot(on_table=[True]), "on_table", "bool array of shape (1,)", "must be bool of shape (2,)"),
    case(
        shot(on_table=[[True, True]]), "on_table", "bool array of shape (1, 2)", "must be bool of shape (2,)"
    ),
    case(shot(on_table=[1, 0]), "on_table", "int64 array of shape (2,)", "must be bool of shape (2,)"),
    case(shot(on_table=[1.0, 0.0]), "on_table", "float64 array", "must be bool of shape (2,)"),
    case(shot(on_table="yes"), "on_table", "array of shape ()", "must be bool of shape (2,)"),
    case(shot(on_table=[[True], True]), "on_table", "[[True], True]", "must be bool of shape (2,)"),
    *[
        case(
            shot(max_events=wrong),
            "max_events",
            repr(wrong),
            "must be an integer in [1, 2147483648]",
            f"max_events={wrong!r}",
        )
        for wrong in (0, -1, 1.5, 100.0, True, "many", None, NAN, 2**31 + 1)
    ],
    *[
        case(call(table=wrong), "table", repr(wrong), '"match", "tight"', f"{who}-table={wrong!r}")
        for call, who in [(shot, "shot"), (batch, "batch")]
        for wrong in (3, True, ["match"], {"name": "match"}, b"match")
    ],
    *[
        case(
            call(table=wrong),
            "table",
            repr(wrong),
            "must be one of 'match', 'tight'",
            f"{who}-table={wrong!r}",
        )
        for call, who in [
            (shot, "shot"),
            (batch, "batch"),
            (lambda table: lambda: sn.Table.preset(table), "preset"),
        ]
        for wrong in ("", "Match", "loose", "unbounded")
    ],
    case(lambda: sn.Table.preset(None), "table", "None", "must be one of 'match', 'tight'"),
    case(batch(positions=[(0.0, 0.0), (0.3, 0.0)]), "positions", "shape (2, 2)", "must have shape (b, n, 2)"),
    case(batch(velocities=np.zeros((2, 2, 2))), "velocities", "shape (2, 2, 2)", "must have shape (3, 2, 2)"),
    case(batch(spins=np.zeros((3, 2))), "spins", "shape (3, 2)", "must have shape (3, 2, 3)"),
    case(
        batch(positions=[put(0.3, 0.0), put(0.3, 0.0), put(0.02, 0.0)]),
        "positions[2]",
        "balls 0 and 1",
        "overlap by 0.0325 m",
    ),
    case(
        batch(positions=[put(0.3, 0.0), put(0.905, 0.5), put(0.3, 0.0)]),
        "positions[1][1]",
        "(0.905, 0.5)",
        "must be on the table",
    ),
    case(
        batch(positions=[put(0.3, 0.0), put(0.3, NAN), put(0.3, 0.0)]),
        "positions[1, 1, 1]",
        "nan",
        "must be finite",
    ),
    case(
        batch(on_table=[True, True]), "on_table", "bool array of shape (2,)", "must be bool of shape (3, 2)"
    ),
    case(
        batch(**{k: np.zeros((2, 0, n)) for k, n in WIDTHS.items()}),
        "positions",
        "shape (2, 0, 2)",
        "at least one ball",
        "empty tables",
    ),
    *[
        case(
            batch(threads=wrong),
            "threads",
            repr(wrong),
            "must be an integer in [1, 1024]",
            f"threads={wrong!r}",
        )
        for wrong in (0, -2, 1.0, "2", True, 1025)
    ],
    *[
        case(batch(events=wrong), "events", repr(wrong), "must be True or False", f"events={wrong!r}")
        for wrong in ("x", 1, None, [True])
    ],
    case(batch(max_events=0), "max_events", "0", "must be an integer in [1, 2147483648]", "batch-max_events"),
    *[
        case(
            call(physics={name: 0.0}),
            f"physics.{name}",
            "0.0",
            "must be > 0 to simulate a shot",
            f"{who}-frictionless {name}",
        )
        for call, who in [(shot, "shot"), (batch, "batch")]
        for name in ("mu_s", "mu_r")
    ],
    *[
        case(call(physics={name: wrong}), f"physics.{name}", repr(wrong), allowed, f"{who}-{name}={wrong}")
        for call, who in [(shot, "shot"), (batch, "batch")]
        for name, wrong, allowed in [
            ("mu_s", 5e-324, "times g = 9.81 in [1e-06, 1e+06] m/s^2"),
            ("mu_r", 1e-8, "times g = 9.81 in [1e-06, 1e+06] m/s^2"),
            ("spin_decel", 5e-324, "must be 0 (a spin about the vertical stays) or at least 1e-06 rad/s^2"),
        ]
    ],
    case(
        shot(physics={"g": 1e308}),
        "physics.mu_s",
        "0.21",
        "times g = 1e+308 in [1e-06, 1e+06]",
        "crushing weight",
    ),
    case(
        shot(physics={"g": 1e-300}), "physics.mu_s", "0.21", "times g = 1e-300 in [1e-06, 1e+06]", "no weight"
    ),
]

STRIKES = [
    *[
        case(strike(**{field: wrong}), field, repr(wrong), allowed, f"strike-{field}={wrong!r}")
        for field, allowed, wrongs in [
            ("speed", "must be a finite number in [0, 1000]", (-1.0, -1e-300, 1000.1, 1e25, 1e200, NAN, INF)),
            ("elevation", "must be a finite number in [0, 1.5]", (-0.01, 1.51, NAN, INF)),
            ("aim", "must be a finite number", (NAN, INF)),
            ("side", "must be a finite number", (NAN, -INF)),
            ("top", "must be a finite number", (NAN, INF)),
        ]
        for wrong in (
            *wrongs,
            "1",
            None,
            True,
            [1.0, 2.0],
            1j,
            b"1",
            np.array([2.0]),
            np.ma.masked,
            [[1.0], 2.0],
            {},
        )
    ],
    *[
        case(
            strike(aim=aim),
            "aim",
            str(aim),
            "must be in radians, within a turn of 0; from degrees: np.radians(degrees)",
            f"aim {aim}",
        )
        for aim in (90.0, -180.0, 6.3)
    ],
    case(
        strike(side=0.6),
        "(side, top)",
        "(0.6, 0.0)",
        "0.6 R is a miscue, must be within 0.5 R of the ball's centre",
        "miscue",
    ),
    case(
        strike(side=-0.4, top=0.4),
        "(side, top)",
        "(-0.4, 0.4)",
        "miscue, must be within 0.5 R",
        "miscue of the pair",
    ),
    case(
        strike(top=-0.5001), "(side, top)", "(0.0, -0.5001)", "miscue, must be within 0.5 R", "just a miscue"
    ),
    case(
        strike(side=0.4, physics={"max_offset": 0.3}),
        "(side, top)",
        "(0.4, 0.0)",
        "within 0.3 R",
        "miscue of other physics",
    ),
]


def moved(**fields):
    return lambda: sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], [Z]).at(**fields)


TIMES = [
    case(moved(t=-0.5), "t", "-0.5", "must not be negative"),
    case(moved(t=[0.1, -1e-12]), "t", "-1e-12", "must not be negative"),
    case(moved(t=NAN), "t[0]", "nan", "must be finite"),
    case(moved(t=[0.0, INF]), "t[1]", "inf", "must be finite"),
    case(moved(t=[[0.1]]), "t", "shape (1, 1)", "must have shape (n,)"),
    case(moved(t=True), "t", "True", "must be real numbers of shape (n,)"),
    case(moved(t=np.ma.array([0.1], mask=[True])), "t", "masked", "must be real numbers of shape (n,)"),
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
    *[
        case(strike(speed=wrong), "speed", repr(wrong), "must be a finite number", f"speed={wrong!r}")
        for wrong in (np.complex128(1 + 2j), np.array(1j), np.timedelta64(3, "ns"), np.datetime64(3, "ns"))
    ],
    case(
        shot(max_events=np.timedelta64(3, "ns")),
        "max_events",
        repr(np.timedelta64(3, "ns")),
        "must be an integer in",
        "events of time",
    ),
    case(shot(fidelity="euler:" + "9" * 5000), "fidelity", "'euler:9999", FIDELITY, "endless N"),
    case(
        lambda: sn.Table("x", np.zeros((1, 2)), np.zeros((0, 6)), np.zeros((0, 3))),
        "table.noses",
        "shape (1, 2)",
        "must have shape (n, 5)",
        "own table of wrong shape",
    ),
]


@pytest.mark.parametrize(("call", "field", "value", "allowed"), [*VECTORS, *NORMALS, *HUGE])
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


def test_balls_off_the_table_may_lie_anywhere():
    """What is not on the table is not looked at: no overlap, no place is wrong for it, and it stays where it
    is."""
    places = [(0.0, 0.0), (0.0, 0.0), (5.0, 5.0)]
    shot = sn.simulate(
        places, [(0.0, 1.0), (9.0, 0.0), (0.0, 0.0)], np.zeros((3, 3)), on_table=[True, False, False]
    )
    assert shot.positions[1:].tolist() == [[0.0, 0.0], [5.0, 5.0]] and shot.on_table.tolist() == [
        True,
        False,
        False,
    ]


def test_what_is_just_allowed_is_played():
    touching = [(0.0, 0.0), (0.0525 - 0.9e-6, 0.0)]
    assert sn.simulate(touching, np.zeros((2, 2)), np.zeros((2, 3))).duration == 0.0
    wall = HALF_WIDTH - BALL_RADIUS
    assert sn.simulate([(wall + 0.9e-6, 0.5)], np.zeros((1, 2)), np.zeros((1, 3))).duration == 0.0
    sn.strike(0.0, -2 * np.pi, side=0.3, top=-0.4, elevation=1.5)
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


def test_a_shot_inside_a_shot_has_its_own_log(monkeypatch):
    """As a signal handler or a trace function may start one: between the kernel and the copy of its log."""
    first, other = (
        ([(0.0, 0.0)], [(1.0, 0.2)], [(0.0, 0.0, 0.0)]),
        ([(0.0, 0.5)], [(0.3, 2.0)], [(5.0, 0.0, 0.0)]),
    )
    want, run = sn.simulate(*first), simulation._run

    def interrupted(*arguments, **more):
        out = run(*arguments, **more)
        monkeypatch.setattr(simulation, "_run", run)
        sn.simulate(*other)
        return out

    monkeypatch.setattr(simulation, "_run", interrupted)
    got = sn.simulate(*first)
    assert (
        np.array_equal(got.events, want.events)
        and np.array_equal(got.segments, want.segments)
        and len(want.events) > 1
    )
