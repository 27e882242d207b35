"""What does the agent observe? The balls and the state of the game, as float32 arrays in [-1, 1]."""

import numpy as np
from gymnasium import spaces

from .._check import choice
from .._jit import kernel
from .._types import Observation, ObservationKind, Singles
from ..game.balls import N_BALLS, REDS_MASK, VALUES, bits, count
from ..geometry import HALF_LENGTH, HALF_WIDTH

OBSERVATIONS = ("flat", "balls")
"""The kinds of observations: "flat", one array; "balls", a dict of two arrays."""
BALL_COLUMNS = ("x", "y", "on_table", "value", "ball_on")
"""Columns of the table of balls: x / 0.889 m and y / 1.7845 m (0 when off the table), 1 if on the table, value / 7, 1 if it may be struck
first (a ball on).
"""
STATE_ENTRIES = (
    "reds", "any_colour", "red", "yellow", "green", "brown", "blue", "pink", "black", "in_hand", "break",
)  # fmt: skip
"""Entries of the state of the game: reds left / 15; the ball on as one-hot, from "any_colour" to "black"; 1 if the cue ball is in hand;
points of this break / 155.
"""

FRAME_ENTRIES = (
    "score", "opponent_score", "lead", "available", "to_play", "free_ball", "choice", "miss_called", "respotted_black",
)  # fmt: skip
"""Entries that a frame adds, from one player's point of view: his score, the opponent's score and the difference, each / 155; points on the
table / 147; all clipped to [-1, 1]. Then flags: it is his turn, the striker has a free ball, the opponent has just fouled (a decision is
open), the foul was called a miss, the black was re-spotted. With a free ball, "ball_on" is 1 for every colour too.
"""

_COLUMNS = len(BALL_COLUMNS)
BALLS_SIZE = N_BALLS * _COLUMNS
"""Numbers in the table of balls, the first part of a flat observation."""
SIZE = BALLS_SIZE + len(STATE_ENTRIES)
"""Numbers in the flat observation of a visit (121). Public as ``snooker_env.tasks.OBSERVATION_SIZE``."""
FRAME_SIZE = SIZE + len(FRAME_ENTRIES)
"""Numbers in the flat observation of a frame (130)."""


def space(kind: ObservationKind, *, frame: bool = False) -> spaces.Box | spaces.Dict:
    """Return the observation space.

    Parameters
    ----------
    kind : {"flat", "balls"}
        "flat": a Box with shape (121,); "balls": a Dict of the boxes "balls" (22, 5) and "state" (11,).
    frame : bool, optional
        Whether the nine entries of a frame follow the eleven of a visit: shapes (130,) and (20,). Default False.

    Returns
    -------
    gymnasium.spaces.Box or gymnasium.spaces.Dict
        The space of float32 numbers in [-1, 1].

    Raises
    ------
    ValueError
        For another kind.

    Examples
    --------
    >>> from snooker_env.tasks import observation_space
    >>> observation_space("flat").shape
    (121,)
    """
    choice("observation", kind, OBSERVATIONS)
    entries = len(STATE_ENTRIES) + (len(FRAME_ENTRIES) if frame else 0)
    balls = spaces.Box(-1.0, 1.0, (N_BALLS, len(BALL_COLUMNS)), np.float32)
    state = spaces.Box(-1.0, 1.0, (entries,), np.float32)
    if kind == "balls":
        return spaces.Dict({"balls": balls, "state": state})
    return spaces.Box(-1.0, 1.0, (N_BALLS * len(BALL_COLUMNS) + entries,), np.float32)


@kernel
def observe_into(row, positions, on_table, ball_on, on, in_hand, points):
    """Write the flat observation (SIZE,) float32. ``ball_on``: a BallOn, ``on``: the mask of the balls on, ``points``: the break so far."""
    for i in range(N_BALLS):
        at, here = i * _COLUMNS, on_table[i]
        row[at] = min(1.0, max(-1.0, positions[i, 0] / HALF_WIDTH)) if here else 0.0
        row[at + 1] = min(1.0, max(-1.0, positions[i, 1] / HALF_LENGTH)) if here else 0.0
        row[at + 2] = 1.0 if here else 0.0
        row[at + 3] = VALUES[i] / 7.0
        row[at + 4] = (on >> i) & 1
    for at in range(BALLS_SIZE, SIZE):
        row[at] = 0.0
    row[BALLS_SIZE] = count(bits(on_table) & REDS_MASK) / 15.0
    if ball_on >= 0:
        row[BALLS_SIZE + 1 + ball_on] = 1.0
    row[BALLS_SIZE + 9] = in_hand
    row[BALLS_SIZE + 10] = points / 155.0


def shaped(kind: ObservationKind, rows: Singles) -> Observation:
    """Convert flat observations to a kind of observations.

    Parameters
    ----------
    kind : {"flat", "balls"}
        The kind.
    rows : numpy.ndarray
        float32 (..., k), with k = 121 in a visit and 130 in a frame.

    Returns
    -------
    numpy.ndarray or dict
        With "flat": ``rows`` itself. With "balls": a dict of new arrays, "balls" (..., 22, 5) and "state" (..., k - 110).

    Examples
    --------
    >>> import numpy as np
    >>> from snooker_env.tasks import shaped_observations
    >>> {name: part.shape for name, part in shaped_observations("balls", np.zeros((8, 121), np.float32)).items()}
    {'balls': (8, 22, 5), 'state': (8, 11)}
    """
    if kind == "flat":
        return rows
    lead = rows.shape[:-1]
    balls = rows[..., :BALLS_SIZE].reshape(*lead, N_BALLS, _COLUMNS)
    return {"balls": np.array(balls), "state": np.array(rows[..., BALLS_SIZE:])}
