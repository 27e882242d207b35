"""How does a frictional impact unfold? Two coupled Coulomb contacts integrated over the normal impulse, events located.

Ball against ball [MJP14] and ball against cushion [MJP10] are the same problem with other constants. In the plane of the impact's
contact A live its slip ``a = (a1, a2)`` and the friction impulse ``F = (F1, F2)``; under the ball pressed into the cloth live the
cloth's slip ``b = (b1, b2)`` and friction impulse ``G = (G1, G2)``. With p the accumulated normal impulse per unit mass::

    a1 = a1_0         + k1 F1 + c1 G1                     Everything is linear in F, G, p and the lift Z,
    a2 = a2_0 + d_a p + k2 F2 + c2 G2 + l_a Z             so those seven numbers (W, the work, is the
    b1 = b1_0         + c1 F1 + 7/2 G1                    seventh) are the whole state.
    b2 = b2_0 + d_b p + c2 F2 + 7/2 G2
    y  = y_0  + d_y p - d_a F2 - d_b G2 + l_y Z           closing speed; dW/dp = y
    N' = n0 + n2 F2'  if positive, else Z' = -(n0 + n2 F2') and N' = 0      (the ball lifts)

Coulomb: F' = -mu(|a|) a/|a|, G' = -mu_s N' b/|b|. Where a slip is zero, friction holds it there if it can; if not, slip starts in
the direction the other forces drive it. Compression ends at y = 0 with W = Wc, the impact at W = (1 - e^2) Wc (energetic
restitution, Stronge).

Method: the explicit pair of Dormand & Prince 5(4) with its dense output. While A slips the independent variable is t with
dp = |a| dt: then F' = -mu a is regular and the end of slip, where its direction turns like a power of |a|, is approached
exponentially instead of as a singularity. All speeds are divided by y_0 first, so tolerances are relative to the impulse.
"""

from math import exp, hypot, sqrt

from .._jit import kernel

OK, TOO_MANY_STEPS = 0, 1
_SLIP, _STICK, _CREEP = 0, 1, 2
_ZERO = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
_MAX_STEPS = 20_000
_KB = 3.5  # effective inverse mass of a solid sphere's lowest point, times M


@kernel
def friction_coefficient(s, law):
    """mu(s) = a + b exp(-c s); ``law`` = (a, b, c)."""
    return law[0] if law[1] == 0.0 else law[0] + law[1] * exp(-law[2] * s)


@kernel
def _slips(x, start, c):
    """Slips a1, a2 at A, b1, b2 at the cloth, and closing speed y from the state x = (F1, F2, G1, G2, p, W, Z)."""
    k1, k2, c1, c2, d_a, d_b, d_y, _n0, _n2, l_a, l_y = c
    f1, f2, g1, g2, p, _w, z = x
    return (
        start[0] + k1 * f1 + c1 * g1,
        start[1] + d_a * p + k2 * f2 + c2 * g2 + l_a * z,
        start[2] + c1 * f1 + _KB * g1,
        start[3] + d_b * p + c2 * f2 + _KB * g2,
        1.0 + d_y * p - d_a * f2 - d_b * g2 + l_y * z,
    )


@kernel
def _cloth_friction(b1, b2, drive1, drive2, most, delta):
    """Friction of at most ``most`` against the cloth slip b; at b = 0 against the drive, or holding it."""
    size = sqrt(b1 * b1 + b2 * b2)
    if size > delta:
        r = -most / size
        return r * b1, r * b2
    size = sqrt(drive1 * drive1 + drive2 * drive2)
    if size <= _KB * most:  # friction can hold: zero slip stays zero
        return -drive1 / _KB, -drive2 / _KB
    r = -most / size
    return r * drive1, r * drive2


@kernel
def _slip_rates(x, start, c, law, mu_s, delta):
    """dx/dt while A slips, dp = |a| dt."""
    c1, c2, d_b, n0, n2 = c[2], c[3], c[5], c[7], c[8]
    a1, a2, b1, b2, y = _slips(x, start, c)
    s = sqrt(a1 * a1 + a2 * a2)
    mu = friction_coefficient(s, law)
    f1, f2 = -mu * a1, -mu * a2
    load = n0 * s + n2 * f2
    lift = 0.0
    if load < 0.0:
        lift, load = -load, 0.0
    g1, g2 = _cloth_friction(b1, b2, c1 * f1, d_b * s + c2 * f2, mu_s * load, delta)
    return f1, f2, g1, g2, s, y * s, lift


