"""How are the episodes of a task played? Batches of tables side by side, a row of whole numbers for each episode; and one table, timed.

A player has ``options``, how it sees and acts (``FREE``), and ``act(tables, observations, going)``, an action for each table of a
``SnookerVectorEnv`` with flat observations. In a frame a player of visits sees the stroke to come as one of a visit (``AtFrames``); a
player whose attribute ``frames`` is true gets the frames themselves. Episodes are played ``BATCH`` at a time, and a player that has a
method ``begin(seed)`` is called before each batch: so the same episodes are played again alike, however many follow. Box actions
are rounded to float32, the type of the action space, before they are played: what is kept is what was played.
"""

import time
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._check import choice, refuse, refuse_what
from .._shots import simulated
from .._types import Floats, Ints
from ..envs.at_frames import AtFrames
from ..envs.vector import SnookerVectorEnv
from .rollouts import play_visits
from .strokes import Keeper
from .tasks import FREE, Task

BATCH = 100
"""Episodes that are played side by side."""
COLUMNS = ("run", "table", "score", "strokes", "points", "pots", "fouls", "cleared", "opponent_points", "ended")
"""Columns of a row: index of the training seed, seed of the table, then integers that docs/benchmark.md explains."""


@dataclass
class PlayedEpisodes:
    """Episodes that were played, as ``play_episodes`` returns them.

    Attributes
    ----------
    rows : list of list of int
        One row for each episode, columns ``COLUMNS``.
    strokes : list of numpy.ndarray
        The strokes of each episode, one row each: uint16 choices, or float32 box actions.
    decisions : int
        Number of decisions of the player.
    seconds : float
        Time of all decisions [s].
    simulated : int
        Number of shots that this process simulated for the decisions.

    Examples
    --------
    >>> from snooker_env.benchmark import COLUMNS, PlayedEpisodes
    >>> PlayedEpisodes([]).decisions, COLUMNS[:3]
    (0, ('run', 'table', 'score'))
    """

    rows: list[list[int]]
    strokes: list[NDArray[Any]] = field(default_factory=list)
    decisions: int = 0
    seconds: float = 0.0
    simulated: int = 0

    def add(self, more: "PlayedEpisodes") -> None:
        """Add episodes that were played after these.

        Parameters
        ----------
        more : PlayedEpisodes
            The next episodes.

        Returns
        -------
        None
        """
        self.rows += more.rows
        self.strokes += more.strokes
        self.decisions += more.decisions
        self.seconds += more.seconds
        self.simulated += more.simulated


def begin(player: Any, batch: int) -> None:
    """Have a player draw the random numbers of this batch, if it can.

    Parameters
    ----------
    player : object
    batch : int
    """
    inner = getattr(player, "player", player)
    for one in (player, inner):
        if callable(getattr(one, "begin", None)):
            one.begin(batch)
            return


def check_player(player: Any, task: Task) -> None:
    """Raise ValueError unless that is a player, and its options are free in this task.

    Parameters
    ----------
    player : object
    task : Task
    """
    if not isinstance(getattr(player, "options", None), dict) or not callable(getattr(player, "act", None)):
        raise refuse_what("agent", f"a {type(player).__name__}", "must be a player: options (a dict) and act(tables, observations, going)")
    for name in player.options:
        choice("key of options", name, FREE)
    if player.options.get("observation", "flat") != "flat":
        raise refuse("observation", player.options["observation"], 'must be "flat": players get flat observations')
    task.judged(**player.options)


def play_episodes(task: Task, player: Any, seeds: list[int], run: int = 0, threads: int | None = None) -> PlayedEpisodes:
    """Play one episode on each of the judged tables with these seeds, side by side.

    Parameters
    ----------
    task : Task
        The task.
    player : object
        A player, with ``options`` and ``act(tables, observations, going)``.
    seeds : list of int
        Seeds of the tables.
    run : int
        Index of the player's training seed, the first number of each row.
    threads : int, optional
        As in ``SnookerVectorEnv``.

    Returns
    -------
    PlayedEpisodes
        The rows and strokes, and the time and simulated shots of the decisions.

    Examples
    --------
    >>> import numpy as np
    >>> from snooker_env.benchmark import TASKS, play_episodes
    >>> class Soft:
    ...     options = {}
    ...     def act(self, tables, observations, going):
    ...         return np.full((len(going), 4), -1.0)
    >>> task = TASKS["SnookerPotHard-v0"]
    >>> len(play_episodes(task, Soft(), task.seeds(2)).rows)
    2
    """
    return (_frames if task.frame else _visits)(task, player, seeds, run, threads)


