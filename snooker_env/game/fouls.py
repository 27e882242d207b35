"""Is a stroke a foul, what does it score, and who plays on which ball next? The rules of one stroke.

``ruling`` is a pure kernel on integers and masks (bit i is ball i). It does not judge intent or effort
(``frame`` has what geometry decides of that); acts outside the simulation are passed in as flags."""

from collections import namedtuple
from enum import IntEnum, IntFlag
from typing import Any, NamedTuple

from .._lib.jit import kernel
from .balls import BLACK, COLOURS_MASK, CUE_BIT, N_BALLS, PINK, VALUES, balls_on_kernel, count, next_on_kernel
from .rule_sets import LATE_PENALTY

AUTO = -1  # the referee decides which ball was nominated: the one evidently played at (see ``_nomination``)


class Flag(IntFlag):
    """Other facts about a stroke: input of ``ruling``."""

    JUMP = 1  # illegal: passed over a part of a ball before striking one, or landed behind the one struck
    PUSH = 2  # a push stroke
    DOUBLE_HIT = 4  # the tip struck the cue ball twice
    OUTSIDE_D = 8  # in hand, but not played from on or within the lines of the D
    FEET = 16  # both feet off the floor
    OUT_OF_TURN = 32
    SEVEN = 64  # an act that always costs 7: wrong cue ball, use of a ball off the table, measuring ...
    SNOOKERED = 128  # with colours respotted, the next striker is snookered on the next ball on
    BEHIND_FREE_BALL = 256  # as SNOOKERED, and the effective snookering ball is the one just nominated
    NO_CUSHION = 512  # no ball reached a cushion: a foul in the Shoot Out if none was potted either
    LATE = 1024  # not begun within the shot clock, and so not played
    SIX_RED = 2048  # the rules of six-red snooker hold
    SHOOT_OUT = 4096  # the rules of the Shoot Out hold


RULE_FLAGS = (Flag(0), Flag.SIX_RED, Flag.SHOOT_OUT)  # the flag of each rule set, by its code


class Foul(IntFlag):
    """The fouls of a stroke: output of ``ruling``. Those named as a ``Flag`` are explained there."""

    NO_CONTACT = 1  # the cue ball struck no ball
    WRONG_FIRST = 2  # it first struck a ball that was not on
    WRONG_POT = 4  # a ball was potted that was not on
    CUE_POTTED = 8
    CUE_OFF = 16  # the cue ball left the table
    BALL_OFF = 32  # an object ball left the table
    JUMP = 64
    PUSH = 128
    DOUBLE_HIT = 256
    OUTSIDE_D = 512
    FEET = 1024
    OUT_OF_TURN = 2048
    BEHIND_FREE_BALL = 4096  # a snooker behind the free ball; in six-red snooker, behind any nominated ball
    NO_NOMINATION = 8192  # a foul on a colour never nominated, such as reds played in successive strokes
    SEVEN = 16384
    NO_CUSHION = 32768
    LATE = 65536


class VisitEnd(IntEnum):
    """Whether and why the striker's visit ended with this stroke."""

    CONTINUES = 0
    MISS = 1  # a fair stroke that potted nothing
    FOUL = 2
    CLEARANCE = 3  # no object ball is left


class Outcome(IntEnum):
    """Whether the frame goes on after the stroke, and if not, how it ended."""

    PLAYING = 0
    STRIKER_WINS = 1
    OPPONENT_WINS = 2
    RESPOTTED_BLACK = 3  # level and no ball left: cue ball in hand, and a lot decides who plays first


def _plain(enum):
    """The members of an enumeration as plain integers, because numba does not support ``IntFlag``."""
    return namedtuple(enum.__name__, enum.__members__)(*map(int, enum))


FLAG, FOUL, VISIT, OUTCOME = _plain(Flag), _plain(Foul), _plain(VisitEnd), _plain(Outcome)


