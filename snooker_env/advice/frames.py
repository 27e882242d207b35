"""What does a stroke of a frame lead to, for both players? ``Outlook``: the chance to win, and the other's next visit,
by the samples in which the opponent comes to the table."""

from math import hypot, sqrt
from typing import NamedTuple

import numpy as np

from .._types import Floats, Ints
from ..game import frame_columns as columns
from ..game.balls import CUE
from ..planning import Outcomes, Positions, clear_paths, obstructions
from ..planning.trials import turned
from ..planning.worth import chosen, lead_of
from ..players.player import placed
from .practice import Practice
from .visits import played_on
from .words import lie_words

Z = 1.959964  # standard deviations of a 95 % interval


class Outlook(NamedTuple):
    """See ``Suggestion``, whose attributes have these names."""

    win: float
    win_interval: tuple[float, float]
    replies: float | None
    leaves: float | None
    snookers: float | None


def outlooks(
    practice: Practice, starts: Positions, each: Ints, stops: Outcomes, n: int, visits: int, seed: int
) -> list[Outlook]:
    """The outlook of n strokes: ``each`` (n * tries,) says which; ``visits`` are played to their end."""
    after = stops.afterstates
    wins = practice.judge.value_of(lead_of(starts)[each], after)[:, 0].reshape(n, -1)
    comes = np.flatnonzero(others_next(after))
    theirs = met(after[comes])
    hidden = ~clear_paths(theirs).any_part
    groups = [np.flatnonzero(each[comes] == k) for k in range(n)]
    scored = rest_of(practice, theirs, groups, visits, seed)
    out = []
    for mine, group, rest in zip(wins, groups, scored, strict=True):
        half = Z * sqrt(float(mine.var(ddof=1)) / len(mine)) if len(mine) > 1 else 0.0
        win = float(mine.mean())
        interval = max(0.0, win - half), min(1.0, win + half)
        replies = (float((rest > 0.0).mean()), float(rest.mean())) if len(rest) else (None, None)
        out.append(Outlook(win, interval, *replies, float(hidden[group].mean()) if len(group) else None))
    return out


def rest_of(practice: Practice, left: Positions, groups: list[Ints], visits: int, seed: int) -> list[Floats]:
    """For each group of rows of ``left``: the points of the visits from its first ``visits`` rows."""
    rows = [group[:visits] for group in groups]
    numbers = np.concatenate([np.arange(len(some)) for some in rows]).astype(np.int64)
    rest = played_on(practice, left[np.concatenate(rows).astype(np.int64)].as_visits(), numbers, seed)
    return np.split(rest, np.cumsum([len(some) for some in rows])[:-1])


def others_next(after: Positions) -> np.ndarray:
    """Where the other comes to the table next: bool (n,)."""
    game = after.game
    plays = np.isin(game[:, columns.PHASE], (columns.STROKE, columns.CHOICE))
    return plays & (game[:, columns.STRIKER] == 1)


def met(after: Positions) -> Positions:
    """What the opponent meets: as it plays, after a foul as the balls lie, with a cue ball in hand where it is good."""
    return placed(chosen(turned(after), columns.PLAY), np.zeros(len(after), np.int64))[0]


def lies(stops: Outcomes) -> list[str]:
    """Where strokes that leave the table to the other put the cue ball, in words; "" elsewhere."""
    out, after = [""] * len(stops.first), stops.afterstates
    rows = np.flatnonzero(others_next(after) & (stops.penalty == 0))
    theirs = met(after[rows])
    seen = clear_paths(theirs).any_part
    for j, k in enumerate(rows.tolist()):
        x, y = theirs.positions[j, CUE].tolist()
        ball = -1 if seen[j] else _nearest_in_the_way(theirs, j)
        gap = 0.0 if ball < 0 else hypot(*(theirs.positions[j, ball] - (x, y)).tolist())
        out[k] = lie_words(x, y, ball, gap)
    return out


def _nearest_in_the_way(at: Positions, k: int) -> int:
    """The ball nearest to the cue ball of those on its straight lines to the balls on; -1 if there is none."""
    here, on = at.positions[k], np.flatnonzero(at.balls_on[k])
    many, starts = np.arange(len(on)), np.repeat(here[None, CUE], len(on), 0)
    hit = obstructions(at, np.full(len(on), k), starts, here[on], ignore=[CUE])
    hit[many, on] = False
    way = np.flatnonzero(hit.any(axis=0))
    if not len(way):
        return -1
    return int(way[np.hypot(*(here[way] - here[CUE]).T).argmin()])
