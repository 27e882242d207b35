"""How does the planner of the whole game play? One search for pots, safeties and escapes, one worth for both
players, and all decisions of a frame by that worth (``frame_decisions``)."""

import numpy as np

from .._lib.check import integer, refuse, refuse_what
from .._lib.types import Floats, Integers, Singles
from ..game import frame_columns as columns
from ..planning import FrameJudge, Positions, Search, processors
from ..planning.aims import Dynamics
from ..planning.learned.foresight import Foresight
from ..planning.learned.learned_value import LearnedValue
from ..planning.learned.learned_worth import LearnedWorth
from ..planning.learned.policy_proposals import PolicyProposals
from ..planning.positions import PositionsLike
from ..planning.search import BUDGET, MOST
from ..planning.worth import Chance, decide, lead_of
from ..tasks.options import Options
from .choices import GhostBall
from .frame_decisions import FramePlayer
from .player import Ranked, Strokes
from .search_player import SearchPlayer
from .weights import learned_at, learned_worth, level_for


class Tactician(FramePlayer):
    """The best stroke of a ``Search`` with a ``FrameJudge``, in visits of the planner; ``learned``: layers and a ``Chance``."""

    kind = "tactician"
    judge: FrameJudge

    def __init__(
        self, budget: int = BUDGET, learned: tuple[list[tuple[Singles, Singles]], Chance] | None = None
    ):
        self.name: str = self.kind if budget == BUDGET else f"{self.kind}_{budget}"
        self.budget: int = integer("budget", budget, FrameJudge.least, MOST)
        self._given, self._visits = learned, SearchPlayer("planner", budget)

    def _bind(self, options: Options) -> None:
        self._visits, self._plain = self._visits.at(options), GhostBall().at(options)
        noise, physics = options.rules.noise, options.rules.physics
        layers, chance = learned_worth() if self._given is None else self._given
        learned = learned_at(level_for(noise))
        value = LearnedValue(learned.value, noise.spread(physics), processors())
        worth = LearnedWorth(value, layers)
        foresight = Foresight(options.rules, Dynamics.of(options.rules), worth)
        self.judge = FrameJudge(options, worth, chance, foresee=foresight.promise)
        self.search = Search(self.judge, self.budget, PolicyProposals(learned.policy))

    def play(self, positions: PositionsLike, seeds: Integers) -> Strokes:
        at = Positions.of(positions)
        return self.decide_frames(at, seeds).strokes if at.of_frames else self._visits.play(at, seeds)

    def rank(self, positions: PositionsLike, seeds: Integers) -> list[Ranked]:
        """The strokes that met noise samples, most first, best first, with their chances to win; in visits their points."""
        at = Positions.of(positions)
        return self._consider(at, seeds) if at.of_frames else self._visits.rank(at, seeds)

    def chance_to_win(self, positions: PositionsLike) -> Floats:
        """Return how likely the strikers of n positions of frames win, if both play on as the ``tactician`` does.

        Float64 (n,), in [0, 1]; 0 or 1 of a frame that is over. The worth of the position is added to the lead, and a
        law (``planning.worth.Chance``) says what that is worth while so many points are on the table. A cue ball in hand
        is not placed; after a foul or a lot that was won the best decision is taken. ValueError if the player is not
        bound or has no law, or positions are of visits."""
        rules, at, judge = self.options.rules, Positions.of(positions), self.judge
        if not at.of_frames:
            raise refuse_what("positions", "those of visits", "must be of frames: nobody wins a visit")
        if judge.chance is None:
            raise refuse("player", self.name, "must hold a law of the chance to win")
        at, worth = at.known_to(rules), judge.worth
        gains, over = np.zeros(len(at)), at.game[:, columns.PHASE] == columns.FINISHED
        rows = np.flatnonzero(~(over | at.choice | at.lot))
        if len(rows):
            gains[rows] = worth(at[rows])
        rows = np.flatnonzero(at.choice)
        if len(rows):
            gains[rows] = decide(worth, at[rows], rules.rule_set.code)[1]
        rows = np.flatnonzero(at.lot)
        if len(rows):
            black = at[rows]
            black.game[:, columns.PHASE] = columns.STROKE
            gains[rows] = np.abs(worth(black))  # it begins, or the other does
        won = at.game[:, columns.WINNER] == 0
        chances = judge.chances(lead_of(at), gains, at)
        return np.where(over, won, chances)
