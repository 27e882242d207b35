"""What is kept of a stroke that was played? How it was struck, the shot, what the referee said of it, and the table that it left."""

from dataclasses import dataclass
from typing import Any

from .._types import Bools, Floats
from ..game.balls import BallOn, ids_of
from ..game.ruling import Foul
from ..simulation import Shot
from .stroke import BREAK, COST, CUE_SPEED, FIRST, FOULS, FREE, PLAYER, SCORED, WAS_ON, ShotBuffers


@dataclass(frozen=True, eq=False, kw_only=True)
class Played:
    """One stroke as it was played and judged, and the table after it.

    Attributes
    ----------
    shot : Shot
        With its path, if that was wanted.
    cue : dict of str to float
        The strike, errors of execution included: "speed" [m/s], "side", "top" (tip offset over R, right and up), "aim", "elevation" [rad].
    player : int
        Who played it: 0, in a frame 0 or 1.
    ball_on : BallOn
        What was on.
    free_ball : bool
        Whether he had a free ball.
    first : tuple of int
        The balls struck first: one, none, or those struck at the same instant.
    points, penalty : int
        What it scored; what it gave to the other player.
    fouls : Foul
        The rules that it broke.
    positions : float64 (22, 2)
        The balls after it [m], colours respotted and a cue ball in hand placed.
    on_table : bool (22,)
        Which balls are on the table then.
    next_on : BallOn
        What is on next; NOTHING when it is over.
    next_free_ball : bool
        Whether the next player has a free ball.
    next_player : int
        Whose turn it is next.
    scores : tuple of int
        Of a frame, after the stroke; of a visit its points so far.
    break_before : int
        Points of the break before this stroke.
    break_points : int
        Points of the break with this stroke, 0 if it scored nothing; of a visit its points so far.
    in_hand : bool
        Whether the cue ball is in hand next.
    choice : bool
        Whether the next player may first say what he wants, after a foul.
    over : bool
        Whether the visit or frame has ended.
    winner : int, or None
        Who has won the frame.
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


def judged(seen: list[int]) -> dict[str, Any]:
    """The fields of ``Played`` that are in a row of ``ShotBuffers.seen``."""
    return {
        "player": seen[PLAYER], "ball_on": BallOn(seen[WAS_ON]), "free_ball": bool(seen[FREE]), "first": ids_of(seen[FIRST]),
        "points": seen[SCORED], "penalty": seen[COST], "fouls": Foul(seen[FOULS]),
        "break_before": seen[BREAK] - seen[SCORED],
    }  # fmt: skip


def struck(buffers: ShotBuffers, j: int) -> dict[str, float]:
    """The field ``cue`` of ``Played``, of shot j."""
    return dict(zip(("speed", "side", "top", "aim", "elevation"), buffers.shots[j, CUE_SPEED:].tolist(), strict=True))
