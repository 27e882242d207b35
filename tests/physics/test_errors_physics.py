"""Are wrong physical parameters refused, whichever way they are given? A ValueError names the field, the
value and what is allowed."""

import pytest

import snooker_env as sn
from snooker_env.envs.snooker import SnookerEnv
from tests.refusals import INF, NAN, batch, case, cushion, impact, refused, shot, strike

RANGES = {
    "R": ("[0.001, 1]", 0, -1, 1.1, 1e-300),
    "M": ("(0, inf)", 0, -0.1),
    "g": ("(0, inf)", 0, -9.81),
    "mu_s": ("[0, 1]", -0.1, 1.1),
    "mu_r": ("[0, 1]", -0.01, 1.01),
    "spin_decel": ("[0, inf)", -1),
    "roll_drag": ("[0, 1]", -1e-9, 1.01),
    "e_b": ("[0, 1]", -0.1, 1.01),
    "e_c": ("[0, 1]", -0.1, 1.01),
    "e_c_knee": ("[0, inf)", -1),
    "e_c_power": ("[0, 0.8]", -0.1, 0.81),
    "mu_c": ("[0, 1]", -0.1, 2),
    "sin_theta": ("[0, 0.95]", -0.1, 0.96),
    "end_mass_ratio": ("[0, inf)", -1),
    "max_offset": ("(0, 0.999]", 0, 1.0),
}
SHARE = "must be a finite number in [0, 1]"
KNEE = "must be at least 0.001 m/s where e_c_power > 0: above it e(v) = e_c (v / e_c_knee)^(-e_c_power)"
MU_BB = 'must be a number in [0, 1], "marlow", or (a, b, c) with a, b, c >= 0 and a + b <= 1'
WAYS = {
    "Physics": lambda name, value: lambda: sn.Physics(**{name: value}),
    "preset": lambda name, value: lambda: sn.Physics.preset("match", **{name: value}),
    "dict": lambda name, value: strike(physics={name: value}),
    "env": lambda name, value: lambda: SnookerEnv(physics={name: value}),
}
PHYSICS = [
    *[
        case(
            way(name, wrong),
            f"physics.{name}",
            repr(wrong),
            f"must be a finite number in {allowed}",
            f"{how}-{name}={wrong!r}",
        )
        for how, way in WAYS.items()
        for name, (allowed, *wrongs) in RANGES.items()
        for wrong in (*wrongs, *((NAN, INF, "0.1", None, True, [0.1]) if how == "Physics" else (NAN,)))
    ],
    *[
        case(way("mu_bb", wrong), "physics.mu_bb", repr(wrong), allowed, f"{how}-mu_bb={wrong!r}")
        for how, way in WAYS.items()
        for wrong, allowed in [
            (-0.1, SHARE),
            (1.1, SHARE),
            (NAN, SHARE),
            (None, SHARE),
            ("Marlow", MU_BB),
            ((0.1, 0.2), MU_BB),
            ((0.5, 0.6, 1.0), MU_BB),
            ([0.1] * 4, MU_BB),
        ]
    ],
    case(
        lambda: sn.Physics(nap=0.001, roll_drag=0.01),
        "physics.roll_drag",
        "0.01",
        "must be 0 with physics.nap = 0.001",
        "nap and drag",
    ),
    case(lambda: sn.Physics(e_c_power=0.25), "physics.e_c_knee", "0.0", KNEE, "power without a knee"),
    case(
        lambda: sn.Physics(e_c_power=1e-9, e_c_knee=9e-4), "physics.e_c_knee", "0.0009", KNEE, "knee too low"
    ),
    case(lambda: sn.Physics.preset("match", e_c_knee=0), "physics.e_c_knee", "0.0", KNEE, "preset-no-knee"),
    case(strike(physics={"e_c_power": 0.1}), "physics.e_c_knee", "0.0", KNEE, "dict-no-knee"),
    *[
        case(
            lambda v=v: sn.Physics(e_j=v),
            "physics.e_j",
            repr(v),
            "must be a finite number in [0, 1]",
            f"e_j={v}",
        )
        for v in (-0.1, 1.01, NAN, INF, "0.5", True)
    ],
    *[
        case(
            lambda v=v: sn.Physics(mu_bb=v),
            "physics.mu_bb",
            str(bad),
            "must be a finite number in [0, inf)",
            f"mu_bb={v}",
        )
        for v, bad in [
            ((-0.1, 0.1, 1.0), -0.1),
            ((0.1, -0.1, 1.0), -0.1),
            ((0.1, 0.1, -1.0), -1.0),
            ((0.1, NAN, 1.0), NAN),
        ]
    ],
    *[
        case(call(wrong), "physics", repr(wrong), "must be one of 'paper', 'match'", f"{who}-{wrong!r}")
        for who, call in [
            ("preset", lambda n: lambda: sn.Physics.preset(n)),
            ("of", lambda n: lambda: sn.Physics.of(n)),
            ("strike", lambda n: strike(physics=n)),
            ("shot", lambda n: shot(physics=n)),
            ("impact", lambda n: impact(physics=n)),
            ("cushion", lambda n: cushion(physics=n)),
            ("batch", lambda n: batch(physics=n)),
            ("env", lambda n: lambda: SnookerEnv(physics=n)),
            ("key", lambda n: lambda: sn.Physics.of({"preset": n})),
        ]
        for wrong in ("", "Paper", "real")
    ],
    *[
        case(
            lambda w=wrong: sn.Physics.of(w),
            "physics",
            repr(wrong),
            "must be None, a preset's name, a dict of overrides, or a Physics",
        )
        for wrong in (3, ["paper"], ("paper",), True, 0.5, b"paper")
    ],
    case(
        lambda: sn.Physics.preset("paper", mu=0.1),
        "physics field",
        "'mu'",
        "must be one of 'R', 'M', 'g', 'mu_s'",
        "preset-unknown",
    ),
    case(lambda: sn.Physics.of({"mu": 0.1}), "physics field", "'mu'", "must be one of 'R'", "of-unknown"),
    case(
        lambda: SnookerEnv(physics={"mu": 0.1}), "physics field", "'mu'", "must be one of 'R'", "env-unknown"
    ),
    case(lambda: sn.Physics.of({"name": "match"}), "physics field", "'name'", "must be one of 'R'"),
    case(lambda: sn.Physics.of({"cls": 1}), "physics field", "'cls'", "must be one of 'R'"),
    case(lambda: sn.Physics.of({1: 0.1}), "physics field", "1", "must be one of 'R'"),
]


@pytest.mark.parametrize(("call", "field", "value", "allowed"), PHYSICS)
def test_wrong_physics(call, field, value, allowed):
    refused(call, field, value, allowed)


def test_an_unknown_field_of_physics_itself_is_refused_as_python_does():
    with pytest.raises(TypeError, match="mu_ball"):
        sn.Physics(mu_ball=0.1)


def test_physics_cannot_be_changed_and_its_range_ends_are_allowed():
    with pytest.raises(AttributeError):
        sn.Physics().e_b = 0.5
    sn.Physics(e_c_power=0.8, e_c_knee=1e-3)
    sn.Physics(
        R=1,
        mu_s=0,
        mu_r=1,
        spin_decel=0,
        e_b=1,
        e_c=0,
        mu_c=1,
        sin_theta=0.95,
        end_mass_ratio=0,
        max_offset=0.999,
        mu_bb=(0, 1, 0),
    )
