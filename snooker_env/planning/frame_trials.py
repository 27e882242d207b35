"""What would strokes of a frame lead to? ``FrameTrials`` plays them on copies of positions by the rules of frames,
and ``turned`` shows positions as their next striker sees them."""

from copy import copy
from dataclasses import replace
from typing import Any

import numpy as np

from .._types import Floats, Ints
from ..game import frame_columns as columns
from ..game.ruling import AUTO
from ..game.sides import strikers_own
from ..tasks.frame import Frames
from ..tasks.options import Rules
from ..tasks.stroke import ShotBuffers
from ..tasks.threads import Threads
from .positions import Positions
from .strokes import Struck, packed_under


class FrameTrials(Struck, Frames):
    """Frames of one stroke: strokes (n, 5) in SI with errors (n, 5) in standard deviations, judged as in a frame."""

    def __init__(self, rules: Rules, threads: Threads):
        super().__init__(replace(rules, drawn=False, observed=False), 0)
        self._crew, self._out = threads, self.output()

    def play(self, at: Positions, rows: Ints, strokes: Floats, errors: Floats) -> Positions:
        """Play n strokes, each on a copy of ``at[rows]``, and return what they leave: n positions of frames in which
        whoever played is still player 0, so that ``STRIKER`` says who comes next.

        A cue ball in hand is played from where it lies. Decisions after a foul must have been made: rows in that
        phase are played as the table lies."""
        trial, after = copy(self), at[rows]  # a copy: several threads may play at once
        trial.lay(after, errors)

        def play(which: Ints, buffers: ShotBuffers) -> None:
            trial.address(which, strokes, buffers)
            trial.complete(which, trial._out, buffers, trial._crew, reported=False)

        trial._crew(np.arange(len(after)), play)
        return after

    def lay(self, after: Positions, errors: Floats) -> None:
        """Put positions of frames on the tables; they are played in place."""
        n = self.n = len(after)
        self.errors, self.streams = errors, np.zeros((n, 2), np.uint64)
        if after.conditions is not None:
            self.packed = packed_under(after.conditions, self.rules)
            self.packs = (self.packed,)
        self.positions, self.on_table, self.game = after.positions, after.on_table, after.game
        saved: Any = after.saved
        if saved is None:
            saved = columns.Layouts(after.positions.copy(), after.on_table.copy())
            after.saved = saved
        self._saved_positions, self._saved_on_table = saved
        self._played = self._replies = np.zeros(n, np.int64)
        self.nominated = np.full(n, AUTO, np.int64)


def turned(after: Positions) -> Positions:
    """The same positions as their next strikers see them: a copy of the game, the balls are shared."""
    return Positions(after.positions, after.on_table, strikers_own(after.game), after.saved, after.conditions)
