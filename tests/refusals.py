"""How does a test see that wrong input is refused, and that the message names it?"""

import re
import warnings

import numpy as np
import pytest

import snooker_env as sn
from snooker_env.envs.snooker import SnookerEnv

Z = (0.0, 0.0, 0.0)
NAN, INF = float("nan"), float("inf")
FIDELITY = 'must be "fast", "standard", "reference" or "euler:N" with N in [1, 10000000]'
WRONG_FIDELITIES = (
    "euler:0",
    "euler:-1",
    "euler:x",
    "Euler:10",
    "",
    None,
    3,
    "euler",
    "euler:",
    "euler:1.5",
    "euler: 5",
    "euler:10000001",
    "euler:\u0663",
    "fast ",
    "FAST",
    ("fast",),
    ["fast"],
    b"fast",
    True,
)


def case(call, field, value, allowed, name=None):
    """One line of a table of wrong input."""
    return pytest.param(call, field, value, allowed, id=name or f"{field}={value}"[:70])


def refused(call, field, value, allowed):
    """The call raises ValueError that names all three; a warning is an error, too."""
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


# The calls, each with arguments that are right but for the changes


def impact(**changes):
    args = {"v1": (1, 0, 0), "w1": Z, "v2": Z, "w2": Z, "normal": (1, 0, 0)} | changes
    return lambda: sn.collide_balls(**args)


def cushion(**changes):
    args = {"v": (1, 0, 0), "w": Z, "normal": (1, 0, 0)} | changes
    return lambda: sn.collide_cushion(**args)


def shot(**changes):
    args = {
        "positions": [(0.0, 0.0), (0.3, 0.0)],
        "velocities": [(1.0, 0.0), (0.0, 0.0)],
        "spins": np.zeros((2, 3)),
    } | changes
    return lambda: sn.simulate(**args)


def batch(**changes):
    args = {
        "positions": [[(0.0, 0.0), (0.3, 0.0)]] * 3,
        "velocities": [[(1.0, 0.0), (0.0, 0.0)]] * 3,
        "spins": np.zeros((3, 2, 3)),
    } | changes
    return lambda: sn.simulate_batch(**args)


def strike(**changes):
    args = {"speed": 2.0, "aim": 0.3} | changes
    return lambda: sn.strike(**args)


def make(**fields):
    return lambda: SnookerEnv(**fields)
