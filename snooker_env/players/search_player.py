"""How do players search? ``search`` judges by the rule of thumb and looks at strokes spread over the pots, ``planner`` by the
learned value at those that the learned policy proposes; ``best_pot`` plays the likeliest pot. The ``tactician`` searches frames
for pots, safeties and escapes, and takes all decisions of a frame by one worth for both players. ``stroke_value`` simulates no
shot: in visits it plays the pot, in frames the stroke, that its networks say is worth most; without one as ``ghost_ball``."""

from typing import Any, NamedTuple

import numpy as np

from .._lib.check import integer, refuse, refuse_what
from .._lib.types import Floats, Integers
from ..game import frame_columns as columns
from ..planning import FrameJudge, Positions, Search, VisitJudge, at_pots, processors
from ..planning.aims import Dynamics
from ..planning.learned.dense_layers import Weights
from ..planning.learned.frame_strokes import FOULS, Foresight, FrameStrokes
from ..planning.learned.learned_worth import LearnedValue, LearnedWorth
from ..planning.learned.stroke_policy import PolicyProposals
from ..planning.learned.stroke_value import LOOKS, Candidates, StrokeValue
from ..planning.positions import PositionsLike, seeds_of
from ..planning.proposals import Propose, over_cushions
from ..planning.search import BUDGET, MOST
from ..planning.stroke_columns import COLUMNS
from ..planning.worth import Chance, apply_decision, best_places, breaks_off, decide, lead_of, left_of
from ..tasks.declarations import CONCEDES, OTHER_BEGINS, SAYS_NOTHING
from ..tasks.options import Options
from .choices import GhostBall
from .player import BoundPlayer, Ranked, Strokes, place_cue_balls
from .seen import begun
from .weights import Learned, StrokeLayers, learned_at, learned_strokes, learned_worth, level_for

KINDS = ("best_pot", "search", "planner")
RANKED = 40  # most strokes of a ranking
LOST = 0.01  # the chance to win below which it concedes a frame in which it needs snookers, where it may
LIKELY = 0.75  # share of the predicted errors under which a stroke at a ball must be fair to be preferred
_IDLE = (1.0, 0.0, 0.0, 0.0, 0.0)  # the stroke of a player who has none


class SearchPlayer(BoundPlayer):
    """The best stroke of a ``Search`` with a ``VisitJudge``; ``learned``: a planner's, by default the package's."""

    frames = False

    def __init__(self, kind: str, budget: int = BUDGET, learned: Learned | None = None):
        self.kind, self.name = kind, kind if budget == BUDGET else f"{kind}_{budget}"
        self.budget = integer("budget", budget, VisitJudge.least, MOST)
        self._learned, self.training_shots = learned, None if kind == "planner" else 0
        self._worth: LearnedWorth | None = None

    def _bind(self, options: Options) -> None:
        self.judge = judge = VisitJudge(options, pots_only=self.kind == "best_pot")
        propose: Propose = at_pots
        if self.kind == "planner":
            learned = self._learned or learned_at(level_for(judge.noise))
            value = LearnedValue(learned.value, judge.spread, judge.planner.threads)
            self._worth = LearnedWorth(value, learned_worth()[0])
            judge.value, propose = value, PolicyProposals(learned.policy)
        self.search = Search(judge, self.budget, propose)

    def worth(self, at: Positions) -> Floats:
        return super().worth(at) if self._worth is None else self._worth(at).astype(np.float64)

    def play(self, positions: PositionsLike, seeds: Integers) -> Strokes:
        return self._play(positions, seeds)[0]

    def rank(self, positions: PositionsLike, seeds: Integers) -> list[Ranked]:
        """The strokes that met noise samples, most first, best first, with their scores [points]."""
        strokes, ranked = self._play(positions, seeds)
        return [show_strokes(one, strokes[k : k + 1]) for k, one in enumerate(ranked)]

    def _play(self, positions: PositionsLike, seeds: Integers) -> tuple[Strokes, list[Ranked]]:
        visits, places, decisions = self.start_playing(positions, seeds)
        ranked = self.search.rank(visits, seeds)
        best = np.array([one.strokes.values[0] for one in ranked]).reshape(-1, COLUMNS)
        return Strokes(best, places, decision=decisions), ranked


