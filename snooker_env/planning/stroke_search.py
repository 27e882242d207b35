"""Which stroke is best? A search over continuous strokes, one shot deep, with a value of what each leaves.

1. Generators propose strokes (``proposals``), and each is played once without error. Its score is the chance
   of its pot by the pot's width, times its points plus the value of the afterstate. Where strokes without a
   pot are proposed, the penalty of a foul is deducted, and if the visit ends, the share ``LEFT`` of the value
   of the position for the opponent.
2. The best meet noise samples, the better ones more of them (sequential halving, Karnin, Koren & Somekh
   2013): scrambled Sobol points, common to all strokes of a position. The score is the mean over the samples,
   with the first look as ``PRIOR`` of them. Without execution errors the first look takes the whole budget."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .._check import integer, number
from .._types import Bools, Environment, Floats, Integers, Ints
from ..game.balls import CUE, SPOTS, BallOn
from ..game.frame_columns import BALL_ON, IN_HAND, OVER, POINTS
from ..tasks.noise import Noise, NoiseLike
from ..tasks.options import Options
from ..tasks.tables import I_PENALTY, I_POINTS
from .planner import Outcomes, Planner, options_in
from .positions import Positions, PositionsLike, check_played, seeds_of
from .proposals import Proposals, at_balls, at_pots, over_cushions
from .prospects import RULE_OF_THUMB, SURE, prospects_of, spread_of
from .sobol import DIMENSIONS, normal_points
from .strokes import AIM, COLUMNS, SIDE, SPEED, TOP, Dynamics, actions_of

PRIOR = 1.0  # number of samples that the look without error counts as
FEWEST = 8  # least budget of a decision
SCHEDULES = (
    (30, 16, ((4, 2), (2, 3))),
    (60, 32, ((6, 2), (3, 5))),
    (120, 60, ((10, 3), (4, 7))),
    (500, 220, ((20, 4), (8, 12), (4, 25))),
    (2000, 800, ((40, 8), (16, 25), (5, 95))),
)
"""Budget, number of looks, and for each round the number of strokes and their further samples."""
LEFT = 0.5  # share of a position's value for the opponent that counts
FOUL = 20.0
"""What a foul costs beside its penalty [points]: the opponent may have the balls replaced or a free ball."""
Value: TypeAlias = Callable[[Positions], NDArray[np.floating[Any]]]
"""Values [points] of n positions that strokes have left: (n,)."""
Propose: TypeAlias = Callable[["StrokeSearch", Positions, int, Ints], Proposals]
"""A generator: proposals of m strokes for each position, of the search, the n positions, m and seeds (n,)."""
WITHOUT_POTS: tuple[Propose, ...] = (at_balls, over_cushions)
"""The generators for positions in which those of the search have no likely pot."""


class Ranked(NamedTuple):
    """The strokes that ``StrokeSearch.rank`` tried in n positions: most samples first, then best first.

    A stroke that was left behind in an earlier round may keep a higher score: fewer samples flatter it.

    Attributes
    ----------
    strokes, scores : numpy.ndarray
        float64 (n, m, 5), strokes in SI, see ``Planner``; float64 (n, m), expected points of the stroke and
        of what follows.
    samples : numpy.ndarray
        int64 (n, m). Noise samples that each stroke met; 0 if it had only the look without error.

    Examples
    --------
    >>> from snooker_env.planning import Position, StrokeSearch
    >>> position = Position(cue=(0.0, 0.9), black=(0.4, 1.3))
    >>> StrokeSearch({"noise": "club"}, budget=30).rank(position, [7]).samples[0, :5].tolist()
    [5, 5, 2, 2, 0]
    """

    strokes: Floats
    scores: Floats
    samples: Ints

    def actions(self) -> NDArray[np.float32]:
        """Convert the strokes to actions of ``aim="absolute"``: float32 (n, m, 4)."""
        flat = self.strokes.reshape(-1, COLUMNS)
        made = actions_of(flat[:, SPEED], flat[:, AIM], flat[:, SIDE], flat[:, TOP])
        return made.reshape(*self.scores.shape, 4)


def schedule(budget: int) -> tuple[int, tuple[tuple[int, int], ...]]:
    """Number of looks, and (strokes, further samples) of each round; together at most ``budget`` shots."""
    for least, looks, rounds in reversed(SCHEDULES):
        if budget >= least:
            grown = tuple((many, each * budget // least) for many, each in rounds)
            return looks * budget // least, grown
    return budget, ()


class StrokeSearch:
    """Searches for the best stroke with a number of simulated shots.

    Parameters
    ----------
    env_or_options : Env, VectorEnv, AECEnv, Options or dict
        Where strokes are played, see ``Planner``: physics, table, fidelity and execution noise count. With the
        reward "legal" strokes of all kinds are tried, and the share of them that is no foul is their score.
    budget : int, optional
        Largest number of simulated shots for a decision, at least 8; default 120.
    value : callable, optional
        Values [points] of n ``Positions``: (n,). Default: the rule of thumb ``prospects_of``.
    propose : callable or sequence of callable, optional
        Generators of strokes, ``propose(search, at, m, seeds)`` -> ``Proposals``; those that have any for a
        position share the looks evenly. The first one proposes pots; where none of these is likelier than
        ``doubtful``, those of ``snooker_env.planning.proposals`` for strokes at balls and over cushions join.
        Default: ``at_pots``.
    doubtful : float, optional
        Largest chance of a pot at which strokes without one are tried as well, in [0, 1]; default 0.
    pots_only : bool, optional
        Score by the chance of the pot alone; without a pot, less that of a foul. Default False.
    noise, threads : optional
        As for ``Planner``.

    Examples
    --------
    >>> from snooker_env.planning import Position, StrokeSearch
    >>> search = StrokeSearch({"noise": "club"}, budget=30)
    >>> search.rank(Position(cue=(0.0, 0.9), black=(0.4, 1.3)), seeds=[7]).strokes.shape, search.shots
    ((1, 16, 5), 30)
    """

    def __init__(
        self,
        env_or_options: Environment | Options | dict[str, Any],
        budget: int = 120,
        *,
        value: Value | None = None,
        propose: Propose | Sequence[Propose] = at_pots,
        doubtful: float = 0.0,
        pots_only: bool = False,
        noise: NoiseLike | None = None,
        threads: int | None = None,
    ):
        self.budget: int = integer("budget", budget, FEWEST, 10**7)
        options = options_in(env_or_options)
        self.planner: Planner = Planner(options, noise=noise, threads=threads)
        rules = self.planner.rules
        self.noise: Noise = rules.noise
        self.spread: float = spread_of(self.noise, rules.physics)
        self.dynamics = Dynamics.of(rules)
        self.value: Value = self._by_rule if value is None else value
        self.propose: Propose | Sequence[Propose] = propose
        self.legal: bool = options.reward == "legal"
        self.doubtful: float = 1.0 if self.legal else number("doubtful", doubtful, 0.0, 1.0)
        self.pots_only = pots_only

    @property
    def shots(self) -> int:
        """Number of strokes simulated so far, an int."""
        return self.planner.shots

    @property
    def strokes_tried(self) -> int:
        """Number of strokes that ``rank`` tries in each position, an int."""
        return self.budget if self.noise.silent else schedule(self.budget)[0]

    def _by_rule(self, at: Positions) -> Floats:
        """Values of positions by the rule of thumb [points]: float64 (n,)."""
        constants = SURE if self.noise.silent else RULE_OF_THUMB
        rails, threads = self.dynamics.rails, self.planner.threads
        return prospects_of(at, self.spread, constants, threads=threads, rails=rails)[0]

    def rank(self, positions: PositionsLike, seeds: Integers) -> Ranked:
        """Try strokes in n positions and return them ``Ranked``: each row's first one is to be played.

        ``seeds``, int (n,): of the proposals and noise samples; equal seeds give equal decisions. A cue ball
        in hand is played from where it lies. ValueError if a position is invalid or has no stroke."""
        at = Positions.of(positions).as_visits().known_to(self.planner.rules)
        n, keys = len(at), seeds_of(seeds, len(at))
        check_played(at, np.arange(n), self.planner.table, self.planner.physics.R)
        looks, rounds = self.strokes_tried, () if self.noise.silent else schedule(self.budget)[1]
        if not n:
            return Ranked(np.zeros((0, looks, COLUMNS)), np.zeros((0, looks)), np.zeros((0, looks), np.int64))
        strokes, chances, which, safe = self._proposed(at, looks, keys)
        every, none = np.arange(n)[:, None], np.zeros((n * looks, DIMENSIONS))
        rows = np.repeat(np.arange(n), looks)
        scores = self._gains(at, safe, rows, strokes.reshape(-1, COLUMNS), none).reshape(n, looks)
        if not self.noise.silent and not self.legal:
            scores *= chances
            doubt = np.flatnonzero(safe & (chances < 1.0).any(axis=1))
            if len(doubt) and not self.pots_only:  # a pot that is missed leaves the balls about as they lie
                scores[doubt] -= (1.0 - chances[doubt]) * LEFT * self.value(for_opponent(at[doubt]))[:, None]
        order = np.argsort(-scores, axis=1, kind="stable")
        # a look flatters pots, and strokes that pot by luck: the best of each kind are sampled
        if safe.any():
            kinds = np.where((which > 0) & (scores > 0.0), -1, which)[safe]
            order[safe] = in_turn(order[safe], kinds)

        def met(rows: Ints, picks: Ints, errors: Floats) -> Floats:
            return self._gains(at, safe, rows, strokes[rows, picks], errors)[:, None]

        order, values, tries = halved(scores[..., None], order, rounds, keys, met, lambda each: each[..., 0])
        return Ranked(strokes[every, order], values[every, order, 0], tries[every, order])

    def outcomes(self, at: Positions, rows: Ints, strokes: Floats, errors: Floats) -> Outcomes:
        """Play strokes (m, 5) on ``at[rows]`` under errors (m, 5) in standard deviations."""
        return self.planner.play(at, rows, strokes=strokes, errors=errors)

    def _proposed(self, at: Positions, m: int, seeds: Ints) -> tuple[Floats, Floats, Ints, Bools]:
        """Strokes (n, m, 5), chances and generators (n, m), and where some are without a pot (n,)."""
        generators = (self.propose,) if callable(self.propose) else tuple(self.propose)
        strokes, chances, which = self._shared(generators, at, m, seeds)
        doubt = chances.max(axis=1) <= self.doubtful
        if doubt.any():
            strokes, chances, which = strokes.copy(), chances.copy(), which.copy()
            shared = self._shared((*generators, *WITHOUT_POTS), at[doubt], m, seeds[doubt])
            strokes[doubt], chances[doubt], which[doubt] = shared
        return strokes, chances, which, doubt | which.any(axis=1)

    def _shared(self, generators: Sequence[Propose], at: Positions, m: int, seeds: Ints):
        """Strokes of the generators that have any, in turn; chances; which generator each is of."""
        made = [Proposals(*generate(self, at, m, seeds)) for generate in generators]
        if len(made) == 1:
            return made[0].strokes, made[0].chances, np.zeros((len(at), m), np.int64)
        has = np.stack([each.chances.any(axis=1) for each in made])
        turn = np.arange(m) % np.maximum(1, has.sum(axis=0))[:, None]
        which = np.minimum((np.cumsum(has, axis=0)[:, :, None] <= turn).sum(axis=0), len(made) - 1)
        every, looks = np.arange(len(at))[:, None], np.arange(m)
        strokes, chances = (np.stack(part)[which, every, looks] for part in zip(*made, strict=True))
        return strokes, chances, which

    def _gains(self, at: Positions, safe: Bools, rows: Ints, strokes: Floats, errors: Floats) -> Floats:
        """What strokes (k, 5) on ``at[rows]`` under errors (k, 5) bring, and what they leave is worth: (k,)."""
        after, out = self.planner._played(at, rows, strokes=strokes, errors=errors)
        gains, penalty, careful = out.reals[:, I_POINTS].copy(), out.counts[:, I_PENALTY], safe[rows]
        if self.legal:
            return (penalty == 0).astype(np.float64)
        if self.pots_only:
            return (gains > 0).astype(np.float64) - (careful & (penalty > 0))
        gains[careful] -= penalty[careful] + FOUL * (penalty[careful] > 0)
        on, left = np.flatnonzero(~after.over), np.flatnonzero(after.over & careful)
        if len(on):
            gains[on] += self.value(after[on])
        if len(left):
            gains[left] -= LEFT * self.value(for_opponent(after[left]))
        return gains


def halved(
    looks: Floats,
    order: Ints,
    rounds: Sequence[tuple[int, int]],
    seeds: Ints,
    met: Callable[[Ints, Ints, Floats], Floats],
    score: Callable[[Floats], Floats],
) -> tuple[Ints, Floats, Ints]:
    """Sequential halving: of the strokes of n positions the best meet noise samples, the better ones more of them.
    ``looks`` (n, m, v): the values of each stroke without error, -inf where there is none; they count as ``PRIOR``
    samples. ``order`` (n, m): the strokes, best first. ``rounds``: how many go on, and their further samples.
    ``met(rows, picks, errors)``: values (k, v) of the strokes ``picks`` of the positions ``rows`` under errors (k, 5).
    ``score``: what values (..., v) are compared by. Returns the order then, means (n, m, v) and samples (n, m)."""
    n, m = looks.shape[:2]
    every, sums = np.arange(n)[:, None], PRIOR * looks
    values, tries = looks.copy(), np.zeros((n, m), np.int64)
    samples = np.stack([normal_points(sum(each for _, each in rounds), k) for k in seeds.tolist()])
    done = 0
    for many, each in rounds:
        best = order[:, :many]
        j, c = np.nonzero(np.isfinite(looks[every, best, 0]))
        c = best[j, c]
        errors = samples[:, done : done + each][j].reshape(-1, DIMENSIONS)
        got = met(np.repeat(j, each), np.repeat(c, each), errors).reshape(len(j), each, -1)
        sums[j, c] += np.ascontiguousarray(got.transpose(0, 2, 1)).sum(axis=2)  # rounded in a fixed order
        tries[j, c] += each
        done += each
        values[j, c] = sums[j, c] / (PRIOR + tries[j, c])[:, None]
        again = np.argsort(-score(values[every, best]), axis=1, kind="stable")
        order = np.concatenate([np.take_along_axis(best, again, 1), order[:, many:]], 1)
    return order, values, tries


def in_turn(order: Ints, kinds: Ints) -> Ints:
    """Rows (n, m) of indices, best first, as the best of each of ``kinds`` (n, m), the second best, ..."""
    sorted_kinds = np.take_along_axis(kinds, order, 1)
    place = np.zeros_like(order)
    for kind in np.unique(kinds):
        same = sorted_kinds == kind
        place[same] = (np.cumsum(same, axis=1) - 1)[same]
    return np.take_along_axis(order, np.argsort(place, axis=1, kind="stable"), 1)


def for_opponent(after: Positions) -> Positions:
    """Positions after a visit as those of the opponent's; a cue ball in hand lies at its usual place."""
    theirs = after.copy()
    reds = theirs.on_table[:, 1:16].any(axis=1)
    theirs.game[:, BALL_ON] = np.where(reds, int(BallOn.RED), 2 + theirs.on_table[:, 16:].argmax(axis=1))
    theirs.game[:, [IN_HAND, POINTS, OVER]] = 0
    theirs.positions[~theirs.on_table[:, CUE], CUE] = SPOTS[CUE]
    theirs.on_table[:, CUE] = True
    return theirs
