"""How is a step taken while both contacts slip? By the Taylor series of the solution, as long as it converges fast.

Between the ends of slips all is analytic in t, dp = |a| dt. Written with the sizes s = |a| and B = |b| and the cloth slip's direction e as
quantities of their own, the equations of ``impulse.py`` hold only products, so each series follows from those of lower order by sums of
products [Moore 1966; Jorba & Zou 2005]::

    s s = a . a      b = B e, e . e = 1      N = n0 s + n2 f2      f = -mu a      g = -mu_s N e      W' = y s

b = B e at order k is a linear equation for B_k and the part of e_k across e_0; the part along e_0 follows from e . e = 1. A cloth slip that
starts from zero is no singularity either: b = t B e with B_0 > 0, where e_0 is the direction of what drives it. Then b_{k+1} itself holds
B_k and e_k, the latter through the friction -mu_s N e, and the equation is linear all the same.
"""

from math import exp, log, sqrt

from ..._jit import kernel
from .coulomb import KB, friction_coefficient
from .polynomial import ROW

_MIN_ORDER = 4
_HOVER = 0.03  # an error allowed in a slip, over that slip: a slip that should die would hover at the size of the tolerance
_HUGE = 1e100  # no use in going on: the next coefficients might overflow
_STEEP = 0.9  # ratio of successive terms; a larger one is chance
_POSITIVE = 0xFFFF  # a mask that spares the compiler's test for negative indices, a third of the time
_S, _A1, _A2, _E1, _E2, _B, _N, _MU = 8, 9, 10, 11, 12, 13, 14, 15  # the series' places in a row, behind the polynomial's


