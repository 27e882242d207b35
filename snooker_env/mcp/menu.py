"""What does a model read about the menu of strokes? What closed forms foresee of each."""

from typing import Any

import numpy as np

from .._lib.check import integer, refuse
from .._lib.types import Bools, Floats, Ints
from ..game.balls import NAMES
from ..game.frame import CHOICES
from ..game.frame_columns import BALL_ON, PLAY
from ..geometry import HALF_LENGTH, HALF_WIDTH, POCKETS
from ..planning import Positions, pots
from ..players.cue_stroke import cue_strokes
from ..players.seen import SeenPlayer
from ..tasks import foreseen as columns
from ..tasks.box_actions import FASTEST
from ..tasks.observations import STROKE_SIZE
from ..tasks.options import Options
from ..tasks.stroke_menu import DECISIONS, SPEEDS, TOPS

MEANING = (
    "speed: m/s; chance: of potting the ball; x, y: where the cue ball stops; next: worth of the position left, in points, to "
    "whoever plays next; promise: chance times the points of this pot and the next ones."
)
_SHOWN = {
    "speed": (columns.F_SPEED, FASTEST),
    "top": (columns.F_TOP, TOPS[-1]),
    "points": (columns.F_POINTS, 7),
    "chance": (columns.F_CHANCE, 1),
    "foul": (columns.F_FOUL, 1),
    "x": (columns.F_X, HALF_WIDTH),
    "y": (columns.F_Y, HALF_LENGTH),
    "cushions": (columns.F_NOSES, 5),
    "next": (columns.F_PROSPECTS, columns.MOST_WORTH),
    "promise": (columns.F_PROMISE, columns.MOST_PROMISE),
}  # name of a number: the column that holds it, and over what


class _Reader:
    """Sees the menu of one position and takes the stroke of a number."""

    def __init__(self, at: Positions, options: Options, number: int):
        task = "frame" if at.of_frames else "visit"
        self.options = {"task": task, "action": "strokes", "observation": "strokes"}
        self.number = number
        try:
            self.strokes = SeenPlayer(self, name="menu").at(options).play(at, [0])
        except ValueError as error:
            raise ValueError(str(error).removeprefix("player menu: act(...) returned ")) from None

    def act(self, observations: Floats, masks: Bools, seeds: Ints) -> list[int]:
        """The number, once it is known to be on the menu."""
        self.row, (self.there,) = observations[0], masks
        number = integer("number", self.number, 0, len(self.there) - 1)
        if not self.there[number]:
            raise refuse("number", number, "must be on the menu of this table")
        return [number]


def take_stroke(number: int, at: Positions, options: Options) -> dict[str, Any]:
    """The stroke with this number, as fields of ``POST api/stroke``."""
    strokes = _Reader(at, options, number).strokes
    decision = int(strokes.decision[0])
    if decision != PLAY:
        return {"choice": CHOICES[decision]}
    fields = cue_strokes(strokes, at)[0].to_dict() | ({"choice": "play"} if at.choice[0] else {})
    return {name: value for name, value in fields.items() if value is not None}


def foresee_strokes(at: Positions, options: Options) -> list[dict[str, Any]]:
    """What is foreseen of each stroke on the menu, the best first: pots by their promise, then others."""
    reader, named = _Reader(at, options, 0), _name_pots(at)
    rows = reader.row[: len(reader.there) * STROKE_SIZE].reshape(-1, STROKE_SIZE).astype(float)
    found = []
    for number in np.flatnonzero(reader.there).tolist():
        one: dict[str, Any] = {"number": number}
        if at.of_frames and number >= len(rows) - DECISIONS:
            found.append(one | {"choice": ("play_again", "replace")[number - len(rows)]})
            continue
        if rows[number, columns.F_POT] > 0:
            one["pot"] = named[number // (SPEEDS * len(TOPS))]
        numbers = {name: round(rows[number, c] * over, 3) for name, (c, over) in _SHOWN.items()}
        found.append(one | numbers)
    return sorted(found, key=_rank)


def _name_pots(at: Positions) -> list[list[str]]:
    """Ball and pocket of each line of the menu that is a pot; with a free ball of both kinds, the widest first."""
    found, kinds = [], [at.as_visits()]
    if at.free_ball[0]:
        kinds.append(kinds[0].copy())
        kinds[1].game[:, BALL_ON] = at.ball_on
    for some in map(pots, kinds):
        found += zip(-some.tolerance[0], some.ball[0].tolist(), some.pocket[0].tolist(), strict=True)
    return [[NAMES[ball], POCKETS[pocket]] for _, ball, pocket in sorted(found) if ball >= 0]


def _rank(one: dict[str, Any]) -> tuple[Any, ...]:
    """Decisions, then fair pots by their promise, then other fair strokes by what they leave, then fouls."""
    if "choice" in one:
        return (0,)
    return 1 + one["foul"], "pot" not in one, -one["promise"], one["next"], one["number"]
