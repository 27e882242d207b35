"""What is a position of a frame worth to who comes to it, and what follows from that?

A *worth* maps n ``Positions`` of frames, seen by their strikers, to the points that each is expected to score from now on, less
the other's. One worth serves both: **after each stroke either I go on, and the next position's worth is mine, or the other
comes, and it is theirs**. All decisions compare it: after a foul, in hand, who begins at a re-spotted black."""

from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np

from .._lib.jit import entry
from .._lib.types import Bools, Floats, Ints, Singles
from ..game import frame_columns as columns
from ..game.balls import BLACK, CUE, N_BALLS, VALUES, available
from ..geometry import BAULK_Y, D_RADIUS
from ..tasks.stroke import place
from .positions import Positions
from .trials import turn_to_striker

SPREAD, NARROWEST, WIDEST = 1.2e-3, 3.3e-4, 5e-3
"""An error of direction in the middle of those that are learned from [rad]; those beyond the others count as these."""
LAST, FOUL, SURE = float(VALUES[BLACK]), 4.0, 0.98
"""Points that the last black, or a foul on it, brings; the least that a foul does; how sure it is at most who gets them."""
Worth: TypeAlias = Callable[[Positions], Floats | Singles]
_ROWS = ((0.0, 7), (0.6, 4))
_IN_D = [(x * np.sqrt(1.0 - y * y), -y) for y, many in _ROWS for x in np.linspace(-0.95, 0.95, many)]
PLACES = np.array(_IN_D) * D_RADIUS + (0.0, BAULK_Y)
"""Where in the D a cue ball in hand is tried: (11, 2) [m]."""


@entry
def _choose(game, positions, on_table, saved_positions, saved_on_table, what):
    for k in range(len(game)):
        columns.choose(game[k], what)
        if what == columns.REPLACE:
            for i in range(N_BALLS):
                positions[k, i, 0], positions[k, i, 1] = saved_positions[k, i, 0], saved_positions[k, i, 1]
                on_table[k, i] = saved_on_table[k, i]


@entry
def _list_choices(game, rules, out):
    for k in range(len(game)):
        out[k, columns.PLAY] = out[k, columns.PLAY_AGAIN] = True
        out[k, columns.REPLACE] = columns.may_replace(game[k], rules) and game[k, columns.SAVED_LAYOUT]
        out[k, columns.PLACE_ANYWHERE] = columns.may_place_anywhere(game[k], rules)


@entry
def _count_points(game, out):
    for k in range(len(game)):
        row = game[k]
        out[k] = available(row[columns.ON_TABLE], row[columns.BALL_ON], row[columns.FREE_BALL])


@entry
def _place(positions, on_table, places):
    for k in range(len(positions)):
        place(positions[k], on_table[k], places[k, 0], places[k, 1], False)


def breaks_off(at: Positions) -> Bools:
    """Whether the strikers of n positions break off a whole rack, (n,)."""
    begins = at.in_hand & (at.game[:, columns.STROKES] == 0)
    return begins & (at.game[:, columns.RACK] == at.game[:, columns.ON_TABLE])


def apply_decision(at: Positions, what: int) -> Positions:
    """Positions after the strikers' decision ``what`` after a foul, as who then plays sees them: a copy."""
    after = at.copy()
    saved = after.saved if after.saved is not None else columns.Layouts(after.positions, after.on_table)
    _choose(after.game, after.positions, after.on_table, *saved, what)
    return turn_to_striker(after)


def decide(worth: Worth, at: Positions, rules: int = 0) -> tuple[Ints, Floats]:
    """The best decision after a foul for n strikers who have that choice, and its worth to them: (n,), (n,).

    Who leads by more than is left plays on: further fouls of the other would bring points without use."""
    allowed, values = np.zeros((len(at), 4), np.bool_), np.full((len(at), 4), -np.inf)
    _list_choices(at.game, rules, allowed)
    if at.saved is None:
        allowed[:, columns.REPLACE] = False
    for what in (columns.PLAY_AGAIN, columns.REPLACE):
        allowed[lead_of(at) > left_of(at), what] = False
    for what in range(4):
        rows = np.flatnonzero(allowed[:, what])
        if len(rows):
            after = apply_decision(at[rows], what)
            mine = what in (columns.PLAY, columns.PLACE_ANYWHERE)
            values[rows, what] = worth(after) if mine else -worth(after)
    best = values.argmax(axis=1)
    return best, values[np.arange(len(at)), best]


def follows(worth: Worth, after: Positions, before: Floats, rules: int = 0) -> Floats:
    """What strokes were worth to those who played them, who are player 0 in ``after``: the points since the leads
    ``before`` (n,), and the worth of what they leave, of which the other may be the next to play: (n,)."""
    game = after.game
    gains = lead_of(after) - before
    mine = game[:, columns.STRIKER] == 0
    lost = (game[:, columns.OVER] != 0) & (game[:, columns.WINNER] == 1)
    gains -= np.where(lost, left_of(after), 0.0)  # by a third miss, with balls on the table
    lot = (game[:, columns.RESPOTTED_BLACK] != 0) & (before != 0.0)  # level now: chance says who begins
    playing = (game[:, columns.PHASE] == columns.STROKE) & ~lot
    choosing = game[:, columns.PHASE] == columns.CHOICE
    rows = np.flatnonzero(playing)
    if len(rows):
        gains[rows] += np.where(mine[rows], 1.0, -1.0) * worth(turn_to_striker(after[rows]))
    rows = np.flatnonzero(choosing)
    if len(rows):
        gains[rows] += np.where(mine[rows], 1.0, -1.0) * decide(worth, turn_to_striker(after[rows]), rules)[1]
    return gains


