"""What is recorded of a stroke? The strike, the shot, the referee's decision, and the table after it."""

from dataclasses import dataclass
from typing import Any

from .._lib.types import Bools, CueKind, Floats
from ..game.balls import BallOn, ids_of
from ..game.fouls import Foul
from ..game.frame import Frame
from ..physics.cue_room import MOVED, RAISED, UNPLAYABLE
from ..simulation import Shot
from .noise import Noise
from .stroke import BREAK, COST, CUE_SPEED, FIRST, FOULS, FREE, PLAYER, ROOM, SCORED, WAS_ON, ShotBuffers


@dataclass(frozen=True, eq=False, kw_only=True)
class Played:
    """One stroke as it was played and judged, and the table after it: an element of ``env.history``."""

    shot: Shot  # with its path if that was recorded
    cue: dict[str, float]  # errors included: "speed" [m/s], "side", "top" (over R), "aim", "elevation" [rad]
    cue_kind: CueKind  # whether rails and balls were in the way of the cue
    noise: Noise  # the errors of the player
    player: int  # who played it: 0, or in a frame 0 or 1
    ball_on: BallOn  # what was on
    free_ball: bool  # whether the player had one
    first: tuple[int, ...]  # ids of the balls struck first: one, none, or those struck at the same instant
    points: int
    penalty: int  # to the opponent
    fouls: Foul  # the rules that the stroke broke
    positions: Floats  # (22, 2) after the stroke [m], colours respotted and a cue ball in hand placed
    on_table: Bools  # (22,) then
    next_on: BallOn  # NOTHING when the visit or frame is over
    next_free_ball: bool
    next_player: int
    scores: tuple[int, ...]  # in a frame both after the stroke; in a visit its points so far
    break_before: int
    break_points: int  # with this stroke; in a frame 0 if it scored nothing
    in_hand: bool  # whether the cue ball is in hand next
    choice: bool  # whether the next player has a decision to make, after a foul
    over: bool  # whether the visit or frame has ended
    winner: int | None  # of the frame
    frame: Frame | None = None  # all that the rules know of it after the stroke; None in a visit
    before: Frame | None = None  # the same before the stroke; None where nobody kept it, as the next
    meant: dict[str, Any] | None = None  # the stroke without errors: the fields of ``CueStroke``
    room: tuple[str, ...] = ()  # what a real cue did to it: "raised", "moved" (its tip, up), "unplayable"


def fields_of(buffers: ShotBuffers, j: int) -> dict[str, Any]:
    """The fields of ``Played`` that shot j of the buffers holds."""
    seen, done = buffers.seen[j].tolist(), int(buffers.shots[j, ROOM])
    names = ("speed", "side", "top", "aim", "elevation")
    cue = dict(zip(names, buffers.shots[j, CUE_SPEED:ROOM].tolist(), strict=True))
    room = zip(("raised", "moved", "unplayable"), (RAISED, MOVED, UNPLAYABLE), strict=True)
    strike = {"cue": cue, "room": tuple(name for name, flag in room if done & flag)}
    cost = {"points": seen[SCORED], "penalty": seen[COST], "fouls": Foul(seen[FOULS])}
    before = {"ball_on": BallOn(seen[WAS_ON]), "free_ball": bool(seen[FREE]), "player": seen[PLAYER]}
    first = {"first": ids_of(seen[FIRST]), "break_before": seen[BREAK] - seen[SCORED]}
    return strike | cost | before | first
