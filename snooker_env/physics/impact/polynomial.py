"""What happens inside a step of an impact? The step as a polynomial: its state at any time, and when a quantity reaches a value.

Both methods of integration leave their step in this form, in a work array: coefficient k of quantity q is ``w[ROW * k + q]``. The first
seven quantities are the state (F1, F2, G1, G2, p, W, Z); then the closing speed y; the rest is a method's own.
"""

from ..._jit import kernel

ROW = 16
WORK = 21 * ROW  # the size of a work array: a step of degree 20
W, Y = 5, 7


@kernel
def state_at(w, n, t):
    """The state at time t in a step of degree n."""
    m = ROW * n
    f1, f2, g1, g2, p, work, z = w[m], w[m + 1], w[m + 2], w[m + 3], w[m + 4], w[m + 5], w[m + 6]
    for _ in range(n):
        m -= ROW
        f1, f2, g1, g2 = w[m] + t * f1, w[m + 1] + t * f2, w[m + 2] + t * g1, w[m + 3] + t * g2
        p, work, z = w[m + 4] + t * p, w[m + 5] + t * work, w[m + 6] + t * z
    return f1, f2, g1, g2, p, work, z


@kernel
def value_at(w, n, q, t):
    """Quantity q at time t, its derivative, and half the second."""
    m = ROW * n + q
    f, slope, bend = w[m], 0.0, 0.0
    for _ in range(n):
        m -= ROW
        bend = slope + t * bend
        slope = f + t * slope
        f = w[m] + t * f
    return f, slope, bend


@kernel
def time_of(w, n, q, value, low, high, t, near):
    """When quantity q falls to the value, between low, where it is above, and high, where it is not; t: a guess, near: how close is enough.

    Halley's method kept between low and high. It ends after a correction so small that the next, about its cube over the square of the
    time since ``first``, where the quantity may stand still, would be below ``near``.
    """
    first = low
    for _ in range(60):
        if not low < t < high:
            t = 0.5 * (low + high)
        f, slope, bend = value_at(w, n, q, t)
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
