"""Is no root missed? Crossings of quadratics and quartics against exact construction and dense sampling."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from snooker_env.physics import detection, roots
from tests.kernels import from_python

distance_crossing = from_python(detection.distance_crossing)
quadratic_crossing = from_python(roots.quadratic_crossing)
quartic_crossing = from_python(roots.quartic_crossing)


def numbers(low, high):
    """Floats in which squares do not underflow, or 0: no speed or acceleration of a ball is smaller and not nothing."""
    return st.floats(low, high).map(lambda x: 0.0 if abs(x) < 1e-100 else x)


@settings(max_examples=300, deadline=None)
@given(
    st.lists(numbers(-3, 3), min_size=4, max_size=4),
    st.floats(0.1, 5),
    st.sampled_from([1.0, -1.0]),
    st.integers(-12, 12).map(lambda k: 10.0**k),
)
def test_quartic_with_known_real_roots(roots, T, sign, scale):
    """With times stretched over 24 decades."""
    q = sign * np.poly(roots)
    gaps = np.diff(np.sort(roots))
    if gaps.min() < 1e-3 or min(abs(x) for x in [*roots, *(T - x for x in roots)]) < 1e-6:
        return  # (nearly) double roots and roots at the ends: rounding of the coefficients decides
    falls = [x for x in roots if 0 <= x <= T and np.polyval(np.polyder(q), x) < 0]
    stretched = (a / scale**k for a, k in zip(q, range(4, -1, -1), strict=True))
    first = min(falls, default=np.inf)
    assert quartic_crossing(*stretched, T * scale) / scale == pytest.approx(first, abs=1e-8)


@settings(max_examples=300, deadline=None)
@given(st.tuples(*[numbers(-10, 10)] * 5), st.floats(0.01, 3))
def test_quartic_never_misses_a_sign_change(q, T):
    """Where a dense sample sees the value fall through zero, a crossing there or before is found; and what is found is one."""
    got = quartic_crossing(*q, T)
    x = np.linspace(0, T, 2001)
    f = np.polyval(q, x)
    size = np.polyval(np.abs(q), T) + 1e-300
    seen = np.flatnonzero((f[:-1] > 1e-12 * size) & (f[1:] < -1e-12 * size))
    if len(seen):
        assert got <= x[seen[0] + 1] * (1 + 1e-12)
    if np.isfinite(got):
        assert 0 <= got <= T
        assert abs(np.polyval(q, got)) <= 1e-9 * size


@given(numbers(-5, 5), numbers(-5, 5), numbers(-5, 5), st.floats(0.01, 4))
@settings(max_examples=300, deadline=None)
def test_quadratic(c0, c1, c2, T):
    got = quadratic_crossing(c0, c1, c2, T)
    x = np.linspace(0, T, 2001)
    f = c0 + c1 * x + c2 * x * x
    seen = np.flatnonzero((f[:-1] > 1e-9) & (f[1:] < -1e-9))
    if len(seen):
        assert x[seen[0]] - 1e-6 <= got <= x[seen[0] + 1] + 1e-6
    if np.isfinite(got):
        assert abs(c0 + c1 * got + c2 * got * got) < 1e-9
        assert c1 + 2 * c2 * got < 0


@settings(max_examples=400, deadline=None)
@given(st.tuples(*[numbers(-2, 2)] * 6), st.floats(0.01, 3))
def test_rejection_loses_nothing(c, T):
    """The cheap tests before the quartic never throw away a contact that a dense sample sees."""
    x0, y0, x1, y1, x2, y2 = c
    d = 0.3
    if np.hypot(x0, y0) < d + 1e-6:
        return
    got = distance_crossing(x0, y0, x1, y1, x2, y2, d, T)
    t = np.linspace(0, T, 4001)
    far = np.hypot(x0 + x1 * t + x2 * t * t, y0 + y1 * t + y2 * t * t)
    inside = np.flatnonzero(far < d - 1e-9)
    if len(inside):
        assert got <= t[inside[0]]
    if np.isfinite(got):
        x, y = x0 + x1 * got + x2 * got**2, y0 + y1 * got + y2 * got**2
        assert np.hypot(x, y) == pytest.approx(d, abs=1e-9)
