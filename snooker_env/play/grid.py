"""On which grid is a game played? Strokes are rounded before they are played, and places after them: to whole multiples of
powers of two, so a table on it is the same on every machine, bit for bit."""

from collections.abc import Sequence
from itertools import product
from math import hypot, pi
from typing import TypeAlias

import numpy as np

from .._lib.check import refuse_what
from .._lib.types import Bools, Floats, Ints
from ..advice import CueStroke
from ..game.balls import CUE, NAMES
from ..game.frame import Frame
from ..game.in_hand import place_cue
from ..planning.stroke_columns import FARTHEST
from ..tasks.box_actions import MAX_SPEED, MIN_SPEED, STEEPEST
from ..tasks.frames import Frames

Places: TypeAlias = Floats | list[list[float]]
Flags: TypeAlias = Bools | list[bool]
STEP = 2.0**-21
"""Of places [m]: two balls in contact, each moved by half a step, overlap by less than the micrometre that is allowed."""
SPEED, TIP, TILT, TURN = 512, 512, 1024, 2**22
"""Steps of a stroke: of its speed a m/s, of its tip a ball's radius, of its elevation a radian, of its direction a turn."""
LOW = (int(MIN_SPEED * SPEED) + 1, -int(FARTHEST * TIP), -int(FARTHEST * TIP), -TURN // 2, 0)
HIGH = (int(MAX_SPEED * SPEED), int(FARTHEST * TIP), int(FARTHEST * TIP), TURN // 2 - 1, int(STEEPEST * TILT))
"""The ends of a stroke's numbers, as ``numbers_of`` lists them."""
_NEAR = sorted(product(range(-4, 5), repeat=2), key=lambda shift: hypot(*shift))


def numbers_of(stroke: CueStroke) -> list[int]:
    """Speed, side, top, direction and elevation of a stroke as whole numbers, those nearest to them."""
    speed, side, top, aim, elevation = stroke.numbers().tolist()
    tip = int if hypot(round(side * TIP), round(top * TIP)) > FARTHEST * TIP else round  # towards the middle
    turns = (round(aim / (2.0 * pi) * TURN) + TURN // 2) % TURN - TURN // 2
    near = round(speed * SPEED), tip(side * TIP), tip(top * TIP), turns, round(elevation * TILT)
    return [min(high, max(low, step)) for low, step, high in zip(LOW, near, HIGH, strict=True)]


def stroke_of(numbers: list[int]) -> CueStroke:
    """The stroke that ``numbers_of`` turns into these numbers; ValueError if there is none."""
    speed, side, top, aim, elevation = numbers
    aimed = {"aim": aim * (2.0 * pi / TURN), "elevation": elevation / TILT}
    return CueStroke.of({"speed": speed / SPEED, "side": side / TIP, "top": top / TIP, **aimed})


def steps_of(places: Places | Sequence[float]) -> Ints:
    """The points of the grid nearest to places [m]."""
    return np.rint(np.asarray(places) / STEP).astype(np.int64)


def list_moved(before: Places, after: Places, on_table: Flags, frame: Frame) -> list[int]:
    """Balls on the table that lie at another point of the grid than they lay; without a cue ball in hand."""
    moved = (steps_of(before) != steps_of(after)).any(axis=1) & np.asarray(on_table)
    moved[CUE] &= not frame.in_hand
    return np.flatnonzero(moved).tolist()


class Grid:
    """Where the balls of a game by link come to rest: at a point of the grid."""

    def settle(self, tables: Frames, before: Places) -> None:
        """Put all balls on the grid after a stroke, before which they lay ``before`` (22, 2) [m]."""
        moved = list_moved(before, tables.positions[0], tables.on_table[0], tables.frame(0))
        still = tables.on_table[0].copy()
        still[[CUE, *moved]] = False
        tables.positions[0, still] = np.asarray(before)[still]
        for ball in moved:
            self.put(tables, ball)

    def put(self, tables: Frames, ball: int) -> None:
        """Put a ball on the point of the grid nearest to it where it may lie; ValueError if there is none."""
        positions, frame = tables.positions[0], tables.frame(0)
        here, in_hand = steps_of(positions[ball]), ball == CUE and frame.in_hand
        for shift in _NEAR:
            positions[ball] = x, y = ((here + shift) * STEP).tolist()
            if not in_hand and is_sound(tables):
                return
            if in_hand and place_cue(positions, tables.on_table[0], x, y, anywhere=frame.anywhere) == (x, y):
                return
        raise refuse_what("place", NAMES[ball], "must have a point of the grid near it where it may lie")


def is_sound(tables: Frames) -> bool:
    try:
        tables.rules.table.check(tables.positions[0], tables.rules.physics.R, on_table=tables.on_table[0])
    except ValueError:
        return False
    return True
