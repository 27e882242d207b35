"""How does a frame go on? One row of integers for each, and the rules of frames as kernels that change it.

A row (int64, ``COLUMNS`` wide) holds a frame between two strokes; ``frame.Frame`` is its readable face.
``after_stroke``, ``choose``, ``draw``, ``claim`` and ``concede`` change it; the caller first asks whether
they may. What "replace" restores is in ``Layouts``. A visit without a frame has ``VISIT_COLUMNS`` only."""

from typing import NamedTuple

import numpy as np

from .._lib.jit import kernel
from .._lib.types import Bools, Floats, Ints
from .balls import BLACK, COLOURS_MASK, available, balls_on_kernel, next_on_kernel
from .fouls import FOUL, OUTCOME
from .rule_sets import CLOCK_LIMIT, MOST_MISSES, SHOOT_OUT, SHOT_CLOCK, SIX_RED

# Columns of visits and frames.
BALL_ON = 0  # a ``BallOn``: what must be struck first
IN_HAND = 1  # whether the cue ball is in hand
POINTS = 2  # of the break
OVER = 3  # whether the episode has ended by the rules
STEPS = 4  # of the episode so far
VISIT_COLUMNS = 5

# Columns of frames.
FREE_BALL = 5  # whether the striker may nominate one
ON_TABLE = 6  # mask of the object balls
PHASE = 7  # ``STROKE`` to ``FINISHED``
STRIKER = 8  # who plays next, 0 or 1; in the phase ``CHOICE`` who chooses, in ``LOT`` the last striker
BREAKER = 9  # who broke off, 0 or 1
SCORE_0 = 10  # the score of player 0
SCORE_1 = 11  # the score of player 1
WINNER = 12  # 0 or 1; -1: the frame goes on
RESPOTTED_BLACK = 13  # whether scores were level, so that the black was re-spotted
MISS_CALLED = 14  # whether the last stroke was a foul and a miss
FAILURES = 15  # misses in succession from one position with a clear full-ball path
WARNED = 16  # whether one more failure loses the frame
SAVED = 17  # whether the position before a foul is kept
SAVED_ON_TABLE = 18  # its mask of the object balls
SAVED_BALL_ON = 19  # its ``BALL_ON``
SAVED_IN_HAND = 20  # its cue ball: 0 lay on the table, 1 was in hand in the D, 2 anywhere
SAVED_FREE_BALL = 21  # its ``FREE_BALL``
SAVED_LAYOUT = 22  # whether the places of its balls are kept, in ``Layouts``
STROKES = 23  # of both players
PAID = 24  # the agent's lead that rewards have already paid
FRAMES_0 = 25  # frames of the match that player 0 has won
FRAMES_1 = 26  # frames of the match that player 1 has won
FIRST_BREAK = 27  # who broke off in the first frame of the match
CLOCK = 28  # time played in a game with a clock [ms]
MISSES = 29  # in six-red snooker: misses in succession
ANYWHERE = 30  # whether the cue ball in hand may go anywhere on the table
OPPONENT = 31  # which player of a pool is the opponent, from 1; 0: there is no pool
RACK = 32  # mask of the object balls that the frame began with
COLUMNS = 33

(STROKE, CHOICE, LOT, FINISHED) = range(4)  # Phases, in the order of ``frame.PHASES``
(PLAY, PLAY_AGAIN, REPLACE, PLACE_ANYWHERE) = range(4)  # decisions after a foul: ``frame.CHOICES``
(NO_MISSES, CLEAR_PATHS, ATTEMPTS) = range(3)  # miss rules, in the order of ``frame.MISS_RULES``
MISSED = FOUL.NO_CONTACT | FOUL.WRONG_FIRST


class Conditions(NamedTuple):
    """The constants of all frames of an environment."""

    rules: int  # code of the rule set (``rule_sets``)
    miss: int  # code of the miss rule
    time_to_play: int  # from the rest of the balls to each stroke [ms], in a game with a clock


class Effort(NamedTuple):
    """For the miss rule: were paths to a ball on clear, and did the cue ball come near one?"""

    clear_path: bool
    full_ball_path: bool
    attempt: bool


class Layouts(NamedTuple):
    """The balls on n tables before the last stroke: (n, 22, 2) [m], (n, 22)."""

    positions: Floats
    on_table: Bools


@kernel
def strikeable(row, mask):
    """Mask of the balls of ``mask`` that may be struck first, free balls too; ``row``: of visit or frame."""
    on = balls_on_kernel(row[BALL_ON], mask)
    if row.shape[0] > FREE_BALL and row[FREE_BALL]:
        on |= COLOURS_MASK & mask
    return on


@kernel
def begin_frame(row, on_table, breaker, in_hand):
    """A new frame with the balls of the mask ``on_table``."""
    for c in range(row.shape[0]):
        row[c] = 0
    row[ON_TABLE] = row[RACK] = on_table & ~1
    row[BALL_ON], row[IN_HAND] = next_on_kernel(row[ON_TABLE]), in_hand
    row[STRIKER] = row[BREAKER] = breaker
    row[WINNER] = -1


