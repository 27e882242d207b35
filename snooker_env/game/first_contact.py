"""What does the cue ball meet on a straight line? The way to a ball, and the ball met first; kernels."""

import numpy as np

from .._lib.jit import kernel
from ..geometry import BALL_RADIUS
from .balls import N_BALLS


@kernel
def meets(bx, by, ux, uy, radius):
    """How far it rolls from the origin along the unit vector u until it meets a ball at b [m], or inf."""
    along, across = bx * ux + by * uy, bx * uy - by * ux
    if along <= 0.0 or abs(across) >= 2.0 * radius:
        return np.inf
    return along - np.sqrt(4.0 * radius * radius - across * across)


@kernel
def find_first_ball(positions, on_table, x, y, ux, uy, far):
    """The ball met first from (x, y) along the unit vector u, up to the distance ``far`` [m]; 0 if none."""
    ball = 0
    for i in range(1, N_BALLS):
        if on_table[i]:
            run = meets(positions[i, 0] - x, positions[i, 1] - y, ux, uy, BALL_RADIUS)
            if run < far:
                far, ball = run, i
    return ball
