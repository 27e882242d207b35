"""What is a stroke of a visit worth? Its points, and the value of the position that it leaves; where strokes without a pot
are tried, less the penalty of a foul and, if the visit ends, the share ``LEFT`` of what the position is worth to the opponent."""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from .._lib.types import Bools, Floats, Ints, Singles
from ..game.balls import CUE, SPOTS, BallOn
from ..game.frame_columns import BALL_ON, IN_HAND, OVER, POINTS
from ..tasks.rule_of_thumb import RULE_OF_THUMB, SURE
from .planner import Planner, RulesLike, options_in
from .positions import Positions
from .pot_geometry import prospects_of
from .proposals import Proposals, Propose, at_balls, over_cushions
from .search import Judge, Plan, Proposed, Search
from .stroke_columns import COLUMNS

SCHEDULES = (
    (30, 16, ((4, 2), (2, 3))),
    (60, 32, ((6, 2), (3, 5))),
    (120, 60, ((10, 3), (4, 7))),
    (500, 220, ((20, 4), (8, 12), (4, 25))),
    (2000, 800, ((40, 8), (16, 25), (5, 95))),
)
"""Budget, number of looks, and for each round the number of strokes and their further samples."""
LEFT = 0.5  # share of a position's value for the opponent that counts
FOUL = 20.0  # what a foul costs beside its penalty [points]: the balls replaced, or a free ball
Value: TypeAlias = Callable[
    [Positions], Floats | Singles
]  # values [points] of positions that strokes have left
WITHOUT_POTS: tuple[Propose, ...] = (at_balls, over_cushions)  # for positions without a likely pot


