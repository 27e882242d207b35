"""Which breaks are played? The cue ball meets the apex of 15 reds, touching or loose, or breaks off from the
D.

Used by ``python -m benchmarks.rack``. A break is r (n, 2), v (n, 2), w (n, 3) at the moment when the cue ball
meets the rack.
"""

from math import asin, cos, pi, sin

import numpy as np

from snooker_env.game.balls import SPOTS

from .compliant import R


def meet(r, direction, start):
    """Where the cue ball, going along ``direction`` from ``start``, first touches another ball."""
    a = r[1:] - start
    along, off = a @ direction, a[:, 0] * direction[1] - a[:, 1] * direction[0]
    hit = np.abs(off) < 2 * R
    return start + direction * (along[hit] - np.sqrt((2 * R) ** 2 - off[hit] ** 2)).min()


def rolling(r, direction, speed):
    """Velocities and spins when the cue ball rolls and the rest is still."""
    v, w = np.zeros((len(r), 2)), np.zeros((len(r), 3))
    v[0] = speed * direction
    w[0, :2] = speed / R * np.array([-direction[1], direction[0]])
    return v, w


def apex_break(speed, offset, gap=0.0, rng=None):
    """The cue ball meets the foremost of 15 reds, the colours off the table; ``offset`` [R] of its line from
    the rack's axis.

    gap [m]: the rack's pitch is 2 R + gap; with ``rng`` each red is also moved at random within gap / 2, so
    that gaps are 0 to 2 gap.
    """
    r = SPOTS[:16].copy()
    r[1:] = r[1] + (r[1:] - r[1]) * (1 + gap / (2 * R))
    if rng is not None:
        angle, size = rng.uniform(0, 2 * pi, 15), 0.5 * gap * np.sqrt(rng.uniform(0, 1, 15))
        r[1:] += np.column_stack([size * np.cos(angle), size * np.sin(angle)])
    along = np.array([0.0, 1.0])
    tilt = asin(offset / 2)
    r[0] = r[1] + 2 * R * np.array([sin(tilt), -cos(tilt)])
    return r, *rolling(r, along, speed)


def break_off(rng):
    """A break-off as it is played: all 22 balls, the cue ball from the D thin onto the end red of the back
    row."""
    r = SPOTS.copy()
    start = np.array([rng.uniform(0.08, 0.2), SPOTS[0, 1] - rng.uniform(0, 0.1)])
    to = r[15] + [rng.uniform(0.01, 0.04), 0] - start
    direction = to / np.hypot(*to)
    r[0] = meet(r, direction, start)
    return r, *rolling(r, direction, rng.uniform(2.5, 4.5))
