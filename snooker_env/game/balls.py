"""Which balls are there, what is each worth and where does it belong? Ids, values and places; the table's own are in ``geometry``.

World frame as in ``geometry``. The 22 balls have fixed ids: 0 the cue
ball, 1 to 15 the reds, 16 to 21 the colours in the order of their values. A set of balls is an integer whose bit i stands for ball i,
or a bool array (22,); positions are float64 (22, 2).
"""

from collections.abc import Iterable
from enum import IntEnum
from typing import Any

import numpy as np

from .._check import array, integer, refuse
from .._jit import kernel
from .._types import Bools, Flags, Floats, Vectors
from ..geometry import BALL_RADIUS, BAULK_Y, COLOUR_SPOTS, D_RADIUS

N_BALLS = 22
CUE, YELLOW, GREEN, BROWN, BLUE, PINK, BLACK = 0, 16, 17, 18, 19, 20, 21
N_REDS = 15

COLOUR_NAMES = ("yellow", "green", "brown", "blue", "pink", "black")
NAMES = ("cue", *(f"red {i}" for i in range(1, 16)), *COLOUR_NAMES)
"""Names by id."""

VALUES = np.array([0] + [1] * 15 + [2, 3, 4, 5, 6, 7], dtype=np.int64)
"""Points by id; the cue ball has none."""

_BITS = 1 << np.arange(N_BALLS)
CUE_BIT = 1
REDS_MASK = 0xFFFE
COLOURS_MASK = 0x3F0000
ALL_MASK = 0x3FFFFF


class BallOn(IntEnum):
    """What the striker must hit first. From RED on, the number is the points that the ball on is worth.

    ============= === ==========================================================================
    NOTHING       -1  The frame is over.
    ANY_COLOUR    0   A red was just potted: any one colour, which the striker nominates.
    RED           1   A red.
    YELLOW        2   The yellow.
    GREEN         3   The green.
    BROWN         4   The brown.
    BLUE          5   The blue.
    PINK          6   The pink.
    BLACK         7   The black.
    ============= === ==========================================================================
    """

    NOTHING = -1
    ANY_COLOUR = 0
    RED = 1
    YELLOW = 2
    GREEN = 3
    BROWN = 4
    BLUE = 5
    PINK = 6
    BLACK = 7


PINK_GAP = 0.0005
"""Gap [m] between the pink on its spot and the red at the apex: as near as possible without touching."""

TOUCH = 1e-6
"""Two balls touch when the gap between them is below this [m]: far under what an eye sees, far over rounding."""


def _spots():
    """A place for each ball: the cue ball's usual place for the break, the racked triangle, the six spots."""
    spots = np.empty((N_BALLS, 2))
    spots[CUE] = D_RADIUS / 2, BAULK_Y
    spots[YELLOW:] = COLOUR_SPOTS
    pink_y = spots[PINK, 1]
    # Rows sqrt(3) R apart with a pitch of 2 R: each red touches its neighbours to rounding. Figures rounded to mm would overlap.
    ball = 1
    for row in range(5):
        for k in range(row + 1):
            spots[ball] = (2 * k - row) * BALL_RADIUS, pink_y + 2 * BALL_RADIUS + PINK_GAP + row * np.sqrt(3.0) * BALL_RADIUS
            ball += 1
    return spots


SPOTS = _spots()
"""(22, 2): each colour's spot; for a red its place in the triangle, for the cue ball its usual place for the break."""

for _constant in (VALUES, SPOTS):
    _constant.setflags(write=False)


@kernel
def bits(present):
    """The mask of a bool array (22,)."""
    mask = 0
    for i in range(N_BALLS):
        if present[i]:
            mask |= 1 << i
    return mask


@kernel
def count(mask):
    """How many balls are in a mask."""
    n = 0
    for i in range(N_BALLS):
        n += (mask >> i) & 1
    return n


def next_on(mask: int) -> int:
    """The ball on (a ``BallOn``) for a player who comes to the table: red while there is one, then the lowest colour, or NOTHING (-1)."""
    if mask & REDS_MASK:
        return 1
    for i in range(YELLOW, N_BALLS):
        if (mask >> i) & 1:
            return i - 14
    return -1


def balls_on(ball_on: int, on_table: int) -> int:
    """The balls that may be struck first.

    Parameters
    ----------
    ball_on : int
        A ``BallOn``.
    on_table : int
        Mask of the balls on the table, bit i for ball i.

    Returns
    -------
    int
        Their mask.

    Examples
    --------
    >>> from snooker_env.game import BallOn, balls_on, ids_of, mask_of
    >>> ids_of(balls_on(BallOn.RED, mask_of([0, 1, 2, 21])))
    (1, 2)
    """
    if ball_on == 1:
        return on_table & REDS_MASK
    if ball_on == 0:
        return on_table & COLOURS_MASK
    if ball_on < 0:
        return 0
    return on_table & (1 << (ball_on + 14))


# The same two for kernels; Python calls the plain ones, which need no compiling.
next_on_kernel: Any = kernel(next_on)
balls_on_kernel: Any = kernel(balls_on)


def mask_of(balls: Iterable[int]) -> int:
    """The mask of some balls.

    Parameters
    ----------
    balls : iterable of int
        Ids, 0 to 21.

    Returns
    -------
    int
        Bit i for ball i.

    Raises
    ------
    ValueError
        For an id that is none.
    """
    mask = 0
    for ball in balls:
        mask |= 1 << integer("ball", ball, 0, N_BALLS - 1)
    return mask


def mask_of_present(on_table: Bools) -> int:
    """The mask of a bool array (22,)."""
    return int(on_table @ _BITS)


def ids_of(mask: int) -> tuple[int, ...]:
    """The ids in a mask, in order.

    Parameters
    ----------
    mask : int
        Bit i for ball i.

    Returns
    -------
    tuple of int

    Raises
    ------
    ValueError
        For a mask with other bits.
    """
    integer("mask", mask, 0, ALL_MASK)
    return tuple(i for i in range(N_BALLS) if mask >> i & 1)


def check_table(positions: Vectors, on_table: Flags) -> tuple[Floats, Bools]:
    """Fresh copies of ``positions`` (22, 2) and ``on_table`` (22,) bool; raises ``ValueError`` for anything else."""
    present = np.array(on_table)
    if present.shape != (N_BALLS,) or present.dtype != np.bool_:
        raise refuse("on_table", f"{present.dtype} array of shape {present.shape}", f"must be bool of shape ({N_BALLS},)")
    return array("positions", positions, (N_BALLS, 2)), present


def colour(name: str) -> int:
    """The id of a colour by its name."""
    if name not in COLOUR_NAMES:
        raise refuse("colour", name, "must be one of " + ", ".join(map(repr, COLOUR_NAMES)))
    return YELLOW + COLOUR_NAMES.index(name)