@kernel
def _end(row, winner):
    """End the frame; what no frame that is over has is cleared (``frame.SETTLED``)."""
    row[PHASE], row[OVER], row[WINNER] = FINISHED, 1, winner
    row[BALL_ON] = -1
    row[FREE_BALL] = row[MISS_CALLED] = row[FAILURES] = row[WARNED] = 0
    row[SAVED] = row[SAVED_LAYOUT] = row[MISSES] = row[ANYWHERE] = 0


@kernel
def lead_of(row, player):
    """The player's score less the other's."""
    return row[SCORE_0] - row[SCORE_1] if player == 0 else row[SCORE_1] - row[SCORE_0]


@kernel
def needs_snookers(row, player):
    """Whether ``player`` trails by more than is left for them; a free ball is the striker's alone."""
    if row[STRIKER] == player:
        return -lead_of(row, player) > available(row[ON_TABLE], row[BALL_ON], row[FREE_BALL])
    return -lead_of(row, player) > available(row[ON_TABLE], -1, 0)


@kernel
def _rules_miss_out(row):
    """Whether the scores rule a miss out: a player needs penalty points, or the lead equals the points left."""
    level = abs(lead_of(row, 0)) == available(row[ON_TABLE], row[BALL_ON], row[FREE_BALL])
    return level or needs_snookers(row, 0) or needs_snookers(row, 1)


@kernel
def _is_miss(result, conditions, effort, failures, misses, decided):
    """Whether a foul is also a miss. ``decided``: the scores, before or after the stroke, rule it out."""
    if conditions.miss == NO_MISSES or not result.fouls & MISSED:
        return False
    if conditions.rules == SIX_RED and misses == MOST_MISSES:
        return False
    if effort.full_ball_path and failures:
        return True
    poor = conditions.miss == ATTEMPTS and not effort.attempt
    return (effort.clear_path or effort.full_ball_path or poor) and not decided


@kernel
def shot_clock(row, rules):
    """The longest time to play the next stroke [ms]; 0 for no limit."""
    if rules != SHOOT_OUT:
        return 0
    return SHOT_CLOCK[1] if 2 * row[CLOCK] >= CLOCK_LIMIT else SHOT_CLOCK[0]


@kernel
def is_late(row, rules, time_to_play):
    """Whether a stroke after ``time_to_play`` [ms] is too late for the shot clock: it must not be played."""
    return 0 < shot_clock(row, rules) < time_to_play


@kernel
def after_stroke(row, result, conditions, effort, layout, duration):
    """One stroke with the ``Ruling``; ``layout``: whether that before it is stored; ``duration`` [ms]."""
    rules, time_to_play, full = conditions.rules, conditions.time_to_play, effort.full_ball_path
    me = row[STRIKER]
    other = 1 - me
    failures, warned, misses = row[FAILURES], row[WARNED], row[MISSES]
    decided = _rules_miss_out(row)
    on_table, ball_on = row[ON_TABLE], row[BALL_ON]
    in_hand, free_ball = row[IN_HAND] + row[ANYWHERE], row[FREE_BALL]
    row[SCORE_0 + me] += result.points
    row[SCORE_0 + other] += result.penalty
    row[ON_TABLE] = result.on_table
    if rules == SHOOT_OUT:
        limit, late = shot_clock(row, rules), is_late(row, rules, time_to_play)
        row[CLOCK] += (min(time_to_play, limit) if row[CLOCK] else 0) + (0 if late else duration)
    if result.outcome == OUTCOME.STRIKER_WINS or result.outcome == OUTCOME.OPPONENT_WINS:
        row[POINTS] = 0 if result.fouls else row[POINTS] + result.points
        _end(row, me if result.outcome == OUTCOME.STRIKER_WINS else other)
        return
    row[STRIKER] = other if result.stays == 0 else me
    row[POINTS] = row[POINTS] + result.points if result.stays == 1 else 0
    row[BALL_ON], row[IN_HAND], row[FREE_BALL] = result.ball_on, result.in_hand, result.free_ball
    row[MISS_CALLED] = row[FAILURES] = row[WARNED] = row[SAVED] = row[SAVED_LAYOUT] = row[MISSES] = 0
    row[ANYWHERE] = rules == SHOOT_OUT and result.fouls != 0 and result.outcome == OUTCOME.PLAYING
    if result.outcome == OUTCOME.RESPOTTED_BLACK:
        row[PHASE], row[RESPOTTED_BLACK] = LOT, 1
        return
    if rules == SHOOT_OUT:
        if not row[RESPOTTED_BLACK] and row[CLOCK] + time_to_play >= CLOCK_LIMIT:
            _time_is_up(row)
        return
    if not result.fouls:
        return
    if warned and full and result.fouls & MISSED:
        _end(row, other)
        return
    called = _is_miss(result, conditions, effort, failures, misses, decided or _rules_miss_out(row))
    row[PHASE], row[MISS_CALLED] = CHOICE, called
    row[FAILURES] = failures + 1 if called and full else 0
    row[MISSES] = misses + 1 if called and rules == SIX_RED else 0
    row[SAVED], row[SAVED_LAYOUT] = 1, layout
    row[SAVED_ON_TABLE], row[SAVED_BALL_ON] = on_table, ball_on
    row[SAVED_IN_HAND], row[SAVED_FREE_BALL] = in_hand, free_ball


