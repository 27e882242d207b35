"""How does a player play that scores the discrete choices? The highest score; its aim is solved."""

import numpy as np

from .._lib.check import refuse_what
from .._lib.types import Bools, Floats, Integers, Ints
from ..game.fouls import AUTO
from ..game.frame_columns import VISIT_COLUMNS
from ..planning import Positions, pots
from ..planning.ghost_ball import geometric_strokes
from ..planning.positions import PositionsLike, seeds_of
from ..planning.strokes import action_masks, intentions_of
from ..planning.trials import packed_under
from ..tasks.declarations import SAYS_NOTHING
from ..tasks.discrete_actions import SIDES, SIZE, SPEEDS, STROKES, TOPS, choice_of
from ..tasks.frames import Asked
from ..tasks.kernel_arrays import Packed
from ..tasks.options import Options, Rules
from ..tasks.stroke import ShotBuffers, address
from .player import BoundPlayer, Ranked, Strokes, streams_of

MOST = 100  # most strokes of a ranking


class ChoicePlayer(BoundPlayer):
    """Base class of players that score the choices of ``action="discrete"``. Subclasses implement ``scores``.

    Examples
    --------
    >>> import numpy as np
    >>> import snooker_env as sn
    >>> from snooker_env.players import ChoicePlayer
    >>> class First(ChoicePlayer):
    ...     def scores(self, at, seeds):
    ...         return np.where(sn.planning.action_masks(at), -np.arange(540.0), -np.inf)
    >>> First().at({}).play(sn.Position(cue=(0.0, 0.9), black=(0.4, 1.3)), [0]).speed.tolist()
    [0.9]
    """

    frames = False
    _rules: Rules  # of where it plays, under which its choices are read
    _packed: Packed  # the same for kernels

    def _bind(self, options: Options) -> None:
        names = ("physics", "table", "fidelity", "conditions", "cue")
        same = {name: getattr(options, name) for name in names}
        self._rules = Options(action="discrete", **same).rules
        self._packed = self._rules.pack()

    def scores(self, at: Positions, seeds: Ints) -> Floats:
        """Score all choices in n positions of visits: float (n, 540), -inf for unavailable ones."""
        raise NotImplementedError(f"{type(self).__qualname__} must have scores(at, seeds): float (n, {SIZE})")

    def figures(self, scores: Floats) -> Floats | None:
        """What a ranking shows of one position's scores (m,), highest first: float64 (m,), or None."""
        return scores.astype(np.float64)

    def play(self, positions: PositionsLike, seeds: Integers) -> Strokes:
        """See ``Player.play``."""
        visits, places, decisions, scores = self._score(positions, seeds)
        return Strokes(self._read_choices(visits, scores.argmax(axis=1)), places, decision=decisions)

    def rank(self, positions: PositionsLike, seeds: Integers) -> list[Ranked]:
        """Rank the choices of each position: at most 100 strokes, highest score first."""
        visits, places, decisions, scores = self._score(positions, seeds)
        ranked = []
        for k, row in enumerate(scores):
            choices = np.argsort(-row, kind="stable")[: max(1, min(MOST, int(np.isfinite(row).sum())))]
            values = self._read_choices(visits[np.full(len(choices), k)], choices)
            where, what = np.repeat(places[k : k + 1], len(choices), 0), np.full(len(choices), decisions[k])
            strokes = Strokes(values, where, decision=what)
            ranked.append(Ranked(strokes, self.figures(row[choices])))
        return ranked

    def _read_choices(self, visits: Positions, choices: Ints) -> Floats:
        """The strokes (n, 5) that a choice in each of n visits means; cue balls have been placed."""
        rules, n = self._rules, len(visits)
        own, buffers = visits.known_to(rules).conditions, ShotBuffers(n, 0)
        packed = self._packed if own is None else packed_under(own, rules)
        streams, nominated = np.zeros((n, 2), np.uint64), np.empty(0, np.int64)
        tables = visits.positions, visits.on_table, visits.game, streams, nominated
        actions = choices[:, None].astype(np.float64)
        address(np.arange(n), actions, tables, buffers.struck, packed, rules.fidelity)
        return intentions_of(buffers, packed[1])

    def _score(self, positions: PositionsLike, seeds: Integers) -> tuple[Positions, Floats, Ints, Floats]:
        """The visits with placed cue balls, their places, the decisions after fouls, and the scores."""
        at = Positions.of(positions)
        keys = seeds_of(seeds, len(at))
        visits, places, decisions = self.start_playing(at, keys)
        scores = self.scores(visits, keys)
        if np.shape(scores) != (len(at), SIZE):
            allowed = f"must have shape ({len(at)}, {SIZE}): a score for each choice of each position"
            what = f"array of shape {np.shape(scores)}"
            raise refuse_what(f"{type(self).__qualname__}.scores", what, allowed)
        return visits, places, decisions, scores


