"""What is a stroke worth? In a visit its points, and the value of what it leaves; in a frame pots, safeties and escapes are
judged alike, by points, by the worth of what they leave to the next player (``worth``), and by the chance to win that follows."""

from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np

from .._lib.check import refuse_what
from .._lib.types import Bools, Floats, Ints, Singles
from ..game import frame_columns as columns
from ..game.balls import CUE, SPOTS, BallOn
from ..tasks.noise import Noise, Spread
from ..tasks.options import Rules
from ..tasks.pot_chance import RULE_OF_THUMB, SURE
from ..tasks.threads import Threads, processors
from . import worth as worths
from .aims import Dynamics
from .planner import Planner, RulesLike, options_in
from .positions import Positions
from .pot_geometry import clear_paths, prospects_of
from .proposals import Proposals, Propose, at_balls, over_cushions, safeties
from .stroke_columns import COLUMNS
from .trials import FrameTrials, turn_to_striker
from .worth import LAST, Chance, Worth, lead_of, left_of, pass_after_miss


class Plan(NamedTuple):
    """How a budget is spent: ``looks`` at strokes of each kind, and (strokes, further samples) of each round."""

    looks: tuple[int, ...]
    rounds: tuple[tuple[int, int], ...]


BUDGET = 120  # simulated shots of a decision, by default
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
Value: TypeAlias = Callable[[Positions], Floats | Singles]  # what strokes have left is worth [points]
Generators: TypeAlias = tuple[Propose, ...]
WITHOUT_POTS: Generators = (at_balls, over_cushions)  # for positions without a likely pot
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


