"""Which stroke does a player ask for? Speed, tip, aim, elevation and place in SI units, checked, and as a row of the box action space.

A program or a person says ``Wish`` in the words of the protocol; the frame plays actions. Nothing is repaired on the way: a tip beyond the
miscue limit or a speed out of range is refused, and the message says what is allowed.
"""

from dataclasses import dataclass
from math import hypot, pi, sqrt
from typing import Any

import numpy as np

from .._check import choice, number, refuse
from .._types import Floats
from ..game.balls import COLOUR_NAMES, NAMES, colour
from ..geometry import BAULK_Y, D_RADIUS, POCKETS
from ..tasks.box_actions import MAX_ELEVATION, MAX_SPEED, MIN_SPEED

MOST_OFFSET = 0.5
"""The miscue limit: the largest distance of the tip from the ball's middle, over R."""
DECISIONS = {"play_again": -1.0, "play": 0.0, "replace": 1.0}
"""The last number of an action, for each choice after a foul."""


@dataclass(frozen=True, kw_only=True)
class Wish:
    """A stroke as it is asked for, without errors of execution.

    Attributes
    ----------
    speed : float
        Of the cue [m/s].
    aim : float
        Direction in which the cue ball leaves [rad], anticlockwise from +x; in (-pi, pi].
    side, top : float
        Tip offset over R: + right, + up.
    elevation : float
        Of the cue [rad].
    """

    speed: float
    aim: float
    side: float = 0.0
    top: float = 0.0
    elevation: float = 0.0

    def action(self, place: tuple[float, float]) -> Floats:
        """The row of ``Actions("absolute", elevation=True, placement=True, decision=True)`` that means this; ``place``: in the D."""
        row = np.zeros(8)
        row[0] = 2.0 * (self.speed - MIN_SPEED) / (MAX_SPEED - MIN_SPEED) - 1.0
        row[1], row[2], row[3] = 2.0 * self.side, 2.0 * self.top, self.aim / pi
        row[4] = 2.0 * self.elevation / MAX_ELEVATION - 1.0
        across = min(1.0, max(-1.0, place[0] / D_RADIUS))
        depth = D_RADIUS * sqrt(max(0.0, 1.0 - across * across))
        row[5] = across
        row[6] = 2.0 * min(1.0, max(0.0, (BAULK_Y - place[1]) / depth)) - 1.0 if depth > 1e-9 else -1.0
        return row


def wish_of(given: dict[str, Any], aim: float | None = None) -> Wish:
    """The ``Wish`` in a request: "speed", "aim" unless it is given otherwise, "side", "top", "elevation"; ValueError for a wrong number."""
    for name in ("speed",) if aim is not None else ("speed", "aim"):
        if name not in given:
            raise refuse(name, None, 'must be given: {"speed": m/s, "aim": rad, "side": 0, "top": 0, "elevation": rad}')
    side, top = (number(name, given.get(name, 0.0), -MOST_OFFSET, MOST_OFFSET) for name in ("side", "top"))
    if hypot(side, top) > MOST_OFFSET * (1.0 + 1e-9):
        raise refuse("side, top", [side, top], f"must be within {MOST_OFFSET} of the middle together: beyond it the tip slips off")
    turn = number("aim", given["aim"], -1e6, 1e6) if aim is None else aim
    turn -= 2.0 * pi * np.round(turn / (2.0 * pi))
    return Wish(
        speed=number("speed", given["speed"], MIN_SPEED, MAX_SPEED), aim=float(min(pi, max(-pi, turn))), side=side, top=top,
        elevation=number("elevation", given.get("elevation", 0.0), 0.0, MAX_ELEVATION),
    )  # fmt: skip


def place_of_request(field: str, value: Any) -> tuple[float, float]:
    """Two numbers [m]; ValueError for anything else."""
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise refuse(field, value, "must be [x, y] in metres")
    return number(f"{field}[0]", value[0], -10, 10), number(f"{field}[1]", value[1], -10, 10)


def ball_named(field: str, value: Any) -> int:
    """The id of an object ball by its name ("red 3", "blue")."""
    return NAMES.index(choice(field, value, NAMES[1:]))


def colour_named(field: str, value: Any) -> int:
    """The id of a colour by its name."""
    return colour(choice(field, value, COLOUR_NAMES))


def pocket_named(field: str, value: Any) -> int:
    """The index of a pocket by its name; "right middle" is "middle right"."""
    if isinstance(value, str):
        for k, name in enumerate(POCKETS):
            if sorted(value.lower().split()) == sorted(name.split()):
                return k
    raise refuse(field, value, "must be one of " + ", ".join(map(repr, POCKETS)))
