"""What does a player do in a frame who can say what strokes and positions are worth? All decisions by one worth: the
stroke, what to do after a foul, where the cue ball in hand goes, who begins at a re-spotted black."""

from typing import NamedTuple

import numpy as np

from .._lib.types import Integers
from ..game import frame_columns as columns
from ..planning import Positions, Search
from ..planning.frame_judge import FrameJudge
from ..planning.learned.frame_strokes import FrameStrokes
from ..planning.positions import seeds_of
from ..planning.worth import apply_decision, best_places, breaks_off, decide, lead_of, left_of
from ..tasks.declarations import CONCEDES, OTHER_BEGINS, SAYS_NOTHING
from .choices import GhostBall
from .player import BoundPlayer, Ranked, Strokes, place_cue_balls
from .search_player import show_strokes

LOST = 0.01  # the chance to win below which it concedes a frame in which it needs snookers, where it may
_IDLE = (1.0, 0.0, 0.0, 0.0, 0.0)  # the stroke of a player who has none


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
                some = (
                    place_cue_balls(at[rows], seeds[rows]) if usual[rows[0]] else best_places(worth, at[rows])
                )
                at.positions[rows] = some[0].positions
                places[rows] = at.positions[rows, 0]
        tried: list[Ranked | None] = [None] * n
        rows = np.flatnonzero(plays)
        for k, one in zip(rows.tolist(), self.search.rank(at[rows], seeds[rows]), strict=True):
            if len(one.strokes):
                tried[k], values[k] = one, one.strokes.values[0]
        rows = rows[[tried[k] is None for k in rows.tolist()]]
        if len(rows):  # nothing was found: any stroke at a ball on
            values[rows] = self._plain.play(at[rows].as_visits(), seeds[rows]).values
        if "concede" in options.says and judge.chance is not None:
            some = np.flatnonzero(
                [one is not None and one.scores is not None and one.scores[0] < LOST for one in tried]
            )
            behind = lead_of(at[some]) < -left_of(at[some])  # it needs snookers
            declare[some[behind]] = CONCEDES
        return Decided(Strokes(values, places, decision=decisions, declare=declare), tried, at)

    def _consider(self, at: Positions, seeds: Integers) -> list[Ranked]:
        """The strokes that met noise samples, else all, at most ``RANKED``, best first, with chances or points."""
        strokes, tried, _ = self.decide_frames(at, seeds)
        own = [strokes[k : k + 1] for k in range(len(tried))]
        return [
            Ranked(mine, None) if one is None else show_strokes(one, mine)
            for mine, one in zip(own, tried, strict=True)
        ]
