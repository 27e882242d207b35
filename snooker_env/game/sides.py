"""How does a player see a frame? Rows from the other side, from the striker's, and as a visit."""

import numpy as np

from .._types import Ints
from .frame_columns import (
    ANYWHERE,
    BALL_ON,
    BREAKER,
    FIRST_BREAK,
    FRAMES_0,
    FRAMES_1,
    FREE_BALL,
    IN_HAND,
    PAID,
    SCORE_0,
    SCORE_1,
    STRIKER,
    WINNER,
)


def swapped(game: Ints) -> Ints:
    """Rows of frames (m, COLUMNS) as if the players had changed sides: a new array."""
    other = game.copy()
    for a, b in ((SCORE_0, SCORE_1), (FRAMES_0, FRAMES_1)):
        other[:, a], other[:, b] = game[:, b], game[:, a]
    for column in (STRIKER, BREAKER, FIRST_BREAK):
        other[:, column] = 1 - game[:, column]
    other[:, WINNER] = np.where(game[:, WINNER] < 0, game[:, WINNER], 1 - game[:, WINNER])
    other[:, PAID] = -game[:, PAID]
    return other


def strikers_own(game: Ints) -> Ints:
    """Rows of frames (m, COLUMNS) with the striker as player 0: a new array."""
    return np.where(game[:, STRIKER, None] == 1, swapped(game), game)


def as_visits(game: Ints) -> Ints:
    """Copied rows as a player of visits sees them: free ball as any colour, anywhere as already placed."""
    seen = game.copy()
    free, anywhere = game[:, FREE_BALL] != 0, game[:, ANYWHERE] != 0
    seen[free, BALL_ON] = seen[free, FREE_BALL] = 0
    seen[anywhere, IN_HAND] = seen[anywhere, ANYWHERE] = 0
    return seen
