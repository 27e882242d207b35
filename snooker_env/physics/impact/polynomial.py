"""What happens inside a step of an impact? Its state at any time, and when a quantity has a value.

Both methods of integration write a step as polynomials: ``series[ROW * k + column]`` is a quantity's
coefficient of order k. Columns 0 to 6 are the state, 7 the closing speed, the others work space.
"""

import numpy as np

from ..._lib.jit import kernel
from .inertia import Impulses

ROW = 24
WORK = 21 * ROW
"""The size of ``series``: a step of order 20, the highest of ``contact.py``."""
F1, F2, G1, G2, P, WORK_DONE, LIFT, CLOSING = (np.int64(k) for k in range(8))  # typed, as in ``coulomb.py``
"""Columns: the fields of ``Impulses`` in their order, and the closing speed."""

_MOST_TRIALS = 60
"""Halley's method takes 2 or 3, bisection alone ends after so many. Doubled or halved: no change."""


@kernel
def state_at(series, degree, t):
    """The state at time t in a step of this degree (Horner's scheme)."""
    m = ROW * degree
    f1, f2, g1, g2, p = series[m + F1], series[m + F2], series[m + G1], series[m + G2], series[m + P]
    done, lift = series[m + WORK_DONE], series[m + LIFT]
    for _ in range(degree):
        m -= ROW
        f1, f2, g1, g2 = (
            series[m + F1] + t * f1,
            series[m + F2] + t * f2,
            series[m + G1] + t * g1,
            series[m + G2] + t * g2,
        )
        p, done, lift = series[m + P] + t * p, series[m + WORK_DONE] + t * done, series[m + LIFT] + t * lift
    return Impulses(f1, f2, g1, g2, p, done, lift)


@kernel
def value_at(series, degree, column, t):
    """A quantity at time t, its derivative, and half the second."""
    m = ROW * degree + column
    f, slope, bend = series[m], 0.0, 0.0
    for _ in range(degree):
        m -= ROW
        bend = slope + t * bend
        slope = f + t * slope
        f = series[m] + t * f
    return f, slope, bend


@kernel
def time_of(series, degree, column, value, low, high, guess, near):
    """When a quantity falls to the value: between ``low``, where it is above, and ``high``, where it is not.

    Bracketed Halley iteration, until the next correction, about this one's cube over the square of the time
    since the first ``low`` (the derivative may be zero there), is below ``near``.
    """
    first, t = low, guess
    for _ in range(_MOST_TRIALS):
        if not low < t < high:
            t = 0.5 * (low + high)
        f, slope, bend = value_at(series, degree, column, t)
        f -= value
        low, high = (t, high) if f > 0.0 else (low, t)
        bottom = slope * slope - f * bend
        if slope >= 0.0 or bottom <= 0.0:
            t = low  # so that the next is halfway
            continue
        move = f * slope / bottom
        t -= move
        if abs(move * move * move) <= near * (t - first) * (t - first) or high - low <= near:
            break
    return min(max(t, low), high)
