"""Which stroke does a request contain? Its fields checked, in SI units and names, and as a row of the box action space.

Nothing is corrected: a tip beyond the miscue limit or a speed out of range is refused, and the message says what is allowed.
"""

from typing import Any

import numpy as np

from .._check import choice, number, refuse
from .._types import Floats
from ..advice.strokes import CueStroke
from ..game.balls import COLOUR_NAMES, NAMES, colour
from ..geometry import POCKETS
from ..physics.parameters import Physics
from ..planning.strokes import encoded
from ..tasks.box_actions import Actions

DECISIONS = {"play_again": -1.0, "play": 0.0, "replace": 1.0}
"""Last component of an action for each choice after a foul."""
_ACTIONS = Actions("absolute", True, True, Physics(), True)


def action_of(stroke: CueStroke, place: tuple[float, float]) -> Floats:
    """The row of ``Actions("absolute", elevation=True, placement=True, decision=True)`` for this stroke, in full precision.

    ``place``: where a cue ball in hand is placed in the D [m].
    """
    return encoded(_ACTIONS, stroke.numbers()[None], np.array([place]))[0]


def stroke_in(given: dict[str, Any], aim: float | None = None) -> CueStroke:
    """The stroke in a request: "speed", "aim" (unless passed separately), "side", "top", "elevation"; ValueError if invalid."""
    for name in ("speed",) if aim is not None else ("speed", "aim"):
        if name not in given:
            raise refuse(name, None, 'must be given: {"speed": m/s, "aim": rad, "side": 0, "top": 0, "elevation": 0}')
    parts = {name: given[name] for name in ("speed", "side", "top", "elevation") if name in given}
    return CueStroke(aim=number("aim", given["aim"], -1e6, 1e6) if aim is None else aim, **parts)


def place_of_request(field: str, value: Any) -> tuple[float, float]:
    """Two numbers [m]; ValueError for anything else."""
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise refuse(field, value, "must be [x, y] in metres")
    return number(f"{field}[0]", value[0], -10, 10), number(f"{field}[1]", value[1], -10, 10)


def ball_named(field: str, value: Any) -> int:
    """Id of the object ball with a name ("red 3", "blue")."""
    return NAMES.index(choice(field, value, NAMES[1:]))


def colour_named(field: str, value: Any) -> int:
    """Id of the colour with a name."""
    return colour(choice(field, value, COLOUR_NAMES))


def pocket_named(field: str, value: Any) -> int:
    """Index of the pocket with a name; "right middle" is "middle right"."""
    if isinstance(value, str):
        for k, name in enumerate(POCKETS):
            if sorted(value.lower().split()) == sorted(name.split()):
                return k
    raise refuse(field, value, "must be one of " + ", ".join(map(repr, POCKETS)))