class Chance(NamedTuple):
    """The chance to win a frame. Until only the black is left, a logistic law: of the lead that is expected at its end,
    beside the luck that is still to come, ``near`` + ``far`` x points on the table [points], times the players' errors of
    direction over ``SPREAD`` to the power ``errors``: who errs less makes more of one visit. A lead of more than is on the
    table is lost by fouls alone: it counts ``needs`` in the logit, and ``snookers`` for each point beyond; of what the other
    is expected to score, no more than a foul brings is of use.

    With the black alone the next points end the frame unless they make it level, so that the rules say who wins by them:
    only who scores them is not certain."""

    near: float
    far: float
    snookers: float
    needs: float
    errors: float = 0.0

    def __call__(
        self, now: Floats, worth: Floats, left: Floats, last: Bools, spread: float | Floats
    ) -> Floats:
        """The chance (n,) of who leads by ``now`` (n,) and is expected to score ``worth`` (n,) more than the other from
        here on, when ``left`` (n,) are on the table, ``last``: only the black, between players whose direction errs by
        ``spread`` [rad]."""
        sign, beyond = np.sign(now), np.abs(now) - left
        wide = (self.near + self.far * left) * (np.clip(spread, NARROWEST, WIDEST) / SPREAD) ** self.errors
        chance = _logistic((now + worth) / wide)
        # level, at best: all that is on the table, and then the lot and a re-spotted black
        chance = np.where((beyond == 0.0) & (left > 0.0), 0.5 * chance + 0.5 * (now > 0.0), chance)
        gain = sign * np.maximum(sign * worth, -FOUL)
        fouls = _logistic(sign * (self.needs + self.snookers * beyond) + gain / wide)
        chance = np.where(beyond > 0.0, fouls, chance)
        black = _scores(worth)
        ends = black * _chance_at_end(now + LAST) + (1.0 - black) * _chance_at_end(now - LAST)
        return np.where(last, ends, chance)


def _logistic(logit: Floats) -> Floats:
    return 1.0 / (1.0 + np.exp(-np.clip(logit, -30.0, 30.0)))  # never 1.0 by rounding


def _scores(worth: Floats) -> Floats:
    """How sure it is that who expects ``worth`` (n,) more than the other makes the next points, if a black brings them."""
    return np.clip(0.5 + worth / (2.0 * LAST), 1.0 - SURE, SURE)


def _chance_at_end(lead: Floats) -> Floats:
    """The chance of who leads by ``lead`` (n,) when the black has gone: level, a lot and a re-spotted black decide."""
    return 0.5 + 0.5 * np.sign(lead)


def in_one_stroke(now: Floats, worth: Floats, most: Floats, mine: Bools) -> Floats:
    """The chance (n,) of who leads by ``now`` and expects ``worth`` more, where time allows one stroke, ``mine`` or the
    other's, of at most ``most`` points: who is ahead wins, unless they change it."""
    sign = np.where(mine, 1.0, -1.0)
    scores = _scores(sign * worth)
    striker = scores * _chance_at_end(sign * now + LAST) + (1.0 - scores) * _chance_at_end(sign * now)
    chance = np.clip(np.where(mine, striker, 1.0 - striker), 1.0 - SURE, SURE)
    return np.where(np.abs(now) > most, now > 0.0, chance)


def last_of(at: Positions) -> Bools:
    """Whether only the black is left, so that the next points end the frame unless they make it level: (n,)."""
    return (at.game[:, columns.ON_TABLE] == 1 << BLACK) & (at.game[:, columns.BALL_ON] == VALUES[BLACK])


def left_of(at: Positions) -> Floats:
    """Points that are still on the table: float64 (n,); none after the last black."""
    left = np.empty(len(at))
    _count_points(at.game, left)
    return left


def lead_of(at: Positions) -> Floats:
    """Points of player 0 less those of player 1: float64 (n,)."""
    return (at.game[:, columns.SCORE_0] - at.game[:, columns.SCORE_1]).astype(np.float64)


def pass_after_miss(at: Positions) -> Positions:
    """The same balls as the other player would meet them after a miss: a copy."""
    left = at.copy()
    game = left.game
    reds = left.on_table[:, 1:16].any(axis=1)
    game[:, columns.BALL_ON] = np.where(reds, 1, 2 + left.on_table[:, 16:].argmax(axis=1))
    game[:] = columns.swap_sides(game)
    game[:, columns.STRIKER] = 0
    for column in (columns.POINTS, columns.FREE_BALL, columns.IN_HAND, columns.ANYWHERE):
        game[:, column] = 0
    return left


def best_places(worth: Worth, at: Positions) -> tuple[Positions, Floats]:
    """Positions with cue balls in hand put where in the D that is worth most: a copy, and the worths (n,)."""
    n, m = len(at), len(PLACES)
    tried = at[np.repeat(np.arange(n), m)]
    _place(tried.positions, tried.on_table, np.tile(PLACES, (n, 1)))
    tried.game[:, columns.IN_HAND] = 0
    values = np.asarray(worth(tried), np.float64).reshape(n, m)
    best = values.argmax(axis=1)
    placed = at.copy()
    placed.positions[:, CUE] = tried.positions.reshape(n, m, N_BALLS, 2)[np.arange(n), best, CUE]
    return placed, values[np.arange(n), best]