@kernel
def _stick_forces(b1, b2, c, mu_s, delta):
    """Per unit of p, the friction (f1, f2) that holds a = 0, with the cloth's (g1, g2) and the lift it implies."""
    k1, k2, c1, c2, d_a, d_b, _dy, n0, n2, l_a, _ly = c
    size = sqrt(b1 * b1 + b2 * b2)
    if size > delta:
        e1, e2 = b1 / size, b2 / size
    else:  # with a held, only the second component is driven: the cloth holds as well, or slips along it
        det = k2 * _KB - c2 * c2
        f2, g2 = (c2 * d_b - _KB * d_a) / det, (c2 * d_a - k2 * d_b) / det
        if abs(g2) <= mu_s * (n0 + n2 * f2):
            return 0.0, f2, 0.0, g2, 0.0
        e1, e2 = 0.0, 1.0 if d_b - c2 * d_a / k2 >= 0.0 else -1.0
    # g = -mu_s N e and f = -(d + C g)/k with N = n0 + n2 f2: one linear equation for f2
    f2 = (c2 * mu_s * e2 * n0 - d_a) / (k2 - c2 * mu_s * e2 * n2)
    load = n0 + n2 * f2
    if load < 0.0:
        f2 = (l_a * n0 - d_a) / (k2 - l_a * n2)
        return 0.0, f2, 0.0, 0.0, -(n0 + n2 * f2)
    g1, g2 = -mu_s * load * e1, -mu_s * load * e2
    return -c1 * g1 / k1, f2, g1, g2, 0.0


@kernel
def _stick_rates(x, start, c, mu_s, delta):
    """dx/dp while A sticks."""
    _a1, _a2, b1, b2, y = _slips(x, start, c)
    f1, f2, g1, g2, lift = _stick_forces(b1, b2, c, mu_s, delta)
    return f1, f2, g1, g2, 1.0, y, lift


@kernel
def _creep_rates(x, start, c, law, mu_s, delta):
    """dx/dp just after A broke loose, while its slip is negligible: the slip grows in the direction e the drive gives it.

    There a' = kappa e, so e_i = q_i / (kappa + mu k_i) with q the drive without A's own friction, and |e| = 1 gives kappa; q holds
    the cloth's friction, which depends on e through the load: iterated.
    """
    k1, k2, c1, c2, d_a, d_b, _dy, n0, n2, l_a, _ly = c
    _a1, _a2, b1, b2, y = _slips(x, start, c)
    mu = friction_coefficient(0.0, law)
    e1, e2 = 0.0, 1.0 if d_a >= 0.0 else -1.0
    g1 = g2 = lift = 0.0
    for _ in range(30):
        load = n0 - n2 * mu * e2
        lift = max(0.0, -load)
        g1, g2 = _cloth_friction(b1, b2, -c1 * mu * e1, d_b - c2 * mu * e2, mu_s * max(0.0, load), delta)
        r1, r2 = _direction(c1 * g1, d_a + c2 * g2 + l_a * lift, mu * k1, mu * k2)
        moved = abs(r1 - e1) + abs(r2 - e2)
        e1, e2 = r1, r2
        if moved < 1e-15:
            break
    return -mu * e1, -mu * e2, g1, g2, 1.0, y, lift


@kernel
def _direction(q1, q2, m1, m2):
    """The unit vector e with e_i = q_i / (kappa + m_i) for some kappa >= 0; that of q if there is none."""
    size = hypot(q1, q2)
    if q1 == 0.0 or size == 0.0:
        return 0.0, 1.0 if q2 >= 0.0 else -1.0
    low, high = 0.0, size
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
def _rates(x, mode, start, c, law, mu_s, delta):
    if mode == _SLIP:
        return _slip_rates(x, start, c, law, mu_s, delta)
    if mode == _STICK:
        return _stick_rates(x, start, c, mu_s, delta)
    return _creep_rates(x, start, c, law, mu_s, delta)


@kernel
def _held(x, start, c, law, mu_s, delta):
    """Can friction hold the slip at A at zero?"""
    _1, _2, b1, b2, _y = _slips(x, start, c)
    f = _stick_forces(b1, b2, c, mu_s, delta)
    return hypot(f[0], f[1]) <= friction_coefficient(0.0, law)


