"""How fast do the impulses of an impact grow? Coulomb's law at its two contacts: at A, between the bodies, and under the pressed ball.

The equations and their names are those of ``impulse.py``. Each contact is in one of a few states, and each state has its own rates.
"""

from math import exp, hypot, sqrt

from ..._jit import kernel

SLIP, STICK, CREEP = 0, 1, 2  # what contact A does
SLIDES, STARTS, GRIPS = 0, 1, 2  # what the cloth contact does: slips; is about to slip, from zero; holds
_SLOW = 0.1  # a slip changes slowly if friction and drive cancel but for this part
KB = 3.5  # effective inverse mass of a solid sphere's lowest point, times M


@kernel
def friction_coefficient(s, law):
    """mu(s) = a + b exp(-c s); ``law`` = (a, b, c)."""
    return law[0] if law[1] == 0.0 else law[0] + law[1] * exp(-law[2] * s)


@kernel
def slips(x, start, c):
    """Slips a1, a2 at A, b1, b2 at the cloth, and the closing speed y, from the state x = (F1, F2, G1, G2, p, W, Z)."""
    k1, k2, c1, c2, d_a, d_b, d_y, _n0, _n2, l_a, l_y = c
    f1, f2, g1, g2, p, _w, z = x
    return (
        start[0] + k1 * f1 + c1 * g1,
        start[1] + d_a * p + k2 * f2 + c2 * g2 + l_a * z,
        start[2] + c1 * f1 + KB * g1,
        start[3] + d_b * p + c2 * f2 + KB * g2,
        1.0 + d_y * p - d_a * f2 - d_b * g2 + l_y * z,
    )


@kernel
def _cloth_friction(b1, b2, drive1, drive2, most, near, cloth):
    """Friction of at most ``most`` against the cloth slip b; against the drive, where b starts from zero; or what holds it at zero."""
    if cloth == GRIPS:
        return -drive1 / KB, -drive2 / KB
    size = sqrt(b1 * b1 + b2 * b2)
    if size > (near if cloth == STARTS else 0.0):
        r = -most / size
        return r * b1, r * b2
    size = sqrt(drive1 * drive1 + drive2 * drive2)
    if size == 0.0:
        return 0.0, 0.0
    r = -most / size
    return r * drive1, r * drive2


@kernel
def _slip_rates(x, start, c, law, mu_s, near, cloth):
    """dx/dt while A slips, dp = |a| dt."""
    c1, c2, d_b, n0, n2 = c[2], c[3], c[5], c[7], c[8]
    a1, a2, b1, b2, y = slips(x, start, c)
    s = sqrt(a1 * a1 + a2 * a2)
    mu = friction_coefficient(s, law)
    f1, f2 = -mu * a1, -mu * a2
    load = n0 * s + n2 * f2
    lift = 0.0
    if load < 0.0 or x[6] > 0.0:
        lift, load = -load, 0.0
    g1, g2 = _cloth_friction(b1, b2, c1 * f1, d_b * s + c2 * f2, mu_s * load, near, cloth)
    return f1, f2, g1, g2, s, y * s, lift


@kernel
def _stick_forces(b1, b2, z, c, mu_s, near, cloth):
    """Per unit of p, the friction (f1, f2) that holds a = 0, with the cloth's (g1, g2) and the lift it implies."""
    k1, k2, c1, c2, d_a, d_b, _dy, n0, n2, l_a, _ly = c
    if cloth == GRIPS:  # only the second components are driven
        det = k2 * KB - c2 * c2
        return 0.0, (c2 * d_b - KB * d_a) / det, 0.0, (c2 * d_a - k2 * d_b) / det, 0.0
    size = sqrt(b1 * b1 + b2 * b2)
    if size > (near if cloth == STARTS else 0.0):
        e1, e2 = b1 / size, b2 / size
    else:
        e1, e2 = 0.0, 1.0 if d_b - c2 * d_a / k2 >= 0.0 else -1.0
    # g = -mu_s N e and f = -(d + C g)/k with N = n0 + n2 f2: one linear equation for f2
    drive = c2 * mu_s * e2 * n0 - d_a
    f2 = drive / (k2 - c2 * mu_s * e2 * n2) if drive != 0.0 else 0.0  # at sin_theta 0, mu_s 1 both are zero
    load = n0 + n2 * f2
    if load < 0.0 or z > 0.0:
        f2 = (l_a * n0 - d_a) / (k2 - l_a * n2)
        return 0.0, f2, 0.0, 0.0, -(n0 + n2 * f2)
    g1, g2 = -mu_s * load * e1, -mu_s * load * e2
    return -c1 * g1 / k1, f2, g1, g2, 0.0


@kernel
def _stick_rates(x, start, c, mu_s, near, cloth):
    """dx/dp while A sticks."""
    _a1, _a2, b1, b2, y = slips(x, start, c)
    f1, f2, g1, g2, lift = _stick_forces(b1, b2, x[6], c, mu_s, near, cloth)
    return f1, f2, g1, g2, 1.0, y, lift


