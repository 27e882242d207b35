"""Where does a colour go when it returns? The spotting rule, exact, as kernels.

A colour goes on its own spot; if that is occupied (a ball there would touch another as the referee sees it),
on the free spot of the highest value; if all are, as near its own spot as possible without touching, on the
straight line towards the top cushion; if that has no room, below the spot (the rules state this for pink and
black). Of several colours, those whose own spot is free go first, then the highest value."""

import numpy as np

from .._lib.jit import kernel
from ..geometry import HALF_LENGTH
from . import balls


@kernel
def touches(positions, on_table, x, y, reach):
    """Whether the centre of a ball on the table is nearer to (x, y) than ``reach`` [m]."""
    for i in range(balls.N_BALLS):
        if on_table[i]:
            dx, dy = positions[i, 0] - x, positions[i, 1] - y
            if dx * dx + dy * dy < reach * reach:
                return True
    return False


@kernel
def has_no_room(positions, on_table, x, y, radius):
    """Whether a ball at (x, y) [m] would touch one that is on the table."""
    return touches(positions, on_table, x, y, 2.0 * radius + balls.REFEREE_TOUCH)


@kernel
def nearest_free(positions, on_table, x, y, direction, radius):
    """The y nearest to ``y`` in ``direction`` (+1 up, -1 down) at which a ball on the line ``x`` touches no other; exact."""
    reach = 2.0 * radius + balls.CLEARANCE
    moved = True
    while moved:
        moved = False
        for i in range(balls.N_BALLS):
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
    """The place of the colour ``ball`` by the rule: (x, y) [m]; its entry in ``on_table`` must be False."""
    x, y = balls.SPOTS[ball, 0], balls.SPOTS[ball, 1]
    if not has_no_room(positions, on_table, x, y, radius):
        return x, y
    for spot in range(balls.BLACK, balls.YELLOW - 1, -1):
        if not has_no_room(positions, on_table, balls.SPOTS[spot, 0], balls.SPOTS[spot, 1], radius):
            return balls.SPOTS[spot, 0], balls.SPOTS[spot, 1]
    up = nearest_free(positions, on_table, x, y, 1.0, radius)
    if up <= HALF_LENGTH - radius - balls.CLEARANCE:
        return x, up
    # Twenty-one balls cannot fill a line along the whole table, so there is always room below.
    return x, nearest_free(positions, on_table, x, y, -1.0, radius)


@kernel
def spot(positions, on_table, mask, radius):
    """Put the colours in ``mask``, removed first, on ``positions`` (22, 2) [m] and ``on_table``."""
    for ball in range(balls.YELLOW, balls.BLACK + 1):
        if (mask >> ball) & 1:
            on_table[ball] = False
    waiting = mask
    for ball in range(balls.BLACK, balls.YELLOW - 1, -1):
        x, y = balls.SPOTS[ball, 0], balls.SPOTS[ball, 1]
        if (mask >> ball) & 1 and not has_no_room(positions, on_table, x, y, radius):
            positions[ball, 0], positions[ball, 1] = x, y
            on_table[ball] = True
            waiting &= ~(1 << ball)
    for ball in range(balls.BLACK, balls.YELLOW - 1, -1):
        if (waiting >> ball) & 1:
            x, y = place_colour(positions, on_table, ball, radius)
            positions[ball, 0], positions[ball, 1] = x, y
            on_table[ball] = True