class Before(NamedTuple):
    """What ``ruling`` knows of the frame before the stroke, all integers."""

    on_table: int  # mask of the balls on the table
    ball_on: int  # a ``BallOn``
    free_ball: int  # 1 if the striker has a free ball
    lead: int  # the striker's score minus the opponent's


class Facts(NamedTuple):
    """What ``ruling`` knows of the stroke, all integers: masks of balls, and an id."""

    first: int  # the balls struck by the first impact; more than one: simultaneously
    touching: int  # the balls that touched the cue ball before it
    moved: int  # those of them that the cue ball moved as it left them
    potted: int  # the balls in pockets, bit 0 the cue ball
    off: int  # the balls off the table, bit 0 the cue ball
    nominated: Any  # the id of the ball nominated, 0 for none, or AUTO


class Ruling(NamedTuple):
    """The result of ``ruling``, all integers; ``referee.Verdict`` explains the fields."""

    fouls: int
    penalty: int
    points: int
    respotted: int
    on_table: int
    ball_on: int
    stays: int
    in_hand: int
    free_ball: int
    visit_end: int
    outcome: int
    nominated: int


@kernel
def _highest(mask, free, value_on):
    """The highest value in a mask; a free ball has the value of the ball on that it replaces."""
    high = 0
    for i in range(N_BALLS):
        if (mask >> i) & 1:
            high = max(high, value_on if i == free else VALUES[i])
    return high


@kernel
def _top_ball(mask):
    """The highest id in a mask, or 0."""
    for i in range(N_BALLS - 1, 0, -1):
        if (mask >> i) & 1:
            return i
    return 0


@kernel
def _nomination(on, ball_on, free_ball, first, touching, nominated):
    """The id of the colour on, or of the free ball, or 0 for none. With AUTO it is the highest colour first
    struck among those allowed; if none was struck, an allowed colour that the cue ball was touching."""
    if ball_on != 0 and not free_ball:
        return 0
    if nominated >= 0:
        return nominated
    could_be = COLOURS_MASK if ball_on == 0 else COLOURS_MASK & ~on
    ball = _top_ball(first & could_be)
    # From a touching ball, a striker who first strikes the real ball on has not nominated a free ball.
    return ball if ball != 0 or (ball_on != 0 and first & on != 0) else _top_ball(touching & could_be)


