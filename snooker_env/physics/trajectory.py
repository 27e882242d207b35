"""Where is every ball at a given time? From the path log of a shot, by the engine's own formulas."""

import numpy as np

from .._lib.check import refuse
from .._lib.jit import entry
from .._lib.types import Floats
from . import cloth, flight


@entry
def states_at(segments, n_balls, times, phys, positions, velocities, spins):
    """Fill positions (m, n, 2) or (m, n, 3) [m], velocities [m/s] and spins (m, n, 3) [rad/s] at ``times`` (m,) [s].
    ``segments`` (k, cloth.SEGMENT) in order of time: each holds until the ball's next; of several at one time the last."""
    k = segments.shape[0]
    state = np.empty(k, np.int64)
    for s in range(k):
        state[s] = int(segments[s, cloth.SEGMENT_STATE])
    current = np.empty(n_balls, np.int64)
    for m in range(times.shape[0]):
        t = times[m]
        for s in range(k):  # the log is in order of time
            if segments[s, cloth.T0] > t:
                break
            current[int(segments[s, cloth.SEGMENT_BALL])] = s
        for i in range(n_balls):
            r, v, w = flight.evaluate(segments, state, current[i], t, phys)
            positions[m, i, 0], positions[m, i, 1] = r
            velocities[m, i, 0], velocities[m, i, 1] = v
            if positions.shape[2] == 3:
                positions[m, i, 2], velocities[m, i, 2] = flight.height(segments, state, current[i], t, phys)
            spins[m, i, 0], spins[m, i, 1], spins[m, i, 2] = w


def check_path(segments: Floats) -> None:
    """Raise ValueError unless a shot has its path."""
    if not len(segments):
        allowed = "must be there: simulate() keeps them, environments with keep_history = True"
        raise refuse("shot.segments", "none", allowed)
