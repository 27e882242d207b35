"""Which stroke does a request contain? Its fields checked, in SI units and names; nothing is corrected."""

from typing import Any

from .._check import choice, number, refuse
from ..advice import CueStroke
from ..game.balls import COLOUR_NAMES, NAMES, colour
from ..geometry import POCKETS


def stroke_in(fields: dict[str, Any], aim: float | None = None) -> CueStroke:
    """The stroke in a request, its "aim" unless passed separately; ValueError if invalid."""
    for name in ("speed",) if aim is not None else ("speed", "aim"):
        if name not in fields:
            form = '{"speed": m/s, "aim": rad, "side": 0, "top": 0, "elevation": 0}'
            raise refuse(name, None, f"must be given: {form}")
    parts = {name: fields[name] for name in ("speed", "side", "top", "elevation") if name in fields}
    return CueStroke(aim=number("aim", fields["aim"], -1e6, 1e6) if aim is None else aim, **parts)


def place_asked(field: str, value: Any) -> tuple[float, float]:
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
