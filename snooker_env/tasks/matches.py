"""How is a match played? Best of N frames, the players break in turn, the next rack follows in the same step.
A frame that the referee stops truncates the match."""

from typing import Any

import numpy as np

from .._types import Ints
from ..game.frame_columns import FIRST_BREAK, FRAMES_0, FRAMES_1, OVER, PAID, SCORE_0, SCORE_1
from ..game.layouts import deal_tables
from . import frame_kernels
from .frame import Frames
from .frame_kernels import AGENT
from .rewards import FRAMES_PAID
from .states import FrameState


class Matches(Frames):
    """n tables, each in the middle of its own match."""

    COUNTS: tuple[str, ...] = (*Frames.COUNTS, "frames_won", "opponent_frames", "frame")

    def go_on(self, which: Ints) -> None:
        """Count the frames that have just ended, and set up the next ones unless the match is decided."""
        ended = which[self.game[which, OVER] != 0]
        if not len(ended):
            return
        goes_on = np.empty(len(ended), np.bool_)
        frame_kernels.count_frames(ended, self.game, self.rules.frames // 2 + 1, goes_on)
        if not len(ended := ended[goes_on]):
            return
        plan = self.rules.plan
        deal_tables(ended, plan.code, plan.tables, self.streams, self.positions, self.on_table)
        alone = len(self.seats) == 1
        frame_kernels.begin_next(ended, alone, self._reward, plan.in_hand, self.on_table, self.game)

    def _worth(self, k):
        if self._reward == FRAMES_PAID:
            return self.game[k, FRAMES_0 + AGENT] - self.game[k, FRAMES_1 - AGENT]
        return self.game[k, SCORE_0 + AGENT] - self.game[k, SCORE_1 - AGENT]

    def get_state(self, k: int) -> dict[str, Any]:
        """See ``Tables.get_state``."""
        won = self.game[k, [FRAMES_0, FRAMES_1]].tolist()
        match = {"frames": won, "first_break": int(self.game[k, FIRST_BREAK]), "best_of": self.rules.frames}
        return super().get_state(k) | match

    def set_state(self, k: int, state: FrameState) -> None:
        """See ``Tables.set_state``."""
        super().set_state(k, state)
        assert state.frames is not None and state.first_break is not None  # ``checked`` has seen to it
        self.game[k, [FRAMES_0, FRAMES_1, FIRST_BREAK]] = *state.frames, state.first_break
        self.game[k, PAID] = self._worth(k) - state.unpaid

    def text(self, k: int) -> str:
        """See ``Tables.text``."""
        won = self.game[k, [FRAMES_0, FRAMES_1]].tolist()
        return f"frames {won[0]} - {won[1]}   {super().text(k)}"