@kernel
def _sum2(x, h, p, k, q, m):
    """x + h (p k + q m), componentwise; the kin below take more terms."""
    p *= h
    q *= h
    return (
        x[0] + p * k[0] + q * m[0], x[1] + p * k[1] + q * m[1], x[2] + p * k[2] + q * m[2], x[3] + p * k[3] + q * m[3],
        x[4] + p * k[4] + q * m[4], x[5] + p * k[5] + q * m[5], x[6] + p * k[6] + q * m[6],
    )  # fmt: skip


@kernel
def _sum3(x, h, a, k, b, m, c, n):
    return _sum2(_sum2(x, h, a, k, b, m), h, c, n, 0.0, n)


@kernel
def _sum4(x, h, a, k, b, m, c, n, d, o):
    return _sum2(_sum2(x, h, a, k, b, m), h, c, n, d, o)


@kernel
def _sum5(x, h, a, k, b, m, c, n, d, o, e, q):
    return _sum2(_sum4(x, h, a, k, b, m, c, n, d, o), h, e, q, 0.0, q)


@kernel
def _dense(r, i, s):
    """Component i of the step's continuous extension at the fraction s (Hairer, Norsett & Wanner, II.6)."""
    q = 1.0 - s
    return r[0][i] + s * (r[1][i] + q * (r[2][i] + s * (r[3][i] + q * r[4][i])))


@kernel
def _dense_all(r, s):
    return (_dense(r, 0, s), _dense(r, 1, s), _dense(r, 2, s), _dense(r, 3, s), _dense(r, 4, s), _dense(r, 5, s), _dense(r, 6, s))


@kernel
def _continuous_extension(x, new, h, k1, k3, k4, k5, k6, k7):
    """Coefficients of the step's continuous extension, order 4 (Hairer, Norsett & Wanner, II.6)."""
    dx = _sum2(_ZERO, 1.0, 1.0, new, -1.0, x)
    bend = _sum2(_ZERO, 1.0, h, k1, -1.0, dx)
    twist = _sum3(dx, 1.0, -h, k7, -1.0, bend, 0.0, bend)
    last = _sum5(
        _ZERO, h, -12715105075 / 11282082432, k1, 87487479700 / 32700410799, k3, -10690763975 / 1880347072, k4,
        701980252875 / 199316789632, k5, -1453857185 / 822651844, k6,
    )  # fmt: skip
    return x, dx, bend, twist, _sum2(last, h, 69997945 / 29380423, k7, 0.0, k7)


@kernel
def _closing(r, s, c):
    """Closing speed at the fraction s of a step."""
    return 1.0 + c[6] * _dense(r, 4, s) - c[4] * _dense(r, 1, s) - c[5] * _dense(r, 3, s) + c[10] * _dense(r, 6, s)


@kernel
def _locate(r, c, low, f_low, f_high, work_target, seek_work):
    """The fraction in [low, 1] where closing speed (or work minus its target) falls through zero: regula falsi, Illinois."""
    high = 1.0
    if f_low <= 0.0:
        return low
    for _ in range(60):
        s = (low * f_high - high * f_low) / (f_high - f_low)
        f = _dense(r, 5, s) - work_target if seek_work else _closing(r, s, c)
        if abs(f) < 1e-15 or high - low < 1e-15:
            return s
        if f > 0.0:
            if f_low < f:  # not expected on a falling function; keeps the bracket honest
                f_high *= 0.5
            low, f_low = s, f
            f_high *= 0.5
        else:
            high, f_high = s, f
            f_low *= 0.5
    return 0.5 * (low + high)


