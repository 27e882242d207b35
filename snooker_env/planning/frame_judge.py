"""What is a stroke of a frame worth? Pots, safeties and escapes are judged alike, by the points that they bring and the
worth of what they leave to the next player (``worth``), and by the chance to win that follows."""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from .._lib.check import refuse_what
from .._lib.types import Bools, Floats, Ints
from ..game import frame_columns as columns
from ..tasks.threads import Threads, processors
from . import worth as worths
from .planner import RulesLike, options_in
from .positions import Positions
from .pot_geometry import clear_paths
from .proposals import Proposals, at_balls, over_cushions, safeties
from .search import BUDGET, Judge, Plan, Proposed, Search
from .stroke_columns import COLUMNS
from .trials import FrameTrials, turn_to_striker
from .worth import FOUL, LAST, Chance, Worth, lead_of, left_of, pass_after_miss

Foresee: TypeAlias = Callable[[Positions, Ints, Floats, int], Floats]
"""What strokes (m, 5) without a pot in ``at[rows]`` promise under so many errors, without a simulated shot: (m,) [points]."""
SAFETY = 1  # the kind of safeties
FORESEEN, AGAIN, KEPT = 8, 2.5, 0.8
"""Of safeties, for each that is looked at: how many are foreseen without error, and of these how many under several; the
share of the looks that goes to those that promise most, the others come as they are."""
SURE_OF = 4  # errors under which these are foreseen
HIDES = 0.3  # how likely the other is to foul in a snooker that the striker needs
EASY = 0.9  # chance of the likeliest pot by its width from which a decision is easy
TIE = 2e-4  # what a point counts beside the chance to win: a frame that is won or lost is still played well
PLANS = Plan((44, 0, 0, 0), ((7, 2), (3, 7))), Plan((24, 40, 16, 24), ((20, 4), (7, 8)))
"""Looks at pots, safeties, contacts and escapes where the decision is easy, and where it is hard; ``BUDGET`` on average."""


def scale(plan: Plan, share: float) -> Plan:
    """The same plan with about ``share`` times as many shots."""
    root = share**0.5
    looks = tuple(max(4, round(many * share)) if many else 0 for many in plan.looks)
    rounds = ((max(2, round(many * root)), max(1, round(each * root))) for many, each in plan.rounds)
    return Plan(looks, tuple(rounds))