def schedule(budget: int) -> Plan:
    """Number of looks, and (strokes, further samples) of each round; together at most ``budget`` shots."""
    for least, looks, rounds in reversed(SCHEDULES):
        if budget >= least:
            grown = tuple((many, each * budget // least) for many, each in rounds)
            return Plan((looks * budget // least,), grown)
    return Plan((budget,), ())


class Proposed(NamedTuple):
    """``Proposals`` for n positions, the kind of each stroke (n, m), and whether a position has some without a pot (n,)."""

    strokes: Floats
    chances: Floats
    kinds: Ints
    safe: Bools


class _Judge:
    """What a search asks of a game: how to spend the budget and where (``plans``), which strokes to try (``propose``), what k of
    them are worth without error, (k, v), and which to go on with (``look``), and under errors in standard deviations (``sample``)."""

    def __init__(self, rules: Rules):
        self.rules: Rules = rules
        self.noise: Noise = rules.noise
        self.spread: Spread = rules.noise.spread(rules.physics)
        self.dynamics: Dynamics = Dynamics.of(rules)

    def groups(self, kinds: Ints, looks: Floats) -> Ints:
        """Of which groups of strokes the best are sampled, (n, m), by their kinds and looks (n, m, v)."""
        return kinds

    def score(self, values: Floats) -> Floats:
        """What such values of n positions, (n, m, v), are compared by: (n, m)."""
        return values[..., 0]

    def figures(self, values: Floats) -> tuple[Floats, Floats]:
        """The scores and the points (n, m) of a ranking."""
        return values[..., 0], values[..., 0]


class VisitJudge(_Judge):
    """Judges strokes by the points of a visit.

    Parameters
    ----------
    env_or_options, threads
        As for ``Planner``. With the reward "legal" strokes of all kinds are tried; their score is the share that is no foul.
    value, pots_only : callable, bool, optional
        Values [points] of n ``Positions``: (n,), by default ``prospects_of``; whether only the chance of the pot counts, and
        without a pot the chance of a foul against a stroke.

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

    def plans(self, budget: int, propose: Generators, at: Positions, seeds: Ints) -> list[tuple[Plan, Ints]]:
        """One for all positions; without execution errors the first look takes the whole budget."""
        plan = Plan((budget,), ()) if self.noise.silent else schedule(budget)
        return [(plan, np.arange(len(at)))]

    def propose(self, generators: Generators, at: Positions, seeds: Ints, plan: Plan) -> Proposed:
        """Pots; where there are none, or a stroke need only be fair, strokes at balls and over cushions, too."""
        (m,), at = plan.looks, at.as_visits()
        strokes, chances, kinds = self._share(generators, at, m, seeds)
        doubt = chances.max(axis=1) <= (1.0 if self.legal else 0.0)
        if doubt.any():
            strokes, chances, kinds = strokes.copy(), chances.copy(), kinds.copy()
            every = *generators, *WITHOUT_POTS
            shared = self._share(every, at[doubt], m, seeds[doubt])
            strokes[doubt], chances[doubt], kinds[doubt] = shared
        return Proposed(strokes, chances, kinds, doubt | kinds.any(axis=1))

    def _share(self, some: Generators, at: Positions, m: int, seeds: Ints) -> tuple[Floats, Floats, Ints]:
        """Strokes of the generators that have any, in turn; chances; which generator each is of."""
        made = [Proposals(*generate(self, at, m, seeds)) for generate in some]
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
    lowest = 2 + theirs.on_table[:, 16:].argmax(axis=1)
    theirs.game[:, columns.BALL_ON] = np.where(reds, int(BallOn.RED), lowest)
    theirs.game[:, [columns.IN_HAND, columns.POINTS, columns.OVER]] = 0
    theirs.positions[~theirs.on_table[:, CUE], CUE] = SPOTS[CUE]
    theirs.on_table[:, CUE] = True
    return theirs


def scale(plan: Plan, share: float) -> Plan:
    """The same plan with about ``share`` times as many shots."""
    root = share**0.5
    looks = tuple(max(4, round(many * share)) if many else 0 for many in plan.looks)
    rounds = ((max(2, round(many * root)), max(1, round(each * root))) for many, each in plan.rounds)
    return Plan(looks, tuple(rounds))


class FrameJudge(_Judge):
    """Judges strokes by the positions of a frame that they leave.

    Parameters
    ----------
    env_or_options, worth
        As for ``Planner``, with the rules of frames; function of n ``Positions``: the points that each striker will score in
        the rest of the frame less those of the opponent, float (n,).
    chance, foresee : Chance, callable, optional
        The law of the chance to win of an expected lead, see ``planning.worth``, None: points alone count; function that
        judges safeties without simulating a shot, so that many more are considered.

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

    def plans(self, budget: int, propose: Generators, at: Positions, seeds: Ints) -> list[tuple[Plan, Ints]]:
        """One where a likely pot makes the decision easy, one elsewhere."""
        if not at.of_frames:
            raise refuse_what("positions", "those of visits", "must be of frames, or judged by a VisitJudge")
        if len(propose) != 1:
            many = f"{len(propose)} generators"
            raise refuse_what("propose", many, "must be one: of strokes at pots")
        easy, hard = (scale(plan, budget / BUDGET) for plan in PLANS)
        if self.noise.silent:
            easy, hard = easy._replace(rounds=()), hard._replace(rounds=())
        if not len(at):
            return []
        pots = propose[0](self, at.as_visits(), hard.looks[0], seeds)
        # a striker who would need snookers at the next visit must see more than pots
        likely = (pots.chances.max(axis=1) >= EASY) & (lead_of(at) + left_of(pass_after_miss(at)) >= 0.0)
        return [(easy, np.flatnonzero(likely)), (hard, np.flatnonzero(~likely))]

    def propose(self, generators: Generators, at: Positions, seeds: Ints, plan: Plan) -> Proposed:
        """So many of each kind as the plan says."""
        made, visits = [], at.as_visits()
        every = *generators, safeties, at_balls, over_cushions
        for kind, (generate, many) in enumerate(zip(every, plan.looks, strict=True)):
            if not many:
                continue
            more = FORESEEN if kind == SAFETY and self.foresee is not None else 1
            strokes, chances = generate(self, visits, more * many, seeds)
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
            theirs &= (game[:, columns.OVER] == 0) & (game[:, columns.RESPOTTED_BLACK] == 0)
            theirs &= lead >= before
            rows = np.flatnonzero(theirs & (lead < -left_of(after)))
            rows = rows[~clear_paths(turn_to_striker(after[rows]))]
            fouled = self.chances(lead[rows] + worths.FOUL, rest[rows], after[rows])
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


Judge: TypeAlias = VisitJudge | FrameJudge
