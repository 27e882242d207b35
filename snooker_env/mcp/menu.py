"""What does a model read of the menu of strokes? Of each what closed forms foresee, as numbers and in words."""

from typing import Any

import numpy as np

from .._lib.check import integer, refuse
from .._lib.types import Bools, Floats, Ints
from ..game.balls import NAMES
from ..game.frame import CHOICES
from ..game.frame_columns import PLAY
from ..geometry import HALF_LENGTH, HALF_WIDTH, POCKETS
from ..planning import Positions, pots
from ..players.cue_stroke import cue_strokes
from ..players.seen import SeenPlayer
from ..tasks import foreseen as columns
from ..tasks.box_actions import FASTEST
from ..tasks.observations import STROKE_SIZE
from ..tasks.options import Options
from ..tasks.stroke_menu import DECISIONS, PER_SPEED, SPEEDS, TOPS


class _Reader:
    """Sees the menu of one position and takes the stroke of a number."""

    def __init__(self, frame: bool, number: int):
        self.options = {"task": "frame" if frame else "visit", "action": "strokes", "observation": "strokes"}
        self.number = number

    def act(self, observations: Floats, masks: Bools, seeds: Ints) -> list[int]:
        """The number, once it is known to be on the menu."""
        self.row, (self.there,) = observations[0], masks
        number = integer("number", self.number, 0, len(self.there) - 1)
        if not self.there[number]:
            raise refuse("number", number, "must be on the menu of this table")
        return [number]


def take_stroke(number: int, at: Positions, options: Options) -> dict[str, Any]:
    """The stroke with this number, as fields of ``POST api/stroke``."""
    return _read(number, at, options)[1]


def _read(number: int, at: Positions, options: Options) -> tuple[_Reader, dict[str, Any]]:
    reader = _Reader(at.of_frames, number)
    try:
        strokes = SeenPlayer(reader, name="menu").at(options).play(at, [0])
    except ValueError as error:
        raise ValueError(str(error).removeprefix("player menu: act(...) returned ")) from None
    decision = int(strokes.decision[0])
    if decision != PLAY:
        return reader, {"choice": CHOICES[decision]}
    fields = {
        name: value for name, value in cue_strokes(strokes, at)[0].to_dict().items() if value is not None
    }
    return reader, fields | ({"choice": "play"} if at.choice[0] else {})


def foresee_strokes(at: Positions, options: Options) -> list[dict[str, Any]]:
    """What is foreseen of each stroke on the menu, the best first: pots by their promise, then others."""
    reader, _ = _read(0, at, options)
    direct, frame = pots(at.as_visits()), at.of_frames
    rows = reader.row[: len(reader.there) * STROKE_SIZE].reshape(-1, STROKE_SIZE).astype(float)
    found = []
    for number in np.flatnonzero(reader.there).tolist():
        row, line = rows[number], number // (SPEEDS * len(TOPS))
        if frame and number >= len(rows) - DECISIONS:
            found.append({"number": number, "choice": ("play_again", "replace")[number - len(rows)]})
            continue
        is_pot = number < PER_SPEED * SPEEDS and row[columns.F_POT] > 0
        pot = [NAMES[direct.ball[0, line]], POCKETS[direct.pocket[0, line]]] if is_pot else None
        x, y = row[columns.F_X] * HALF_WIDTH, row[columns.F_Y] * HALF_LENGTH
        found.append(
            {
                "number": number,
                "pot": pot,
                "speed": round(row[columns.F_SPEED] * FASTEST, 2),
                "top": round(row[columns.F_TOP] * TOPS[-1], 2),
                "chance": round(row[columns.F_CHANCE], 3) if pot else None,
                "points": round(7 * row[columns.F_POINTS]),
                "foul": bool(row[columns.F_FOUL]),
                "cue_ball": [round(x, 3), round(y, 3)],
                "cushions": round(5 * row[columns.F_NOSES]),
                "next": round(columns.MOST_WORTH * row[columns.F_PROSPECTS], 1),
                "promise": round(columns.MOST_PROMISE * row[columns.F_PROMISE], 1),
            }
        )
    return sorted(found, key=_rank)


def _rank(one: dict[str, Any]) -> tuple[Any, ...]:
    """Decisions, then fair pots by their promise, then other fair strokes by what they leave, then fouls."""
    if "choice" in one:
        return (0,)
    return 1 + one["foul"], one["pot"] is None, -one["promise"], one["next"], one["number"]
