"""Which balls are there, what is each worth and where does it belong? The table's places are in ``geometry``.

Ids: 0 the cue ball, 1 to 15 the reds, 16 to 21 the colours by value. A set of balls is an integer whose bit i
stands for ball i, or a bool array (22,). Positions are float64 (22, 2) [m] in the table frame."""

from collections.abc import Iterable
from enum import IntEnum
from typing import Any

import numpy as np

from .._lib.check import array, choice, flags, integer, refuse
from .._lib.jit import kernel
from .._lib.types import Bools, Flags, Floats, Vectors
from ..geometry import BALL_RADIUS, BAULK_Y, COLOUR_SPOTS

N_BALLS = 22
"""Number of balls, the cue ball included."""
CUE, YELLOW, GREEN, BROWN, BLUE, PINK, BLACK = 0, 16, 17, 18, 19, 20, 21
"""Ids of the cue ball and of the colours; the reds have the ids 1 to 15."""
N_REDS = 15  # number of reds
COLOUR_NAMES = ("yellow", "green", "brown", "blue", "pink", "black")
"""Names of the colours in the order of their ids, 16 to 21, and of their values, 2 to 7."""
NAMES = ("cue", *(f"red {i}" for i in range(1, 16)), *COLOUR_NAMES)
"""Names of the balls by id."""
VALUES = np.array([0] + [1] * 15 + [2, 3, 4, 5, 6, 7], dtype=np.int64)
"""Points by id: int64 (22,), read-only; 0 for the cue ball."""
_BITS = 1 << np.arange(N_BALLS)
CUE_BIT = 1
REDS_MASK = 0xFFFE
COLOURS_MASK = 0x3F0000
ALL_MASK = 0x3FFFFF


class BallOn(IntEnum):
    """The ball on: what the striker must hit first. From RED on, the number is its value in points.

    NOTHING (-1): the frame is over. ANY_COLOUR (0): any one colour, which the striker nominates, as a red was
    just potted. RED (1), YELLOW (2), GREEN (3), BROWN (4), BLUE (5), PINK (6), BLACK (7): that ball.

    Examples
    --------
    >>> from snooker_env.game import BallOn
    >>> BallOn(5).name, int(BallOn.BLACK)
    ('BLUE', 7)
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


PINK_GAP = 0.0005  # gap between the pink on its spot and the red at the apex [m]: small, without contact
TOUCH = 1e-6
"""Two balls touch when the gap between them is below this [m]: far below sight, far above rounding."""
REFEREE_TOUCH = 50e-6
"""The referee calls a touching ball when the gap to the cue ball is below this [m]: the eye resolves about 70
um at 25 cm (one arc minute), and balls that touch come to rest 1 to 40 um apart in the simulation."""
CLEARANCE = 2.0 * REFEREE_TOUCH
"""The gap beside a ball or cushion at which a ball is put down [m]: the referee sees no contact."""


def _spots():
    """A place for each ball: the cue ball's usual place in hand, the racked triangle, the six spots."""
    spots = np.empty((N_BALLS, 2))
    spots[CUE] = 0.18, BAULK_Y
    spots[YELLOW:] = COLOUR_SPOTS
    pink_y = spots[PINK, 1]
    # Rows sqrt(3) R apart, a pitch of 2 R: each red touches its neighbours. Rounded to mm they would overlap.
    for ball, (row, k) in enumerate(((n, k) for n in range(5) for k in range(n + 1)), 1):
        y = pink_y + 2 * BALL_RADIUS + PINK_GAP + row * np.sqrt(3.0) * BALL_RADIUS
        spots[ball] = (2 * k - row) * BALL_RADIUS, y
    return spots


SPOTS = _spots()
"""A place for each ball: float64 (22, 2) [m], read-only. The spots, the racked triangle, and for the cue ball
in hand the baulk line between brown and yellow; it breaks off from there or from its mirror image."""

for _constant in (VALUES, SPOTS):
    _constant.setflags(write=False)


@kernel
def bits(present):
    """The mask of the balls that are present. An inner kernel.

    Parameters
    ----------
    present : bool (22,)
        Which balls are present, by id.

    Returns
    -------
    int
        Mask with bit i for ball i.
    """
    mask = 0
    for i in range(N_BALLS):
        if present[i]:
            mask |= 1 << i
    return mask