@kernel
def expand(w, x, a1, a2, b1, b2, y, starts, p_left, c, law, mu_s, tol, order):
    """The series at state x with its slips and closing speed -> its order, and the time for which it holds to within tol.

    starts: the cloth slip is zero and about to start. p_left: the impulse still to come, about; the order is no higher than that needs.
    """
    k1, k2, c1, c2, d_a, d_b, d_y, n0, n2, _la, _ly = c
    w[0], w[1], w[2], w[3], w[4], w[5], w[6], w[7] = x[0], x[1], x[2], x[3], x[4], x[5], x[6], y
    s0 = sqrt(a1 * a1 + a2 * a2)
    mu0 = friction_coefficient(s0, law)
    varies = mu0 - law[0]
    f1, f2, s = -mu0 * a1, -mu0 * a2, s0
    n0, n2 = mu_s * n0, mu_s * n2  # N in units of what the cloth's friction can be
    load0 = n0 * s0 + n2 * f2
    if starts:
        b1, b2 = c1 * f1, d_b * s0 + c2 * f2
    size0 = sqrt(b1 * b1 + b2 * b2)
    e1_0, e2_0 = b1 / size0, b2 / size0
    if starts:
        size0 -= KB * load0
    g1, g2 = -load0 * e1_0, -load0 * e2_0
    w[_S], w[_A1], w[_A2], w[_E1], w[_E2], w[_B], w[_N], w[_MU] = s0, a1, a2, e1_0, e2_0, size0, load0, varies
    tol = min(tol, _HOVER * s0)
    per_s, per_size = 1.0 / s0, 1.0 / size0
    h1, h2 = a1 * per_s, a2 * per_s
    x1, x2 = e1_0 * per_size, e2_0 * per_size
    power = y * s0
    size, last, t, t_power = 0.0, 0.0, p_left * per_s, 1.0
    for k in range(1, order + 1):
        m = ROW * k
        r = 1.0 / k
        # the coefficients of order k: the rates of order k - 1, integrated
        p = s * r
        power *= r
        u1, u2 = (k1 * r) * f1 + (c1 * r) * g1, (d_a * p + (k2 * r) * f2) + (c2 * r) * g2
        v1, v2 = (c1 * r) * f1, d_b * p + (c2 * r) * f2
        q1, q2 = (KB * r) * g1, (KB * r) * g2
        f1 *= r
        f2 *= r
        g1 *= r
        g2 *= r
        y_k = (d_y * p - d_a * f2) - d_b * g2
        w[m], w[m + 1], w[m + 2], w[m + 3], w[m + 4], w[m + 5], w[m + 6], w[m + 7] = f1, f2, g1, g2, p, power, 0.0, y_k
        w[m + _A1], w[m + _A2] = u1, u2
        if k == 1:  # the time that the impact takes if the slip goes on to change at this rate
            s_end = s0 + (h1 * u1 + h2 * u2) * per_s * p_left
            t = 2.0 * p_left / (s0 + max(s_end, 0.2 * s0))
        last, size = size, abs(u1) + abs(u2) + abs(v1 + q1) + abs(v2 + q2) + abs(power)
        if (size * t + last) * t_power <= tol and k >= _MIN_ORDER:
            return k, t
        t_power *= t
        if k == order or size > _HUGE:
            break
        # products of the orders 1 to k - 1, the newest last
        squares = ys = ee = be1 = be2 = ne1 = ne2 = 0.0
        i = ROW * (k >> 1)
        if k & 1 == 0:
            e1, e2 = w[i + _E1], w[i + _E2]
            squares = 0.5 * (w[i + _A1] * w[i + _A1] + w[i + _A2] * w[i + _A2] - w[i + _S] * w[i + _S])
            ys = w[i + 7] * w[i + _S]
            ee = 0.5 * (e1 * e1 + e2 * e2)
            be1, be2 = w[i + _B] * e1, w[i + _B] * e2
            ne1, ne2 = w[i + _N] * e1, w[i + _N] * e2
            i -= ROW
        while i > 0:
            j = (m - i) & _POSITIVE
            e1, e2, d1, d2 = w[i + _E1], w[i + _E2], w[j + _E1], w[j + _E2]
            squares += w[i + _A1] * w[j + _A1] + w[i + _A2] * w[j + _A2] - w[i + _S] * w[j + _S]
            ys += w[i + 7] * w[j + _S] + w[j + 7] * w[i + _S]
            ee += e1 * d1 + e2 * d2
            be1 += w[i + _B] * d1 + w[j + _B] * e1
            be2 += w[i + _B] * d2 + w[j + _B] * e2
            ne1 += w[i + _N] * d1 + w[j + _N] * e1
            ne2 += w[i + _N] * d2 + w[j + _N] * e2
            i -= ROW
        # the rates of order k
        s = (squares * per_s + h1 * u1) + h2 * u2
        f1, f2 = -mu0 * u1, -mu0 * u2
        if varies > 0.0:
            mu = k * s * varies
            for n in range(1, k):
                i = ROW * n
                j = (m - i) & _POSITIVE
                mu += n * w[i + _S] * w[j + _MU]
                f1 -= w[i + _A1] * w[j + _MU]
                f2 -= w[i + _A2] * w[j + _MU]
            mu *= -law[2] * r
            w[m + _MU] = mu
            f1 -= mu * a1
            f2 -= mu * a2
        power = (ys + y_k * s0) + y * s
        load = n0 * s + n2 * f2
        scale = size0
        if starts:
            r = 1.0 / (k + 1)
            scale = size0 + (KB * load0) * r
            per_size = 1.0 / scale
            x1, x2 = e1_0 * per_size, e2_0 * per_size
            v1, v2 = (c1 * r) * f1 - be1, (d_b * s + c2 * f2) * r - be2
            q1, q2 = -(KB * r) * (ne1 + load * e1_0), -(KB * r) * (ne2 + load * e2_0)
        else:
            v1 -= be1
            v2 -= be2
        v1 += q1
        v2 += q2
        across = v2 * x1 - v1 * x2
        e1, e2 = -ee * e1_0 - across * e2_0, -ee * e2_0 + across * e1_0
        w[m + _S], w[m + _E1], w[m + _E2], w[m + _N] = s, e1, e2, load
        w[m + _B] = v1 * e1_0 + v2 * e2_0 + scale * ee
        g1, g2 = -((load0 * e1 + ne1) + load * e1_0), -((load0 * e2 + ne2) + load * e2_0)
    h = exp(log(tol / (last + 1e-300)) / (k - 1))
    ratio = size * h / (last + 1e-300)
    if ratio > 1.0:  # then the very last term is the larger
        h = exp(log(tol / size) / k)
    # what is left out is the last term over 1 - ratio: a step shorter by the root of that, or a little more (Bernoulli's inequality)
    ratio = min(ratio, _STEEP)
    return k, h / (1.0 + ratio / ((1.0 - ratio) * k))


@kernel
def turned(w, b1, b2):
    """Does the cloth's slip point backwards, seen from the step's start?"""
    return b1 * w[_E1] + b2 * w[_E2] < 0.0