def show_strokes(one: Ranked, said: Strokes) -> Ranked:
    """What a player shows of a ranking: the strokes that met noise samples, else all, at most ``RANKED``; it says ``said``."""
    m = min(RANKED, int((one.samples > 0).sum()) or len(one.samples))
    same = [np.repeat(part, m, 0) for part in said.parts[1:]]
    scores = None if one.scores is None else one.scores[:m]
    strokes = Strokes(one.strokes.values[:m], *same)
    return Ranked(strokes, scores, one.points[:m], one.samples[:m], one.kinds[:m])


class Decided(NamedTuple):
    strokes: Strokes
    tried: list[Ranked | None]  # what its search tried; None where it plays no stroke or found none
    start: Positions  # what the strokes are played from, after decisions, with placed cue balls


class FramePlayer(BoundPlayer):
    """Plays frames by what its ``search`` finds and its ``judge`` says of positions; without a stroke as ``_plain`` does."""

    search: Search | FrameStrokes
    judge: FrameJudge | FrameStrokes
    _plain: GhostBall

    def decide_frames(self, at: Positions, seeds: Integers) -> Decided:
        """What it does in n positions of frames, what it tried in those in which it strikes, and from where."""
        options, judge, seeds = self.options, self.judge, seeds_of(seeds, len(at))
        worth = judge.worth
        n, at = len(at), at.known_to(judge.rules).copy()
        values, places = np.tile(_IDLE, (n, 1)), np.full((n, 2), np.nan)
        decisions, declare = np.full(n, columns.PLAY), np.full(n, SAYS_NOTHING)
        plays, code = np.ones(n, np.bool_), judge.rules.rule_set.code
        rows = np.flatnonzero(at.lot)
        if len(rows):
            at.game[rows, columns.PHASE] = columns.STROKE
            other = rows[worth(at[rows]) < 0.0] if "lot" in options.says else rows[:0]
            declare[other], plays[other] = OTHER_BEGINS, False
        rows = np.flatnonzero(at.choice)
        if len(rows):
            decisions[rows] = decide(worth, at[rows], code)[0]
            for what in (columns.PLAY, columns.PLACE_ANYWHERE):
                some = rows[decisions[rows] == what]
                at.game[some] = apply_decision(at[some], what).game
            plays[rows] = np.isin(decisions[rows], (columns.PLAY, columns.PLACE_ANYWHERE))
        hand, usual = plays & at.in_hand, breaks_off(at) | at.anywhere
        for rows in np.flatnonzero(hand & usual), np.flatnonzero(hand & ~usual):
            if len(rows):  # at the break-off, and where it may stand anywhere, as other players do
                some = at[rows]
                put, _ = place_cue_balls(some, seeds[rows]) if usual[rows[0]] else best_places(worth, some)
                at.positions[rows], places[rows] = put.positions, put.positions[:, 0]
        tried: list[Ranked | None] = [None] * n
        rows = np.flatnonzero(plays)
        for k, one in zip(rows.tolist(), self.search.rank(at[rows], seeds[rows]), strict=True):
            if len(one.strokes):
                tried[k], values[k] = one, one.strokes.values[0]
        rows = rows[[tried[k] is None for k in rows.tolist()]]
        if len(rows):  # nothing was found: any stroke at a ball on
            values[rows] = self._plain.play(at[rows].as_visits(), seeds[rows]).values
        if "concede" in options.says and judge.chance is not None:
            scores = [1.0 if one is None or one.scores is None else one.scores[0] for one in tried]
            some = np.flatnonzero(np.array(scores) < LOST)
            behind = lead_of(at[some]) < -left_of(at[some])  # it needs snookers
            declare[some[behind]] = CONCEDES
        return Decided(Strokes(values, places, decision=decisions, declare=declare), tried, at)

    def _consider(self, at: Positions, seeds: Integers) -> list[Ranked]:
        """The strokes that met noise samples, else all, at most ``RANKED``, best first, with chances or points."""
        strokes, tried, _ = self.decide_frames(at, seeds)
        own = [strokes[k : k + 1] for k in range(len(tried))]
        both = zip(own, tried, strict=True)
        return [Ranked(mine, None) if one is None else show_strokes(one, mine) for mine, one in both]


class Tactician(FramePlayer):
    """The best stroke of a ``Search`` with a ``FrameJudge``, in visits of the planner; ``learned``: layers and a ``Chance``."""

    kind = "tactician"
    judge: FrameJudge

    def __init__(self, budget: int = BUDGET, learned: tuple[Weights, Chance] | None = None):
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
        """Return how likely the strikers of n positions of frames win, if both play on as the ``tactician`` does: float64 (n,).

        A law (``planning.worth.Chance``) of the lead and the worth of the position. A cue ball in hand is not placed; after a
        foul or a lot the best decision is taken. ValueError if the player is not bound or has no law, or for visits."""
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


