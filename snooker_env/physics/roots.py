"""When does a quadratic or quartic first fall through zero in [0, T]? None is missed.

The quartic is cut at the roots of its derivative, found between those of the second derivative. On each piece
it is monotone: the first that goes from above zero to zero or below holds the crossing, found by bracketed
Newton iteration. A root of even order (touched from above) is no crossing.
"""

from math import inf, sqrt

from .._lib.jit import kernel


@kernel
def _quadratic_roots(a, b, c):
    """Real roots of a x^2 + b x + c in rising order, without cancellation; (inf, inf) if none."""
    if a == 0.0:
        return (-c / b, inf) if b != 0.0 else (inf, inf)
    disc = b * b - 4.0 * a * c
    if disc < 0.0:
        return inf, inf
    root = sqrt(disc)
    # by b's value, not its sign bit: -0.0 and 0.0 give the same bits
    q = -0.5 * (b + (root if b >= 0.0 else -root))
    first = q / a
    second = c / q if q != 0.0 else first
    return (first, second) if first <= second else (second, first)


@kernel
def quadratic_crossing(c0, c1, c2, T):
    """The time in [0, T] at which c0 + c1 x + c2 x^2 falls through zero, or inf. There is at most one."""
    if c0 <= 0.0 and c1 <= 0.0 and c2 <= 0.0:
        return inf  # not above zero at any time
    low, high = _quadratic_roots(c2, c1, c0)
    for x in (low, high):
        if 0.0 <= x <= T and c1 + 2.0 * c2 * x < 0.0:
            return x
    return inf


@kernel
def _bracketed_cubic(a, b, c, d, low, high, f_low):
    """The root of a cubic in [low, high], where it is monotone and changes sign; f_low: its value at low."""
    x = 0.5 * (low + high)
    for _ in range(100):
        f = ((a * x + b) * x + c) * x + d
        if f == 0.0:
            return x
        if (f > 0.0) == (f_low > 0.0):
            low = x
        else:
            high = x
        slope = (3.0 * a * x + 2.0 * b) * x + c
        step = x - f / slope if slope != 0.0 else 0.5 * (low + high)
        if not low < step < high:
            step = 0.5 * (low + high)
        if abs(step - x) <= 4e-16 * abs(x) or step in (low, high):
            return step
        x = step
    return x


@kernel
def _falling_quartic(q4, q3, q2, q1, q0, low, high):
    """The root in [low, high] where the quartic falls monotonically from above zero to zero or below."""
    x = 0.5 * (low + high)
    for _ in range(100):
        f = (((q4 * x + q3) * x + q2) * x + q1) * x + q0
        if f > 0.0:
            low = x
        else:
            high = x
        slope = ((4.0 * q4 * x + 3.0 * q3) * x + 2.0 * q2) * x + q1
        step = x - f / slope if slope < 0.0 else 0.5 * (low + high)
        if not low < step < high:
            step = 0.5 * (low + high)
        if abs(step - x) <= 4e-16 * abs(x) or step in (low, high):
            return step
        x = step
    return x


@kernel
def quartic_crossing(q4, q3, q2, q1, q0, T):
    """The earliest time in [0, T] at which q0 + q1 x + ... + q4 x^4 falls through zero, or inf."""
    # roots of the second derivative cut [0, T] into pieces on which the derivative is monotone
    bend1, bend2 = _quadratic_roots(12.0 * q4, 6.0 * q3, 2.0 * q2)
    at = 0.0
    value, slope = q0, q1
    for bend in (bend1, bend2, T):
        end = min(max(bend, 0.0), T)
        if end <= at:
            continue
        end_value = (((q4 * end + q3) * end + q2) * end + q1) * end + q0
        end_slope = ((4.0 * q4 * end + 3.0 * q3) * end + 2.0 * q2) * end + q1
        if (slope > 0.0) != (end_slope > 0.0) and slope != 0.0 and end_slope != 0.0:
            turn = _bracketed_cubic(4.0 * q4, 3.0 * q3, 2.0 * q2, q1, at, end, slope)
            turn_value = (((q4 * turn + q3) * turn + q2) * turn + q1) * turn + q0
            if value > 0.0 and turn_value <= 0.0:
                return _falling_quartic(q4, q3, q2, q1, q0, at, turn)
            if turn_value > 0.0 and end_value <= 0.0:
                return _falling_quartic(q4, q3, q2, q1, q0, turn, end)
        elif value > 0.0 and end_value <= 0.0:
            return _falling_quartic(q4, q3, q2, q1, q0, at, end)
        at, value, slope = end, end_value, end_slope
    return inf
