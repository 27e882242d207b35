"""What does the agent see? The ball layout and the state of the game, as float32 arrays in [-1, 1]."""

import numpy as np
from gymnasium import spaces

from .._check import choice
from ..game.balls import HALF_LENGTH, HALF_WIDTH, N_BALLS, REDS_MASK, VALUES

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

_SCALE = np.array([HALF_WIDTH, HALF_LENGTH])
_BITS = 1 << np.arange(N_BALLS)


def space(kind, *, frame=False):
    """The observation space: "flat" a Box of 22 * 5 + 11 numbers, "balls" a Dict of "balls" (22, 5) and "state" (11,).

    ``frame``: with the nine entries of a frame behind the eleven.
    """
    choice("observation", kind, OBSERVATIONS)
    entries = len(STATE_ENTRIES) + (len(FRAME_ENTRIES) if frame else 0)
    balls = spaces.Box(-1.0, 1.0, (N_BALLS, len(BALL_COLUMNS)), np.float32)
    state = spaces.Box(-1.0, 1.0, (entries,), np.float32)
    if kind == "balls":
        return spaces.Dict({"balls": balls, "state": state})
    return spaces.Box(-1.0, 1.0, (N_BALLS * len(BALL_COLUMNS) + entries,), np.float32)


def observe(kind, positions, on_table, ball_on, on, in_hand, points, more=()):
    """A fresh observation. ``ball_on``: a BallOn, ``on``: the mask of the balls on, ``points``: the break so far, ``more``: the
    entries that a frame adds."""
    balls = np.zeros((N_BALLS, len(BALL_COLUMNS)), np.float32)
    balls[:, :2] = np.where(on_table[:, None], positions / _SCALE, 0.0)
    balls[:, 2] = on_table
    balls[:, 3] = VALUES / 7.0
    balls[:, 4] = (on & _BITS) != 0
    state = np.zeros(len(STATE_ENTRIES), np.float32)
    state[0] = np.count_nonzero(on_table & ((REDS_MASK & _BITS) != 0)) / 15.0
    if ball_on >= 0:
        state[1 + ball_on] = 1.0
    state[9] = in_hand
    state[10] = points / 155.0
    np.clip(balls[:, :2], -1.0, 1.0, out=balls[:, :2])
    if more:
        state = np.concatenate([state, np.clip(np.array(more, np.float32), -1.0, 1.0)])
    if kind == "balls":
        return {"balls": balls, "state": state}
    return np.concatenate([balls.ravel(), state])


def observe_frame(kind, table, player):
    """A fresh observation of a ``FrameTable`` as ``player`` sees it. Its first part is what the visit task would show."""
    frame = table.frame
    mine, other = frame.scores[player], frame.scores[1 - player]
    to_play = frame.phase != "over" and frame.striker == player
    more = (
        mine / 155.0, other / 155.0, (mine - other) / 155.0, frame.available / 147.0, to_play, frame.free_ball, frame.phase == "choice",
        frame.miss_called, frame.respotted_black,
    )  # fmt: skip
    return observe(kind, table.positions, table.on_table, frame.ball_on, table.on, frame.in_hand, frame.break_points, more)
