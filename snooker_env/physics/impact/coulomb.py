"""How does Coulomb's law at the two contacts drive an impact? Rates of its impulses in each state.

Symbols as in ``inertia.py`` and ``impulse.py``. A slips, sticks, or creeps; the cloth slides, starts, or
grips.
"""

from math import exp, hypot, sqrt
from typing import NamedTuple

import numpy as np

from ..._lib.jit import kernel
from .inertia import K_CLOTH, Contact, Impulses, Slips, slips_after

# typed: with literals numba would compile every callee once for each
SLIP, STICK, CREEP = (np.int64(k) for k in range(3))
"""Of contact A. SLIP: friction is opposite to the slip. STICK: friction holds it at zero. CREEP: friction
cannot, but the slip is too small to integrate; it has the direction of the driving forces."""
SLIDES, STARTS, GRIPS = (np.int64(k) for k in range(3))
"""Of the cloth. SLIDES: friction is opposite to the slip. STARTS: the slip is zero and about to start;
friction is opposite to the driving force. GRIPS: friction holds it at zero."""

_NEARLY_BALANCED = 0.1
"""A slip creeps only while friction and drive sum to at most this part of friction's effect. Doubled or
halved: less than 2 % of the steps (measured as in ``impulse.py``, here and below)."""
_ALIGNED = 1e-3
"""And only within this angle of the driving force [rad]. Doubled or halved: no change above 2e-8."""
_DIRECTION_TRIALS, _SETTLED = 30, 1e-15
"""Each iteration of the direction of creep gains about mu. Halved: no change above 5e-13."""
_TRIALS = 60
"""Newton's method takes 3 to 6; bisection alone, as for q1 near zero, no more to end at rounding."""


class Friction(NamedTuple):
    """Friction at A against the slip s: mu(s) = least + extra exp(-fade s), ``fade`` in 1 / (unit of s)."""

    least: float
    extra: float
    fade: float


class Problem(NamedTuple):
    """One impact: its constants, the slips before it, friction at A and the cloth, energetic restitution."""

    contact: Contact
    start: Slips
    friction: Friction
    mu_s: float
    e: float


@kernel
def friction_coefficient(s, friction):
    """mu(s), without an exponential for a constant law."""
    return (
        friction.least if friction.extra == 0.0 else friction.least + friction.extra * exp(-friction.fade * s)
    )


@kernel
def _cloth_friction(slip, drive1, drive2, most, near, cloth):
    """The cloth's friction: ``most`` against slip b, or the drive at zero; or what holds b at zero."""
    if cloth == GRIPS:
        return -drive1 / K_CLOTH, -drive2 / K_CLOTH
    size = sqrt(slip.b1 * slip.b1 + slip.b2 * slip.b2)
    if size > (near if cloth == STARTS else 0.0):
        r = -most / size
        return r * slip.b1, r * slip.b2
    size = sqrt(drive1 * drive1 + drive2 * drive2)
    if size == 0.0:
        return 0.0, 0.0
    r = -most / size
    return r * drive1, r * drive2


@kernel
def _slip_rates(x, near, cloth, problem):
    """dx/dt while A slips, dp = |a| dt: F' = -mu a."""
    contact = problem.contact
    slip = slips_after(x, problem.start, contact)
    s = sqrt(slip.a1 * slip.a1 + slip.a2 * slip.a2)
    mu = friction_coefficient(s, problem.friction)
    f1, f2 = -mu * slip.a1, -mu * slip.a2
    load = contact.n_p * s + contact.n_f * f2
    lift = 0.0
    if load < 0.0 or x.Z > 0.0:
        lift, load = -load, 0.0
    drive1, drive2 = contact.c1 * f1, contact.d_b * s + contact.c2 * f2
    g1, g2 = _cloth_friction(slip, drive1, drive2, problem.mu_s * load, near, cloth)
    return Impulses(f1, f2, g1, g2, s, slip.closing * s, lift)


