"""How likely is each player of a frame to win, as it goes on? The positions of a frame, judged one after the other."""

from collections.abc import Sequence
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np

from .._lib.check import number, refuse, refuse_what
from .._lib.types import Bools, Floats
from ..game import frame_columns as columns
from ..game.balls import BLACK, mask_of_present
from ..game.frame import Frame, write_frame
from ..game.sides import strikers_own
from ..physics import cloth
from ..planning import Positions
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


def check_judge(judge: object) -> ChanceJudge | None:
    """A judge, or None for none."""
    if judge is not None and not isinstance(judge, ChanceJudge):
        allowed = 'must have chance_to_win(positions), as snooker_env.player("tactician").at(env) has'
        raise refuse_what("judge", f"a {type(judge).__name__}", allowed)
    return judge


def check_luck(luck: Sequence[float] | None, strokes: int, judged: bool) -> tuple[float, ...] | None:
    """The luck of so many strokes of a frame, or None for not known."""
    if luck is None:
        return None
    if not judged:
        raise refuse("luck", luck, "must be None: without a judge a replay holds no chances to win")
    if not isinstance(luck, list | tuple) or len(luck) != strokes:
        raise refuse("luck", luck, f"must be {strokes} numbers, one for each stroke")
    return tuple(number(f"luck[{k}]", one, -1.0, 1.0) for k, one in enumerate(luck))


def win_chances(judge: ChanceJudge, standings: Sequence[Standing]) -> list[float]:
    """How likely player 0 wins each of n frames as they stand: 0 and 1 only where the judge is certain."""
    n = len(standings)
    game = np.zeros((n, columns.COLUMNS), np.int64)
    saved = columns.Layouts(np.zeros((n, 22, 2)), np.zeros((n, 22), np.bool_))
    for k, one in enumerate(standings):
        write_frame(one.frame, 0, game[k], saved, k)
    present = np.stack([one.on_table for one in standings])
    places = np.where(present[..., None], np.stack([one.positions for one in standings]), 0.0)
    at = Positions(places, present, strikers_own(game), saved)
    theirs = np.asarray(judge.chance_to_win(at), np.float64)
    first = np.where(game[:, columns.STRIKER] == 0, theirs, 1.0 - theirs)
    least = np.where((first > 0.0) & (first < 1.0), 10.0**-DIGITS, 0.0)  # rounding makes nothing certain
    return np.clip(first.round(DIGITS), least, 1.0 - least).tolist()


def standings_of(strokes: Sequence[object]) -> list[Standing]:
    """The frame before the first of n strokes, and after each: n + 1. ValueError unless all are of frames."""
    standings: list[Standing] = []
    for k, one in enumerate(strokes):
        if not isinstance(one, Played) or one.frame is None:
            what = "a stroke of a visit" if isinstance(one, Played) else "a bare shot"
            raise refuse_what(f"strokes[{k}]", what, "must be of a frame with a judge: nobody wins a visit")
        if k == 0:
            standings.append(_before(one, one.frame))
        standings.append(Standing(one.frame, one.positions, one.on_table))
    return standings


def _before(stroke: Played, after: Frame) -> Standing:
    """The frame that a stroke was played from, its cue ball placed; how often it was missed before is not known."""
    first = stroke.shot.segments[: len(stroke.shot.positions)]
    here = first[:, cloth.SEGMENT_STATE] != cloth.GONE
    scores = list(stroke.scores)
    scores[stroke.player] -= stroke.points
    scores[1 - stroke.player] -= stroke.penalty
    balls = mask_of_present(here) & ~1
    level = balls == 1 << BLACK and scores[0] == scores[1]
    same = {name: getattr(after, name) for name in ("breaker", "rack", "rules", "miss")}
    frame = Frame(
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
    return Standing(frame, first[:, [cloth.X, cloth.Y]], here)
