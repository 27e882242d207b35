"""What happens in the visits that a player plays? Every stroke of them, on tables that are the same for every player."""

import time
from dataclasses import dataclass

import numpy as np

from snooker_env import Positions, SnookerVectorEnv
from snooker_env.checks import refuse
from snooker_env.game import BallOn, plan_of
from snooker_env.game import layout as deal
from snooker_env.tasks import OBSERVATION_SIZE

from ..features.pot_features import TOLERANCE, tolerance_of, with_pots

HELD_OUT_SEED = 1_000_000
"""Seed of the first held-out table; table k has this + k."""
CENTURY = 100
"""Points of a visit that make a century break."""
MAXIMUM = 147
"""Points of the largest break from all 15 reds: a black after each."""


@dataclass
class Strokes:
    """All strokes of ``visits`` visits, one entry each, in the order of play."""

    visits: int
    visit: np.ndarray
    """Which visit."""
    number: np.ndarray
    """Which stroke of it, from 0."""
    points: np.ndarray
    """Points scored; 0 for a miss or a foul."""
    foul: np.ndarray
    """Whether it was a foul."""
    ball_on: np.ndarray
    """What was on, a ``BallOn``."""
    cleared: np.ndarray
    """Whether nothing was left to pot."""
    cue: np.ndarray
    """(n, 2) where the cue ball lay afterwards [m]; NaN where it was potted."""
    tolerance: np.ndarray
    """How far the aim of the widest direct pot may err that was there afterwards [rad], by ``game.pots``; 0 where there was none."""
    decision_seconds: float
    """Seconds that the player took for all of them."""

    @property
    def made(self):
        """Whether it scored."""
        return self.points > 0

    @property
    def goes_on(self):
        """Whether it scored and left something to pot."""
        return self.made & ~self.cleared

    @property
    def clears(self):
        """Whether it scored and left nothing: a foul that pots the last ball clears no table."""
        return self.made & self.cleared

    @property
    def colour(self):
        """Whether any colour was on."""
        return self.ball_on == BallOn.ANY_COLOUR

    @property
    def following(self):
        """Which entry is the next stroke of the same visit; -1 after its last."""
        order = np.lexsort((self.number, self.visit))
        same = np.diff(self.visit[order]) == 0
        following = np.full(len(order), -1)
        following[order[:-1][same]] = order[1:][same]
        return following

    def a_visit(self, values):
        """Sums of ``values`` (one a stroke) over each visit."""
        return np.bincount(self.visit, values, self.visits)

    @property
    def followed(self):
        """Of the pots that left something to pot: whether the next stroke pots too, an entry for each."""
        return self.made[self.following[self.goes_on]]


def tables_of(layout, visits):
    """Seeds of as many different tables: the first from ``HELD_OUT_SEED`` on that are not as one before, or as one before in a mirror.

    Raises ValueError if the layout has too few.
    """
    plan, seeds, known = plan_of(layout), [], set()
    for seed in range(HELD_OUT_SEED, HELD_OUT_SEED + 20 * visits):
        positions, _ = deal(plan, np.random.default_rng(seed))
        table = np.sort(np.abs(positions[:, 0])).round(9).tobytes()
        if table not in known:
            known.add(table)
            seeds.append(seed)
            if len(seeds) == visits:
                return seeds
    raise refuse("visits", visits, f"must be at most {len(seeds)} on layout {layout!r}: it has no more tables")


def play(
    player, visits, *, layout="held_out", noise="professional", first_seed: int | list[int | None] = HELD_OUT_SEED, threads=None, **options
):
    """The ``Strokes`` of ``visits`` visits played side by side; ``options`` go to the environment, after the player's own.

    ``first_seed``: of the first table, the next have the seeds after it; or a list with the seed of each.
    """
    tables = SnookerVectorEnv(visits, layout=layout, noise=noise, threads=threads, **{**player.options, **options})
    observations, _ = tables.reset(seed=first_seed)
    log, going, number, decision_seconds = [], np.ones(visits, bool), 0, 0.0
    while going.any():
        ball_on = Positions.of(tables).ball_on[going]
        began = time.perf_counter()
        actions = player.act(tables, observations, going)
        decision_seconds += time.perf_counter() - began
        observations, _, ended, _, info = tables.step(actions)
        here = np.flatnonzero(going)
        left = Positions.of(tables)[here]
        cue = np.where(left.on_table[:, :1], left.positions[:, 0], np.nan)
        log.append(
            (here, np.full(len(here), number), info["points"][here], info["foul"][here] != 0, ball_on, ~left.on_table[:, 1:].any(1), cue,
             _tolerance(observations, here))
        )  # fmt: skip
        going &= ~ended
        number += 1
    tables.close()
    columns = (np.concatenate(column) for column in zip(*log, strict=True))
    names = ("visit", "number", "points", "foul", "ball_on", "cleared", "cue", "tolerance")
    return Strokes(visits=visits, decision_seconds=decision_seconds, **dict(zip(names, columns, strict=True)))


def _tolerance(observations, here):
    """Of the widest pot on each table ``here`` [rad]."""
    widest = with_pots(observations[here])[:, OBSERVATION_SIZE:]
    return np.where(widest[:, 0] > 0, tolerance_of(widest[:, TOLERANCE]), 0.0)


def summary(strokes):
    """The figures of a visit: means, with the standard errors ``_se`` of those over visits; None where nothing of the kind happened."""
    pots, points = strokes.a_visit(strokes.points > 0), strokes.a_visit(strokes.points)
    colours = strokes.points[strokes.colour & (strokes.points > 0)]
    error = lambda x: float(np.std(x, ddof=1) / np.sqrt(len(x))) if len(x) > 1 else None  # noqa: E731
    share = lambda x: float(np.mean(x)) if len(x) else None  # noqa: E731
    fouls = strokes.a_visit(strokes.foul)
    return {
        "visits": strokes.visits, "strokes": len(strokes.points), "pots_a_visit": float(pots.mean()), "pots_a_visit_se": error(pots),
        "points_a_visit": float(points.mean()), "points_a_visit_se": error(points), "pot_rate": share(strokes.points > 0),
        "next_pot_after_a_pot": share(strokes.followed), "fouls_a_visit": float(fouls.mean()), "fouls_a_visit_se": error(fouls),
        "foul_rate": share(strokes.foul), "colour_value": share(colours), "high_colours": share(colours >= 6),
        "centuries": float(np.mean(points >= CENTURY)), "clearances": share(strokes.a_visit(strokes.clears) > 0),
        "longest_break": int(points.max()),
    }  # fmt: skip