class FrameJudge(Judge):
    """Judges strokes by the positions of a frame that they leave.

    Parameters
    ----------
    env_or_options
        Where strokes are played, see ``Planner``, including the rules of frames.
    worth : callable
        Function of n ``Positions``: the points that each striker will score in the rest of the frame less those of the
        opponent, float (n,).
    chance : Chance, optional
        The law of the chance to win of an expected lead, see ``planning.worth``. None: points alone count.
    foresee : callable, optional
        Function that judges safeties without simulating a shot, so that many more are considered. None: as proposed.

    Examples
    --------
    >>> from snooker_env.planning import FrameJudge, prospects_of
    >>> from snooker_env.tasks import Noise
    >>> FrameJudge({"task": "frame"}, worth=lambda at: prospects_of(at, Noise().spread())[0]).least
    30
    """

    least = 30

    def __init__(
        self,
        env_or_options: RulesLike,
        worth: Worth,
        chance: Chance | None = None,
        *,
        foresee: Foresee | None = None,
    ):
        super().__init__(options_in(env_or_options).rules)
        self._trials = FrameTrials(self.rules, Threads(min(1024, processors())))
        self.worth: Worth = worth
        self.chance: Chance | None = chance
        self.foresee: Foresee | None = foresee

    def plans(self, search: Search, at: Positions, seeds: Ints) -> list[tuple[Plan, Ints]]:
        """One where a likely pot makes the decision easy, one elsewhere."""
        if not at.of_frames:
            raise refuse_what("positions", "those of visits", "must be of frames, or judged by a VisitJudge")
        if len(search.propose) != 1:
            many = f"{len(search.propose)} generators"
            raise refuse_what("propose", many, "must be one: of strokes at pots")
        easy, hard = (scale(plan, search.budget / BUDGET) for plan in PLANS)
        if self.noise.silent:
            easy, hard = easy._replace(rounds=()), hard._replace(rounds=())
        if not len(at):
            return []
        (propose,) = search.propose
        pots = propose(search, at.as_visits(), hard.looks[0], seeds)
        # a striker who would need snookers at the next visit must see more than pots
        likely = (pots.chances.max(axis=1) >= EASY) & (lead_of(at) + left_of(pass_after_miss(at)) >= 0.0)
        return [(easy, np.flatnonzero(likely)), (hard, np.flatnonzero(~likely))]

    def propose(self, search: Search, at: Positions, seeds: Ints, plan: Plan) -> Proposed:
        """So many of each kind as the plan says."""
        made, visits = [], at.as_visits()
        generators = (*search.propose, safeties, at_balls, over_cushions)
        for kind, (generate, many) in enumerate(zip(generators, plan.looks, strict=True)):
            if not many:
                continue
            more = FORESEEN if kind == SAFETY and self.foresee is not None else 1
            strokes, chances = generate(search, visits, more * many, seeds)
            if kind == SAFETY and self.foresee is not None:
                strokes, chances = self._promising(self.foresee, at, Proposals(strokes, chances), many)
            made.append((strokes, chances, np.full(chances.shape, kind)))
        strokes, chances, kinds = (np.concatenate(part, axis=1) for part in zip(*made, strict=True))
        return Proposed(strokes, chances, kinds, np.full(len(at), plan.looks[1] > 0))

    def _promising(self, foresee: Foresee, at: Positions, made: Proposals, many: int) -> Proposals:
        """The ``many`` of proposals for n positions that promise most without a simulated shot."""
        seems = np.where(made.chances > 0.0, 0.0, -np.inf)
        for samples, keep in ((1, round(many * AGAIN)), (SURE_OF, round(many * KEPT))):
            rows, picks = np.nonzero(np.isfinite(seems))
            seems[rows, picks] = foresee(at, rows, made.strokes[rows, picks], samples)
            seems[np.argsort(np.argsort(-seems, axis=1, kind="stable"), axis=1) >= keep] = -np.inf
        # some as they come: what is foreseen errs alike for many
        rest = (made.chances > 0.0) & ~np.isfinite(seems)
        seems = np.where(rest, -1e9 - np.arange(seems.shape[1]), seems)
        best = np.argsort(-seems, axis=1, kind="stable")[:, :many]
        strokes = np.take_along_axis(made.strokes, best[..., None], 1)
        return Proposals(strokes, np.take_along_axis(made.chances, best, 1))

    def look(self, at: Positions, proposed: Proposed, rows: Ints, picks: Ints) -> tuple[Floats, Bools]:
        """With the chance of each pot; what fouls as intended goes on where it wins the frame, or nothing else was found."""
        level = np.zeros((len(rows), COLUMNS))
        after, before = self.outcomes(at, rows, proposed.strokes[rows, picks], level), lead_of(at)
        foul = after.game[:, columns.SCORE_1] > at.game[rows, columns.SCORE_1]
        foul &= (after.game[:, columns.OVER] == 0) | (after.game[:, columns.WINNER] != 0)
        fair = np.zeros(len(at), np.bool_)
        fair[rows[~foul]] = True
        keep = ~(foul & fair[rows])
        values = np.zeros((len(rows), 7))
        rows, picks = rows[keep], picks[keep]
        parts = self._parts(at, rows, after[np.flatnonzero(keep)])
        if not self.noise.silent:  # a pot that is missed leaves the balls about as they lie
            left = pass_after_miss(at)
            points = -self.worth(left).astype(np.float64)
            missed = np.column_stack([1.0 - self.chances(-before, -points, left), points])[rows]
            made = proposed.chances[rows, picks, None]
            parts[:, :2] = made * parts[:, :2] + (1.0 - made) * missed
        values[keep] = parts
        return values, keep

    def sample(self, at: Positions, proposed: Proposed, rows: Ints, picks: Ints, errors: Floats) -> Floats:
        """The ``_parts`` of each."""
        return self._parts(at, rows, self.outcomes(at, rows, proposed.strokes[rows, picks], errors))

    def score(self, values: Floats) -> Floats:
        """Of (n, m, 7), see ``_parts``: the chance to win, and hardly the points."""
        return self._one(self._play_again(values))

    def figures(self, values: Floats) -> tuple[Floats, Floats]:
        """Chances to win, without a law the points; and the points."""
        both = self._play_again(values)
        return both[..., 1 if self.chance is None else 0], both[..., 1]

    def outcomes(self, at: Positions, rows: Ints, strokes: Floats, errors: Floats) -> Positions:
        """Play strokes (m, 5) on ``at[rows]`` under errors (m, 5), see ``FrameTrials.play``."""
        return self._trials.play(at, rows, strokes, errors)

    def gains(self, at: Positions, rows: Ints, strokes: Floats, errors: Floats) -> Floats:
        """What strokes (m, 5) on ``at[rows]`` under errors (m, 5) are worth to their strikers: (m, 2), chance and points."""
        return self.value_of(lead_of(at)[rows], self.outcomes(at, rows, strokes, errors))

    def value_of(self, before: Floats, after: Positions) -> Floats:
        """What strokes played at the leads ``before`` (m,) that left ``after`` are worth to their strikers, as ``gains``."""
        points = worths.follows(self.worth, after, before, self.rules.rule_set.code)
        rest = before + points - lead_of(after)
        chance = self.chances(lead_of(after), rest, after)
        if self.chance is not None:
            game, lead = after.game, lead_of(after)  # where the other comes to a stroke without a foul
            theirs = (game[:, columns.STRIKER] == 1) & (game[:, columns.PHASE] == columns.STROKE)
            theirs &= (
                (game[:, columns.OVER] == 0) & (game[:, columns.RESPOTTED_BLACK] == 0) & (lead >= before)
            )
            rows = np.flatnonzero(theirs & (lead < -left_of(after)))
            rows = rows[~clear_paths(turn_to_striker(after[rows]))]
            fouled = self.chances(lead[rows] + FOUL, rest[rows], after[rows])
            chance[rows] += HIDES * np.maximum(0.0, fouled - chance[rows])  # a snooker that the striker needs
        over, won = after.game[:, columns.OVER] != 0, after.game[:, columns.WINNER] == 0
        return np.column_stack([np.where(over, won, chance), points])

    def chances(self, now: Floats, worth: Floats, at: Positions) -> Floats:
        """The chances to win (m,) of who leads by ``now`` and expects ``worth`` more from ``at``; without a law 0."""
        if self.chance is None:
            return np.zeros(len(now))
        left, clock = left_of(at), self.rules.rule_set.clock
        if not clock:
            return self.chance(now, worth, left, worths.last_of(at), self.spread.core)
        # a stroke is played while there is time for one more, and takes at least the time to play it
        strokes = np.maximum(1, -((at.game[:, columns.CLOCK] - clock) // self.rules.time_to_play) - 1)
        each = np.maximum(LAST, at.on_table[:, 1:16].sum(axis=1))  # several reds at once
        left = np.minimum(left, each * strokes)
        worth = np.clip(worth, -left, left)
        chances = self.chance(now, worth, left, worths.last_of(at), self.spread.core)
        ends = worths.in_one_stroke(now, worth, each, at.game[:, columns.STRIKER] == 0)
        return np.where((strokes == 1) & (at.game[:, columns.RESPOTTED_BLACK] == 0), ends, chances)

    def _one(self, both: Floats) -> Floats:
        """What strokes are compared by, of chances and points (..., 2)."""
        return both[..., 1] if self.chance is None else both[..., 0] + TIE * both[..., 1]

    def _parts(self, at: Positions, rows: Ints, after: Positions) -> Floats:
        """What strokes that left ``after`` are worth, (k, 7): chance and points where no miss was called; whether one was, and
        then chance and points if it is not played again, and what they lose by the penalty."""
        before, parts = lead_of(at)[rows], np.zeros((len(rows), 7))
        both, called = self.value_of(before, after), after.game[:, columns.MISS_CALLED] != 0
        parts[~called, :2], parts[called, 3:5], parts[:, 2] = both[~called], both[called], called
        some = np.flatnonzero(called)
        if len(some):
            same = at[rows[some]]
            worth, now = self.worth(same).astype(np.float64), lead_of(after)[some]
            parts[some, 5] = self.chances(now, worth, same) - self.chances(before[some], worth, same)
            parts[some, 6] = now - before[some]
        return parts

    def _play_again(self, parts: Floats) -> Floats:
        """Chances and points (n, m, 2) of ``_parts`` (n, m, 7): a called miss may be played again, so that it is worth no more
        than the best of the m strokes, less its penalty."""
        fair, called, left, less = parts[..., :2], parts[..., 2:3], parts[..., 3:5], parts[..., 5:]
        out, again = fair + left, fair + less
        alone = np.where(called < 1.0, again / np.where(called < 1.0, 1.0 - called, 1.0), -np.inf)

        def lower(one: Floats, other: Floats) -> Floats:
            return np.where((self._one(one) <= self._one(other))[..., None], one, other)

        worth = lower(out, alone)
        best = np.take_along_axis(worth, self._one(worth).argmax(axis=1)[:, None, None], 1)
        best = np.where(np.isfinite(best), best, 1e9)  # nothing but called misses: they are not bounded
        return lower(out, again + called * best)
