"""How does the planner of the whole game play? One search for pots, safeties and escapes, one worth for both
players, and all decisions of a frame by that worth: what to do after a foul, where the cue ball in hand goes, who
begins at a re-spotted black."""

from typing import Any, NamedTuple

import numpy as np

from .._check import integer, refuse, refuse_what
from .._types import Floats
from ..game import frame_columns as columns
from ..planning import Positions, processors, spread_of
from ..planning.frame_search import AVERAGE, LEAST, FrameSearch, Tried
from ..planning.learned.learned_value import LearnedValue
from ..planning.learned.learned_worth import LearnedWorth
from ..planning.learned.policy_proposals import PolicyProposals
from ..planning.positions import PositionsLike
from ..planning.worth import best_places, chosen, decide, lead_of, left_of
from ..tasks.declarations import CONCEDES, OTHER_BEGINS, SAYS_NOTHING
from ..tasks.options import Options
from .choices import GhostBall
from .player import BoundPlayer, Ranked, Strokes, placed
from .search import MOST, RANKED, SearchPlayer
from .weights import learned_at, learned_worth, level_for

LOST = 0.01
"""The chance to win below which it concedes a frame in which it needs snookers, where it may."""
_IDLE = (1.0, 0.0, 0.0, 0.0, 0.0)  # the stroke of a player who has none


class Decided(NamedTuple):
    """What the ``tactician`` does in n positions.

    ``strokes``: n ``Strokes``; ``tried``: of each position what its search tried, None where it plays no stroke;
    ``start``: the positions that the strokes are played from, after decisions, with placed cue balls."""

    strokes: Strokes
    tried: list[Tried | None]
    start: Positions