@kernel
def _stick_forces(b1, b2, z, near, cloth, problem):
    """The friction that holds a = 0, the cloth's and the lift, per unit of p: f1, f2, g1, g2, lift."""
    k1, k2, c1, c2, d_a, d_b, _d_n, n_p, n_f, l_a, _l_n = problem.contact
    mu_s = problem.mu_s
    if cloth == GRIPS:  # a' = 0 and b' = 0; only their second components are driven
        det = k2 * K_CLOTH - c2 * c2
        return 0.0, (c2 * d_b - K_CLOTH * d_a) / det, 0.0, (c2 * d_a - k2 * d_b) / det, 0.0
    size = sqrt(b1 * b1 + b2 * b2)
    if size > (near if cloth == STARTS else 0.0):
        e1, e2 = b1 / size, b2 / size
    else:
        e1, e2 = 0.0, 1.0 if d_b - c2 * d_a / k2 >= 0.0 else -1.0
    # g = -mu_s N e with N = n_p + n_f f2, and a2' = 0: one linear equation for f2
    drive = c2 * mu_s * e2 * n_p - d_a
    f2 = drive / (k2 - c2 * mu_s * e2 * n_f) if drive != 0.0 else 0.0  # at sin_theta 0, mu_s 1 both are zero
    load = n_p + n_f * f2
    if load < 0.0 or z > 0.0:  # the ball lifts: g = 0, and a2' = 0 holds with l_a Z' = -l_a N
        f2 = (l_a * n_p - d_a) / (k2 - l_a * n_f)
        return 0.0, f2, 0.0, 0.0, -(n_p + n_f * f2)
    g1, g2 = -mu_s * load * e1, -mu_s * load * e2
    return -c1 * g1 / k1, f2, g1, g2, 0.0


@kernel
def _stick_rates(x, near, cloth, problem):
    """dx/dp while A sticks."""
    slip = slips_after(x, problem.start, problem.contact)
    f1, f2, g1, g2, lift = _stick_forces(slip.b1, slip.b2, x.Z, near, cloth, problem)
    return Impulses(f1, f2, g1, g2, 1.0, slip.closing, lift)


@kernel
def _creep_rates(x, near, cloth, problem):
    """dx/dp while A creeps: friction and drive nearly balance, as A begins to slip or its slip decays.

    The slip has the drive's direction e: a' = kappa e, kappa >= 0, F' = -mu e, so (kappa + mu k_i) e_i = q_i.
    The drive q, without A's friction, has the cloth's, which depends on e by the load: e is iterated, kappa
    is from |e| = 1.
    """
    contact, mu_s = problem.contact, problem.mu_s
    slip = slips_after(x, problem.start, contact)
    mu = friction_coefficient(hypot(slip.a1, slip.a2), problem.friction)
    e1, e2 = 0.0, 1.0 if contact.d_a >= 0.0 else -1.0
    g1 = g2 = lift = 0.0
    for _ in range(_DIRECTION_TRIALS):
        load = contact.n_p - contact.n_f * mu * e2
        lift = 0.0
        if load < 0.0 or x.Z > 0.0:
            lift, load = -load, 0.0
        drive1, drive2 = -contact.c1 * mu * e1, contact.d_b - contact.c2 * mu * e2
        g1, g2 = _cloth_friction(slip, drive1, drive2, mu_s * load, near, cloth)
        q1, q2 = contact.c1 * g1, contact.d_a + contact.c2 * g2 + contact.l_a * lift
        r1, r2 = _direction(q1, q2, mu * contact.k1, mu * contact.k2)
        moved = abs(r1 - e1) + abs(r2 - e2)
        e1, e2 = r1, r2
        if moved < _SETTLED:
            break
    return Impulses(-mu * e1, -mu * e2, g1, g2, 1.0, slip.closing, lift)