def _visits(task, player, seeds, run, threads):
    options = {**task.frozen, "layout": task.judged_layout}  # all of them: whatever a player's options say now, these hold
    keeper = Keeper(player, len(seeds))
    s = play_visits(keeper, len(seeds), first_seed=seeds, threads=threads, **options)
    points, pots, fouls = s.a_visit(s.points), s.a_visit(s.made), s.a_visit(s.foul)
    scores = {"points": points, "pots": pots, "legal": 1 - fouls}
    zeros = np.zeros(len(seeds))
    strokes, cleared = s.a_visit(np.ones(len(s.points))), s.a_visit(s.clears)
    columns = (zeros + run, seeds, scores[task.score], strokes, points, pots, fouls, cleared, zeros, zeros + 1)
    return PlayedEpisodes(np.array(columns).T.astype(int).tolist(), keeper.strokes(), len(s.points), s.decision_seconds, s.simulated)


def _frames(task, player, seeds, run, threads):
    n = len(seeds)
    tables = SnookerVectorEnv(n, task.judged(**player.options), threads=threads)
    keeper = Keeper(player if getattr(player, "frames", False) else AtFrames(player), n)
    observations, _ = tables.reset(seed=seeds)
    going, ended, played = np.ones(n, bool), np.zeros(n, bool), PlayedEpisodes([])
    sums: dict[str, Floats] = {name: np.zeros(n) for name in ("strokes", "pots", "fouls")}
    last: dict[str, Ints] = {name: np.zeros(n, np.int64) for name in ("score", "opponent_score", "winner")}
    while going.any():
        actions, asked = _decided(keeper, tables, observations, going, played)
        observations, _, terminated, truncated, info = tables.step(actions)
        sums["strokes"] += asked
        sums["pots"] += asked & (info["points"] > 0)
        sums["fouls"] += asked & (info["fouls"] != 0)
        done = going & (terminated | truncated)
        for name, values in last.items():
            values[done] = info[name][done]
        ended |= done & terminated
        going &= ~done
    won = (last["winner"] == 0) & ended
    zeros = np.zeros(n)
    columns = (
        zeros + run, seeds, won, sums["strokes"], last["score"], sums["pots"], sums["fouls"], zeros, last["opponent_score"], ended
    )  # fmt: skip
    tables.close()
    played.rows, played.strokes = np.array(columns).T.astype(int).tolist(), keeper.strokes()
    return played


def _decided(player, tables, observations, going, played):
    """The player's actions, and the tables on which it had one to choose; its time and simulated shots are added to what was ``played``.

    A frame that the opponent won before the player's first stroke only needs its last step: any action will do.
    """
    asked = going & ~tables.tables.ended()
    if not asked.any():
        return np.zeros(tables.action_space.shape, tables.action_space.dtype), asked
    began, before = time.perf_counter(), simulated()
    actions = player.act(tables, observations, asked)
    played.seconds += time.perf_counter() - began
    played.simulated += simulated() - before
    played.decisions += int(asked.sum())
    return actions, asked


def one_table(task: Task, player: Any, seeds: list[int], decisions: int) -> PlayedEpisodes:
    """Time decisions on one table: episodes one after the other, until so many decisions have been taken; the first is not counted.

    Parameters
    ----------
    task : Task
    player : object
    seeds : list of int
        Of the tables.
    decisions : int

    Returns
    -------
    PlayedEpisodes
        Without rows.
    """
    tables = SnookerVectorEnv(1, task.judged(**player.options), threads=None, autoreset_mode="Disabled")
    player = AtFrames(player) if task.frame and not getattr(player, "frames", False) else player
    played, going, first = PlayedEpisodes([]), np.ones(1, bool), True
    for seed in seeds:
        observations, _ = tables.reset(seed=seed)
        over = False
        while not over and played.decisions < decisions:
            actions, _ = _decided(player, tables, observations, going, PlayedEpisodes([]) if first else played)
            first = False
            observations, _, terminated, truncated, _ = tables.step(actions)
            over = bool(terminated[0] or truncated[0])
        if played.decisions >= decisions:
            break
    tables.close()
    return played