class Tactician(BoundPlayer):
    """The best stroke of a ``FrameSearch``, in visits of the planner; ``learned``: the layers of a ``LearnedWorth``
    and a ``Chance``, each may be None; by default the package's."""

    kind = "tactician"

    def __init__(self, budget: int = AVERAGE, learned: Any = None):
        self.name: str = self.kind if budget == AVERAGE else f"{self.kind}_{budget}"
        self.budget: int = integer("budget", budget, LEAST, MOST)
        self._given = learned
        self._visits, self.search = SearchPlayer("planner", budget), None

    def _bind(self, options: Options) -> None:
        self._visits, self._plain = self._visits.at(options), GhostBall().at(options)
        noise, physics = options.rules.noise, options.rules.physics
        layers, chance = learned_worth() if self._given is None else self._given
        learned = learned_at(level_for(noise))
        value = LearnedValue(learned.value, spread_of(noise, physics), processors())
        worth = LearnedWorth(value, layers)
        self.search = FrameSearch(options, worth, PolicyProposals(learned.policy), self.budget, chance=chance)

    def play(self, positions: Any, seeds: Any) -> Strokes:
        """See ``Player.play``."""
        at = Positions.of(positions)
        return self.decided(at, np.asarray(seeds)).strokes if at.of_frames else self._visits.play(at, seeds)

    def rank(self, positions: Any, seeds: Any) -> list[Ranked]:
        """The strokes that met noise samples, most first, best first, with their chances to win; in visits their points."""
        at = Positions.of(positions)
        if not at.of_frames:
            return self._visits.rank(at, seeds)
        strokes, tried, _ = self.decided(at, np.asarray(seeds))
        ranked = []
        for k, one in enumerate(tried):
            if one is None:
                ranked.append(Ranked(strokes[k : k + 1], None))
                continue
            m = min(RANKED, int((one.samples > 0).sum()) or len(one.samples))
            same = [np.repeat(part[k : k + 1], m, 0) for part in strokes.parts[1:]]
            ranked.append(Ranked(Strokes(one.strokes[:m], *same), one.chances[:m]))
        return ranked

    def chance_to_win(self, positions: PositionsLike) -> Floats:
        """Return how likely the striker of each position wins the frame, if both play on as the ``tactician`` does.

        The worth of the position is added to the lead, and a law (``planning.worth.Chance``) says what that lead at
        the end is worth while so many points are still on the table. Nothing is simulated: a millisecond for one
        position.

        Parameters
        ----------
        positions : PositionsLike
            n positions of frames, as their strikers see them. A cue ball in hand is not placed: the worth was
            learned of such positions, too. After a foul, and where the striker has won the lot, the best decision
            is taken.

        Returns
        -------
        numpy.ndarray
            float64 (n,), in [0, 1]. Of a frame that is over 0 or 1.

        Raises
        ------
        ValueError
            If the player is not bound, the positions are of visits, which nobody wins, or the player was made
            without a law of the chance.
        """
        rules, at, search = self.options.rules, Positions.of(positions), self.search
        if not at.of_frames:
            raise refuse_what("positions", "those of visits", "must be of frames: nobody wins a visit")
        if search is None or search.chance is None:
            raise refuse("player", self.name, "must hold a law of the chance to win")
        at, worth = at.known_to(rules), search.worth
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
        return np.where(
            over, won, search.chance(lead_of(at) + gains, left_of(at), lead_of(at), search.spread)
        )

    def decided(self, at: Positions, seeds: Any) -> Decided:
        """What it does in positions of frames, what it tried in those in which it strikes, and from where."""
        search: Any = self.search
        assert search is not None, self.options  # it must be bound
        worth = search.worth
        n, at = len(at), at.known_to(search.rules).copy()
        values, places = np.tile(_IDLE, (n, 1)), np.full((n, 2), np.nan)
        decisions, declare = np.full(n, columns.PLAY), np.full(n, SAYS_NOTHING)
        plays, code = np.ones(n, np.bool_), search.rules.rule_set.code
        rows = np.flatnonzero(at.lot)
        if len(rows):
            at.game[rows, columns.PHASE] = columns.STROKE
            other = rows[worth(at[rows]) < 0.0] if "lot" in self.options.says else rows[:0]
            declare[other], plays[other] = OTHER_BEGINS, False
        rows = np.flatnonzero(at.choice)
        if len(rows):
            decisions[rows] = decide(worth, at[rows], code)[0]
            for what in (columns.PLAY, columns.PLACE_ANYWHERE):
                some = rows[decisions[rows] == what]
                at.game[some] = chosen(at[some], what).game
            plays[rows] = np.isin(decisions[rows], (columns.PLAY, columns.PLACE_ANYWHERE))
        game = at.game
        racks = (game[:, columns.STROKES] == 0) & (game[:, columns.RACK] == game[:, columns.ON_TABLE])
        hand, usual = plays & at.in_hand, racks | at.anywhere
        for rows in np.flatnonzero(hand & usual), np.flatnonzero(hand & ~usual):
            if len(rows):  # at the break-off, and where it may stand anywhere, as other players do
                some = placed(at[rows], seeds[rows]) if usual[rows[0]] else best_places(worth, at[rows])
                at.positions[rows] = some[0].positions
                places[rows] = at.positions[rows, 0]
        tried: list[Tried | None] = [None] * n
        rows = np.flatnonzero(plays)
        for k, one in zip(rows.tolist(), search.rank(at[rows], seeds[rows]), strict=True):
            if len(one.strokes):
                tried[k], values[k] = one, one.strokes[0]
        rows = rows[[tried[k] is None for k in rows.tolist()]]
        if len(rows):  # nothing was found: any stroke at a ball on
            values[rows] = self._plain.play(at[rows].as_visits(), seeds[rows]).values
        if "concede" in self.options.says and search.chance is not None:
            some = np.flatnonzero([one is not None and one.chances[0] < LOST for one in tried])
            behind = lead_of(at[some]) < -left_of(at[some])  # it needs snookers
            declare[some[behind]] = CONCEDES
        return Decided(Strokes(values, places, decision=decisions, declare=declare), tried, at)
