"""What does an environment of one table show of it, and how is it saved? Balls, ball on, visit or frame,
options, and states."""

from typing import Any

import numpy as np

from .._types import Bools, Floats
from ..game.balls import BallOn
from ..game.frame import Frame
from ..game.frame_columns import BALL_ON, IN_HAND, POINTS
from ..physics.parameters import Physics
from ..physics.table import Table
from ..tasks.frame import Frames
from ..tasks.noise import Noise
from ..tasks.options import Options
from ..tasks.tables import Tables
from .record import Record
from .reset_options import Start


class ShowsBalls:
    """The balls of an environment with one table."""

    tables: Tables

    @property
    def positions(self) -> Floats:
        """Centres of the balls [m], float64 (22, 2); a copy. Row 0 is the cue ball, 1 to 15 the reds, 16 to
        21 yellow to black."""
        return self.tables.positions[0].copy()

    @property
    def on_table(self) -> Bools:
        """Which balls are on the table, bool (22,); a copy."""
        return self.tables.on_table[0].copy()


class TakesTurns:
    """Whose turn it is in an environment of several agents."""

    _selected: str | None = None

    @property
    def agent_selection(self) -> str:
        """The agent whose turn it is. Before ``reset`` there is none: then AttributeError, as PettingZoo's
        own environments have it."""
        if self._selected is None:
            raise AttributeError(
                "agent_selection cannot be read before reset(): call reset(), then observe(), last() or action_mask()"
            )
        return self._selected

    @agent_selection.setter
    def agent_selection(self, agent: str) -> None:
        self._selected = agent


class OneTable(ShowsBalls):
    """Properties and states of an environment with one table."""

    options: Options
    np_random: np.random.Generator
    _np_random_seed: int | None
    _record: Record
    _seeded: bool

    @property
    def ball_on(self) -> BallOn:
        """What must be struck first, a ``BallOn``."""
        return BallOn(self.tables.game[0, BALL_ON])

    @property
    def in_hand(self) -> bool:
        """Whether the cue ball is in hand, a bool."""
        return bool(self.tables.game[0, IN_HAND])

    @property
    def points(self) -> int:
        """Points of the visit so far, an int; in a frame those of the striker's break."""
        return int(self.tables.game[0, POINTS])

    @property
    def over(self) -> bool:
        """Whether there is no stroke to play, a bool: the visit or frame has ended, was stopped by the
        referee, or has not begun."""
        return bool(self.tables.ended()[0])

    @property
    def on(self) -> int:
        """The balls that may be struck first, as an int with bit i set for ball i."""
        return self.tables.on(0)

    @property
    def frame(self) -> Frame | None:
        """The current ``snooker_env.game.frame.Frame``; None in a visit."""
        return self.tables.frame(0) if isinstance(self.tables, Frames) else None

    @property
    def physics(self) -> Physics:
        """The physical constants, a ``Physics``."""
        return self.options.rules.physics

    @property
    def table(self) -> Table:
        """The table, a ``Table``."""
        return self.options.rules.table

    @property
    def noise(self) -> Noise:
        """The execution noise, a ``Noise``."""
        return self.options.rules.noise

    # states
    # --------------------------------------------------------------------------------------------------------

    def get_state(self) -> dict[str, Any]:
        """Return the whole state between two shots; ``set_state`` restores it exactly.

        Returns JSON types. In a visit: "positions" (22, 2) [m], "on_table" (22,), "ball_on", "in_hand",
        "points", "over", "stream", "rng". In a frame: "positions", "on_table", "frame" (``Frame.to_dict``),
        "strokes", "unpaid", "due", "stream", "rng"; in a match also "frames", "first_break" and "best_of".
        """
        return self.tables.get_state(0) | {"rng": self.np_random.bit_generator.state}

    def set_state(self, state: dict[str, Any]) -> None:
        """Restore a state; the next shot continues identically.

        ``state``: a result of ``get_state``. ValueError if the state is invalid; then nothing has changed.
        """
        self._take(Start(state=self.tables.checked(state, self.np_random)), seed=None)
        self._record.begin_episode()

    def _take(self, start: Start, *, seed: int | None) -> None:
        """Begin from there; the random stream of a state is taken over unless there is a seed."""
        rng = start.take(self.tables, 0)
        if rng is not None and seed is None:
            # Gymnasium's number for "not from a seed"
            self.np_random.bit_generator.state, self._np_random_seed = rng, -1
            self._seeded = True