@kernel
def _time_is_up(row):
    """The frame's clock has run down: the higher score wins; if level, the caller leaves only the black."""
    lead = lead_of(row, 0)
    if lead != 0:
        _end(row, 0 if lead > 0 else 1)
        return
    row[PHASE], row[RESPOTTED_BLACK], row[ON_TABLE], row[BALL_ON] = LOT, 1, 1 << BLACK, BLACK - 14
    row[IN_HAND], row[ANYWHERE], row[POINTS] = 1, 0, 0


@kernel
def may_replace(row, rules):
    """Whether the position before a miss may be restored."""
    return row[PHASE] == CHOICE and row[MISS_CALLED] and not (rules == SIX_RED and row[MISSES] >= MOST_MISSES)


@kernel
def may_place_anywhere(row, rules):
    """Whether the cue ball may go anywhere: after the last miss in succession, unless snookers are needed."""
    last = row[PHASE] == CHOICE and row[MISS_CALLED] and rules == SIX_RED and row[MISSES] >= MOST_MISSES
    return last and abs(lead_of(row, 0)) <= available(row[ON_TABLE], row[BALL_ON], 0)


@kernel
def allowed_choice(row, what, rules):
    """The decision ``what``; in place of REPLACE and PLACE_ANYWHERE the one of them that is allowed, else PLAY."""
    if what == PLAY or what == PLAY_AGAIN:
        return what
    if may_replace(row, rules):
        return REPLACE
    return PLACE_ANYWHERE if may_place_anywhere(row, rules) else PLAY


@kernel
def choose(row, what):
    """An allowed decision after a foul. The caller restores a replaced layout."""
    row[PHASE] = STROKE
    row[MISS_CALLED] = 0
    if what == REPLACE:
        row[STRIKER] = 1 - row[STRIKER]
        row[WARNED] = row[FAILURES] >= 2
        row[ON_TABLE], row[BALL_ON] = row[SAVED_ON_TABLE], row[SAVED_BALL_ON]
        row[FREE_BALL] = row[SAVED_FREE_BALL]
        row[IN_HAND], row[ANYWHERE] = row[SAVED_IN_HAND] > 0, row[SAVED_IN_HAND] == 2
        return
    row[FAILURES] = row[SAVED] = row[SAVED_LAYOUT] = 0
    if what == PLAY_AGAIN:
        row[STRIKER] = 1 - row[STRIKER]
        row[FREE_BALL] = 0
        return
    row[MISSES] = 0
    if what == PLACE_ANYWHERE:
        row[FREE_BALL], row[IN_HAND], row[ANYWHERE] = 0, 1, 1


@kernel
def draw(row, first):
    """Player ``first`` begins at the re-spotted black."""
    row[PHASE], row[STRIKER], row[POINTS] = STROKE, first, 0


@kernel
def may_claim(row):
    """Whether the striker may claim the frame: only the black is left and the lead is more than 7."""
    return row[PHASE] == STROKE and row[ON_TABLE] == 1 << BLACK and lead_of(row, row[STRIKER]) > 7


@kernel
def claim(row):
    """The striker claims the frame, where ``may_claim``."""
    _end(row, row[STRIKER])


@kernel
def concede(row):
    """The striker concedes the frame."""
    _end(row, 1 - row[STRIKER])


# How a player sees frames.


def swap_sides(game: Ints) -> Ints:
    """Rows of frames (m, COLUMNS) as if the players had changed sides: a new array."""
    other = game.copy()
    for a, b in ((SCORE_0, SCORE_1), (FRAMES_0, FRAMES_1)):
        other[:, a], other[:, b] = game[:, b], game[:, a]
    for column in (STRIKER, BREAKER, FIRST_BREAK):
        other[:, column] = 1 - game[:, column]
    winner = game[:, WINNER]
    other[:, WINNER] = np.where(winner < 0, winner, 1 - winner)
    other[:, PAID] = -game[:, PAID]
    return other


def strikers_own(game: Ints) -> Ints:
    """Rows of frames (m, COLUMNS) with the striker as player 0: a new array."""
    return np.where(game[:, STRIKER, None] == 1, swap_sides(game), game)


def as_visits(game: Ints) -> Ints:
    """Copied rows as a player of visits sees them: free ball as any colour, anywhere as already placed."""
    seen = game.copy()
    free, anywhere = game[:, FREE_BALL] != 0, game[:, ANYWHERE] != 0
    seen[free, BALL_ON] = seen[free, FREE_BALL] = 0
    seen[anywhere, IN_HAND] = seen[anywhere, ANYWHERE] = 0
    return seen
