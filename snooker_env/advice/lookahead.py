"""How does the lookahead player choose? It tries strokes without errors, the better ones under errors, and so on to the best few.

The value of a stroke is its points plus, if the visit goes on, the value of the position left, by the rule of thumb
(``planning.prospects_of``). Where no direct pot is likely, strokes that hit a ball on are tried as well: full, thin and off cushions. Then
the opponent's gain counts too: the penalty of a foul, and half of the value of the position for him.

All candidates of a round meet the same noise samples. The better ones go on to the next round, with more samples (sequential halving,
Karnin, Koren & Somekh 2013).
"""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..game.balls import CUE, SPOTS, BallOn
from ..game.frame_columns import BALL_ON
from ..planning import Positions, Stops
from . import seeds
from .advisor import Advisor, Ranked
from .candidates import FAN, FINE_FAN, at_balls, at_pots, fan
from .practice import Practice, starts, stroke_of_row

ROUNDS = ((64, 6), (24, 24), (12, 96))
"""For each round: the number of candidates, the best so far, and the number of further noise samples."""
LEFT = 0.5
"""Weight of the position's value for the opponent, where nothing can be potted."""
DOUBTFUL = 0.4
"""Largest chance of a pot, by the rule of thumb, at which strokes that pot nothing are tried as well."""
EACH = 2
"""Strokes for each pot, top and side in the first round: neighbouring speeds give similar results."""

Tried: TypeAlias = tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]
"""The start of each stroke (n,), the strokes (n, 5), and their values (n,)."""
_NONE: Tried = (np.empty(0, np.int64), np.empty((0, 5)), np.empty(0))


class LookaheadAdvisor(Advisor):
    """The built-in "lookahead": the best strokes by simulation and a rule of thumb. Its scores are points."""

    name = "lookahead"

    def rank(self, practice: Practice, at: Positions, n: int, seed: int) -> Ranked:
        """The best strokes in one position, best first, each with its value [points]."""
        there = starts(practice, at)
        rows, strokes, likely = at_pots(practice, there)
        trial = practice.play(there, rows, strokes)
        made = trial.points > 0
        tried = _best((rows, strokes, likely * self._gain(practice, trial)), made, len(made))
        safe = not (likely[made] > DOUBTFUL).any()
        if safe:
            contacts, lucky = self._contacts(practice, there)
            groups = ((tried, np.ones(len(tried[0]), np.bool_), 32), (contacts, ~lucky, 24), (contacts, lucky, 8))
            tried = _joined([_best(*group) for group in groups])
        rows, strokes, scores = self._halved(practice, there, tried, seed, safe=safe)
        in_hand = bool(at.in_hand[0])
        return [(stroke_of_row(s, there[k : k + 1], in_hand), float(v)) for k, s, v in zip(rows.tolist(), strokes, scores, strict=True)]

    @staticmethod
    def _gain(practice: Practice, stops: Stops) -> NDArray[np.float64]:
        """Points of the strokes and the value of what is left for the visit."""
        return stops.points + stops.goes_on * practice.prospects(stops.afterstates)[0]

    def _worth(self, practice: Practice, stops: Stops, safe: bool) -> NDArray[np.float64]:
        """Values of strokes; with ``safe``, less penalties and the opponent's prospects."""
        gain = self._gain(practice, stops)
        if not safe:
            return gain
        theirs = stops.afterstates.copy()
        reds = theirs.on_table[:, 1:16].any(axis=1)
        theirs.game[:, BALL_ON] = np.where(reds, int(BallOn.RED), 2 + theirs.on_table[:, 16:].argmax(axis=1))
        theirs.positions[~theirs.on_table[:, CUE], CUE] = SPOTS[CUE]  # in hand: about the usual place
        theirs.on_table[:, CUE] = True
        return gain - stops.penalty - LEFT * ~stops.goes_on * practice.prospects(theirs)[0]

    def _contacts(self, practice: Practice, there: Positions) -> tuple[Tried, NDArray[np.bool_]]:
        """Strokes that hit a ball on without errors, and which of them pot it (mostly by luck); all strokes tried if none is fair."""
        tried, lucky = _NONE, np.empty(0, np.bool_)
        for directions in (FAN, FINE_FAN):
            some = [np.concatenate([at_balls(there, k), fan(directions)]) for k in range(len(there))]
            rows, strokes = np.repeat(np.arange(len(there)), [len(each) for each in some]), np.concatenate(some)
            trial = practice.play(there, rows, strokes)
            tried, lucky, fair = (rows, strokes, self._worth(practice, trial, safe=True)), trial.points > 0, trial.penalty == 0
            if fair.any():
                return (rows[fair], strokes[fair], tried[2][fair]), lucky[fair]
        return tried, lucky

    def _halved(self, practice: Practice, there: Positions, tried: Tried, seed: int, *, safe: bool) -> Tried:
        """The strokes of the last round, best first, and their mean values under errors."""
        rows, strokes, worth = tried
        order = np.argsort(-worth, kind="stable")
        if practice.sure:
            keep = order[: ROUNDS[-1][0]]
            return rows[keep], strokes[keep], worth[keep]
        if not safe:
            order = order[_few_of_a_kind(rows[order], strokes[order])]
        rows, strokes = rows[order[: ROUNDS[0][0]]], strokes[order[: ROUNDS[0][0]]]
        samples = seeds.keys(seed, seeds.CHOOSING, sum(each for _, each in ROUNDS))
        sums, tries = np.zeros(len(rows)), 0
        for many, each in ROUNDS:
            best = np.argsort(-sums, kind="stable")[:many]
            rows, strokes, sums = rows[best], strokes[best], sums[best]
            n = len(rows)
            stops = practice.play(there, np.repeat(rows, each), np.repeat(strokes, each, 0), np.tile(samples[tries : tries + each], n))
            sums += self._worth(practice, stops, safe).reshape(n, each).sum(axis=1)
            tries += each
        best = np.argsort(-sums, kind="stable")
        return rows[best], strokes[best], sums[best] / tries


def _best(tried: Tried, which: NDArray[np.bool_], most: int) -> Tried:
    """The best ``most`` of the strokes in the mask ``which``."""
    of = np.flatnonzero(which)
    rows, strokes, worth = tried
    keep = of[np.argsort(-worth[of], kind="stable")[:most]]
    return rows[keep], strokes[keep], worth[keep]


def _joined(groups: list[Tried]) -> Tried:
    """Several groups of strokes as one."""
    rows, strokes, worth = (np.concatenate(part) for part in zip(*groups, strict=True))
    return rows, strokes, worth


def _few_of_a_kind(rows: NDArray[np.int64], strokes: NDArray[np.float64]) -> NDArray[np.int64]:
    """Indices of the first ``EACH`` strokes for each start, side, top and approximate direction; the strokes are sorted by value."""
    seen: dict[tuple[float, ...], int] = {}
    kept = []
    for i, (row, (_, side, top, aim, _)) in enumerate(zip(rows.tolist(), strokes.tolist(), strict=True)):
        kind = (row, side, top, round(aim, 1))
        seen[kind] = seen.get(kind, 0) + 1
        if seen[kind] <= EACH:
            kept.append(i)
    return np.array(kept, np.int64)
