"""How does a sphere that lies on nothing collide, with another one or with a fixed body? In closed form.

Unit vectors and vectors in three dimensions, z up; impulses per unit mass [m/s]. A tangential impulse f changes the slip
at its own contact by 7/2 f on each free sphere (``inertia.py``, one sphere). Its direction never changes, so friction
acts along the first slip s: between two spheres ds = -7 mu(s) dp, against a fixed body ds = -7/2 mu dp, until s is zero.
"""

from math import exp, expm1, log, sqrt

from ..._lib.jit import kernel


@kernel
def slip_after(s, p, friction):
    """The slip of two free spheres, s at first [m/s], after the normal impulse p: ds/dp = -7 mu(s), mu = a + b exp(-c s).

    With E = exp(c s), dE/dp = -7 c (a E + b): a E + b falls as exp(-7 a c p); with r = E over the first one,
    r = 1 + (1 + b exp(-c s)/a) (exp(-7 a c p) - 1).
    """
    a, b, c = friction.least, friction.extra, friction.fade
    if b == 0.0 or c == 0.0:
        return max(0.0, s - 7.0 * (a + b) * p)
    least = exp(-c * s)  # r where the slip has ended
    k = 7.0 * a * c * p
    r = 1.0 + (1.0 + b * least / a) * expm1(-k) if k > 1e-12 else 1.0 - 7.0 * (a + b * least) * c * p
    return s + log(r) / c if r > least else 0.0


@kernel
def _cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel
def _spin_up(w, n, f, R):
    """The spin after the impulse f at R n from the centre: R dw = 5/2 n x f."""
    x, y, z = _cross(n, f)
    q = 2.5 / R
    return w[0] + q * x, w[1] + q * y, w[2] + q * z


@kernel
def between(v1, w1, v2, w2, n, friction, e, R):
    """Impact of two equal free spheres, ``n`` from 1 to 2, that approach -> v1, w1, v2, w2."""
    dx, dy, dz = v1[0] - v2[0], v1[1] - v2[1], v1[2] - v2[2]
    closing = dx * n[0] + dy * n[1] + dz * n[2]
    turn = _cross((w1[0] + w2[0], w1[1] + w2[1], w1[2] + w2[2]), n)
    sx = dx - closing * n[0] + R * turn[0]
    sy = dy - closing * n[1] + R * turn[1]
    sz = dz - closing * n[2] + R * turn[2]
    s, p = sqrt(sx * sx + sy * sy + sz * sz), 0.5 * (1.0 + e) * closing
    k = (s - slip_after(s, p, friction)) / (7.0 * s) if s > 0.0 else 0.0
    f = -k * sx, -k * sy, -k * sz
    j = f[0] - p * n[0], f[1] - p * n[1], f[2] - p * n[2]
    return (
        (v1[0] + j[0], v1[1] + j[1], v1[2] + j[2]),
        _spin_up(w1, n, f, R),
        (v2[0] - j[0], v2[1] - j[1], v2[2] - j[2]),
        _spin_up(w2, n, f, R),  # -f at -R n
    )


@kernel
def against(v, w, n, mu, e, R):
    """Impact of a free sphere with a fixed body, ``n`` towards it -> v, w. Unchanged if it does not approach."""
    x, y, z = n
    closing = v[0] * x + v[1] * y + v[2] * z
    if not closing > 0.0:
        return v, w
    sx = v[0] + R * (w[1] * z - w[2] * y) - closing * x
    sy = v[1] + R * (w[2] * x - w[0] * z) - closing * y
    sz = v[2] + R * (w[0] * y - w[1] * x) - closing * z
    slip = sqrt(sx * sx + sy * sy + sz * sz)
    p = (1.0 + e) * closing
    f = min(mu * p, slip / 3.5) / slip if slip > 0.0 else 0.0
    fx, fy, fz = -f * sx, -f * sy, -f * sz
    q = 2.5 / R
    w = (w[0] + q * (y * fz - z * fy), w[1] + q * (z * fx - x * fz), w[2] + q * (x * fy - y * fx))
    return (v[0] - p * x + fx, v[1] - p * y + fy, v[2] - p * z + fz), w
