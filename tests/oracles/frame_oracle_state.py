"""What does the oracle of frames know of a frame, a stroke and a verdict? Its data, as ``frame_oracle_rules``
explains them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

REDS, COLOURS = range(1, 16), range(16, 22)
ANY, RED, YELLOW, PINK, BLACK = 0, 1, 2, 6, 7


def value(ball: int) -> int:
    """Points of a ball."""
    return 1 if ball in REDS else ball - 14 if ball in COLOURS else 0


@dataclass
class State:
    """A frame between two strokes."""

    positions: np.ndarray
    on_table: np.ndarray
    scores: list[int]
    striker: int
    ball_on: int
    in_hand: bool
    free_ball: bool = False
    respotted_black: bool = False
    phase: str = "stroke"
    winner: int | None = None
    break_points: int = 0
    miss_called: bool = False
    failures: int = 0
    warned: bool = False
    saved: State | None = None
    misses: int = 0
    """Calls of a miss in succession, in six-red snooker."""
    clock: int = 0
    """Time played, in the Shoot Out [ms]."""
    anywhere: bool = False
    """Whether the cue ball in hand may stand anywhere, not in the D alone."""

    @property
    def balls(self) -> list[int]:
        """Ids of the object balls on the table."""
        return [int(i) for i in np.flatnonzero(self.on_table) if i]

    @property
    def reds(self) -> int:
        """Number of reds on the table."""
        return sum(i in REDS for i in self.balls)

    def on(self) -> list[int]:
        """The balls that may be struck first, a free ball left out."""
        if self.ball_on == RED:
            return [i for i in self.balls if i in REDS]
        if self.ball_on == ANY:
            return [i for i in self.balls if i in COLOURS]
        return [self.ball_on + 14]

    def next_on(self) -> int:
        """What is on for a player who comes to the table (Section 3 Rule 3)."""
        if self.reds:
            return RED
        return min(self.balls) - 14 if self.balls else -1


@dataclass
class Stroke:
    """What happened in a stroke."""

    cue: np.ndarray
    """Where the cue ball was struck [m]."""
    first: list[int]
    """Balls that the cue ball struck first, more than one if at the same time."""
    potted: list[int]
    rest: np.ndarray
    """Where the balls came to rest [m]."""
    leaving: list[tuple[int, float]] = field(default_factory=list)
    """The balls that the cue ball struck before its first cushion, and when [s]."""
    velocity: np.ndarray = field(default_factory=lambda: np.zeros(2))
    """Of the cue ball as it is struck [m/s]."""
    path: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    """Of the cue ball's centre up to its first impact with a ball, or to rest, at close points [m]; only for
    ``miss="attempt"``."""
    among: Callable[[list[int]], np.ndarray] | None = None
    """``path``, had only these balls been on the table beside the cue ball."""
    nominated: int | None = None
    """The colour named; None where players name none and the one struck first counts."""
    cushion: bool = True
    """Whether any ball met a cushion or a jaw; only for the Shoot Out."""
    duration: int = 0
    """How long the balls ran; only for the Shoot Out [ms]."""


@dataclass
class Verdict:
    """What the referee says of a stroke."""

    fouls: set[str] = field(default_factory=set)
    penalty: int = 0
    points: int = 0
    spotted: list[int] = field(default_factory=list)
    unsure: set[str] = field(default_factory=set)
    """Names of what rounding decides."""
    notes: set[str] = field(default_factory=set)
    """What else was exercised."""


@dataclass(frozen=True)
class Rules:
    """The options of a frame."""

    miss: str = "off"
    nominate: bool = False
    concede: bool = False
    claim: bool = False
    lot: bool = False
    game: str = "snooker"
    time_to_play: int = 9000
    """Of the Shoot Out [ms]."""
