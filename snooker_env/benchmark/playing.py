"""How are episodes and visits played? Side by side. Actions are rounded to float32 before they are played and kept;
seeds of decisions depend on training seed, table and stroke alone, so a player plays alike in any batch."""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._lib.types import Bools, Floats, Ints, Singles
from ..envs.vector import SnookerVectorEnv
from ..planning import Positions, pots
from ..players import FRAMES, VISITS, Player, ask_player, decision_seeds
from ..players import player as player_named
from ..players.search_player import StrokeValuePlayer
from ..players.seen import SeenPlayer
from ..simulation import count_shots
from .luck_counter import Decide, Luck
from .tasks import HELD_OUT_SEED, Task

BATCH = 100  # episodes that are played side by side
SUMS = ("strokes", "points", "pots", "fouls")
COLUMNS = ("run", "table", "score", *SUMS, "cleared", "opponent_points", "ended", "luck")
"""Columns of a row: index of the training seed, seed of the table, then integers (docs/benchmark_files.md)."""
STROKES = COLUMNS.index("strokes")
PARTS = 1000  # the column luck counts thousandths of the score
Kept = list[NDArray[np.float32]]  # the strokes of each episode: its actions, one row each


@dataclass
class PlayedEpisodes:
    """Episodes that were played, as ``play_episodes`` returns them."""

    rows: list[list[int]]  # one for each episode, columns ``COLUMNS``
    strokes: Kept = field(default_factory=list)  # float32 (strokes, size), actions that hold all of a stroke
    decisions: int = 0  # of the player
    seconds: float = 0.0  # time of all of them [s]
    simulated: int = 0  # shots that this process simulated for them
    foresees: bool = False  # whether the player knows what each of its strokes would do, by closed forms

    def add(self, more: "PlayedEpisodes") -> None:
        for name in ("rows", "strokes", "decisions", "seconds", "simulated"):
            setattr(self, name, getattr(self, name) + getattr(more, name))
        self.foresees |= more.foresees


class Decider:
    """Asks a player at tables; rounds, keeps and times its decisions, and counts its simulated shots."""

    def __init__(self, player: Player | str, tables: SnookerVectorEnv, seeds: Sequence[int], seed: int):
        self.player: Player = player_named(player).at(tables)
        self.decisions: int = 0
        self.seconds: float = 0.0
        self.simulated: int = 0
        self._tables, self._seeds, self._seed = tables, np.asarray(seeds, np.int64), seed
        self._log: list[tuple[Ints, NDArray[np.float32]]] = []

    def __call__(self, asked: Bools, number: int) -> NDArray[np.float32]:
        """The actions on all tables: the player's on those ``asked`` for their stroke ``number``, else 0."""
        began, before = time.perf_counter(), count_shots()
        seeds = decision_seeds(self._seed, self._seeds, number)
        actions = ask_player(self.player, self._tables, asked, seeds).astype("<f4")
        self.seconds += time.perf_counter() - began
        self.simulated += count_shots() - before
        self.decisions += int(asked.sum())
        self._log.append((np.flatnonzero(asked), actions[asked]))
        return actions

    def strokes(self) -> Kept:
        tables, actions = (np.concatenate(part) for part in zip(*self._log, strict=True))
        ends = np.cumsum(np.bincount(tables, minlength=len(self._seeds)))
        return np.split(actions[np.argsort(tables, kind="stable")], ends[:-1])


class Repeater:
    """Replays the strokes of a file, and notes which episodes go on after their last stroke (``short``)."""

    def __init__(self, strokes: Kept, size: int):
        self._strokes, self._size = strokes, size
        self.short: Bools = np.zeros(len(strokes), np.bool_)

    def __call__(self, asked: Bools, number: int) -> NDArray[np.float32]:
        """The next stroke of each episode; zeros after the last."""
        actions = np.zeros((len(asked), self._size), "<f4")
        for k in np.flatnonzero(asked).tolist():
            if number < len(self._strokes[k]):
                actions[k] = self._strokes[k][number]
            else:
                self.short[k] = True
        return actions


