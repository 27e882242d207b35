"""How is a step taken while both contacts slip? By the Taylor series, which covers most of an impact or all.

In t, dp = |a| dt, the solution is analytic between ends of slips. With s = |a|, the cloth slip b = B e, |e| =
1, and the load N (per unit of t), the equations of ``impulse.py`` have only products::

    s s = a . a      b = B e, e . e = 1      N = n_p s + n_f F2'      F' = -mu a      G' = -mu_s N e      p' = s      W' = closing s

So each coefficient follows from lower ones by sums of products: automatic differentiation (Moore, Interval
Analysis, 1966; Jorba & Zou, Experimental Mathematics 14, 2005). With X = sum of X_k t^k::

    (X Y)_k = X_0 Y_k + X_k Y_0 + [X_1 Y_(k-1) + ... + X_(k-1) Y_1]                     known part in brackets
    X_k = (X')_(k-1) / k                                                               F, G, p, W; a, b and the closing speed from these
    s_k = ([a . a - s s]_k / 2 + a_0 . a_k) / s_0                                       from s s = a . a
    e_k . e_0 = -[e . e]_k / 2                                                          from e . e = 1
    B_0 e_k + B_k e_0 = b_k - [B e]_k                                                   from b = B e: its parts along and across e_0
    mu = least + m, m = extra exp(-fade s):  k m_k = -fade (1 s_1 m_(k-1) + ... + k s_k m_0)      from m' = -fade s' m

A cloth slip that starts from zero: b = t B e, e_0 along the driving force, B_0 > 0, and b_(k+1) replaces b_k.
It has e_k in the friction, G'_k = -mu_s (N_0 e_k + [N e]_k + N_k e_0): the factor of e_k becomes B_0 +
K_CLOTH mu_s N_0 / (k + 1).
"""

from math import exp, log, sqrt

import numpy as np

from ..._lib.jit import kernel
from ..._lib.lanes import lane, lanes, lanes_at, put_lanes
from .coulomb import friction_coefficient
from .inertia import K_CLOTH
from .polynomial import CLOSING, F1, F2, G1, G2, LIFT, ROW, WORK_DONE, P

A1, A2, E1, E2, _E, _BN, S, M = 8, 9, 10, 11, 12, 16, 20, 21
"""Columns behind ``polynomial.py``'s: a, e, (e, e), (B, B, mu_s N, mu_s N), s, mu's varying part m."""

_LEAST_ORDER = 4
"""The lowest last order: below, two terms may be small by chance. Doubled or halved: no change."""
_HOVER = 0.03
"""Largest error in a slip over it: with more, a slip that should decay stays at the tolerance. Doubled or
halved: less than 3 % of the steps."""
_HUGE = 1e100
"""A larger term ends the series, as the next might overflow."""
_STEEP = 0.9
"""Largest ratio of successive terms that is used; above is chance. Doubled: steps beyond convergence, errors
without bound. Halved: 4 % fewer steps, up to 5 times the error of two balls at ``standard``."""
_SLOWEST = 0.2
"""In the estimated duration the slip falls to no less than this part. Doubled or halved: no change."""
_TINY = 1e-300
"""Keeps a quotient of two zeros finite."""
_PART_OF_ONE = 1.0 / np.maximum(np.arange(32.0), 1.0)
"""1/k, because a division takes longer than a load."""
_POSITIVE = 0xFFFF
"""A mask by which the compiler omits its test for negative indices, a third of the time."""


