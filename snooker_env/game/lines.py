"""What does the cue ball meet, rolling along a straight line? The distance to a ball, and the ball met first, as kernels."""

import numpy as np

from .._jit import kernel
from ..geometry import BALL_RADIUS
from .balls import N_BALLS


@kernel
def meets(bx, by, ux, uy, radius):
    """Distance that the cue ball rolls from the origin along the unit vector u until it meets the ball at b [m]; inf if it misses."""
    along, across = bx * ux + by * uy, bx * uy - by * ux
    if along <= 0.0 or abs(across) >= 2.0 * radius:
        return np.inf
    return along - np.sqrt(4.0 * radius * radius - across * across)


@kernel
def met(positions, on_table, x, y, ux, uy, far):
    """The ball that the cue ball meets first, rolling from (x, y) along the unit vector u for the distance ``far`` [m]; 0 if none."""
    ball = 0
    for i in range(1, N_BALLS):
        if on_table[i]:
            run = meets(positions[i, 0] - x, positions[i, 1] - y, ux, uy, BALL_RADIUS)
            if run < far:
                far, ball = run, i
    return ball
