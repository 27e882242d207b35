"""Where are trial strokes played for advice? On a ``Practice``: with and without execution errors, in a visit or by the
rules of a frame. And does the cue have ``Room`` for them?"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from math import degrees
from typing import Any

import numpy as np

from .._lib.check import choice, integer, refuse, refuse_what
from .._lib.types import Bools, Floats, Ints, Words
from ..game import frame_columns as columns
from ..game.balls import NAMES
from ..game.in_hand import place_cue
from ..physics.conditions import END_MASS_RATIO
from ..physics.cue_room import MOVED, OVER_NOTHING, OVER_RAIL, RAISED, UNPLAYABLE, in_room_over
from ..planning import FrameJudge, Outcomes, Planner, Positions, Search, VisitJudge
from ..planning.positions import bare
from ..planning.trials import turn_to_striker
from ..planning.worth import apply_decision
from ..players.cue_stroke import CueStroke
from ..players.player import place_cue_balls
from ..players.search_player import Tactician
from ..players.seen import begun
from ..tasks.noise import Noise
from ..tasks.options import Options, Rules
from ..tasks.tables import Tables

PHYSICAL_OPTIONS = tuple(name for name in Options.group("shot") if name != "noise")  # of the table
FRAME_OPTIONS = tuple(Options.group("frame"))  # those that count as well where a position is of a frame
MOST_SCORE = 1000  # largest score of a player in a position of a frame
QUICK = 30  # simulated shots of a decision of the player that plays visits on
RAIL = "rail"  # what is in the way if no ball is
JUDGING, GOING_ON = 1, 2  # of noise samples: those that chose a stroke do not judge it, for it may be lucky


class Practice:
    """A table for trial strokes, with the player's execution errors (``noisy``) and without (``exact``)."""

    def __init__(self, options: Options):
        self.options = options
        self.noisy: Planner = Planner(options)
        self.exact: Planner = Planner(options, noise="none")
        self.noise: Noise = options.rules.noise
        self.sure: bool = self.noise.silent

    @cached_property
    def judge(self) -> FrameJudge:
        """Plays strokes of frames and knows what is worth what in them: the same for all players."""
        return Tactician().at(self.options).judge

    @cached_property
    def quick(self) -> Search:
        """A fast search, with which visits are played on."""
        return Search(VisitJudge(self.options), QUICK)

    def worth(self, at: list[Positions]) -> Floats:
        """The worth of positions of frames to their strikers (n,)."""
        return np.asarray(self.judge.worth(join(at)), np.float64) if at else np.empty(0)

    def play(self, at: Positions, rows: Ints, strokes: Floats, keys: Words | None = None) -> Outcomes:
        """Play strokes (n, 5) on copies of ``at[rows]``: with errors if there are ``keys``, else without. In frames points, penalty
        and, but for kicks, what is left are those of a frame, and whoever played is player 0 in ``afterstates``."""
        planner = self.exact if keys is None else self.noisy
        stops = planner.play_strokes(at, rows, strokes, None if self.sure else keys)
        if not at.of_frames:
            return stops
        errors = np.zeros_like(strokes)
        if not (self.sure or keys is None):
            errors = self.noise.errors_of(np.stack([keys, np.zeros_like(keys)], axis=1))
        after = self.judge.outcomes(at.known_to(self.options.rules), np.asarray(rows), strokes, errors)
        game, before = after.game, at.game[rows]
        stays = (game[:, columns.PHASE] == columns.STROKE) & (game[:, columns.STRIKER] == 0)
        return stops._replace(
            points=(game[:, columns.SCORE_0] - before[:, columns.SCORE_0]).astype(np.float64),
            penalty=game[:, columns.SCORE_1] - before[:, columns.SCORE_1],
            goes_on=stays,
            afterstates=after,
        )


def practice_of(
    noise: Any, options: object = None, source: object = None, *, of_frames: bool = False
) -> Practice:
    """The practice table for a noise and ``options``; None: those of an environment ``source``."""
    if options is None:
        options = getattr(bare(source), "options", None)
        options = options if isinstance(options, Options) else {}
    names = (*PHYSICAL_OPTIONS, *FRAME_OPTIONS) if of_frames else PHYSICAL_OPTIONS
    if isinstance(options, Options):
        held = PHYSICAL_OPTIONS if options.task == "visit" else names
        same: dict[str, Any] = {name: getattr(options, name) for name in held}
    elif isinstance(options, Mapping):
        for key in options:
            choice("key of options", key, names)
        same = dict(options)
    else:
        allowed = f"must be None, an Options, or a dict with keys of {names}"
        raise refuse_what("options", f"a {type(options).__name__}", allowed)
    return Practice(Options(task="frame" if of_frames else "visit", noise=Noise.of(noise), **same))


