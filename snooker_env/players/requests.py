"""Which stroke do the fields of a request ask for? The language of ``POST api/stroke`` (docs/play/protocol.md), which
programs speak too. A ValueError names an invalid field."""

from dataclasses import replace
from typing import Any

from .._lib.check import choice, number, refuse
from .._lib.files import strict_json
from ..game.balls import COLOUR_NAMES, NAMES, colour
from ..geometry import POCKET_AIMS, POCKETS
from ..planning import Planner, Positions
from .cue_stroke import CueStroke

STROKE = ("speed", "side", "top", "aim", "aim_at", "elevation", "place")  # fields that define a stroke


def read_object(raw: bytes) -> dict[str, Any]:
    """The JSON object in a body or a line; ValueError for others, NaN, Infinity and repeated names."""
    try:
        fields = strict_json(raw or b"{}")
    except ValueError as error:
        raise ValueError(f"the body must be JSON in UTF-8 ({error})") from None
    if not isinstance(fields, dict):
        raise ValueError("the body must be a JSON object")
    return fields


def read_stroke(fields: dict[str, Any], at: Positions, options: Any) -> CueStroke:
    """The stroke in a request, played from the one position ``at``, where the cue ball has been placed.

    An ``aim_at`` is solved with throw, for the ``options``."""
    for name in ("speed",) if "aim_at" in fields else ("speed", "aim"):
        if name not in fields:
            form = '{"speed": m/s, "aim": rad, "side": 0, "top": 0, "elevation": 0}'
            raise refuse(name, None, f"must be given: {form}")
    if "aim_at" in fields and "aim" in fields:
        raise refuse("aim", fields["aim"], "must be left out with aim_at")
    aim = number("aim", fields.get("aim", 0.0), -1e6, 1e6)
    parts = {name: fields[name] for name in ("speed", "side", "top", "elevation") if name in fields}
    stroke = CueStroke(aim=aim, **parts)
    if "aim_at" not in fields:
        return stroke
    ball, pocket = _read_pot(fields["aim_at"], at)
    aims = Planner(options).pot_aim(at, [0], [ball], POCKET_AIMS[[pocket], :2], [stroke.numbers()])
    return replace(stroke, aim=float(aims[0]))


def _read_pot(asked: object, at: Positions) -> tuple[int, int]:
    """Ball and pocket of {"pot": [ball, pocket]}."""
    pair = asked.get("pot") if isinstance(asked, dict) and set(asked) == {"pot"} else None
    if not isinstance(pair, list) or len(pair) != 2:
        raise refuse("aim_at", asked, 'must be {"pot": [ball, pocket]}, as {"pot": ["blue", "middle right"]}')
    ball = NAMES.index(choice("aim_at.pot[0]", pair[0], NAMES[1:]))
    pocket = _read_pocket("aim_at.pot[1]", pair[1])
    if not at.on_table[0, ball]:
        raise refuse("aim_at.pot[0]", NAMES[ball], "must be on the table")
    return ball, pocket


def _read_pocket(field: str, value: object) -> int:
    """Index of the pocket with a name; "right middle" is "middle right"."""
    if isinstance(value, str):
        for k, name in enumerate(POCKETS):
            if sorted(value.lower().split()) == sorted(name.split()):
                return k
    raise refuse(field, value, "must be one of " + ", ".join(map(repr, POCKETS)))


def read_place(field: str, value: object) -> tuple[float, float]:
    """Two numbers [m]; ValueError for anything else."""
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise refuse(field, value, "must be [x, y] in metres")
    return number(f"{field}[0]", value[0], -10, 10), number(f"{field}[1]", value[1], -10, 10)


def read_colour(field: str, value: object) -> int:
    return colour(choice(field, value, COLOUR_NAMES))
