"""How is a step taken when the contacts do not both slip? By the Runge-Kutta pair 5(4) of Dormand & Prince.

Coefficients: Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I, II.5 and II.6. All seven
impulses; the stages are in a loop, so that the rates are compiled once.
"""

import numpy as np

from ..._lib.jit import kernel
from .coulomb import rates
from .inertia import Impulses
from .polynomial import CLOSING, F2, G2, LIFT, ROW, P

DEGREE = 4
"""Degree of the continuous extension."""
_STAGES = ROW * (DEGREE + 1)
"""Where the rates of the 7 stages begin in ``series``, behind the polynomial: 7 numbers each."""
_NONE = Impulses(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
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
        -12715105075 / 11282082432,
        0.0,
        87487479700 / 32700410799,
        -10690763975 / 1880347072,
        701980252875 / 199316789632,
        -1453857185 / 822651844,
        69997945 / 29380423,
    )
)


@kernel
def step(series, x, h, per, mode, near, cloth, problem):
    """One step of length h from x with rates ``per`` -> its end, the rates there, the error at equal p."""
    _store(series, 0, per)
    end, per_end = x, per
    for i in range(6):
        end = x
        for j in range(i + 1):
            end = _add(end, h * _A[i, j], _stage(series, j))
        per_end = rates(end, mode, near, cloth, problem)
        _store(series, i + 1, per_end)
    off = _NONE
    for j in range(7):
        off = _add(off, h * _ERROR[j], _stage(series, j))
    # An error in p(t) alone has no effect; what counts is the error of each number as a function of p.
    off = _add(off, -off.p / per_end.p, per_end)
    worst = max(
        max(max(abs(off.F1), abs(off.F2)), max(abs(off.G1), abs(off.G2))), max(abs(off.W), abs(off.Z))
    )
    return end, per_end, worst


@kernel
def _store(series, i, per):
    m = _STAGES + 7 * i
    series[m], series[m + 1], series[m + 2], series[m + 3], series[m + 4], series[m + 5], series[m + 6] = per


@kernel
def _stage(series, i):
    m = _STAGES + 7 * i
    return Impulses(
        series[m], series[m + 1], series[m + 2], series[m + 3], series[m + 4], series[m + 5], series[m + 6]
    )


@kernel
def _add(x, h, per):
    return Impulses(
        x.F1 + h * per.F1,
        x.F2 + h * per.F2,
        x.G1 + h * per.G1,
        x.G2 + h * per.G2,
        x.p + h * per.p,
        x.W + h * per.W,
        x.Z + h * per.Z,
    )


@kernel
def leave_polynomial(series, x, end, h, contact):
    """Write the step's continuous extension, order 4, as polynomial in its fraction (ibid., II.6)."""
    for q in range(7):
        r1 = end[q] - x[q]
        r2 = h * series[_STAGES + q] - r1
        r3 = r1 - h * series[_STAGES + 6 * 7 + q] - r2
        r4 = 0.0
        for j in range(7):
            r4 += h * _EXTENSION[j] * series[_STAGES + 7 * j + q]
        # x + t (r1 + (1 - t) (r2 + t (r3 + (1 - t) r4))), by powers of t
        series[q] = x[q]
        series[ROW + q], series[2 * ROW + q], series[3 * ROW + q], series[4 * ROW + q] = (
            r1 + r2,
            r3 + r4 - r2,
            -r3 - 2.0 * r4,
            r4,
        )
    for k in range(DEGREE + 1):  # the closing speed follows linearly
        m = ROW * k
        closing = contact.d_n * series[m + P] - contact.d_a * series[m + F2] - contact.d_b * series[m + G2]
        series[m + CLOSING] = closing + contact.l_n * series[m + LIFT]
    series[CLOSING] += 1.0