def one_position(source: Any, scores: Any = None) -> Positions:
    """The one position in a source as its next stroke is played, without points; a frame with ``scores``."""
    tables = getattr(bare(source), "tables", None)
    if isinstance(tables, Tables) and not tables.begun.all():
        words = "must have a position: call reset() first"
        raise refuse_what("position", "an environment before reset()", words)
    at = Positions.of(source)
    if len(at) != 1:
        raise refuse_what("position", f"{len(at)} positions", "must be one position")
    if at.over[0]:
        raise refuse("position.over", True, "must be False: there is no stroke to play")
    at = at.copy()
    at.game[:, columns.POINTS] = 0  # only future points count, and no break can exceed what a table allows
    if scores is not None:  # a position of a visit becomes one of a frame
        if at.of_frames:
            raise refuse("scores", scores, "must be None: the position of a frame has its own")
        if not isinstance(scores, list | tuple) or len(scores) != 2:
            raise refuse("scores", scores, "must be two integers: of the striker and of the opponent")
        both = [integer(f"scores[{k}]", score, 0, MOST_SCORE) for k, score in enumerate(scores)]
        at = begun(at)
        at.game[:, [columns.SCORE_0, columns.SCORE_1]] = both
        at.game[:, columns.STROKES] = not at.on_table.all()  # else it is the break-off
    if at.choice[0]:
        at = apply_decision(at, columns.PLAY)
    if at.of_frames:
        at.game[:, columns.PHASE] = columns.STROKE  # who has won the lot begins
    if at.anywhere[0]:  # the places that strokes know are those of the D
        at.game[:, [columns.IN_HAND, columns.ANYWHERE]] = 0
    return at


def start_from(at: Positions, stroke: CueStroke) -> Positions:
    """``at`` with a cue ball in hand at the free place nearest to that of the stroke."""
    if stroke.place is None:
        return at
    if not at.in_hand[0]:
        raise refuse("place", stroke.place, "must be None: the cue ball is not in hand")
    at = at.copy()
    at.positions[0, 0] = place_cue(at.positions[0], at.on_table[0], *stroke.place)
    return at


def join(positions: list[Positions]) -> Positions:
    """Several positions of one table as the rows of one."""
    places, present, game = zip(*((one.positions, one.on_table, one.game) for one in positions), strict=True)
    own = [one.conditions for one in positions if one.conditions is not None]
    saved = [one.saved for one in positions if one.saved is not None]
    layouts = columns.Layouts(*map(np.concatenate, zip(*saved, strict=True))) if saved else None
    tables = np.concatenate(own) if own else None
    return Positions(np.concatenate(places), np.concatenate(present), np.concatenate(game), layouts, tables)


def find_arrivals(after: Positions) -> Bools:
    """Where the other comes to the table next: bool (n,)."""
    game = after.game
    plays = np.isin(game[:, columns.PHASE], (columns.STROKE, columns.CHOICE))
    return plays & (game[:, columns.STRIKER] == 1)


def arrive(after: Positions) -> Positions:
    """What the opponent meets: as it plays, after a foul as the balls lie, with a cue ball in hand where it is good."""
    return place_cue_balls(
        apply_decision(turn_to_striker(after), columns.PLAY), np.zeros(len(after), np.int64)
    )[0]


def keys(seed: int, purpose: int, n: int, *more: int) -> Any:
    """n keys of noise samples, uint64 (n,): the same for equal arguments; a larger n begins with the same."""
    return np.random.default_rng((seed, purpose, *more)).integers(0, 2**64 - 1, n, dtype=np.uint64)


@dataclass(frozen=True, kw_only=True)
class Room:
    """How the cue finds room for a stroke, execution errors apart; ``Suggestion`` describes the fields."""

    elevation: float
    side: float
    top: float
    raised: bool
    moved: bool
    unplayable: bool
    over: str | None
    behind: float  # 0 if there is nothing in the way

    @property
    def words(self) -> str:
        """What the cue does for room, in words; "" for nothing, and for less than half a degree."""
        what = self.over and ("a red" if self.over.startswith("red") else f"the {self.over}")
        over = f" over {what}" if what else ""
        if self.unplayable:
            return f"no room for the cue{over}: nobody can play it, raised to {degrees(self.elevation):.0f} degrees"
        parts = []
        if self.raised and degrees(self.elevation) >= 0.5:
            parts.append(f"cue raised to {degrees(self.elevation):.0f} degrees{over}")
        if self.moved:
            tip = f"{abs(self.top):.2f} {'above' if self.top >= 0.0 else 'below'} the middle"
            aside = f", {abs(self.side):.2f} {'right' if self.side > 0 else 'left'}" if self.side else ""
            parts.append(f"tip moved to {tip}{aside}{'' if parts else over}")
        return ", ".join(parts)

    def to_dict(self) -> dict[str, Any]:
        """Return the fields and the words as JSON types."""
        return asdict(self) | {"words": self.words}


def room_for(stroke: Floats, at: Positions, rules: Rules) -> Room:
    """The room for a stroke in the one position ``at``: float64 (5,) as of ``CueStroke.numbers``."""
    physics, tables = rules.physics, at.conditions if rules.drawn else None
    ratio = physics.end_mass_ratio if tables is None else float(tables[0, END_MASS_RATIO])
    # kernels are compiled for arrays that can be written
    places, present, rails = at.positions[0].copy(), at.on_table[0].copy(), np.array(rules.rails)
    numbers = map(float, (physics.R, physics.max_offset, ratio))
    played, done, over, behind = in_room_over(tuple(stroke.tolist()), places, present, rails, *numbers)
    _, side, top, _, elevation = played
    bits = {"raised": RAISED, "moved": MOVED, "unplayable": UNPLAYABLE}
    found: Any = {name: bool(done & bit) for name, bit in bits.items()}
    found["over"] = None if over == OVER_NOTHING else RAIL if over == OVER_RAIL else NAMES[over]
    return Room(elevation=elevation, side=side, top=top, behind=behind, **found)
