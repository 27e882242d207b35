"""How are episodes played? Side by side. Actions are rounded to float32 before they are played and kept; seeds
of decisions depend on training seed, table and stroke alone, so a player plays alike in any batch."""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._lib.types import Bools, Floats, Ints
from ..envs.vector import SnookerVectorEnv
from ..players import FRAMES, VISITS, Player, ask_player, decision_seeds
from ..players import player as player_named
from ..players.search_player import StrokeValuePlayer
from ..players.seen import SeenPlayer
from ..simulation import count_shots
from .luck_counter import Decide, Luck
from .tasks import Task

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
    foresees: bool = False  # whether the player knows what its strokes do, see ``foresees``

    def add(self, more: "PlayedEpisodes") -> None:
        for name in ("rows", "strokes", "decisions", "seconds", "simulated"):
            setattr(self, name, getattr(self, name) + getattr(more, name))
        self.foresees |= more.foresees


def foresees(player: Player) -> bool:
    """Whether closed forms tell a player what each of its strokes would do: on a menu, or by its own prediction."""
    return isinstance(player, StrokeValuePlayer) or (
        isinstance(player, SeenPlayer) and player.sees.get("observation") == "strokes"
    )


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


Round = tuple[Bools, dict[str, Any], Bools, Bools]  # asked for a stroke; the info after it; done; terminated


def rounds(tables: SnookerVectorEnv, seeds: list[int], decide: Decide) -> Iterator[Round]:
    """Play every table to its end."""
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
    cost = decide.decisions, decide.seconds, decide.simulated
    return PlayedEpisodes(rows, strokes, *cost, foresees(decide.player))


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