@kernel
def ruling(before, facts, flags):
    """The ``Ruling`` on the stroke ``facts`` in the frame ``before``; ``flags``: Flag bits."""
    on_table, ball_on, free_ball, lead = before
    first, touching, moved, potted, off, nominated = facts
    reds_and_colours = on_table & ~CUE_BIT
    on = balls_on_kernel(ball_on, reds_and_colours)
    choice = _nomination(on, ball_on, free_ball, first, touching, nominated)
    free = choice if ball_on != 0 else 0

    # 1. The target, what it is worth and what a plain foul costs.
    value_on = ball_on
    if ball_on == 0:
        on = (1 << choice) & ~CUE_BIT
        value_on = VALUES[choice]
    target = 1 << free if free else on
    fair = target | on
    base = max(4, value_on)
    fouls = 0
    penalty: Any = 0

    # 2. First impact. A touching ball that is on counts as struck, as long as the stroke does not move it.
    if touching & moved:
        fouls |= FOUL.PUSH
        penalty = max(penalty, base, _highest(touching & moved, free, value_on))
    if flags & FLAG.LATE:
        fouls |= FOUL.LATE
        penalty = max(base, LATE_PENALTY)
    elif touching & target & ~moved == 0:
        if first == 0:
            fouls |= FOUL.NO_CONTACT
            penalty = max(penalty, base)
        elif first & target == 0 or first & ~fair != 0:
            fouls |= FOUL.WRONG_FIRST
            penalty = max(penalty, base, _highest(first, free, value_on))

    # 3. Balls potted, 4. the cue ball and balls that left the table.
    down = (potted | off) & ~CUE_BIT
    if potted & ~CUE_BIT & ~fair:
        fouls |= FOUL.WRONG_POT
        penalty = max(penalty, base, _highest(potted & ~fair, free, value_on))
    if potted & CUE_BIT:
        fouls |= FOUL.CUE_POTTED
        penalty = max(penalty, base)
    if off & CUE_BIT:
        fouls |= FOUL.CUE_OFF
        penalty = max(penalty, base)
    if off & ~CUE_BIT:
        fouls |= FOUL.BALL_OFF
        penalty = max(penalty, base, _highest(off, free, value_on))

    # 5. How the cue ball was played.
    if flags & FLAG.PUSH:
        fouls |= FOUL.PUSH
        penalty = max(penalty, base, _highest(first, free, value_on))
    for flag, foul in (
        (FLAG.JUMP, FOUL.JUMP),
        (FLAG.DOUBLE_HIT, FOUL.DOUBLE_HIT),
        (FLAG.OUTSIDE_D, FOUL.OUTSIDE_D),
        (FLAG.FEET, FOUL.FEET),
        (FLAG.OUT_OF_TURN, FOUL.OUT_OF_TURN),
    ):
        if flags & flag:
            fouls |= foul
            penalty = max(penalty, base)

    if flags & FLAG.SHOOT_OUT and flags & FLAG.NO_CUSHION and not potted and not flags & FLAG.LATE:
        fouls |= FOUL.NO_CUSHION
        penalty = max(penalty, base)

    # 6. No snooker behind the free ball without a score, unless only pink and black are left.
    behind = flags & FLAG.BEHIND_FREE_BALL and (fouls or not down)
    if behind and (
        (choice and flags & FLAG.SIX_RED) or (free and reds_and_colours != 1 << PINK | 1 << BLACK)
    ):
        fouls |= FOUL.BEHIND_FREE_BALL
        penalty = max(penalty, base)

    # 7. Seven points, whatever is on.
    if flags & FLAG.SEVEN:
        fouls |= FOUL.SEVEN
        penalty = 7
    if ball_on == 0 and choice == 0 and fouls & ~FOUL.LATE:
        fouls |= FOUL.NO_NOMINATION
        penalty = 7

    # Points, and the colours that return: after a foul all, else those not potted as the sequence's ball on.
    points: Any = 0
    respotted = down & COLOURS_MASK
    if not fouls:
        if ball_on == 1:
            points = count(down)
        elif down:
            points = value_on
            if ball_on != 0:
                respotted &= ~on
    left = (reds_and_colours & ~down) | respotted

    # Who plays on, and on which ball.
    stays = 1 if points else 0
    next_on = next_on_kernel(left)
    if points and ball_on == 1 and left & COLOURS_MASK:
        next_on = 0
    end = VISIT.FOUL if fouls else VISIT.CONTINUES if points else VISIT.MISS
    if left == 0 and not fouls:
        end = VISIT.CLEARANCE

    # The frame ends on an empty table, and with a foul when only the black is left; if level, it returns.
    outcome = OUTCOME.PLAYING
    if left == 0 or (fouls and reds_and_colours == 1 << BLACK):
        lead += points - penalty
        if lead == 0:
            outcome = OUTCOME.RESPOTTED_BLACK
            left = respotted = 1 << BLACK
            next_on = 7
            stays = -1
        else:
            outcome = OUTCOME.STRIKER_WINS if lead > 0 else OUTCOME.OPPONENT_WINS
            left = respotted = 0
            next_on = -1
            stays = 0
    playing = outcome == OUTCOME.PLAYING
    in_hand = 1 if (potted | off) & CUE_BIT or outcome == OUTCOME.RESPOTTED_BLACK else 0
    if flags & FLAG.SHOOT_OUT and playing and fouls:
        in_hand = 1
    free_next = 1 if playing and fouls and flags & FLAG.SNOOKERED and not flags & FLAG.SHOOT_OUT else 0
    return Ruling(
        fouls, penalty, points, respotted, left, next_on, stays, in_hand, free_next, end, outcome, choice
    )