@kernel
def solve(start, c, law, mu_s, e, accuracy):
    """Integrate one impact. Speeds in units of the closing speed (so that is 1); returns (F1, F2, G1, G2, p, W, Z), status.

    start: (a1, a2, b1, b2) before the impact. c: (k1, k2, c1, c2, d_a, d_b, d_y, n0, n2, l_a, l_y), see the module's text.
    accuracy = (tol, delta, creep), in units of the closing speed: tol the local error allowed in a step; slips below delta count as
    zero; a slip that has broken loose is followed with its limiting direction until it exceeds creep.
    """
    tol, delta, creep = accuracy
    x = _ZERO
    p_full = -1.05 * (1.0 + e) / c[6]  # a guess that overshoots a little
    # past this step the method is unstable on a' = -k mu a, and a slip that should die would hover at the size of the tolerance
    h_slip = 2.0 / (c[0] * friction_coefficient(0.0, law) + 1e-9)
    s = hypot(start[0], start[1])
    if s > delta:
        mode, h = _SLIP, min(p_full / s, 0.2 * h_slip)
    else:
        mode, h = _STICK if _held(x, start, c, law, mu_s, delta) else _CREEP, p_full
    k1 = _rates(x, mode, start, c, law, mu_s, delta)
    compressing, target = True, 0.0
    for _ in range(_MAX_STEPS):
        k2 = _rates(_sum2(x, h, 0.2, k1, 0.0, k1), mode, start, c, law, mu_s, delta)
        k3 = _rates(_sum2(x, h, 3 / 40, k1, 9 / 40, k2), mode, start, c, law, mu_s, delta)
        k4 = _rates(_sum3(x, h, 44 / 45, k1, -56 / 15, k2, 32 / 9, k3), mode, start, c, law, mu_s, delta)
        k5 = _rates(_sum4(x, h, 19372 / 6561, k1, -25360 / 2187, k2, 64448 / 6561, k3, -212 / 729, k4), mode, start, c, law, mu_s, delta)
        k6 = _rates(
            _sum5(x, h, 9017 / 3168, k1, -355 / 33, k2, 46732 / 5247, k3, 49 / 176, k4, -5103 / 18656, k5),
            mode, start, c, law, mu_s, delta,
        )  # fmt: skip
        new = _sum5(x, h, 35 / 384, k1, 500 / 1113, k3, 125 / 192, k4, -2187 / 6784, k5, 11 / 84, k6)
        k7 = _rates(new, mode, start, c, law, mu_s, delta)
        err = _sum5(_ZERO, h, 71 / 57600, k1, -71 / 16695, k3, 71 / 1920, k4, -17253 / 339200, k5, 22 / 525, k6)
        err = _sum2(err, h, -1 / 40, k7, 0.0, k7)
        worst = max(max(max(abs(err[0]), abs(err[1])), max(abs(err[2]), abs(err[3]))), max(abs(err[4]), abs(err[6])))
        if worst > tol and h > 1e-13:
            h *= max(0.2, 0.9 * (tol / worst) ** 0.2)
            continue
        a1, a2, _b1, _b2, y = _slips(new, start, c)
        s = sqrt(a1 * a1 + a2 * a2)
        next_mode = mode
        if mode == _SLIP:
            if s <= delta:
                next_mode = _STICK if _held(new, start, c, law, mu_s, delta) else _CREEP
        elif mode == _STICK:
            if not _held(new, start, c, law, mu_s, delta):
                if h > delta:  # it broke loose inside the step: find where
                    h *= 0.5
                    continue
                next_mode = _CREEP
        elif s > creep:
            if s > 2.0 * creep and h > delta:
                h *= 0.5
                continue
            next_mode = _SLIP
        elif _held(new, start, c, law, mu_s, delta):
            next_mode = _STICK
        done = new[5] <= target and not compressing
        if done or (compressing and y <= 0.0):
            r = _continuous_extension(x, new, h, k1, k3, k4, k5, k6, k7)
            low = 0.0
            if compressing:
                low = _locate(r, c, 0.0, _closing(r, 0.0, c), y, 0.0, False)
                compressing = False
                target = (1.0 - e * e) * _dense(r, 5, low)
                done = new[5] <= target
            if done:
                if e > 0.0:
                    low = _locate(r, c, low, _dense(r, 5, low) - target, new[5] - target, target, True)
                return _dense_all(r, low), OK
        h *= 5.0 if worst < 1e-4 * tol else min(5.0, 0.9 * (tol / worst) ** 0.2)
        x, k1 = new, k7
        if next_mode != mode:
            mode = next_mode
            k1 = _rates(x, mode, start, c, law, mu_s, delta)
            h = p_full if mode == _STICK else creep if mode == _CREEP else 0.2 * h_slip
        if mode == _SLIP:
            h = min(h, h_slip)
    return x, TOO_MANY_STEPS
