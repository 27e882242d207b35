"""How lucky was an episode? The sum of the luck of its strokes (``players.luck``), and of the table that a visit was dealt.

Its expectation is 0: a score less a share of it that was fitted on other tables (``statistics.adjust``) has the expectation of
the score, and varies less [Burch et al., AIVAT, 2018]."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeAlias

import numpy as np

from .._lib.types import Bools, Floats, Ints, Singles
from ..envs.vector import SnookerVectorEnv
from ..planning.positions import of_tables
from ..players.luck import EXPECTED, Expected, Turn, luck_of, mean_of_starts, value_of
from ..tasks.frames import OPPONENT, Asked, Frames, Opponent
from ..tasks.tables import Crew, StepOutput, Tables
from ..tasks.threads import Threads

Decide: TypeAlias = Callable[[Bools, int], Singles]
"""The actions on all tables, of those asked for their stroke of this number."""


class Luck:
    """The luck on the n tables ``envs``, not yet reset, from the agent's point of view: in frames of both sides' strokes, in
    visits also of the table dealt if the mean over all deals is known. ``sums``, float64 (n,): so far, in units of ``score``;
    set it to 0 where an episode begins. ``counts``, bool (n,): tables whose luck is counted, at first all."""

    def __init__(self, envs: SnookerVectorEnv, score: str):
        self.sums: Floats = np.zeros(envs.num_envs)
        self.counts: Bools = np.ones(envs.num_envs, np.bool_)
        self._crew = Threads(envs.threads)
        self._tables, self._options, self._points = envs.tables, envs.options, score == "points"
        self._expected: Expected = EXPECTED[score]
        if isinstance(envs.tables, Frames) and len(envs.tables.seats) > 1:
            agent, other = envs.tables.seats
            assert other.player is not None
            envs.tables.sit([agent, replace(other, player=WatchedOpponent(other.player, self))])

    def watch(self, decide: Decide) -> Decide:
        """The same decisions; the luck of each stroke is added before it is played."""

        def watched(asked: Bools, number: int) -> Singles:
            actions = decide(asked, number)
            if number == 0 and self._points and (mean := mean_of_starts(self._options)) is not None:
                self.sums += value_of(self._options)(of_tables(self._tables)) - mean
            self.note(asked, actions)
            return actions

        return watched

    def note(self, asked: Bools, actions: Floats | Singles) -> None:
        """Add the luck of the strokes that the next step plays with ``actions`` (n, k) on the tables ``asked``, bool (n,)."""
        told = np.asarray(self._options.rules.actions.check(actions, self._tables.n), np.float64)

        def turn(copies: Tables, rows: Ints, out: StepOutput) -> None:
            mine, crew = told[rows], self._crew
            if isinstance(copies, Frames) and len(copies.seats) > 1:
                copies.turn(lambda which, buffers: copies.prepare(which, mine, buffers), out, crew)
            else:
                copies.step(mine, np.zeros(copies.n, np.bool_), out, crew)

        self.add(np.flatnonzero(asked), turn)

    def add(self, rows: Ints, turn: Turn) -> None:
        """Add the luck of the stroke that ``turn`` plays on each of the tables ``rows``."""
        rows = rows[self.counts[rows]]
        if len(rows) and (isinstance(self._tables, Frames) or not self._tables.rules.noise.silent):
            self.sums[rows] += luck_of(self._tables, rows, turn, self._expected, self._options)


class WatchedOpponent:
    """An opponent whose luck is added, too: to the agent's bad, when it is good."""

    def __init__(self, player: Opponent, luck: Luck):
        self.name: str = player.name
        self._player, self._luck = player, luck

    def strokes(self, frames: Frames, which: Ints, crew: Crew) -> Asked:
        asked = self._player.strokes(frames, which, crew)

        def turn(copies: Tables, rows: Ints, out: StepOutput) -> None:
            assert isinstance(copies, Frames)
            theirs: Any = tuple(part[rows] for part in asked)
            carry_out = lambda some, buffers: copies.carry_out(some, theirs, buffers, OPPONENT)  # noqa: E731
            copies.turn(carry_out, out, self._luck._crew)

        self._luck.add(which, turn)
        return asked
