"""What happens in the visits that a player plays? Every stroke on the same tables for all, and counts."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .._lib.types import Bools, Floats, Ints, Singles
from ..envs.vector import SnookerVectorEnv
from ..game.balls import BallOn
from ..game.layouts import POT_WINDOWS
from ..planning import Positions, pots
from ..players import VISITS, Player
from .luck_counter import Luck
from .playing import Decider, rounds
from .statistics import adjust
from .tasks import HELD_OUT_SEED

CENTURY, MAXIMUM = 100, 147  # points of a century break, and of the largest with 15 reds
EASY = POT_WINDOWS["easy"][0]
HIGH = 6  # pink and black are colours of high value
FIGURES = {
    **{f"{name}_a_visit": (name, "visits") for name in ("points", "adjusted", "pots", "fouls")},
    **{name: (name, "visits") for name in ("centuries", "maximums", "clearances")},
    "pot_rate": ("pots", "strokes"),
    "next_pot_after_a_pot": ("followed", "goes_on"),
    "easy_pot_left_by_a_pot": ("easy", "goes_on"),
    "colour_value": ("colour_points", "colours"),
    "high_colours": ("high", "colours"),
    "high_colour_after_a_red": ("high_after_red", "reds"),
}
"""Each is a ratio of two sums over visits, see ``counts``. "adjusted": points less luck, see ``luck``."""


@dataclass
class PlayedStrokes:
    """All n strokes of a number of visits, in the order of play."""

    visits: int
    visit: Ints  # (n,): index of the visit of each stroke
    number: Ints  # (n,): its number in the visit, from 0
    points: Floats  # (n,): scored; 0 for a miss or a foul
    foul: Bools  # (n,)
    ball_on: Ints  # (n,): a ``BallOn``
    cleared: Bools  # (n,): whether no object ball was left
    cue: Floats  # (n, 2): position of the cue ball after the stroke [m]; NaN if it was potted
    tolerance: Floats  # (n,): of the aim of the widest direct pot after the stroke [rad]; 0 if there was none
    luck: Floats  # (n,): points, and value of the position left, less their mean over fresh errors; at first also of the deal
    decision_seconds: float  # of all decisions of the player [s]
    simulated: int = 0  # shots that this process simulated for them

    @property
    def has_scored(self) -> Bools:
        """Whether each stroke scored: bool (n,)."""
        return self.points > 0

    @property
    def goes_on(self) -> Bools:
        """Whether each stroke scored and left an object ball: bool (n,)."""
        return self.has_scored & ~self.cleared

    @property
    def following(self) -> Ints:
        """Index of the next stroke of the same visit; -1 after its last: int64 (n,)."""
        order = np.lexsort((self.number, self.visit))
        same = np.diff(self.visit[order]) == 0
        following = np.full(len(order), -1)
        following[order[:-1][same]] = order[1:][same]
        return following

    def a_visit(self, values: Floats | Bools) -> Floats:
        """Sums over each visit, float64 (visits,), of values of each stroke, float (n,)."""
        return np.asarray(np.bincount(self.visit, values, self.visits), np.float64)


def play_visits(
    player: Player | str,
    visits: int,
    *,
    first_seed: int | Sequence[int] = HELD_OUT_SEED,
    seed: int = 0,
    threads: int | None = None,
    each: Callable[[int], None] | None = None,
    **options: object,
) -> PlayedStrokes:
    """Play visits side by side and record every stroke.

    Parameters
    ----------
    player, visits : Player or str, int
        The player or its name; the number of visits.
    first_seed : int or sequence of int
        Seed of the first table (the others use the seeds that follow), or the seed of each table.
    seed : int
        Seed of the player's random numbers, which do not depend on the other tables.
    threads : int, optional
        As in ``SnookerVectorEnv``.
    each : callable, optional
        Called after each round of strokes with the number of visits that still go on.
    **options
        Options of the environment; defaults: the layout "held_out" and "professional" noise. The player's strokes are
        played exactly, whatever the options say about actions.

    Returns
    -------
    PlayedStrokes
        Arrays (n,) of all n strokes in the order of play, among them ``visit``, ``points``, ``foul``, ``cleared`` and
        ``luck`` [points]; ``a_visit(values)`` sums their values over visits, float64 (visits,).

    Examples
    --------
    >>> from snooker_env.benchmark import play_visits
    >>> play_visits("ghost_ball", 3, layout="colours").visit.tolist()[:3]
    [0, 1, 2]
    """
    seeds = list(range(first_seed, first_seed + visits)) if isinstance(first_seed, int) else list(first_seed)
    every: dict[str, Any] = {"layout": "held_out", "noise": "professional", **options}
    every |= {"action": "box", "observation": "flat", **VISITS}
    tables = SnookerVectorEnv(visits, threads=threads, **every)
    decide, log, ball_on = Decider(player, tables, seeds, seed), [], np.empty(0, np.int64)
    luck, before = Luck(tables, "points"), np.zeros(visits)

    def note_ball_on(asked: Bools, number: int) -> Singles:
        nonlocal ball_on
        ball_on = Positions.of(tables).ball_on[asked]
        return decide(asked, number)

    for number, (asked, info, done, _) in enumerate(rounds(tables, seeds, luck.watch(note_ball_on))):
        here = np.flatnonzero(asked)
        left = Positions.of(tables)[here]
        cue = np.where(left.on_table[:, :1], left.positions[:, 0], np.nan)
        outcome = info["points"][here], info["foul"][here], ball_on, ~left.on_table[:, 1:].any(1), cue
        widest, gained, before = pots(left, most=1).tolerance[:, 0], luck.sums - before, luck.sums.copy()
        log.append((here, np.full(len(here), number), *outcome, widest, gained[here]))
        if each is not None:
            each(int(asked.sum() - done.sum()))
    tables.close()
    columns = [np.concatenate(column) for column in zip(*log, strict=True)]
    return PlayedStrokes(visits, *columns, decision_seconds=decide.seconds, simulated=decide.simulated)


def counts(s: PlayedStrokes) -> dict[str, Floats]:
    """Points, pots, fouls and more of each visit (visits,): both terms of every ratio of ``FIGURES``."""
    next_points = np.append(s.points, 0.0)[s.following]  # of the stroke after; 0 after the last
    red, colour = s.has_scored & (s.ball_on == BallOn.RED), s.has_scored & (s.ball_on == BallOn.ANY_COLOUR)
    entries = {
        "points": s.points,
        "pots": s.has_scored,
        "strokes": np.ones(len(s.points)),
        "fouls": s.foul,
        "goes_on": s.goes_on,
        "followed": s.goes_on & (next_points > 0),
        "easy": s.goes_on & (s.tolerance >= EASY),
        "colours": colour,
        "colour_points": colour * s.points,
        "high": colour & (s.points >= HIGH),
        "reds": red,
        "high_after_red": red & (next_points >= HIGH),
        "clearances": s.has_scored & s.cleared,  # a foul clears no table
    }
    sums = {name: s.a_visit(values) for name, values in entries.items()}
    sums["adjusted"] = adjust(sums["points"][None], s.a_visit(s.luck)[None])[0]
    for name, least in (("centuries", CENTURY), ("maximums", MAXIMUM)):
        sums[name] = (sums["points"] >= least).astype(float)
    return sums | {"visits": np.ones(s.visits)}


def summary(strokes: PlayedStrokes) -> dict[str, Any]:
    """Mean figures of visits by name, None where a mean has no cases. Names that end in "_se" are standard errors over visits."""
    each = counts(strokes)
    totals = {name: float(values.sum()) for name, values in each.items()}
    means: dict[str, Any] = {
        name: totals[above] / totals[below] if totals[below] else None
        for name, (above, below) in (FIGURES | {"foul_rate": ("fouls", "strokes")}).items()
        if name not in ("maximums", "easy_pot_left_by_a_pot", "high_colour_after_a_red")
    }
    for name in ("pots", "points", "adjusted", "fouls"):
        spread = float(np.std(each[name], ddof=1) / np.sqrt(strokes.visits)) if strokes.visits > 1 else None
        means[f"{name}_a_visit_se"] = spread
    longest = int(each["points"].max())
    return {"visits": strokes.visits, "strokes": len(strokes.points), **means, "longest_break": longest}
