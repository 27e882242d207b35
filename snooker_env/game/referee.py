"""How does Python call the referee? ``judge(Situation, Stroke) -> Verdict``: checked input, named results."""

from dataclasses import dataclass
from typing import Any

from .._lib.check import choice, integer, refuse
from .._lib.jit import entry
from .balls import ALL_MASK, COLOURS_MASK, CUE_BIT, N_BALLS, NAMES, BallOn, balls_on, check_ball_on, ids_of
from .fouls import AUTO, RULE_FLAGS, Before, Facts, Flag, Foul, Outcome, Ruling, VisitEnd, ruling
from .rule_sets import RULES, RulesName

FULL_TABLE = ALL_MASK & ~CUE_BIT  # the mask of all 21 object balls
MOST_POINTS = 2**60  # upper limit of scores: beyond any play, within the kernel's 64 bits


@dataclass(frozen=True, kw_only=True)
class Situation:
    """What the referee needs of the frame before the stroke. Masks have bit i for ball i."""

    on_table: int = FULL_TABLE  # mask of the object balls; the cue ball's bit does not matter
    ball_on: BallOn = BallOn.RED  # not NOTHING, and at least one of it on the table
    free_ball: bool = False  # the striker may nominate one: with a red or a colour of the sequence on
    lead: int = 0  # the striker's score minus the opponent's; used at the end of the frame only
    rules: RulesName = "snooker"

    def __post_init__(self) -> None:
        integer("on_table", self.on_table, 0, ALL_MASK)
        on = BallOn(integer("ball_on", self.ball_on, BallOn.ANY_COLOUR, BallOn.BLACK))
        object.__setattr__(self, "ball_on", on)
        integer("lead", self.lead, -MOST_POINTS, MOST_POINTS)
        choice("rules", self.rules, RULES)
        check_ball_on("ball_on", on, self.on_table, "on_table", in_turn=False)
        if self.free_ball and self.ball_on == BallOn.ANY_COLOUR:
            raise refuse("free_ball", self.free_ball, "must be False when any colour is on (ball_on)")


@dataclass(frozen=True, kw_only=True)
class Stroke:
    """The events of one stroke; every ball in a mask must be on the table. ``Flag`` explains the bools."""

    first: int = 0  # object balls struck by the cue ball's first impact; several: simultaneously
    potted: int = 0  # balls that entered a pocket, bit 0 the cue ball
    off: int = 0  # balls forced off the table, bit 0 the cue ball
    touching: int = 0  # object balls that touched the cue ball before the stroke
    moved: int = 0  # those of them that the cue ball moved as it left them, not another ball later
    nominated: int = AUTO  # id of a colour, after a red or as the free ball; 0: none; AUTO: first struck
    jump: bool = False
    push: bool = False
    double_hit: bool = False
    outside_d: bool = False
    feet: bool = False
    out_of_turn: bool = False
    seven: bool = False
    snookered: bool = False
    behind_free_ball: bool = False
    no_cushion: bool = False
    late: bool = False

    def __post_init__(self) -> None:
        for name in ("first", "touching", "moved"):
            if integer(name, getattr(self, name), 0, ALL_MASK) & CUE_BIT:
                raise refuse(name, getattr(self, name), "must name object balls only")
        for name in ("potted", "off"):
            integer(name, getattr(self, name), 0, ALL_MASK)
        if self.moved & ~self.touching:
            raise refuse("moved", ids_of(self.moved), "must be some of the touching balls")
        if self.potted & self.off:
            raise refuse("off", ids_of(self.off), "must name no ball that was potted")
        ball = integer("nominated", self.nominated, AUTO, N_BALLS - 1)
        if ball > 0 and not COLOURS_MASK >> ball & 1:
            allowed = "must be a colour (ids 16 to 21), 0 for none or -1 (AUTO)"
            raise refuse("nominated", self.nominated, allowed)

    @property
    def flags(self) -> Flag:
        """The bool fields as a ``Flag``."""
        acts = (flag for flag in Flag if flag not in RULE_FLAGS)
        return Flag(sum(flag for flag in acts if getattr(self, str(flag.name).lower())))


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """The referee's decision. A stroke with a foul scores nothing."""

    fouls: Foul  # false if it was fair
    penalty: int  # to the opponent: the highest that any of the fouls costs (4 to 7), or 0
    points: int  # to the striker
    respotted: int  # mask of the colours to be spotted
    on_table: int  # mask of the object balls after that
    ball_on: BallOn  # next; NOTHING when the frame is over
    stays: bool | None  # the striker plays on, unless a foul's choice says otherwise; None: a lot decides
    in_hand: bool  # the next stroke is played from the D
    free_ball: bool  # the next striker has one, if it is the opponent
    visit_end: VisitEnd
    outcome: Outcome
    nominated: int  # id of the colour that counted as nominated or as the free ball, or 0

    @property
    def over(self) -> bool:
        """Whether the frame has ended."""
        return self.outcome in (Outcome.STRIKER_WINS, Outcome.OPPONENT_WINS)


_ruling = entry(ruling)
_FACE: dict[str, Any] = {"fouls": Foul, "ball_on": BallOn, "visit_end": VisitEnd, "outcome": Outcome}
_FACE |= {"in_hand": bool, "free_ball": bool, "stays": lambda stays: None if stays < 0 else bool(stays)}
"""What the fields of a ``Ruling`` are in a ``Verdict``; the others are integers."""


def verdict_of(result: Ruling) -> Verdict:
    """The kernel's ``Ruling`` as a ``Verdict``."""
    fields = {name: _FACE.get(name, int)(number) for name, number in result._asdict().items()}
    return Verdict(**fields)


def check(situation: Situation, stroke: Stroke) -> None:
    """ValueError if a ``Stroke`` cannot have been played in a ``Situation``."""
    for name in ("first", "touching", "potted", "off"):
        absent = getattr(stroke, name) & ~CUE_BIT & ~situation.on_table
        if absent:
            raise refuse(name, [NAMES[i] for i in ids_of(absent)], "must be on the table before the stroke")
    if stroke.nominated > 0:
        on = balls_on(situation.ball_on, situation.on_table)
        free = situation.on_table & ~on if situation.free_ball else 0
        allowed = on if situation.ball_on == BallOn.ANY_COLOUR else free
        if not allowed >> stroke.nominated & 1:
            what = [NAMES[i] for i in ids_of(allowed & COLOURS_MASK)]
            allowed = f"must be one of {what}" if what else "must be none: no choice is on"
            raise refuse("nominated", NAMES[stroke.nominated], allowed)


def numbers_of(situation: Situation, stroke: Stroke) -> tuple[Before, Facts, int]:
    """Both as the arguments of ``ruling``."""
    before = situation.on_table, situation.ball_on, situation.free_ball, situation.lead
    facts = stroke.first, stroke.touching, stroke.moved, stroke.potted, stroke.off, stroke.nominated
    flags = stroke.flags | RULE_FLAGS[RULES.index(situation.rules)]
    return Before(*map(int, before)), Facts(*map(int, facts)), int(flags)


def ruling_of(situation: Situation, stroke: Stroke) -> Ruling:
    """``judge``, as the kernel's ``Ruling``."""
    check(situation, stroke)
    return _ruling(*numbers_of(situation, stroke))


def judge(situation: Situation, stroke: Stroke) -> Verdict:
    """The ``Verdict`` on a ``Stroke`` in a ``Situation``; ValueError if they do not fit together."""
    return verdict_of(ruling_of(situation, stroke))