def schedule(budget: int) -> Plan:
    """Number of looks, and (strokes, further samples) of each round; together at most ``budget`` shots."""
    for least, looks, rounds in reversed(SCHEDULES):
        if budget >= least:
            grown = tuple((many, each * budget // least) for many, each in rounds)
            return Plan((looks * budget // least,), grown)
    return Plan((budget,), ())


class VisitJudge(Judge):
    """Judges strokes by the points of a visit.

    Parameters
    ----------
    env_or_options, threads
        As for ``Planner``. With the reward "legal" strokes of all kinds are tried; their score is the share that is no foul.
    value : callable, optional
        Values [points] of n ``Positions``: (n,). Default: the rule of thumb ``prospects_of``.
    pots_only : bool, optional
        Whether only the chance of the pot counts; without a pot, the chance of a foul counts against a stroke.

    Examples
    --------
    >>> from snooker_env.planning import VisitJudge
    >>> VisitJudge({"noise": "club"}).least
    8
    """

    least = 8

    def __init__(
        self,
        env_or_options: RulesLike,
        value: Value | None = None,
        *,
        pots_only: bool = False,
        threads: int | None = None,
    ):
        options = options_in(env_or_options)
        self.planner: Planner = Planner(options, threads=threads)
        super().__init__(self.planner.rules)
        self.value: Value = self._by_rule if value is None else value
        self.legal: bool = options.reward == "legal"
        self.pots_only: bool = pots_only

    def _by_rule(self, at: Positions) -> Floats:
        constants = SURE if self.noise.silent else RULE_OF_THUMB
        rails, threads = self.dynamics.rails, self.planner.threads
        return prospects_of(at, self.spread, constants, threads=threads, rails=rails)[0]

    def plans(self, search: Search, at: Positions, seeds: Ints) -> list[tuple[Plan, Ints]]:
        """One for all positions; without execution errors the first look takes the whole budget."""
        plan = Plan((search.budget,), ()) if self.noise.silent else schedule(search.budget)
        return [(plan, np.arange(len(at)))]

    def propose(self, search: Search, at: Positions, seeds: Ints, plan: Plan) -> Proposed:
        """Pots; where there are none, or a stroke need only be fair, strokes at balls and over cushions, too."""
        (m,), at = plan.looks, at.as_visits()
        strokes, chances, kinds = self._share(search, search.propose, at, m, seeds)
        doubt = chances.max(axis=1) <= (1.0 if self.legal else 0.0)
        if doubt.any():
            strokes, chances, kinds = strokes.copy(), chances.copy(), kinds.copy()
            shared = self._share(search, (*search.propose, *WITHOUT_POTS), at[doubt], m, seeds[doubt])
            strokes[doubt], chances[doubt], kinds[doubt] = shared
        return Proposed(strokes, chances, kinds, doubt | kinds.any(axis=1))

    def _share(
        self, search: Search, generators: tuple[Propose, ...], at: Positions, m: int, seeds: Ints
    ) -> tuple[Floats, Floats, Ints]:
        """Strokes of the generators that have any, in turn; chances; which generator each is of."""
        made = [Proposals(*generate(search, at, m, seeds)) for generate in generators]
        if len(made) == 1:
            return made[0].strokes, made[0].chances, np.zeros((len(at), m), np.int64)
        has = np.stack([each.chances.any(axis=1) for each in made])
        turn = np.arange(m) % np.maximum(1, has.sum(axis=0))[:, None]
        which = np.minimum((np.cumsum(has, axis=0)[:, :, None] <= turn).sum(axis=0), len(made) - 1)
        every, looks = np.arange(len(at))[:, None], np.arange(m)
        strokes, chances = (np.stack(part)[which, every, looks] for part in zip(*made, strict=True))
        return strokes, chances, which

    def look(self, at: Positions, proposed: Proposed, rows: Ints, picks: Ints) -> tuple[Floats, Bools]:
        """The points of each, by the chance of its pot."""
        gains = self.sample(at, proposed, rows, picks, np.zeros((len(rows), COLUMNS)))[:, 0]
        if not self.noise.silent and not self.legal:
            chances = proposed.chances[rows, picks]
            gains *= chances
            doubt = np.flatnonzero(doubtful := proposed.safe & (proposed.chances < 1.0).any(axis=1))
            if len(doubt) and not self.pots_only:  # a pot that is missed leaves the balls about as they lie
                left = np.zeros(len(at))
                left[doubt] = LEFT * self.value(for_opponent(at[doubt].as_visits()))
                gains = np.where(doubtful[rows], gains - (1.0 - chances) * left[rows], gains)
        return gains[:, None], np.ones(len(rows), np.bool_)

    def groups(self, kinds: Ints, looks: Floats) -> Ints:
        """Those without a pot that scored by luck are a group of their own."""
        return np.where((kinds > 0) & (looks[..., 0] > 0.0), -1, kinds)

    def sample(self, at: Positions, proposed: Proposed, rows: Ints, picks: Ints, errors: Floats) -> Floats:
        """Points, and the value of what is left."""
        out = self.planner.play_strokes(at, rows, proposed.strokes[rows, picks], errors=errors)
        gains, penalty, careful, after = out.points, out.penalty, proposed.safe[rows], out.afterstates
        if self.legal:
            return (penalty == 0).astype(np.float64)[:, None]
        if self.pots_only:
            return ((gains > 0).astype(np.float64) - (careful & (penalty > 0)))[:, None]
        gains[careful] -= penalty[careful] + FOUL * (penalty[careful] > 0)
        on, left = np.flatnonzero(~after.over), np.flatnonzero(after.over & careful)
        if len(on):
            gains[on] += self.value(after[on])
        if len(left):
            gains[left] -= LEFT * self.value(for_opponent(after[left]))
        return gains[:, None]


def for_opponent(after: Positions) -> Positions:
    """Positions after a visit as those of the opponent's; a cue ball in hand lies at its usual place."""
    theirs = after.copy()
    reds = theirs.on_table[:, 1:16].any(axis=1)
    theirs.game[:, BALL_ON] = np.where(reds, int(BallOn.RED), 2 + theirs.on_table[:, 16:].argmax(axis=1))
    theirs.game[:, [IN_HAND, POINTS, OVER]] = 0
    theirs.positions[~theirs.on_table[:, CUE], CUE] = SPOTS[CUE]
    theirs.on_table[:, CUE] = True
    return theirs
