"""What happens in the visits that a player plays? Every stroke of them, on tables that are the same for every player."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .._shots import simulated
from .._types import Bools, Floats, Ints
from ..envs.vector import SnookerVectorEnv
from ..game.balls import BallOn
from ..planning import Positions, pots
from ..players import VISITS, Player, decided, decision_seeds
from .tasks import HELD_OUT_SEED

CENTURY = 100
"""Points of a century break."""
MAXIMUM = 147
"""Points of the largest break with 15 reds: a black after each red, then the colours."""


@dataclass
class Strokes:
    """All strokes of a number of visits, in the order of play, as ``play_visits`` returns them.

    Attributes
    ----------
    visits : int
        Number of visits.
    visit : int64 (n,)
        Index of the visit of each stroke.
    number : int64 (n,)
        Number of the stroke in its visit, from 0.
    points : float64 (n,)
        Points scored; 0 for a miss or a foul.
    foul : bool (n,)
        Whether the stroke was a foul.
    ball_on : int64 (n,)
        The ball on, a ``BallOn``.
    cleared : bool (n,)
        Whether no object ball was left.
    cue : float64 (n, 2)
        Position of the cue ball after the stroke [m]; NaN if it was potted.
    tolerance : float64 (n,)
        Tolerance of the aim of the widest direct pot after the stroke [rad]; 0 if there was none.
    decision_seconds : float
        Time of all decisions of the player [s].
    simulated : int
        Number of shots that this process simulated for the decisions.

    Examples
    --------
    >>> import snooker_env as sn
    >>> from snooker_env.benchmark import play_visits
    >>> strokes = play_visits(sn.player("ghost_ball"), 2, layout="colours")
    >>> strokes.visits, strokes.a_visit(strokes.points).shape
    (2, (2,))
    """

    visits: int
    visit: Ints
    number: Ints
    points: Floats
    foul: Bools
    ball_on: Ints
    cleared: Bools
    cue: Floats
    tolerance: Floats
    decision_seconds: float
    simulated: int = 0

    @property
    def made(self) -> Bools:
        """Whether each stroke scored: bool (n,)."""
        return self.points > 0

    @property
    def goes_on(self) -> Bools:
        """Whether each stroke scored and left an object ball: bool (n,)."""
        return self.made & ~self.cleared

    @property
    def clears(self) -> Bools:
        """Whether each stroke scored and left no object ball: bool (n,). A foul that pots the last ball clears no table."""
        return self.made & self.cleared

    @property
    def colour(self) -> Bools:
        """Whether any colour was on, for each stroke: bool (n,)."""
        return self.ball_on == BallOn.ANY_COLOUR

    @property
    def following(self) -> Ints:
        """Index of the next stroke of the same visit; -1 after its last: int64 (n,)."""
        order = np.lexsort((self.number, self.visit))
        same = np.diff(self.visit[order]) == 0
        following = np.full(len(order), -1)
        following[order[:-1][same]] = order[1:][same]
        return following

    def a_visit(self, values: Any) -> Floats:
        """Sum values over each visit.

        Parameters
        ----------
        values : array_like, float (n,)
            One value for each stroke.

        Returns
        -------
        float64 (visits,)
            The sums.
        """
        return np.asarray(np.bincount(self.visit, values, self.visits), np.float64)

    @property
    def followed(self) -> Bools:
        """For each pot that left an object ball: whether the next stroke scores too, bool (k,)."""
        return self.made[self.following[self.goes_on]]


def play_visits(
    player: Player,
    visits: int,
    *,
    layout: str = "held_out",
    noise: Any = "professional",
    first_seed: int | Sequence[int] = HELD_OUT_SEED,
    seed: int = 0,
    threads: int | None = None,
    each: Callable[[int], None] | None = None,
    after: Callable[[Any], None] | None = None,
    **options: Any,
) -> Strokes:
    """Play visits side by side and record every stroke.

    Parameters
    ----------
    player : Player
        The player, not bound yet.
    visits : int
        Number of visits.
    layout, noise
        As in ``Options``.
    first_seed : int or sequence of int
        Seed of the first table, the others have the seeds after it; or the seed of each table.
    seed : int, optional
        Seed of what the player draws; default 0. A table's strokes depend on it and on the table's own seed alone.
    threads : int, optional
        As in ``SnookerVectorEnv``.
    each : callable, optional
        Called after each round of strokes with the number of visits that still go on.
    after : callable, optional
        Called with the environment after each decision, before its strokes are played.
    **options
        Other options of the environment.

    Returns
    -------
    Strokes
        All strokes of the visits.

    Examples
    --------
    >>> import snooker_env as sn
    >>> from snooker_env.benchmark import play_visits
    >>> play_visits(sn.player("ghost_ball"), 3, layout="colours").visit.tolist()[:3]
    [0, 1, 2]
    """
    seeds = first_seed + np.arange(visits) if isinstance(first_seed, int) else np.array(first_seed, np.int64)
    tables = SnookerVectorEnv(visits, layout=layout, noise=noise, threads=threads, **{**VISITS, **options})
    tables.reset(seed=seeds.tolist())
    bound = player.at(tables)
    log, going, number, decision_seconds, shots = [], np.ones(visits, bool), 0, 0.0, 0
    while going.any():
        ball_on = Positions.of(tables).ball_on[going]
        began, before = time.perf_counter(), simulated()
        actions = decided(bound, tables, going, decision_seeds(seed, seeds, number)).astype(np.float32)
        decision_seconds += time.perf_counter() - began
        shots += simulated() - before
        if after is not None:
            after(tables)
        _, _, ended, _, info = tables.step(actions)
        here = np.flatnonzero(going)
        left = Positions.of(tables)[here]
        cue = np.where(left.on_table[:, :1], left.positions[:, 0], np.nan)
        log.append(
            (here, np.full(len(here), number), info["points"][here], info["foul"][here] != 0, ball_on, ~left.on_table[:, 1:].any(1), cue,
             pots(left, most=1).tolerance[:, 0])
        )  # fmt: skip
        going &= ~ended
        number += 1
        if each is not None:
            each(int(going.sum()))
    tables.close()
    columns = [np.concatenate(column) for column in zip(*log, strict=True)]
    return Strokes(visits, *columns, decision_seconds=decision_seconds, simulated=shots)


def summary(strokes: Strokes) -> dict[str, Any]:
    """Mean figures of visits.

    Parameters
    ----------
    strokes : Strokes
        All strokes of the visits.

    Returns
    -------
    dict of str to float, int or None
        Points, pots, fouls and other means by name. Names that end in "_se" are standard errors over visits. None where a mean has no
        cases.

    Examples
    --------
    >>> import snooker_env as sn
    >>> from snooker_env.benchmark import play_visits, summary
    >>> summary(play_visits(sn.player("ghost_ball"), 3, layout="colours"))["visits"]
    3
    """
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
