"""Which policies look at nothing, and must win no task? ``snooker_env.players.degenerate:softest`` and other silly strokes;
``...:constant_67`` plays one choice of ``action="discrete"`` on all tables."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from .._lib.types import Floats, Integers, Ints
from ..game import frame_columns as columns
from ..planning import Positions
from ..planning.positions import PositionsLike
from ..tasks.box_actions import MAX_SPEED, MIN_SPEED
from ..tasks.discrete_actions import SIZE
from .choices import ChoicePlayer, GhostBall
from .player import BoundPlayer, Strokes


class Straight(BoundPlayer):
    """One speed [m/s], straight at the nearest ball that is on, or straight away from the nearest ball."""

    training_shots = 0

    def __init__(self, speed: float, away: bool):
        self.speed, self.away = speed, away

    def play(self, positions: PositionsLike, seeds: Integers) -> Strokes:
        at = Positions.of(positions)
        x, y = np.moveaxis(at.positions - at.positions[:, :1], -1, 0)
        balls = at.on_table.copy() if self.away else at.balls_on
        balls[:, 0] = False
        nearest = np.arange(len(at)), np.where(balls, np.hypot(x, y), np.inf).argmin(axis=1)
        values = np.zeros((len(at), 5))
        values[:, 0], values[:, 3] = self.speed, np.arctan2(y, x)[nearest] + np.pi * self.away
        return Strokes(values)


class PlayAgain(GhostBall):
    """``ghost_ball``, who has the other play again after every foul."""

    def play(self, positions: PositionsLike, seeds: Integers) -> Strokes:
        at = Positions.of(positions)
        again = np.where(at.choice, columns.PLAY_AGAIN, columns.PLAY)
        return replace(super().play(at, seeds), decision=again)


class Constant(ChoicePlayer):
    """One choice of ``action="discrete"`` on every table; after fouls it decides as others do that score choices."""

    training_shots = 0

    def __init__(self, choice: int):
        self.choice = choice

    def scores(self, at: Positions, seeds: Ints) -> Floats:
        return np.tile(np.arange(SIZE) == self.choice, (len(at), 1)).astype(float)


SILLY: dict[str, Callable[[], Any]] = {
    "softest": partial(Straight, MIN_SPEED, away=False),
    "softest_away": partial(Straight, MIN_SPEED, away=True),
    "away": partial(Straight, 2.0, away=True),
    "hardest": partial(Straight, MAX_SPEED, away=False),
    "play_again": PlayAgain,
}
MODULE = f"{__name__}:"
_CONSTANTS = {f"constant_{choice}": choice for choice in range(SIZE)}


def is_degenerate(text: str) -> bool:
    name = text.removeprefix(MODULE)
    return name != text and (name in SILLY or name in _CONSTANTS)


def __getattr__(name: str) -> Callable[[], Any]:
    """What makes the one with a name, for ``sn.player``."""
    if name in _CONSTANTS:
        return partial(Constant, _CONSTANTS[name])
    if name in SILLY:
        return SILLY[name]
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
