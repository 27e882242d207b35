"""What would strokes of a frame lead to? ``FrameTrials`` plays them on copies of positions by the rules of frames,
and ``turned`` shows positions as their next striker sees them."""

from copy import copy
from dataclasses import replace

import numpy as np

from .._types import Floats, Ints, Words
from ..game import frame_columns as columns
from ..game.ruling import AUTO
from ..game.sides import strikers_own
from ..tasks.frame import Frames
from ..tasks.options import Rules
from ..tasks.rewards import FRAME_REWARDS
from ..tasks.stroke import ShotBuffers
from ..tasks.threads import Threads
from .positions import Positions
from .strokes import Struck


class FrameTrials(Struck, Frames):
    """Frames of one stroke: strokes (n, 5) in SI with errors (n, 5) in standard deviations, judged as in a frame."""

    def __init__(self, rules: Rules, threads: Threads):
        super().__init__(replace(rules, reward=FRAME_REWARDS[0], one_stroke=False), 0)  # of a visit, too
        self._crew, self._out = threads, self.output()

    def play(self, at: Positions, rows: Ints, strokes: Floats, errors: Floats) -> Positions:
        """Play n strokes, each on a copy of ``at[rows]``, and return what they leave: n positions of frames in which
        whoever played is still player 0, so that ``STRIKER`` says who comes next.

        A cue ball in hand is played from where it lies. Decisions after a foul must have been made: rows in that
        phase are played as the table lies."""
        trial, after = copy(self), at[rows]  # a copy: several threads may play at once
        trial.lay(after, np.zeros((len(after), 2), np.uint64), errors)

        def play(which: Ints, buffers: ShotBuffers) -> None:
            trial.address(which, strokes, buffers)
            trial.complete(which, trial._out, buffers, trial._crew, reported=False)

        trial._crew(np.arange(len(after)), play)
        return after

    def lay(self, after: Positions, streams: Words, errors: Floats | None = None) -> None:
        super().lay(after, streams, errors)
        if after.saved is None:
            after.saved = columns.Layouts(after.positions.copy(), after.on_table.copy())
        self._saved_positions, self._saved_on_table = after.saved
        self._played = self._replies = np.zeros(self.n, np.int64)
        self.nominated = np.full(self.n, AUTO, np.int64)


def turned(after: Positions) -> Positions:
    """The same positions as their next strikers see them: a copy of the game, the balls are shared."""
    return Positions(after.positions, after.on_table, strikers_own(after.game), after.saved, after.conditions)
