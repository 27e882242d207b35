"""How likely is each player of a frame to win, as it goes on? The positions of a frame, judged one after the other."""

from collections.abc import Sequence
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np

from .._lib.check import refuse_what
from .._lib.types import Bools, Floats, Ints
from ..game import frame_columns as columns
from ..game.balls import BLACK, mask_of_present
from ..game.frame import Frame, write_frame
from ..physics import cloth
from ..planning import Positions
from ..simulation import Shot
from ..tasks.played import Played

DIGITS = 4  # decimals of a chance in data


@runtime_checkable
class ChanceJudge(Protocol):
    """Who says how likely the striker of each position of a frame wins: ``snooker_env.player("tactician").at(env)``."""

    def chance_to_win(self, positions: Positions) -> Floats:
        """The chances (n,) of n positions of frames as their strikers see them."""
        ...


class Standing(NamedTuple):
    """A frame between two strokes: the rules' part, and the balls (22, 2) [m], (22,)."""

    frame: Frame
    positions: Floats
    on_table: Bools


def win_chances(judge: ChanceJudge, standings: Sequence[Standing]) -> list[float]:
    """How likely player 0 wins each of n frames as they stand: 0 and 1 only where the judge is certain."""
    strikers = np.array([one.frame.striker for one in standings])
    theirs = np.asarray(judge.chance_to_win(positions_of(standings, strikers)), np.float64)
    first = np.where(strikers == 0, theirs, 1.0 - theirs)
    least = np.where((first > 0.0) & (first < 1.0), 10.0**-DIGITS, 0.0)  # rounding makes nothing certain
    return np.clip(first.round(DIGITS), least, 1.0 - least).tolist()


def positions_of(standings: Sequence[Standing], players: Ints, begun: Ints | None = None) -> Positions:
    """n frames as one of the ``players`` (n,) sees each, who is player 0 there; ``begun`` (n,): strokes played before, or none."""
    n = len(standings)
    game = np.zeros((n, columns.COLUMNS), np.int64)
    saved = columns.Layouts(np.zeros((n, 22, 2)), np.zeros((n, 22), np.bool_))
    for k, one in enumerate(standings):
        write_frame(one.frame, 0 if begun is None else int(begun[k]), game[k], saved, k)
    present = np.stack([one.on_table for one in standings])
    places = np.where(present[..., None], np.stack([one.positions for one in standings]), 0.0)
    return Positions(places, present, np.where(players[:, None] == 1, columns.swap_sides(game), game), saved)


def standings_of(strokes: Sequence[object]) -> list[Standing]:
    """The frame before the first of n strokes, and after each: n + 1. ValueError unless all are of frames."""
    standings: list[Standing] = []
    for k, one in enumerate(strokes):
        if not isinstance(one, Played) or one.frame is None:
            what = "a stroke of a visit" if isinstance(one, Played) else "a bare shot"
            raise refuse_what(f"strokes[{k}]", what, "must be of a frame with a judge: nobody wins a visit")
        if k == 0:
            standings.append(Standing(frame_before(one, one.frame), *start_of(one.shot)))
        standings.append(Standing(one.frame, one.positions, one.on_table))
    return standings


def start_of(shot: Shot) -> tuple[Floats, Bools]:
    """The balls (n, 2) [m] before a shot, and which are on the table (n,)."""
    first = shot.segments[: len(shot.positions)]
    return first[:, [cloth.X, cloth.Y]], first[:, cloth.SEGMENT_STATE] != cloth.GONE


def frame_before(stroke: Played, after: Frame) -> Frame:
    """The frame that a stroke was played from; where nobody kept it, without misses before it and the cue ball in hand."""
    if stroke.before is not None:
        return stroke.before
    _, here = start_of(stroke.shot)
    scores = list(stroke.scores)
    scores[stroke.player] -= stroke.points
    scores[1 - stroke.player] -= stroke.penalty
    balls = mask_of_present(here) & ~1
    level = balls == 1 << BLACK and scores[0] == scores[1]
    same = {name: getattr(after, name) for name in ("breaker", "rack", "rules", "miss")}
    return Frame(
        **same,
        scores=(scores[0], scores[1]),
        striker=stroke.player,
        break_points=stroke.break_before,
        on_table=balls,
        ball_on=stroke.ball_on,
        free_ball=stroke.free_ball,
        in_hand=False,
        respotted_black=level and after.respotted_black,
    )
