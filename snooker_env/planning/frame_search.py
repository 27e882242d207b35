"""Which stroke of a frame is best? The search of ``stroke_search`` for both players: pots, safeties and escapes are
judged alike, by the points they bring and the worth of what they leave to who plays next (``worth``).

The budget goes where the decision is hard. Where a pot is likely (``EASY``), few pots are looked at; elsewhere more
pots, several times as many safeties, and escapes where hardly anything is seen. Good safeties are rare: most are only
looked at, once and without error; the best of each kind then meet noise samples (sequential halving)."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from .._check import integer
from .._types import Environment, Floats, Integers, Ints
from ..game import frame_columns as columns
from ..tasks.noise import Noise, NoiseLike
from ..tasks.options import Options
from ..tasks.threads import Threads, processors
from .frame_trials import FrameTrials
from .planner import options_in
from .positions import Positions, PositionsLike, check_played, seeds_of
from .proposals import Proposals, at_balls, over_cushions, safeties
from .prospects import spread_of
from .stroke_search import Propose, halved, in_turn
from .strokes import COLUMNS, Dynamics
from .worth import LAST, Chance, Worth, follows, in_one_stroke, last_of, lead_of, left_of, passed

EASY = 0.9  # chance of the likeliest pot by its width from which a decision is easy
TIE = 2e-4
"""What a point counts beside the chance to win, so that a frame that is won or lost is still played well."""
LEAST = 30  # budget of a decision
AVERAGE = 120  # average shots of a decision in frames with the numbers of ``Plan`` below


class Plan(NamedTuple):
    """Looks at strokes of each kind, and (strokes, further samples) of each round."""

    pots: int
    safeties: int
    contacts: int
    escapes: int
    rounds: tuple[tuple[int, int], ...]

    def scaled(self, share: float) -> "Plan":
        """The same with about ``share`` times as many shots."""
        looks, root = [max(4, round(many * share)) if many else 0 for many in self[:4]], share**0.5
        return Plan(
            *(looks[0], looks[1], looks[2], looks[3]),
            tuple((max(2, round(many * root)), max(1, round(each * root))) for many, each in self.rounds),
        )


PLANS = Plan(34, 0, 0, 0, ((6, 2), (3, 6))), Plan(24, 116, 20, 24, ((18, 3), (6, 7)))
"""Where the decision is easy, and where it is hard."""


class Tried(NamedTuple):
    """The strokes that ``FrameSearch.rank`` tried in one position: most samples first, then best first.

    ``strokes`` (m, 5) in SI; ``chances`` (m,), the chance to win, without a law for it 0; ``points`` (m,), expected
    points of the striker less the other's from here on; ``samples`` (m,), noise samples that each met; ``kinds``
    (m,): 0 a pot, 1 a safety, 2 a contact, 3 an escape. What is best is told by the chance, and hardly by the points."""

    strokes: Floats
    chances: Floats
    points: Floats
    samples: Ints
    kinds: Ints


class FrameSearch:
    """Searches for the best stroke of a frame: as ``StrokeSearch``, with the ``worth`` of positions in place of a value, and
    the ``chance`` to win of an expected lead (None: points alone count). ``budget``: shots of a decision on average."""

    def __init__(
        self,
        env_or_options: Environment | Options | dict[str, Any],
        worth: Worth,
        propose: Propose,
        budget: int = AVERAGE,
        *,
        chance: Chance | None = None,
        noise: NoiseLike | None = None,
        threads: int | None = None,
    ):
        options = options_in(env_or_options)
        self.budget: int = integer("budget", budget, LEAST, 10**7)
        rules = options.rules
        self.noise: Noise = rules.noise if noise is None else Noise.of(noise)
        self.rules = rules
        usual = min(1024, processors())
        self.threads: int = usual if threads is None else integer("threads", threads, 1, 1024)
        self._trials = FrameTrials(replace(rules, noise=self.noise), Threads(self.threads))
        self.spread: float = spread_of(self.noise, rules.physics)
        self.dynamics: Dynamics = Dynamics.of(replace(rules, noise=self.noise))
        self.worth: Worth = worth
        self.propose: Propose = propose
        self.chance: Chance | None = chance
        self.plans: tuple[Plan, ...] = tuple(plan.scaled(budget / AVERAGE) for plan in PLANS)
        self.shots: int = 0

    def rank(self, positions: PositionsLike, seeds: Integers) -> list[Tried]:
        """Try strokes in n positions of frames whose strikers have a stroke to play, and a decision after a foul
        behind them. A cue ball in hand is played from where it lies."""
        at = Positions.of(positions).known_to(self.rules)
        n, keys = len(at), seeds_of(seeds, len(at))
        check_played(at.as_visits(), np.arange(n), self.rules.table, self.rules.physics.R)
        tried: list[Tried] = [None] * n  # type: ignore[list-item]
        if not n:
            return tried
        easy, hard = self.plans
        asking: Any = self
        pots = self.propose(asking, at.as_visits(), hard.pots, keys)
        # who would need snookers at the next visit must see more than pots
        likely = (pots.chances.max(axis=1) >= EASY) & (lead_of(at) + left_of(passed(at)) >= 0.0)
        for plan, which in ((easy, np.flatnonzero(likely)), (hard, np.flatnonzero(~likely))):
            if len(which):
                for k, one in zip(which.tolist(), self._rank(at[which], keys[which], plan), strict=True):
                    tried[k] = one
        return tried

    def outcomes(self, at: Positions, rows: Ints, strokes: Floats, errors: Floats) -> Positions:
        """Play strokes (m, 5) on ``at[rows]`` under errors (m, 5), see ``FrameTrials.play``."""
        self.shots += len(rows)
        return self._trials.play(at, rows, strokes, errors)

    def gains(self, at: Positions, rows: Ints, strokes: Floats, errors: Floats) -> Floats:
        """What strokes (m, 5) on ``at[rows]`` under errors (m, 5) are worth to their strikers: (m, 2), the chance to
        win and the points."""
        return self.valued(lead_of(at)[rows], self.outcomes(at, rows, strokes, errors))

    def valued(self, before: Floats, after: Positions) -> Floats:
        """What strokes that were played at the leads ``before`` (m,) and left ``after`` are worth to their strikers:
        (m, 2), as ``gains``."""
        points = follows(self.worth, after, before, self.rules.rule_set.code)
        chance = self.chances(lead_of(after), before + points - lead_of(after), after)
        over, won = after.game[:, columns.OVER] != 0, after.game[:, columns.WINNER] == 0
        return np.column_stack([np.where(over, won, chance), points])

    def chances(self, now: Floats, worth: Floats, at: Positions) -> Floats:
        """The chances to win, (m,), of who leads by ``now`` and expects ``worth`` more than the other from the balls of
        ``at``; without a law 0."""
        if self.chance is None:
            return np.zeros(len(now))
        left, clock = left_of(at), self.rules.rule_set.clock
        if not clock:
            return self.chance(now, worth, left, last_of(at), self.spread)
        # a stroke is played while there is time for one more, and takes at least the time to play it
        strokes = np.maximum(1, -((at.game[:, columns.CLOCK] - clock) // self.rules.time_to_play) - 1)
        each = np.maximum(LAST, at.on_table[:, 1:16].sum(axis=1))  # several reds at once
        left = np.minimum(left, each * strokes)
        worth = np.clip(worth, -left, left)
        chances = self.chance(now, worth, left, last_of(at), self.spread)
        ends = in_one_stroke(now, worth, each, at.game[:, columns.STRIKER] == 0)
        return np.where((strokes == 1) & (at.game[:, columns.RESPOTTED_BLACK] == 0), ends, chances)

    def _one(self, both: Floats) -> Floats:
        """What strokes are compared by, of chances and points (..., 2)."""
        return both[..., 1] if self.chance is None else both[..., 0] + TIE * both[..., 1]

    def _score(self, parts: Floats) -> Floats:
        """What the strokes of each position are compared by, of (n, m, 7), see ``_parts``."""
        return self._one(self._replayed(parts))

    def _parts(self, at: Positions, rows: Ints, after: Positions) -> Floats:
        """What strokes on ``at[rows]`` that left ``after`` are worth, (k, 7): chance and points where no miss was called;
        whether one was, and then chance and points if it is not played again, and what they lose by the penalty."""
        before, parts = lead_of(at)[rows], np.zeros((len(rows), 7))
        both, called = self.valued(before, after), after.game[:, columns.MISS_CALLED] != 0
        parts[~called, :2], parts[called, 3:5], parts[:, 2] = both[~called], both[called], called
        some = np.flatnonzero(called)
        if len(some):
            same = at[rows[some]]
            worth, now = self.worth(same).astype(np.float64), lead_of(after)[some]
            parts[some, 5] = self.chances(now, worth, same) - self.chances(before[some], worth, same)
            parts[some, 6] = now - before[some]
        return parts

    def _replayed(self, parts: Floats) -> Floats:
        """Chances and points (n, m, 2) of strokes with these ``_parts`` (n, m, 7) on average: a called miss may be played
        again, so that it is worth no more than the best of the m strokes, less its penalty."""
        fair, called, left, less = parts[..., :2], parts[..., 2:3], parts[..., 3:5], parts[..., 5:]
        out, again = fair + left, fair + less
        alone = np.where(called < 1.0, again / np.where(called < 1.0, 1.0 - called, 1.0), -np.inf)
        lower = lambda one, other: np.where((self._one(one) <= self._one(other))[..., None], one, other)  # noqa: E731
        worth = lower(out, alone)
        best = np.take_along_axis(worth, self._one(worth).argmax(axis=1)[:, None, None], 1)
        best = np.where(np.isfinite(best), best, 1e9)  # nothing but called misses: they are not bounded
        return lower(out, again + called * best)

    def _proposed(self, at: Positions, seeds: Ints, plan: Plan) -> tuple[Floats, Floats, Ints]:
        """Strokes (n, m, 5), chances and kinds (n, m)."""
        asking: Any = self
        visits, made = at.as_visits(), []
        kinds: Sequence[tuple[Propose, int]] = (
            (self.propose, plan.pots),
            (safeties, plan.safeties),
            (at_balls, plan.contacts),
            (over_cushions, plan.escapes),
        )
        for kind, (generate, many) in enumerate(kinds):
            if many:
                made.append((*Proposals(*generate(asking, visits, many, seeds)), kind))
        strokes = np.concatenate([one[0] for one in made], axis=1)
        chances = np.concatenate([one[1] for one in made], axis=1)
        which = np.concatenate([np.full(one[1].shape, one[2]) for one in made], axis=1)
        return strokes, chances, which

    def _rank(self, at: Positions, seeds: Ints, plan: Plan) -> list[Tried]:
        n, every = len(at), np.arange(len(at))[:, None]
        strokes, chances, kinds = self._proposed(at, seeds, plan)
        some, m = chances > 0.0, chances.shape[1]
        rounds = () if self.noise.silent else plan.rounds
        j, c = np.nonzero(some)
        after, before = self.outcomes(at, j, strokes[j, c], np.zeros((len(j), COLUMNS))), lead_of(at)
        # what fouls as intended is played where it wins the frame, or where nothing else was found
        foul = after.game[:, columns.SCORE_1] > at.game[j, columns.SCORE_1]
        foul &= (after.game[:, columns.OVER] == 0) | (after.game[:, columns.WINNER] != 0)
        fair = np.zeros(n, np.bool_)
        fair[j[~foul]] = True
        some[j, c] = keep = ~(foul & fair[j])
        j, c, after = j[keep], c[keep], after[np.flatnonzero(keep)]
        parts = self._parts(at, j, after)
        if rounds:  # a pot that is missed leaves the balls about as they lie
            left = passed(at)
            points = -self.worth(left).astype(np.float64)
            missed = np.column_stack([1.0 - self.chances(-before, -points, left), points])[j]
            made = chances[j, c, None]
            parts[:, :2] = made * parts[:, :2] + (1.0 - made) * missed
        looks = np.zeros((n, m, parts.shape[1]))
        looks[..., :2] = -np.inf
        looks[j, c] = parts
        order = np.argsort(-self._score(looks), axis=1, kind="stable")
        if plan.safeties:  # a look without error flatters: the best of each kind are sampled
            order = in_turn(order, kinds)
            order = np.take_along_axis(order, np.argsort(~some[every, order], axis=1, kind="stable"), 1)

        def met(rows: Ints, picks: Ints, errors: Floats) -> Floats:
            return self._parts(at, rows, self.outcomes(at, rows, strokes[rows, picks], errors))

        order, values, tries = halved(looks, order, rounds, seeds, met, self._score)
        both = self._replayed(values)
        tried: Any = [part[every, order] for part in (strokes, both[..., 0], both[..., 1], tries, kinds)]
        counts = some.sum(axis=1).tolist()
        return [Tried(*(part[k, :count] for part in tried)) for k, count in enumerate(counts)]