def shares(scores: Floats) -> Floats:
    """The probabilities (m,) of choices with these scores: a softmax."""
    parts = np.exp(scores.astype(np.float64) - scores.max())
    return parts / parts.sum()


class Random(ChoicePlayer):
    """Uniformly random choices of ``action="discrete"``, of those available."""

    name, training_shots = "random", 0

    def scores(self, at: Positions, seeds: Ints) -> Floats:
        masks = action_masks(at, rails=self.options.rules.rails)
        order = np.empty(masks.shape)
        for row, seed in zip(order, seeds.tolist(), strict=True):
            row[:] = np.random.default_rng(seed).random(len(row))
        return np.where(masks, order, -np.inf)

    def figures(self, scores: Floats) -> None:
        """None: its scores mean nothing."""


class GhostBall(ChoicePlayer):
    """``ghost_ball``: the widest pot, aim solved, in the middle at 2.3 m/s; all else as in ``planning.ghost_ball``."""

    name, training_shots = "ghost_ball", 0

    def play(self, positions: PositionsLike, seeds: Integers) -> Strokes:
        return self._play(positions, seeds)[0]

    def rank(self, positions: PositionsLike, seeds: Integers) -> list[Ranked]:
        """Its stroke, then the same at the other direct pots, with the tolerance of each pot [mrad]."""
        strokes, start = self._play(positions, seeds)
        direct = pots(start)
        ranked = []
        for k, many in enumerate((direct.ball >= 0).sum(axis=1).tolist()):
            if many < 2:
                ranked.append(Ranked(strokes[k : k + 1], None))
                continue
            values = self._read_choices(start[np.full(many, k)], STROKES * np.arange(many) + _PLAIN)
            others = Strokes(values, np.repeat(strokes.place[k : k + 1], many, 0))
            joined = Strokes.join([strokes[k : k + 1], others[1:]])
            ranked.append(Ranked(joined, 1e3 * direct.tolerance[k, :many]))
        return ranked

    def _play(self, positions: PositionsLike, seeds: Integers) -> tuple[Strokes, Positions]:
        at = Positions.of(positions)
        own = at.positions.copy(), at.on_table.copy(), at.game.copy()
        asked, start = self.turns(*own, at.conditions, seeds_of(seeds, len(at)))
        return Strokes(*asked), start

    def turns(
        self, positions: Floats, on_table: Bools, game: Ints, conditions: Floats | None, seeds: Ints
    ) -> tuple[Asked, Positions]:
        """What it plays on n tables, and from where: visits, which take over the arrays of the tables."""
        n, code = len(seeds), self.options.rules.rule_set.code
        values, places, visits = np.empty((n, 5)), np.empty((n, 2)), np.empty((n, VISIT_COLUMNS), np.int64)
        (nominated, decisions), solves = np.empty((2, n), np.int64), np.empty(n, np.bool_)
        out = values, places, nominated, decisions, visits, solves
        geometric_strokes(positions, on_table, game, code, streams_of(seeds), *out)
        if "nominate" not in self.options.says:  # the colour first struck is the one nominated
            nominated[:] = AUTO
        start, rows = Positions(positions, on_table, visits, None, conditions), np.flatnonzero(solves)
        if len(rows):
            values[rows] = self._read_choices(start[rows], np.full(len(rows), _PLAIN))
        return (values, places, nominated, decisions, np.full(n, SAYS_NOTHING)), start


_PLAIN = choice_of(0, SPEEDS.index(2.3), SIDES.index(0.0), TOPS.index(0.0))  # the widest pot, no spin