class StrokeValuePlayer(FramePlayer):
    """The best stroke of a ``StrokeValue``, in frames of a ``FrameStrokes``, with the layers ``learned``."""

    name = "stroke_value"
    search: FrameStrokes
    values: StrokeValue

    def __init__(self, learned: StrokeLayers | None = None):
        self._given = learned

    def _bind(self, options: Options) -> None:
        rules, level = options.rules, level_for(options.rules.noise)
        learned, self._plain = learned_at(level), GhostBall().at(options)
        layers = learned_strokes() if self._given is None else self._given
        spread = rules.noise.spread(rules.physics)
        # one of the value's networks says almost as much as all, in a quarter of the time
        value, worth = LearnedValue(learned.value[:1], spread), LearnedValue(learned.value, spread)
        self.values = StrokeValue(value, learned.policy, Dynamics.of(rules), rules.noise, layers.visits)
        own = LearnedWorth(worth, learned_worth()[0])
        self.search = self.judge = FrameStrokes(rules, self.values, own, layers.frames)

    def play(self, positions: PositionsLike, seeds: Integers) -> Strokes:
        at = Positions.of(positions)
        if at.of_frames:
            return self.decide_frames(at, seeds).strokes
        if self.options.rules.reward == "legal":
            return self._fairest(at, seeds)
        at, places, found, scores = self._score(at, seeds)
        values = np.zeros((len(at), COLUMNS))
        values[found.rows] = found.strokes[np.arange(len(scores)), scores.argmax(axis=1)]
        others = np.setdiff1d(np.arange(len(at)), found.rows)
        if len(others):
            plain = self._plain.play(at[others], np.asarray(seeds)[others])
            values[others], places[others] = plain.values, plain.place
        return Strokes(values, places)

    def rank(self, positions: PositionsLike, seeds: Integers) -> list[Ranked]:
        """Its strokes, best first, with what they are worth [points]; the one that need only be fair alone."""
        at = Positions.of(positions)
        if at.of_frames:
            return self._consider(at, seeds)
        if self.options.rules.reward == "legal":
            strokes = self._fairest(at, seeds)
            return [Ranked(strokes[k : k + 1], None) for k in range(len(at))]
        at, places, found, scores = self._score(at, seeds)
        made: list[Ranked] = self._plain.rank(at, seeds)
        for j, k in enumerate(found.rows.tolist()):
            order = np.argsort(-scores[j], kind="stable")
            where = np.repeat(places[k : k + 1], len(order), axis=0)
            made[k] = Ranked(Strokes(found.strokes[j, order], where), scores[j, order].astype(np.float64))
        return made

    def _fairest(self, positions: Positions, seeds: Integers) -> Strokes:
        """Strokes that need only be fair: at a ball that is likely to be struck, else over cushions, else as ``ghost_ball``."""
        at, keys = positions.known_to(self.options.rules), seeds_of(seeds, len(positions))
        plain, (visits, places) = self._plain.play(at, keys).values, place_cue_balls(at, keys)
        every, (strokes, there, seen) = np.arange(len(at)), self.search.look(begun(visits), keys)
        fair = np.where(there, 1.0 - seen[..., FOULS], 0.0)[:, LOOKS:]
        worth = self.search.scores(seen)[:, LOOKS:]
        best = (fair + 1e-3 * worth).argmax(axis=1)  # of those that are alike the worthiest
        fair, found = fair[every, best, None], strokes[every, LOOKS + best]
        over, some = over_cushions(self.search, visits, 1, keys)
        values = np.where(some > 0.0, over[:, 0], np.where(fair > 0.0, found, plain))
        return Strokes(np.where(fair >= LIKELY, found, values), places)

    def _score(self, at: Positions, seeds: Integers) -> tuple[Positions, Floats, Candidates, Any]:
        """Positions of visits, the places of cue balls in hand, the strokes that are looked at, and their values."""
        at, keys = at.known_to(self.options.rules), seeds_of(seeds, len(at))
        visits, places = place_cue_balls(at, keys)
        found = self.values.candidates(visits, LOOKS, keys)
        return at, places, found, self.values.scores(found.seen)
