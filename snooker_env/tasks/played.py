"""What is recorded of a stroke? The strike, the shot, the referee's decision, and the table after it."""

from dataclasses import dataclass
from typing import Any

from .._types import Bools, Floats
from ..game.balls import BallOn, ids_of
from ..game.frame import Frame
from ..game.ruling import Foul
from ..physics.cue_room import MOVED, RAISED, UNPLAYABLE
from ..simulation import Shot
from .stroke import BREAK, COST, CUE_SPEED, FIRST, FOULS, FREE, PLAYER, ROOM, SCORED, WAS_ON, ShotBuffers


@dataclass(frozen=True, eq=False, kw_only=True)
class Played:
    """One stroke as it was played and judged, and the table after it: an element of ``env.history``.

    Attributes
    ----------
    shot : Shot
        The simulated shot, with its path if that was recorded.
    cue : dict of str to float
        The strike, errors included: "speed" [m/s], "side", "top" (over R), "aim", "elevation" [rad].
    room : tuple of str
        What ``cue="real"`` did to the stroke that was meant: "raised", "moved" (its tip, upwards), "unplayable".
    player, next_player : int
        Who played it, and whose turn it is next: 0, or in a frame 0 or 1.
    ball_on, next_on : BallOn
        What was on, and what is on next; NOTHING when the visit or frame is over.
    free_ball, next_free_ball : bool
        Whether the player had a free ball, and whether the next player has one.
    first : tuple of int
        Ids of the balls struck first: one, none, or those struck at the same instant.
    points, penalty : int
        Points scored, and penalty points given to the opponent.
    fouls : Foul
        The rules that the stroke broke.
    positions, on_table : numpy.ndarray
        float64 (22, 2), the balls after the stroke [m], colours respotted and a cue ball in hand placed; bool
        (22,), which balls are on the table then.
    scores : tuple of int
        In a frame, both scores after the stroke; in a visit, its points so far.
    break_before, break_points : int
        Points of the break before and with this stroke; the latter in a frame 0 if it scored nothing.
    in_hand, choice, over : bool
        Whether the cue ball is in hand next; whether the next player has a decision to make, after a foul;
        whether the visit or frame has ended.
    winner : int or None
        Who has won the frame.
    frame : Frame or None
        All that the rules know of the frame after the stroke, such as what may be replaced; None in a visit.

    Examples
    --------
    >>> import snooker_env as sn
    >>> env = sn.SnookerEnv(action="discrete")
    >>> env.keep_history = True
    >>> _ = env.reset(seed=1), env.step(67)
    >>> env.history[0].player, env.history[0].ball_on.name
    (0, 'RED')
    """

    shot: Shot
    cue: dict[str, float]
    player: int
    ball_on: BallOn
    free_ball: bool
    first: tuple[int, ...]
    points: int
    penalty: int
    fouls: Foul
    positions: Floats
    on_table: Bools
    next_on: BallOn
    next_free_ball: bool
    next_player: int
    scores: tuple[int, ...]
    break_before: int
    break_points: int
    in_hand: bool
    choice: bool
    over: bool
    winner: int | None
    frame: Frame | None = None
    room: tuple[str, ...] = ()


def judged(seen: list[int]) -> dict[str, Any]:
    """The fields of ``Played`` that a row of ``ShotBuffers.seen`` holds."""
    cost = {"points": seen[SCORED], "penalty": seen[COST], "fouls": Foul(seen[FOULS])}
    before = {"ball_on": BallOn(seen[WAS_ON]), "free_ball": bool(seen[FREE]), "player": seen[PLAYER]}
    return cost | before | {"first": ids_of(seen[FIRST]), "break_before": seen[BREAK] - seen[SCORED]}


def struck(buffers: ShotBuffers, j: int) -> dict[str, float]:
    """The field ``cue`` of ``Played``, for shot j."""
    names = ("speed", "side", "top", "aim", "elevation")
    return dict(zip(names, buffers.shots[j, CUE_SPEED:ROOM].tolist(), strict=True))


def room_of(buffers: ShotBuffers, j: int) -> tuple[str, ...]:
    """The field ``room`` of ``Played``, for shot j."""
    done = int(buffers.shots[j, ROOM])
    return tuple(
        name
        for name, flag in (("raised", RAISED), ("moved", MOVED), ("unplayable", UNPLAYABLE))
        if done & flag
    )