@kernel
def _creep_rates(x, start, c, law, mu_s, near, cloth):
    """dx/dp while the slip at A is negligible and friction hardly outweighs the drive, or the drive it: just after A broke loose, or while
    its slip all but dies. It then has the direction e that the drive gives it.

    There a' = kappa e, so e_i = q_i / (kappa + mu k_i) with q the drive without A's own friction, and |e| = 1 gives kappa; q holds
    the cloth's friction, which depends on e through the load: iterated.
    """
    k1, k2, c1, c2, d_a, d_b, _dy, n0, n2, l_a, _ly = c
    a1, a2, b1, b2, y = slips(x, start, c)
    mu = friction_coefficient(hypot(a1, a2), law)
    e1, e2 = 0.0, 1.0 if d_a >= 0.0 else -1.0
    g1 = g2 = lift = 0.0
    for _ in range(30):
        load = n0 - n2 * mu * e2
        lift = 0.0
        if load < 0.0 or x[6] > 0.0:
            lift, load = -load, 0.0
        g1, g2 = _cloth_friction(b1, b2, -c1 * mu * e1, d_b - c2 * mu * e2, mu_s * load, near, cloth)
        r1, r2 = _direction(c1 * g1, d_a + c2 * g2 + l_a * lift, mu * k1, mu * k2)
        moved = abs(r1 - e1) + abs(r2 - e2)
        e1, e2 = r1, r2
        if moved < 1e-15:
            break
    return -mu * e1, -mu * e2, g1, g2, 1.0, y, lift


@kernel
def _slip_speed(rates, c):
    """How fast the slip at A changes, per unit of the rates' variable."""
    return hypot(c[0] * rates[0] + c[2] * rates[2], c[4] * rates[4] + c[1] * rates[1] + c[3] * rates[3] + c[9] * rates[6])


@kernel
def settled(x, a1, a2, s, start, c, law, mu_s, near, cloth):
    """Does friction nearly balance the drive, and has the slip at A settled in the drive's direction?

    Then dp = |a| dt would hardly move on, and ``_creep_rates`` is right to within the slip.
    """
    rates = _creep_rates(x, start, c, law, mu_s, near, cloth)
    f1, f2 = rates[0], rates[1]
    slow = _slip_speed(rates, c) < _SLOW * friction_coefficient(0.0, law) * c[1]
    return slow and f1 * a1 + f2 * a2 < 0.0 and abs(f1 * a2 - f2 * a1) <= 1e-3 * s * hypot(f1, f2)


@kernel
def _direction(q1, q2, m1, m2):
    """The unit vector e with e_i = q_i / (kappa + m_i), kappa > -min(m1, m2)."""
    size = hypot(q1, q2)
    if q1 == 0.0 or size == 0.0:
        return 0.0, 1.0 if q2 >= 0.0 else -1.0
    low, high = -min(m1, m2), size
    for _ in range(60):
        kappa = 0.5 * (low + high)
        if (q1 / (kappa + m1)) ** 2 + (q2 / (kappa + m2)) ** 2 > 1.0:
            low = kappa
        else:
            high = kappa
    r1, r2 = q1 / (high + m1), q2 / (high + m2)
    size = hypot(r1, r2)
    return r1 / size, r2 / size


@kernel
def rates(x, mode, start, c, law, mu_s, near, cloth):
    if mode == SLIP:
        return _slip_rates(x, start, c, law, mu_s, near, cloth)
    if mode == STICK:
        return _stick_rates(x, start, c, mu_s, near, cloth)
    return _creep_rates(x, start, c, law, mu_s, near, cloth)


@kernel
def held(x, start, c, law, mu_s, near, cloth):
    """Can friction hold the slip at A at zero?"""
    _1, _2, b1, b2, _v = slips(x, start, c)
    f = _stick_forces(b1, b2, x[6], c, mu_s, near, cloth)
    return hypot(f[0], f[1]) <= friction_coefficient(0.0, law)


@kernel
def wedged(c, law, mu_s):
    """Between nose and cloth, both slips zero: do both hold?

    Then nothing moves across the nose, and no impulse frees the ball. It takes both frictions: the forces go through both contacts.
    """
    _1, f2, _2, g2, _lift = _stick_forces(0.0, 0.0, 0.0, c, mu_s, 0.0, GRIPS)
    return abs(f2) <= friction_coefficient(0.0, law) and abs(g2) <= mu_s * (c[7] + c[8] * f2)


@kernel
def grip_holds(rates, x, c, mu_s):
    """Is the cloth's friction in ``rates``, of a grip, within Coulomb's law, and the ball down?"""
    most = mu_s * (c[7] * rates[4] + c[8] * rates[1])
    return x[6] <= 0.0 and rates[2] * rates[2] + rates[3] * rates[3] <= most * most and most > 0.0
