"""Where does a colour go when it comes back? The spotting rule, exact, as kernels.

A colour goes on its own spot; if that is occupied, on the free spot of the highest value; if every spot is occupied, as near its own spot
as it can be without touching another ball, on the straight line from there to the top cushion; and if that line has no room, on the same
line below the spot (the rules say so for pink and black; the centre line is their line). A spot is occupied when a ball placed there
would touch another. Of several colours, those whose own spot is free go first, then the highest value first.
"""

import numpy as np

from .._check import integer, refuse
from .._jit import entry, kernel
from .._types import Bools, Flags, Floats, Vectors
from ..geometry import BALL_RADIUS, HALF_LENGTH
from .balls import ALL_MASK, BLACK, COLOURS_MASK, N_BALLS, SPOTS, TOUCH, YELLOW, check_table

CLEARANCE = 2.0 * TOUCH
"""The gap [m] left to a ball or cushion that a spotted colour must not touch: the least that no test of touching can mistake."""


@kernel
def occupied(positions, on_table, x, y, radius):
    """Would a ball at (x, y) touch one that is on the table?"""
    reach = 2.0 * radius + TOUCH
    for i in range(N_BALLS):
        if on_table[i]:
            dx, dy = positions[i, 0] - x, positions[i, 1] - y
            if dx * dx + dy * dy < reach * reach:
                return True
    return False


@kernel
def nearest_free(positions, on_table, x, y, direction, radius):
    """The y nearest to ``y`` in ``direction`` (+1 up, -1 down) where a ball on the line at ``x`` touches nothing; cushions not asked.

    Each ball i bars an open interval of the line, its centre less and more h with h^2 = (2 R + clearance)^2 - (x_i - x)^2. Leaving
    each interval that holds y at its far end, until none does, gives the nearest free place exactly.
    """
    reach = 2.0 * radius + CLEARANCE
    moved = True
    while moved:
        moved = False
        for i in range(N_BALLS):
            if on_table[i]:
                dx = positions[i, 0] - x
                if abs(dx) < reach:
                    h = np.sqrt(reach * reach - dx * dx)
                    if positions[i, 1] - h < y < positions[i, 1] + h:
                        y = positions[i, 1] + direction * h
                        moved = True
    return y


@kernel
def place_colour(positions, on_table, ball, radius):
    """Where the colour ``ball`` belongs now: (x, y). Its own entry in ``on_table`` must be False."""
    x, y = SPOTS[ball, 0], SPOTS[ball, 1]
    if not occupied(positions, on_table, x, y, radius):
        return x, y
    for spot in range(BLACK, YELLOW - 1, -1):
        if not occupied(positions, on_table, SPOTS[spot, 0], SPOTS[spot, 1], radius):
            return SPOTS[spot, 0], SPOTS[spot, 1]
    up = nearest_free(positions, on_table, x, y, 1.0, radius)
    if up <= HALF_LENGTH - radius - CLEARANCE:
        return x, up
    # Twenty-one balls cannot fill a line that runs the table's length, so below there is always room.
    return x, nearest_free(positions, on_table, x, y, -1.0, radius)


@kernel
def spot(positions, on_table, mask, radius):
    """Return the colours in ``mask`` to the table: writes their rows of ``positions`` (22, 2) and ``on_table`` (22,) bool.

    ``mask`` may name balls that still stand on the table; they are lifted first (the black of a re-spotted black).
    """
    for ball in range(YELLOW, BLACK + 1):
        if (mask >> ball) & 1:
            on_table[ball] = False
    waiting = mask
    for ball in range(BLACK, YELLOW - 1, -1):
        if (mask >> ball) & 1 and not occupied(positions, on_table, SPOTS[ball, 0], SPOTS[ball, 1], radius):
            positions[ball, 0], positions[ball, 1] = SPOTS[ball, 0], SPOTS[ball, 1]
            on_table[ball] = True
            waiting &= ~(1 << ball)
    for ball in range(BLACK, YELLOW - 1, -1):
        if (waiting >> ball) & 1:
            x, y = place_colour(positions, on_table, ball, radius)
            positions[ball, 0], positions[ball, 1] = x, y
            on_table[ball] = True


@entry
def _spot(positions, on_table, mask, radius):
    spot(positions, on_table, mask, radius)


def spot_colours(positions: Vectors, on_table: Flags, mask: int, *, radius: float = BALL_RADIUS) -> tuple[Floats, Bools]:
    """Return colours to the table: new ``positions`` (22, 2) and ``on_table`` (22,) with the colours in ``mask`` placed by the rule.

    The arrays given are not changed. Raises ``ValueError`` for other shapes or a mask that names a ball that is no colour.
    """
    if integer("mask", mask, 0, ALL_MASK) & ~COLOURS_MASK:
        raise refuse("mask", mask, "must name colours only (ids 16 to 21)")
    placed, present = check_table(positions, on_table)
    _spot(placed, present, mask, float(radius))
    return placed, present
