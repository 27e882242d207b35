"""How is a step of the impact's equations taken in any state? By the explicit pair of Dormand & Prince 5(4) on the seven numbers.

Coefficients: Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I, II.5 and II.6. One loop runs over the stages, so that
the rates are compiled once.
"""

import numpy as np

from ..._jit import kernel
from .coulomb import rates
from .polynomial import ROW

DEGREE = 4  # of the continuous extension
_STAGES = ROW * (DEGREE + 1)  # where the stages lie in the work array, behind the polynomial
_A = np.array(
    [
        (0.2, 0.0, 0.0, 0.0, 0.0, 0.0),
        (3 / 40, 9 / 40, 0.0, 0.0, 0.0, 0.0),
        (44 / 45, -56 / 15, 32 / 9, 0.0, 0.0, 0.0),
        (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0.0, 0.0),
        (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0.0),
        (35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84),
    ]
)
_ERROR = np.array((71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40))
_EXTENSION = np.array(
    (
        -12715105075 / 11282082432, 0.0, 87487479700 / 32700410799, -10690763975 / 1880347072, 701980252875 / 199316789632,
        -1453857185 / 822651844, 69997945 / 29380423,
    )
)  # fmt: skip


@kernel
def step(w, x, h, k1, mode, start, c, law, mu_s, near, cloth):
    """One step from x, where the rates are k1 -> the state after it, the rates there, and the error of a state as a function of p."""
    _store(w, 0, k1)
    new, k7 = x, k1
    for i in range(6):
        new = x
        for j in range(i + 1):
            new = _add(new, h * _A[i, j], _stage(w, j))
        k7 = rates(new, mode, start, c, law, mu_s, near, cloth)
        _store(w, i + 1, k7)
    off = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for j in range(7):
        off = _add(off, h * _ERROR[j], _stage(w, j))
    # an error in p(t) alone is harmless: what counts is each number as a function of p
    off = _add(off, -off[4] / k7[4], k7)
    worst = max(max(max(abs(off[0]), abs(off[1])), max(abs(off[2]), abs(off[3]))), max(abs(off[5]), abs(off[6])))
    return new, k7, worst


@kernel
def _store(w, i, k):
    m = _STAGES + 7 * i
    w[m], w[m + 1], w[m + 2], w[m + 3], w[m + 4], w[m + 5], w[m + 6] = k


@kernel
def _stage(w, i):
    m = _STAGES + 7 * i
    return w[m], w[m + 1], w[m + 2], w[m + 3], w[m + 4], w[m + 5], w[m + 6]


@kernel
def _add(x, h, k):
    return (
        x[0] + h * k[0], x[1] + h * k[1], x[2] + h * k[2], x[3] + h * k[3], x[4] + h * k[4], x[5] + h * k[5], x[6] + h * k[6],
    )  # fmt: skip


@kernel
def leave_polynomial(w, x, new, h, c):
    """The last step's continuous extension, of order 4, as a polynomial in the fraction of the step (Hairer, Norsett & Wanner, II.6)."""
    d_a, d_b, d_y, l_y = c[4], c[5], c[6], c[10]
    for q in range(7):
        r1 = new[q] - x[q]
        r2 = h * w[_STAGES + q] - r1
        r3 = r1 - h * w[_STAGES + 42 + q] - r2
        r4 = 0.0
        for j in range(7):
            r4 += h * _EXTENSION[j] * w[_STAGES + 7 * j + q]
        # x + s (r1 + (1 - s) (r2 + s (r3 + (1 - s) r4)))
        w[q], w[ROW + q], w[2 * ROW + q], w[3 * ROW + q], w[4 * ROW + q] = x[q], r1 + r2, r3 + r4 - r2, -r3 - 2.0 * r4, r4
    for k in range(DEGREE + 1):
        m = ROW * k
        w[m + 7] = d_y * w[m + 4] - d_a * w[m + 1] - d_b * w[m + 3] + l_y * w[m + 6]
    w[7] += 1.0
