"""How lucky was a stroke? What it brought and left, less the mean of that over fresh errors of the same stroke from the same
table: a sum whose expectation is 0, whatever is expected. Copies of a table, with other random streams, take the same turn."""

from collections.abc import Callable
from functools import lru_cache
from typing import TypeAlias

import numpy as np

from .._lib.types import Floats, Ints, Words
from ..game.balls import GREEN, SPOTS, YELLOW
from ..game.frame_columns import CHOICE, OVER, PHASE, POINTS, STRIKER, VISIT_COLUMNS
from ..game.layouts import STORED
from ..planning import Positions, processors
from ..planning.judges import for_opponent
from ..planning.learned.learned_worth import LearnedValue
from ..planning.positions import of_tables
from ..tasks.frame_kernels import AGENT
from ..tasks.frames import Frames
from ..tasks.options import Options
from ..tasks.tables import I_FOULS, StepOutput, Tables
from .player import decision_seeds
from .search_player import Tactician
from .weights import learned_at, level_for

DRAWS = 16  # fresh errors of each stroke
BATCH = 8192  # tables that are played at once
_KEYS = 0x6C75636B  # of the fresh errors: no player draws with this seed
Expected: TypeAlias = Callable[[Tables, StepOutput, Options], Floats]
"""What the episodes on n tables that have just taken a stroke have brought and are expected to bring: (n,)."""
Turn: TypeAlias = Callable[[Tables, Ints, StepOutput], None]
"""Plays a stroke on each of n tables, which are copies of the rows (n,) of others."""


@lru_cache(maxsize=16)
def value_of(options: Options) -> LearnedValue:
    """The points that a visit is expected to score from a position, as the planner has learned."""
    rules = options.rules
    learned = learned_at(level_for(rules.noise))
    return LearnedValue(learned.value, rules.noise.spread(rules.physics), processors())


def expect_points(tables: Tables, out: StepOutput, options: Options) -> Floats:
    """Of visits: points, and the learned value of what is left while they go on."""
    points, on = tables.game[:, POINTS].astype(np.float64), np.flatnonzero(tables.game[:, OVER] == 0)
    if len(on):
        points[on] += value_of(options)(of_tables(tables)[on])
    return points


def expect_legal(tables: Tables, out: StepOutput, options: Options) -> Floats:
    """Of one stroke: 1 unless it is a foul."""
    return (out.counts[:, I_FOULS] == 0).astype(np.float64)


def expect_lead(tables: Tables, out: StepOutput, options: Options) -> Floats:
    """Of a stroke and a visit of a frame: the lead, and the learned value of the visit that follows to who plays it."""
    assert isinstance(tables, Frames)
    game, lead = tables.game, tables.lead().astype(np.float64)
    ended = (game[:, OVER] != 0) | ((game[:, STRIKER] == AGENT) & (game[:, PHASE] != CHOICE))
    on = np.flatnonzero(~ended)
    if len(on):
        sign = np.where(game[on, STRIKER] == AGENT, 1.0, -1.0)
        lead[on] += sign * value_of(options)(of_tables(tables)[on].as_visits())
    return lead


@lru_cache(maxsize=16)
def _tactician(options: Options) -> Tactician:
    return Tactician().at(options)


def expect_win(tables: Tables, out: StepOutput, options: Options) -> Floats:
    """Of frames: the agent's chance to win, by the tactician."""
    theirs = _tactician(options).chance_to_win(of_tables(tables))
    return np.where(tables.game[:, STRIKER] == AGENT, theirs, 1.0 - theirs)


EXPECTED = {"points": expect_points, "legal": expect_legal, "lead": expect_lead, "won": expect_win}
"""What an episode is expected to bring, for each score of a ``Task``."""


@lru_cache(maxsize=16)
def mean_of_starts(options: Options) -> float | None:
    """The mean of ``value_of`` over all starts of visits that a layout of stored tables deals; None for other layouts."""
    plan = options.rules.plan
    if plan.code[0] != STORED:
        return None
    first, last = plan.code[2:].astype(int)
    each = plan.tables[first:last]
    mirrored = each * (-1.0, 1.0)
    mirrored[:, [YELLOW, GREEN]] = mirrored[:, [GREEN, YELLOW]]
    both = np.concatenate([each, mirrored])
    there = ~np.isnan(both[..., 0])
    balls = np.where(there[..., None], both, SPOTS)
    starts = for_opponent(Positions(balls, there, np.zeros((len(both), VISIT_COLUMNS), np.int64)))
    return float(value_of(options)(starts).mean(dtype=np.float64))


def luck_of(tables: Tables, rows: Ints, turn: Turn, expected: Expected, options: Options) -> Floats:
    """The luck (m,) of the strokes that ``turn`` plays on the tables ``rows`` (m,), which are not changed."""
    lucks, each = np.zeros(len(rows)), 1 + DRAWS
    for first in range(0, len(rows), BATCH // each):
        some = rows[first : first + BATCH // each]
        again = np.repeat(some, each)
        copies = tables.take(again)
        copies.streams.reshape(-1, each, 2)[:, 1:] = fresh_streams(tables.streams[some])
        out = copies.output()
        turn(copies, again, out)
        brought = expected(copies, out, options).reshape(-1, each)
        lucks[first : first + len(some)] = brought[:, 0] - brought[:, 1:].mean(axis=1)
    return lucks


def fresh_streams(streams: Words) -> Words:
    """Random streams (n, DRAWS, 2) of errors that are independent of those that ``streams`` (n, 2) draw next."""
    fresh = np.zeros((len(streams), DRAWS, 2), np.uint64)
    own = decision_seeds(_KEYS, *streams.view(np.int64).T).astype(np.uint64) << np.uint64(32)
    # no seed of a player is that large
    fresh[:, :, 0] = own[:, None] + np.arange(1, 1 + DRAWS, dtype=np.uint64)
    return fresh
