"""What does the agent see? The ball layout and the state of the game, as float32 arrays in [-1, 1]."""

import numpy as np
from gymnasium import spaces

from .._check import choice
from .._jit import kernel
from .._types import Observation, ObservationKind, Singles
from ..game.balls import N_BALLS, REDS_MASK, VALUES, bits, count
from ..geometry import HALF_LENGTH, HALF_WIDTH

OBSERVATIONS = ("flat", "balls")
BALL_COLUMNS = ("x", "y", "on_table", "value", "ball_on")
"""Columns of the table of balls: x / 0.889 and y / 1.7845 (0 when off the table), 1 if on the table, value / 7, 1 if it may be struck
first (a ball on)."""
STATE_ENTRIES = (
    "reds", "any_colour", "red", "yellow", "green", "brown", "blue", "pink", "black", "in_hand", "break",
)  # fmt: skip
"""Entries of the game's state: reds left / 15, what is on (one-hot), 1 if the cue ball is in hand, points of this break / 155."""

FRAME_ENTRIES = (
    "score", "opponent_score", "lead", "available", "to_play", "free_ball", "choice", "miss_called", "respotted_black",
)  # fmt: skip
"""What a frame adds to the state, seen by one player: his score and the other's / 155, the difference / 155, points on the table / 147
(all cut to [-1, 1]), then flags: it is his turn, the striker has a free ball, the other has just fouled (a decision is open), the foul
was called a miss, the black was re-spotted. With a free ball "ball_on" is 1 for every colour too."""

_COLUMNS = len(BALL_COLUMNS)
BALLS_SIZE = N_BALLS * _COLUMNS
SIZE = BALLS_SIZE + len(STATE_ENTRIES)
FRAME_SIZE = SIZE + len(FRAME_ENTRIES)
"""Numbers in the flat observation of a visit, of a frame, and how many of them, at the front, are the table of balls."""


def space(kind: ObservationKind, *, frame: bool = False) -> spaces.Box | spaces.Dict:
    """The observation space.

    Parameters
    ----------
    kind : {"flat", "balls"}
        "flat": a Box of 22 * 5 + 11 numbers; "balls": a Dict of "balls" (22, 5) and "state" (11,).
    frame : bool
        With the nine entries of a frame behind the eleven.

    Returns
    -------
    gymnasium.spaces.Box or gymnasium.spaces.Dict

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
    """Flat observations as the observations of a kind.

    Parameters
    ----------
    kind : {"flat", "balls"}
    rows : float32 (..., 121 or more)
        They are taken over: with "flat" they come back as they are.

    Returns
    -------
    float32 (..., k) or dict
        With "balls": "balls" (..., 22, 5) and "state" (..., k - 110).
    """
    if kind == "flat":
        return rows
    lead = rows.shape[:-1]
    balls = rows[..., :BALLS_SIZE].reshape(*lead, N_BALLS, _COLUMNS)
    return {"balls": np.array(balls), "state": np.array(rows[..., BALLS_SIZE:])}