def rounds(
    tables: SnookerVectorEnv, seeds: list[int], decide: Decide
) -> Iterator[tuple[Bools, dict[str, Any], Bools, Bools]]:
    """Play every table to its end: which were asked for a stroke, the info after it, which are done, and by the rules."""
    tables.reset(seed=[*seeds])
    going, number = np.ones(tables.num_envs, np.bool_), 0
    while going.any():
        # a frame that the opponent has won already only needs its last step
        asked = going & ~tables.tables.are_over()
        actions = (
            decide(asked, number) if asked.any() else np.zeros(tables.action_space.shape or (), np.float32)
        )
        _, _, terminated, truncated, info = tables.step(actions)
        done = going & (terminated | truncated)
        yield asked, info, done, terminated
        going &= ~done
        number += 1


def tables_for(task: Task, n: int, threads: int | None = None) -> SnookerVectorEnv:
    """Make n judged tables whose actions hold every part of a stroke."""
    return SnookerVectorEnv(n, task.judged_options(**(FRAMES if task.frame else VISITS)), threads=threads)


def play_episodes(
    task: Task,
    player: Player | str,
    seeds: list[int],
    run: int = 0,
    threads: int | None = None,
    *,
    lucky: bool = True,
) -> PlayedEpisodes:
    """Play one episode on each of the judged tables with these seeds, side by side; ``run``: the training seed's index;
    ``lucky``: whether their luck is computed."""
    tables = tables_for(task, len(seeds), threads)
    decide = Decider(player, tables, seeds, run)
    rows = rows_of(task, tables, seeds, decide, run, lucky=lucky)
    strokes = decide.strokes() if decide.decisions else [np.empty((0, 0), np.float32)] * len(seeds)
    cost, who = (decide.decisions, decide.seconds, decide.simulated), decide.player
    menu = isinstance(who, SeenPlayer) and who.sees.get("observation") == "strokes"
    return PlayedEpisodes(rows, strokes, *cost, foresees=menu or isinstance(who, StrokeValuePlayer))


def rows_of(
    task: Task,
    tables: SnookerVectorEnv,
    seeds: list[int],
    decide: Decide,
    run: int = 0,
    *,
    lucky: bool = True,
) -> list[list[int]]:
    """The rows of the episodes with these seeds, as ``decide`` plays them."""
    n = len(seeds)
    luck = Luck(tables, task.score) if lucky else None
    decide = decide if luck is None else luck.watch(decide)
    sums: dict[str, Floats] = {name: np.zeros(n) for name in SUMS}
    cleared, ended, won, opponent = np.zeros((4, n))
    for asked, info, done, terminated in rounds(tables, seeds, decide):
        scored = asked & (info["points"] > 0)
        sums["strokes"] += asked
        sums["points"] += np.where(asked, info["points"], 0)
        sums["pots"] += scored
        sums["fouls"] += asked & info["foul"]
        ended[done] = terminated[done]
        if luck is not None:
            luck.counts[done] = False  # the table goes on with another episode
        if task.frame:
            won[done] = (info["winner"] == 0)[done] & terminated[done]
            sums["points"][done], opponent[done] = info["score"][done], info["opponent_score"][done]
        else:
            cleared[done] = (scored & ~tables.tables.on_table[:, 1:].any(axis=1))[done]
    tables.close()
    scores = {"points": sums["points"], "legal": 1 - sums["fouls"], "won": won}
    scores["lead"] = sums["points"] - opponent
    parts = np.zeros(n) if luck is None else np.round(PARTS * luck.sums)
    columns = (np.full(n, run), seeds, scores[task.score], *sums.values(), cleared, opponent, ended, parts)
    return np.array(columns).T.astype(int).tolist()


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
    return PlayedStrokes(visits, *columns, decision_seconds=decide.seconds)