@kernel
def touching_balls(positions, on_table):
    """The mask of the object balls that touch the cue ball, as the referee sees it."""
    reach = 2.0 * BALL_RADIUS + REFEREE_TOUCH
    mask = 0
    for i in range(1, N_BALLS):
        dx, dy = positions[i, 0] - positions[0, 0], positions[i, 1] - positions[0, 1]
        if on_table[i] and dx * dx + dy * dy < reach * reach:
            mask |= 1 << i
    return mask


@kernel
def count(mask):
    """The number of balls in a mask."""
    n = 0
    for i in range(N_BALLS):
        n += (mask >> i) & 1
    return n


def next_on(mask: int) -> int:
    """The ``BallOn`` for a new visit: red while there is one, then the lowest colour, else -1."""
    if mask & REDS_MASK:
        return 1
    for i in range(YELLOW, N_BALLS):
        if (mask >> i) & 1:
            return i - 14
    return -1


def balls_on(ball_on: int, on_table: int) -> int:
    """The mask of the balls that may be struck first.

    ``snooker_env.kernels.balls_on`` is the same function as an inner kernel.

    Parameters
    ----------
    ball_on : int
        A ``BallOn``.
    on_table : int
        Mask of the balls on the table, bit i for ball i.

    Returns
    -------
    int
        Mask of the balls that may be struck first; 0 for ``BallOn.NOTHING``.

    Examples
    --------
    >>> from snooker_env.game import BallOn, balls_on
    >>> bin(balls_on(BallOn.RED, 1 << 21 | 0b111))  # the cue ball, two reds, the black
    '0b110'
    """
    if ball_on == 1:
        return on_table & REDS_MASK
    if ball_on == 0:
        return on_table & COLOURS_MASK
    if ball_on < 0:
        return 0
    return on_table & (1 << (ball_on + 14))


def points_available(on_table: int, ball_on: int, free_ball: bool = False) -> int:
    """The most points that the striker can still score; a free ball adds 8 with a red on (one more red), else the colour on."""
    points, colours = 0, 0
    for i in range(1, N_BALLS):
        if (on_table >> i) & 1:
            points += i - 14 if i > N_REDS else 8
            colours += i > N_REDS
    if ball_on == 0:
        points += 7
    elif free_ball and colours > (ball_on > 1):
        points += 8 if ball_on == 1 else ball_on
    return points


# The same for kernels; Python calls the plain ones, which need no compiling.
next_on_kernel: Any = kernel(next_on)
balls_on_kernel: Any = kernel(balls_on)
available: Any = kernel(points_available)


def mask_of(balls: Iterable[int]) -> int:
    """The mask of some balls; ValueError unless their ids are 0 to 21."""
    mask = 0
    for ball in balls:
        mask |= 1 << integer("ball", ball, 0, N_BALLS - 1)
    return mask


def mask_of_present(on_table: Bools) -> int:
    """The mask of a bool array (22,)."""
    return int(on_table @ _BITS)


def ids_of(mask: int) -> tuple[int, ...]:
    """The ids of the balls in a mask, in rising order; ValueError for a bit above 21."""
    integer("mask", mask, 0, ALL_MASK)
    return tuple(i for i in range(N_BALLS) if mask >> i & 1)


def check_ball_on(field: str, ball_on: BallOn, mask: int, balls: str, *, in_turn: bool = True) -> None:
    """ValueError unless this may be on with the balls of ``mask`` (``balls`` in words); ``in_turn``: a colour only if the lowest."""
    word, lowest = ball_on.name.lower(), BallOn(next_on(mask))
    if not balls_on(ball_on, mask & ~CUE_BIT):
        raise refuse(field, word, f"must name balls of which one is on the table ({balls})")
    if ball_on > BallOn.RED and mask & REDS_MASK:
        raise refuse(field, word, f"must be 'red' or 'any_colour' while reds are on the table ({balls})")
    if in_turn and ball_on not in (BallOn.ANY_COLOUR, lowest):
        allowed = f"must be 'any_colour' or {lowest.name.lower()!r}, the lowest on the table ({balls})"
        raise refuse(field, word, allowed)


def check_table(positions: Vectors, on_table: Flags) -> tuple[Floats, Bools]:
    """New copies of ``positions`` (22, 2) [m] and ``on_table`` (22,) bool; ValueError for anything else."""
    present = flags("on_table", on_table, (N_BALLS,))
    return array("positions", positions, (N_BALLS, 2)), present


def colour(name: str) -> int:
    """The id of a colour by its name."""
    return YELLOW + COLOUR_NAMES.index(choice("colour", name, COLOUR_NAMES))
