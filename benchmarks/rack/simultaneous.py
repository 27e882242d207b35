"""How do touching balls part when all their contacts are resolved at once as rigid bodies? A linear
complementarity problem, solved twice.

Used by ``python -m benchmarks.rack``, whose docstring states the problem. Projected Gauss-Seidel plays the
breaks; non-negative least squares checks it.
"""

import numba
import numpy as np
from scipy.optimize import nnls

from .compliant import R

TOUCHING = 2e-6
"""Gap [m] up to which the simultaneous solution counts two balls as touching."""


@numba.njit(nogil=True)
def gauss_seidel(i, j, nx, ny, v, e, tolerance):
    """The simultaneous solution: velocities v (n, 2) become those after the impact; returns the sweeps
    taken."""
    impulse, moved = np.zeros(len(i)), v.copy()
    sweeps, change = 0, np.inf
    while change >= tolerance:
        sweeps, change = sweeps + 1, 0.0
        for m in range(len(i)):
            a, b = i[m], j[m]
            closing = (moved[a, 0] - moved[b, 0]) * nx[m] + (moved[a, 1] - moved[b, 1]) * ny[m]
            more = max(-impulse[m], 0.5 * closing)
            impulse[m] += more
            moved[a, 0] -= more * nx[m]
            moved[a, 1] -= more * ny[m]
            moved[b, 0] += more * nx[m]
            moved[b, 1] += more * ny[m]
            change = max(change, abs(more))
    v += (1.0 + e) * (moved - v)
    return sweeps


def contacts(r):
    """Touching pairs i, j and the unit vectors (nx, ny) from i to j."""
    i, j = np.triu_indices(len(r), 1)
    d = r[j] - r[i]
    far = np.hypot(*d.T)
    near = far < 2 * R + TOUCHING
    return i[near], j[near], d[near, 0] / far[near], d[near, 1] / far[near]


def simultaneous(r, v, e):
    """Velocities (n, 2) after the simultaneous impact of all touching balls."""
    v = v.copy()
    gauss_seidel(*contacts(r), v, e, 1e-13 * np.abs(v).max())
    return v


def simultaneous_by_nnls(r, v, e):
    """The same by a second method: the velocities nearest to v that close no contact are those of a
    non-negative least squares problem."""
    i, j, nx, ny = contacts(r)
    rows = np.zeros((len(i), len(r), 2))
    for m in range(len(i)):
        rows[m, i[m]], rows[m, j[m]] = (-nx[m], -ny[m]), (nx[m], ny[m])
    rows = rows.reshape(len(i), -1)
    impulse, _ = nnls(rows.T, -v.ravel(), maxiter=100_000)
    return v + (1 + e) * (rows.T @ impulse).reshape(-1, 2)
