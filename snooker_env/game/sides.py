"""How does a player see a frame? Rows from the other side, from the striker's, and as a visit."""

import numpy as np

from .._lib.types import Ints
from . import frame_columns as columns


def swap_sides(game: Ints) -> Ints:
    """Rows of frames (m, COLUMNS) as if the players had changed sides: a new array."""
    other = game.copy()
    for a, b in ((columns.SCORE_0, columns.SCORE_1), (columns.FRAMES_0, columns.FRAMES_1)):
        other[:, a], other[:, b] = game[:, b], game[:, a]
    for column in (columns.STRIKER, columns.BREAKER, columns.FIRST_BREAK):
        other[:, column] = 1 - game[:, column]
    winner = game[:, columns.WINNER]
    other[:, columns.WINNER] = np.where(winner < 0, winner, 1 - winner)
    other[:, columns.PAID] = -game[:, columns.PAID]
    return other


def strikers_own(game: Ints) -> Ints:
    """Rows of frames (m, COLUMNS) with the striker as player 0: a new array."""
    return np.where(game[:, columns.STRIKER, None] == 1, swap_sides(game), game)


def as_visits(game: Ints) -> Ints:
    """Copied rows as a player of visits sees them: free ball as any colour, anywhere as already placed."""
    seen = game.copy()
    free, anywhere = game[:, columns.FREE_BALL] != 0, game[:, columns.ANYWHERE] != 0
    seen[free, columns.BALL_ON] = seen[free, columns.FREE_BALL] = 0
    seen[anywhere, columns.IN_HAND] = seen[anywhere, columns.ANYWHERE] = 0
    return seen