@kernel
def expand(series, x, slip, starts, p_left, problem, tol, order):
    """Write the series at state x; returns its order, and the time up to which its error is within tol.

    starts: the cloth slip is zero and about to start. p_left: estimated remaining impulse, which limits the
    order. Names without a number are terms of order k, those in 0 values at t = 0; ``r`` is 1/k.
    """
    k1, k2, c1, c2, d_a, d_b, d_n, n_p, n_f, _l_a, _l_n = problem.contact
    friction, mu_s = problem.friction, problem.mu_s
    a1_0, a2_0, b1_0, b2_0, closing0 = slip

    # order 0
    series[F1], series[F2], series[G1], series[G2], series[P], series[WORK_DONE], series[LIFT] = x
    series[CLOSING] = closing0
    s0 = sqrt(a1_0 * a1_0 + a2_0 * a2_0)
    mu0 = friction_coefficient(s0, friction)
    m0 = mu0 - friction.least
    f1, f2, s = -mu0 * a1_0, -mu0 * a2_0, s0  # F', and p' = s
    n_p, n_f = mu_s * n_p, mu_s * n_f  # N in units of what the cloth's friction can be: mu_s N
    load0 = n_p * s0 + n_f * f2
    if starts:  # b_1 without the cloth's own friction: what drives the slip
        b1_0, b2_0 = c1 * f1, d_b * s0 + c2 * f2
    size0 = sqrt(b1_0 * b1_0 + b2_0 * b2_0)  # B_0
    e1_0, e2_0 = b1_0 / size0, b2_0 / size0
    if starts:  # b_1 = B_0 e_0 = drive - K_CLOTH mu_s N_0 e_0
        size0 -= K_CLOTH * load0
    g1, g2 = -load0 * e1_0, -load0 * e2_0  # G'
    put_lanes(series, A1, lanes(a1_0, a2_0, e1_0, e2_0))
    series[S], series[M] = s0, m0
    tol = min(tol, _HOVER * s0)
    per_s, per_size = 1.0 / s0, 1.0 / size0
    h1, h2 = a1_0 * per_s, a2_0 * per_s  # a_0 / s_0
    x1, x2 = e1_0 * per_size, e2_0 * per_size  # e_0 over the factor of e_k
    power = closing0 * s0  # W'
    size = last = t = t2 = t_power = 0.0
    s_last = closing_last = s_first = closing_first = 0.0
    zeros, half = lanes(0.0, 0.0, 0.0, 0.0), lanes(0.5, 0.5, 0.5, 0.5)
    ae_first = e_first = bn_first = ae_last = e_last = bn_last = zeros
    for k in range(1, order + 1):
        m = ROW * k
        r = _PART_OF_ONE[k]
        # The terms of order k of the integrated quantities: the rates of order k - 1 over k.
        p = s * r
        power *= r
        f1 *= r
        f2 *= r
        g1 *= r
        g2 *= r
        a1, a2 = k1 * f1 + c1 * g1, (d_a * p + k2 * f2) + c2 * g2
        v1, v2 = c1 * f1 + K_CLOTH * g1, (d_b * p + c2 * f2) + K_CLOTH * g2  # b
        closing = (d_n * p - d_a * f2) - d_b * g2
        series[m + F1], series[m + F2], series[m + G1], series[m + G2] = f1, f2, g1, g2
        series[m + P], series[m + WORK_DONE], series[m + LIFT], series[m + CLOSING] = p, power, 0.0, closing

        # The order is high enough if the last two terms at the end of the impact are within tol.
        if k == 1:  # the duration of the impact if the slip keeps changing at this rate
            s_end = s0 + (h1 * a1 + h2 * a2) * per_s * p_left
            t = 2.0 * p_left / (s0 + max(s_end, _SLOWEST * s0))
            t2 = t * t
            t_power = t2 * t
        if k >= _LEAST_ORDER - 1:
            if k & 1:
                last = abs(a1) + abs(a2) + abs(v1) + abs(v2) + abs(power)
            else:
                size = abs(a1) + abs(a2) + abs(v1) + abs(v2) + abs(power)
                if (size * t + last) * t_power <= tol:
                    return k, t
                if k == order or size > _HUGE:
                    break
                t_power *= t2

        # The sums in brackets, over the orders i and k - i from 1 to k - 1; for even k the middle term first.
        # [a.a]/2 and [e.e]/2, [B e] and [N e], [s s]/2, [closing s]
        squares, products, ss, cs = zeros, zeros, 0.0, 0.0
        i = ROW * (k >> 1)
        if k & 1 == 0:
            ae = lanes_at(series, i + A1)
            squares = half * ae * ae
            products = lanes_at(series, i + _BN) * lanes_at(series, i + _E)
            ss = 0.5 * series[i + S] * series[i + S]
            cs = series[i + CLOSING] * series[i + S]
            i -= ROW
        while i > ROW:
            j = (m - i) & _POSITIVE
            squares = squares + lanes_at(series, i + A1) * lanes_at(series, j + A1)
            products = (
                products
                + lanes_at(series, i + _BN) * lanes_at(series, j + _E)
                + lanes_at(series, j + _BN) * lanes_at(series, i + _E)
            )
            ss += series[i + S] * series[j + S]
            cs += series[i + CLOSING] * series[j + S] + series[j + CLOSING] * series[i + S]
            i -= ROW
        if k == 2:
            ae_first, e_first, bn_first, s_first, closing_first = (
                ae_last,
                e_last,
                bn_last,
                s_last,
                closing_last,
            )
        elif k > 2:
            squares = squares + ae_first * ae_last
            products = products + bn_first * e_last + bn_last * e_first
            ss += s_first * s_last
            cs += closing_first * s_last + closing_last * s_first
        ee = lane(squares, 2) + lane(squares, 3)
        be1, be2, ne1, ne2 = lane(products, 0), lane(products, 1), lane(products, 2), lane(products, 3)

        # The rates of order k: p' = s, F' = -mu a, W' = closing s, mu_s N, and from b = B e the e of G'.
        s = ((lane(squares, 0) + lane(squares, 1) - ss) * per_s + h1 * a1) + h2 * a2
        f1, f2 = -mu0 * a1, -mu0 * a2
        if m0 > 0.0:
            varying = k * s * m0
            for n in range(1, k):
                i = ROW * n
                j = (m - i) & _POSITIVE
                varying += n * series[i + S] * series[j + M]
                f1 -= series[i + A1] * series[j + M]
                f2 -= series[i + A2] * series[j + M]
            varying *= -friction.fade * r
            series[m + M] = varying
            f1 -= varying * a1_0
            f2 -= varying * a2_0
        power = (cs + closing * s0) + closing0 * s
        load = n_p * s + n_f * f2
        scale = size0  # the factor of e_k
        if starts:
            r = _PART_OF_ONE[k + 1]
            scale = size0 + (K_CLOTH * load0) * r
            per_size = 1.0 / scale
            x1, x2 = e1_0 * per_size, e2_0 * per_size
            v1 = (c1 * f1 - K_CLOTH * (ne1 + load * e1_0)) * r  # b_(k+1) without the part of e_k
            v2 = (d_b * s + c2 * f2 - K_CLOTH * (ne2 + load * e2_0)) * r
        v1 -= be1  # scale e_k + B_k e_0
        v2 -= be2
        across = v2 * x1 - v1 * x2
        e1, e2 = -ee * e1_0 - across * e2_0, -ee * e2_0 + across * e1_0
        b = v1 * e1_0 + v2 * e2_0 + scale * ee
        series[m + S] = s
        s_last, closing_last = s, closing
        ae_last, e_last, bn_last = lanes(a1, a2, e1, e2), lanes(e1, e2, e1, e2), lanes(b, b, load, load)
        put_lanes(series, m + A1, ae_last)
        put_lanes(series, m + _E, e_last)
        put_lanes(series, m + _BN, bn_last)
        g1, g2 = -((load0 * e1 + ne1) + load * e1_0), -((load0 * e2 + ne2) + load * e2_0)

    # The order was not high enough: the time at which the last but one term, or the last, equals tol.
    h = exp(log(tol / (last + _TINY)) / (k - 1))
    ratio = size * h / (last + _TINY)
    if ratio > 1.0:  # then the last one is the larger
        h = exp(log(tol / size) / k)
    # the remainder is the last term over 1 - ratio: shorten by at least the k-th root of that (Bernoulli)
    ratio = min(ratio, _STEEP)
    return k, h / (1.0 + ratio / ((1.0 - ratio) * k))


@kernel
def turns_back(series, b1, b2):
    """Whether the cloth slip b is opposite to its direction at the start of the step."""
    return b1 * series[E1] + b2 * series[E2] < 0.0
