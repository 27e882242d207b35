"""How does a test see that wrong input is refused, and that the message names it?"""

import re
import warnings

import numpy as np
import pytest

import snooker_env as sn
from snooker_env import SnookerEnv

Z = (0.0, 0.0, 0.0)
NAN, INF = float("nan"), float("inf")
FIDELITY = 'must be "fast", "standard", "reference" or "euler:N" with N in [1, 10000000]'
OTHER_FIDELITIES = (None, 3, "", "fast ", "FAST", ("fast",), ["fast"], b"fast", True, "euler", "Euler:10")
NO_STEPS = ("0", "-1", "x", "", "1.5", " 5", "10000001", "\u0663")
WRONG_FIDELITIES = (*OTHER_FIDELITIES, *(f"euler:{n}" for n in NO_STEPS))


def case(call, field, value, allowed, name=None):
    """One line of a table of wrong input."""
    return pytest.param(call, field, value, allowed, id=name or f"{field}={value}"[:70])


def refused(call, field, value, allowed):
    """The call raises ValueError that names all three; a warning is an error, too."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(ValueError) as info:
            call()
    assert value and allowed, "an empty text is in every message"
    message = str(info.value)
    assert type(info.value) is ValueError
    assert message.startswith(field), f"does not name {field}: {message}"
    rest = message[len(field) :]
    assert re.match(r"(\[[\d, ]+\])* = ", rest), f"does not read 'field = value: what is allowed': {message}"
    assert value in rest, f"does not show {value!r}: {message}"
    assert allowed in rest, f"does not say {allowed!r}: {message}"


def refuse_each(table, names):
    """Each line of a table is refused: ``call | field | value | what is allowed``, and maybe ``| wrong; wrong``, each of
    which takes the place of ``?``. ``names``: those that the calls use."""
    for line in filter(str.strip, table.splitlines()):
        call, *said, wrongs = (part.strip() for part in f"{line} | ".split(" | ", 4))
        for wrong in wrongs.removesuffix(" |").split(";"):
            one = call.replace("?", wrong.strip())
            print(one)  # pytest shows it if it is not refused
            shown = repr(eval(wrong, names)) if wrong else ""
            refused(lambda one=one: _call(eval(one, names)), *(part.replace("?", shown) for part in said))


def _call(made):
    return made() if callable(made) else made


# The calls, each with arguments that are right but for the changes


def impact(**changes):
    args = {"v1": (1, 0, 0), "w1": Z, "v2": Z, "w2": Z, "normal": (1, 0, 0)} | changes
    return lambda: sn.collide_balls(**args)


def cushion(**changes):
    args = {"v": (1, 0, 0), "w": Z, "normal": (1, 0, 0)} | changes
    return lambda: sn.collide_cushion(**args)


HERE = {
    "positions": [(0.0, 0.0), (0.3, 0.0)],
    "velocities": [(1.0, 0.0), (0.0, 0.0)],
    "spins": np.zeros((2, 3)),
}


def shot(**changes):
    return lambda: sn.simulate(**HERE | changes)


def batch(**changes):
    args = {name: [value] * 3 for name, value in HERE.items()}
    return lambda: sn.simulate_batch(**args | changes)


def strike(**changes):
    return lambda: sn.strike(**{"speed": 2.0, "aim": 0.3} | changes)


def make(**fields):
    return lambda: SnookerEnv(**fields)