@kernel
def _direction(q1, q2, m1, m2):
    """The unit vector e with e_i = q_i / (kappa + m_i), kappa > -min(m1, m2)."""
    size = hypot(q1, q2)
    if q1 == 0.0 or size == 0.0:
        return 0.0, 1.0 if q2 >= 0.0 else -1.0
    low, high = -min(m1, m2), size
    kappa = high
    for _ in range(_TRIALS):
        r1, r2 = q1 / (kappa + m1), q2 / (kappa + m2)
        square = r1 * r1 + r2 * r2
        low, high = (kappa, high) if square > 1.0 else (low, kappa)
        slope = r1 * r1 / (kappa + m1) + r2 * r2 / (kappa + m2)  # of -square / 2
        # Newton's method for 1 / sqrt(square) = 1, which is nearly linear in kappa
        step = square * (sqrt(square) - 1.0) / slope
        if abs(step) <= _SETTLED * size:
            break
        kappa += step
        if not low < kappa < high:
            kappa = 0.5 * (low + high)
    else:
        kappa = high
    r1, r2 = q1 / (kappa + m1), q2 / (kappa + m2)
    size = hypot(r1, r2)
    return r1 / size, r2 / size


@kernel
def rates(x, mode, near, cloth, problem):
    """The rates of the impulses in this state: per unit of t (dp = |a| dt) while A slips, else of p."""
    if mode == SLIP:
        return _slip_rates(x, near, cloth, problem)
    if mode == STICK:
        return _stick_rates(x, near, cloth, problem)
    return _creep_rates(x, near, cloth, problem)


@kernel
def _slip_rate(per, contact):
    """The rate at which the slip at A changes while the impulses grow at the rates ``per``."""
    return hypot(
        contact.k1 * per.F1 + contact.c1 * per.G1,
        contact.d_a * per.p + contact.k2 * per.F2 + contact.c2 * per.G2 + contact.l_a * per.Z,
    )


@kernel
def settles(x, slip, s, near, cloth, problem):
    """Whether friction at A nearly balances the drive and slip s lies along it: steps in t would stall."""
    per = _creep_rates(x, near, cloth, problem)
    slow = (
        _slip_rate(per, problem.contact)
        < _NEARLY_BALANCED * friction_coefficient(0.0, problem.friction) * problem.contact.k2
    )
    opposed = per.F1 * slip.a1 + per.F2 * slip.a2 < 0.0
    return (
        slow and opposed and abs(per.F1 * slip.a2 - per.F2 * slip.a1) <= _ALIGNED * s * hypot(per.F1, per.F2)
    )


@kernel
def can_hold(x, near, cloth, problem):
    """Whether friction can hold the slip at A at zero."""
    slip = slips_after(x, problem.start, problem.contact)
    f = _stick_forces(slip.b1, slip.b2, x.Z, near, cloth, problem)
    return hypot(f[0], f[1]) <= friction_coefficient(0.0, problem.friction)


@kernel
def is_wedge(problem):
    """Whether both contacts hold a ball between nose and cloth whose slips are zero: no impulse frees it."""
    _f1, f2, _g1, g2, _lift = _stick_forces(0.0, 0.0, 0.0, 0.0, GRIPS, problem)
    load = problem.contact.n_p + problem.contact.n_f * f2
    return abs(f2) <= friction_coefficient(0.0, problem.friction) and abs(g2) <= problem.mu_s * load


@kernel
def stop_wedge(x, slip, contact):
    """The impulses x and what stops a wedged ball: both slips end, and with them the closing speed."""
    k1, k2, c1, c2 = contact.k1, contact.k2, contact.c1, contact.c2
    det1, det2 = k1 * K_CLOTH - c1 * c1, k2 * K_CLOTH - c2 * c2
    return Impulses(
        x.F1 + (c1 * slip.b1 - K_CLOTH * slip.a1) / det1,
        x.F2 + (c2 * slip.b2 - K_CLOTH * slip.a2) / det2,
        x.G1 + (c1 * slip.a1 - k1 * slip.b1) / det1,
        x.G2 + (c2 * slip.a2 - k2 * slip.b2) / det2,
        x.p,
        x.W,
        0.0,
    )


@kernel
def grip_holds(per, x, problem):
    """Whether the cloth's friction in the rates ``per`` of a grip obeys Coulomb, and the ball is down."""
    most = problem.mu_s * (problem.contact.n_p * per.p + problem.contact.n_f * per.F2)
    return x.Z <= 0.0 and most * most >= per.G1 * per.G1 + per.G2 * per.G2 and most > 0.0
