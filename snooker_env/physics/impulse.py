"""How does a frictional impact unfold? Two coupled Coulomb contacts integrated over the normal impulse, events located.

Ball against ball [MJP14] and ball against cushion [MJP10] are the same problem with other constants. In the plane of the impact's
contact A live its slip ``a = (a1, a2)`` and the friction impulse ``F = (F1, F2)``; under the ball pressed into the cloth live the
cloth's slip ``b = (b1, b2)`` and friction impulse ``G = (G1, G2)``. With p the accumulated normal impulse per unit mass and work W::

    a1 = a1_0         + k1 F1 + c1 G1                     Everything is linear in F, G, p and the lift Z,
    a2 = a2_0 + d_a p + k2 F2 + c2 G2 + l_a Z             so F, G, p, Z and the integral V below are
    b1 = b1_0         + c1 F1 + 7/2 G1                    the whole state.
    b2 = b2_0 + d_b p + c2 F2 + 7/2 G2
    y  = y_0  + d_y p - d_a F2 - d_b G2 + l_y Z           closing speed; dW/dp = y, so that
    W  = y_0 p + d_y p^2 / 2 + V                          V' = -d_a F2 - d_b G2 + l_y Z
    N' = n0 + n2 F2'  while that is positive and the ball is down (Z = 0); else N' = 0, Z' = -(n0 + n2 F2')    (it lifts)

Coulomb: F' = -mu(|a|) a/|a|, G' = -mu_s N' b/|b|. Where a slip is zero, friction holds it there if it can; if not, slip starts in
the direction the other forces drive it. Compression ends at y = 0 with W = Wc, the impact at W = (1 - e^2) Wc (energetic
restitution, Stronge).

Method: the explicit pair of Dormand & Prince 5(4) with its dense output. Where the slip is fast the friction is nearly constant and p
itself is the best variable: one step spans most impacts. Where the slip may end it is t with dp = |a| dt: F' = -mu a is regular
there, and the end of slip, where its direction turns like a power of |a|, is approached exponentially instead of as a singularity.
All speeds are divided by y_0 first, so tolerances are relative to the impulse.
"""

from math import exp, hypot, sqrt

from .._jit import kernel
from .dormand_prince import ZERO, continuous_extension, dense, dense_all, secant, sum2, sum3, sum4, sum5, value_at

OK, TOO_MANY_STEPS = 0, 1
_FAST_SLIP, _SLIP, _STICK, _CREEP = 0, 1, 2, 3  # what contact A does, and how it is integrated
_SLIDES, _STARTS, _GRIPS = 0, 1, 2  # what the cloth contact does: slips; is about to slip, from zero; holds
_FAST = 1.5  # slip that is lost in the impact, over slip there is, above which t is the better variable (measured: 1 to 3 are alike)
_MAX_STEPS, _JAMMED, _KNIFE_EDGE = 20_000, 5_000, 1_000  # steps; an impact of play takes 1 to 30
_STIFF = 1e-4  # slips, in closing speeds, that would take more steps than that
_NEAR = 10.0  # cloth slips below this many delta count as zero; wider than the shortest step, so that a slip which friction stops is caught
_SLOW = 0.1  # a slip changes slowly if friction and drive cancel but for this part
_KB = 3.5  # effective inverse mass of a solid sphere's lowest point, times M


@kernel
def friction_coefficient(s, law):
    """mu(s) = a + b exp(-c s); ``law`` = (a, b, c)."""
    return law[0] if law[1] == 0.0 else law[0] + law[1] * exp(-law[2] * s)


@kernel
def _slips(x, start, c):
    """Slips a1, a2 at A, b1, b2 at the cloth, and V' from the state x = (F1, F2, G1, G2, p, V, Z)."""
    k1, k2, c1, c2, d_a, d_b, _dy, _n0, _n2, l_a, l_y = c
    f1, f2, g1, g2, p, _v, z = x
    return (
        start[0] + k1 * f1 + c1 * g1,
        start[1] + d_a * p + k2 * f2 + c2 * g2 + l_a * z,
        start[2] + c1 * f1 + _KB * g1,
        start[3] + d_b * p + c2 * f2 + _KB * g2,
        l_y * z - d_a * f2 - d_b * g2,
    )


@kernel
def _work(p, v, c):
    """W, with y_0 = 1."""
    return (1.0 + 0.5 * c[6] * p) * p + v


@kernel
def _cloth_friction(b1, b2, drive1, drive2, most, near, cloth):
    """Friction of at most ``most`` against the cloth slip b; against the drive, where b starts from zero; or what holds it at zero."""
    if cloth == _GRIPS:
        return -drive1 / _KB, -drive2 / _KB
    size = sqrt(b1 * b1 + b2 * b2)
    if size > (near if cloth == _STARTS else 0.0):
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
    a1, a2, b1, b2, v = _slips(x, start, c)
    s = sqrt(a1 * a1 + a2 * a2)
    mu = friction_coefficient(s, law)
    f1, f2 = -mu * a1, -mu * a2
    load = n0 * s + n2 * f2
    lift = 0.0
    if load < 0.0 or x[6] > 0.0:
        lift, load = -load, 0.0
    g1, g2 = _cloth_friction(b1, b2, c1 * f1, d_b * s + c2 * f2, mu_s * load, near, cloth)
    return f1, f2, g1, g2, s, v * s, lift


@kernel
def _fast_slip_rates(x, start, c, law, mu_s, near, cloth):
    """dx/dp while A slips."""
    f1, f2, g1, g2, s, vs, lift = _slip_rates(x, start, c, law, mu_s, near, cloth)
    r = 1.0 / s
    return f1 * r, f2 * r, g1 * r, g2 * r, 1.0, vs * r, lift * r


@kernel
def _stick_forces(b1, b2, z, c, mu_s, near, cloth):
    """Per unit of p, the friction (f1, f2) that holds a = 0, with the cloth's (g1, g2) and the lift it implies."""
    k1, k2, c1, c2, d_a, d_b, _dy, n0, n2, l_a, _ly = c
    if cloth == _GRIPS:  # only the second components are driven
        det = k2 * _KB - c2 * c2
        return 0.0, (c2 * d_b - _KB * d_a) / det, 0.0, (c2 * d_a - k2 * d_b) / det, 0.0
    size = sqrt(b1 * b1 + b2 * b2)
    if size > (near if cloth == _STARTS else 0.0):
        e1, e2 = b1 / size, b2 / size
    else:
        e1, e2 = 0.0, 1.0 if d_b - c2 * d_a / k2 >= 0.0 else -1.0
    # g = -mu_s N e and f = -(d + C g)/k with N = n0 + n2 f2: one linear equation for f2
    f2 = (c2 * mu_s * e2 * n0 - d_a) / (k2 - c2 * mu_s * e2 * n2)
    load = n0 + n2 * f2
    if load < 0.0 or z > 0.0:
        f2 = (l_a * n0 - d_a) / (k2 - l_a * n2)
        return 0.0, f2, 0.0, 0.0, -(n0 + n2 * f2)
    g1, g2 = -mu_s * load * e1, -mu_s * load * e2
    return -c1 * g1 / k1, f2, g1, g2, 0.0


@kernel
def _stick_rates(x, start, c, mu_s, near, cloth):
    """dx/dp while A sticks."""
    _a1, _a2, b1, b2, v = _slips(x, start, c)
    f1, f2, g1, g2, lift = _stick_forces(b1, b2, x[6], c, mu_s, near, cloth)
    return f1, f2, g1, g2, 1.0, v, lift


@kernel
def _creep_rates(x, start, c, law, mu_s, near, cloth):
    """dx/dp while the slip at A is negligible and friction hardly outweighs the drive, or the drive it: just after A broke loose, or while
    its slip all but dies. It then has the direction e that the drive gives it.

    There a' = kappa e, so e_i = q_i / (kappa + mu k_i) with q the drive without A's own friction, and |e| = 1 gives kappa; q holds
    the cloth's friction, which depends on e through the load: iterated.
    """
    k1, k2, c1, c2, d_a, d_b, _dy, n0, n2, l_a, _ly = c
    a1, a2, b1, b2, v = _slips(x, start, c)
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
    return -mu * e1, -mu * e2, g1, g2, 1.0, v, lift


@kernel
def _slip_speed(rates, c):
    """How fast the slip at A changes, per unit of the rates' variable."""
    return hypot(c[0] * rates[0] + c[2] * rates[2], c[4] * rates[4] + c[1] * rates[1] + c[3] * rates[3] + c[9] * rates[6])


@kernel
def _settled(x, a1, a2, s, start, c, law, mu_s, near, cloth):
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
def _rates(x, mode, start, c, law, mu_s, near, cloth):
    if mode == _FAST_SLIP:
        return _fast_slip_rates(x, start, c, law, mu_s, near, cloth)
    if mode == _SLIP:
        return _slip_rates(x, start, c, law, mu_s, near, cloth)
    if mode == _STICK:
        return _stick_rates(x, start, c, mu_s, near, cloth)
    return _creep_rates(x, start, c, law, mu_s, near, cloth)


@kernel
def _held(x, start, c, law, mu_s, near, cloth):
    """Can friction hold the slip at A at zero?"""
    _1, _2, b1, b2, _v = _slips(x, start, c)
    f = _stick_forces(b1, b2, x[6], c, mu_s, near, cloth)
    return hypot(f[0], f[1]) <= friction_coefficient(0.0, law)


@kernel
def _grip_holds(rates, x, c, mu_s):
    """Is the cloth's friction in ``rates``, of a grip, within Coulomb's law, and the ball down?"""
    most = mu_s * (c[7] * rates[4] + c[8] * rates[1])
    return x[6] <= 0.0 and rates[2] * rates[2] + rates[3] * rates[3] <= most * most and most > 0.0


@kernel
def _closing_part(part, c):
    """The closing speed's linear part, of one coefficient of the continuous extension."""
    return c[6] * part[4] - c[4] * part[1] - c[5] * part[3] + c[10] * part[6]


@kernel
def _end_of_compression(r, c, tol):
    """The fraction of a step at which the closing speed falls to zero."""
    y0, y1, y2, y3, y4 = (
        1.0 + _closing_part(r[0], c), _closing_part(r[1], c), _closing_part(r[2], c), _closing_part(r[3], c), _closing_part(r[4], c),
    )  # fmt: skip
    low, high = 0.0, 1.0
    f_low, f_high = y0, y0 + y1
    if f_low <= 0.0:
        return low
    s = f_low / (f_low - f_high)
    last, f_last = 1.0, f_high
    for _ in range(50):
        f = value_at(y0, y1, y2, y3, y4, s)
        low, high = (s, high) if f > 0.0 else (low, s)
        if abs(f) <= tol or high - low < 1e-15:
            break
        last, f_last, s = s, f, secant(low, high, s, f, last, f_last)
    return s


@kernel
def _end_of_restitution(r, c, target, low, tol):
    """The fraction of a step, past ``low``, at which the work falls to the target."""
    high = 1.0
    last, f_last = low, _work(dense(r, 4, low), dense(r, 5, low), c) - target
    if f_last <= 0.0:
        return low
    s = high
    f = _work(r[0][4] + r[1][4], r[0][5] + r[1][5], c) - target
    for _ in range(50):
        last, f_last, s = s, f, secant(low, high, s, f, last, f_last)
        f = _work(dense(r, 4, s), dense(r, 5, s), c) - target
        low, high = (s, high) if f > 0.0 else (low, s)
        if abs(f) <= tol or high - low < 1e-15:
            break
    return s


@kernel
def solve(start, c, law, mu_s, e, accuracy):
    """Integrate one impact. Speeds in units of the closing speed (so that is 1); returns (F1, F2, G1, G2, p, V, Z), status.

    start: (a1, a2, b1, b2) before the impact. c: (k1, k2, c1, c2, d_a, d_b, d_y, n0, n2, l_a, l_y), see the module's text.
    accuracy = (tol, delta, creep), in units of the closing speed: tol the local error allowed in a step; slips below delta count as
    zero; a slip that has broken loose is followed with its limiting direction until it exceeds creep.
    """
    tol, delta, creep = accuracy
    x = ZERO
    p_full = -1.05 * (1.0 + e) / c[6]  # a guess that overshoots a little
    # past three times this step the method is unstable on a' = -k mu a: a slip that should die would hover at the size of the tolerance
    h_slip = 1.0 / (c[0] * friction_coefficient(0.0, law) + 1e-9)
    s = hypot(start[0], start[1])
    # slip lost in the whole impact: k mu p; fast if that is a small part of the slip there is
    mu = friction_coefficient(s, law)
    fast = _FAST * c[0] * mu * p_full
    near = _NEAR * delta
    b1_old, b2_old = start[2], start[3]
    # the pressed ball starts without slip on the cloth: everything is smooth, and the estimate ten times the true error (measured)
    calm = b1_old * b1_old + b2_old * b2_old <= near * near
    most = friction_coefficient(0.0, law)
    may_grip = _KB * mu_s * (c[7] + abs(c[8]) * most) >= abs(c[5]) - abs(c[3]) * most  # else no cloth slip is ever held
    cloth = _GRIPS if may_grip and calm else _STARTS if calm else _SLIDES
    if s > max(fast, delta):
        mode, h = _FAST_SLIP, p_full
    elif s > delta:
        mode, h = _SLIP, min(p_full / s, 0.4 * h_slip)
    else:
        mode, h = _STICK if _held(x, start, c, law, mu_s, near, cloth) else _CREEP, p_full
    k1 = _rates(x, mode, start, c, law, mu_s, near, cloth)
    if cloth == _GRIPS and not _grip_holds(k1, x, c, mu_s):
        cloth = _STARTS
        if s <= delta:
            mode = _STICK if _held(x, start, c, law, mu_s, near, cloth) else _CREEP
        k1 = _rates(x, mode, start, c, law, mu_s, near, cloth)
    compressing, target = True, 0.0
    for n in range(_MAX_STEPS):
        k2 = _rates(sum2(x, h, 0.2, k1, 0.0, k1), mode, start, c, law, mu_s, near, cloth)
        k3 = _rates(sum2(x, h, 3 / 40, k1, 9 / 40, k2), mode, start, c, law, mu_s, near, cloth)
        k4 = _rates(sum3(x, h, 44 / 45, k1, -56 / 15, k2, 32 / 9, k3), mode, start, c, law, mu_s, near, cloth)
        k5 = _rates(sum4(x, h, 19372 / 6561, k1, -25360 / 2187, k2, 64448 / 6561, k3, -212 / 729, k4), mode, start, c, law, mu_s, near, cloth)
        k6 = _rates(
            sum5(x, h, 9017 / 3168, k1, -355 / 33, k2, 46732 / 5247, k3, 49 / 176, k4, -5103 / 18656, k5),
            mode, start, c, law, mu_s, near, cloth,
        )  # fmt: skip
        new = sum5(x, h, 35 / 384, k1, 500 / 1113, k3, 125 / 192, k4, -2187 / 6784, k5, 11 / 84, k6)
        k7 = _rates(new, mode, start, c, law, mu_s, near, cloth)
        err = sum5(ZERO, h, 71 / 57600, k1, -71 / 16695, k3, 71 / 1920, k4, -17253 / 339200, k5, 22 / 525, k6)
        err = sum2(err, h, -1 / 40, k7, 0.0, k7)
        # an error in p(t) alone is harmless: what counts is each number as a function of p
        off = sum2(err, -err[4] / k7[4], 1.0, k7, 0.0, k7)
        worst = max(max(max(abs(off[0]), abs(off[1])), max(abs(off[2]), abs(off[3]))), max(abs(off[5]), abs(off[6])))
        allowed = 4.0 * tol if mode == _FAST_SLIP and calm else tol
        if worst > allowed and h > 1e-13:
            h *= max(0.2, 0.9 * (allowed / worst) ** 0.2)
            continue
        a1, a2, b1, b2, v = _slips(new, start, c)
        if b1 * b1_old + b2 * b2_old < 0.0 and mu_s * (c[7] + abs(c[8]) * mu) * (new[4] - x[4]) > delta and h > 1e-13:
            h *= 0.25  # the cloth's slip turned right round inside the step, where the stages may not have looked
            continue
        if new[6] < -10.0 * tol and x[6] > 0.0 and h > 1e-13:
            h *= 0.5  # the ball came down inside the step: find where
            continue
        next_cloth = _SLIDES if b1 * b1 + b2 * b2 > near * near else _STARTS
        if cloth == _GRIPS:
            next_cloth = _GRIPS
            if not _grip_holds(k7, new, c, mu_s):
                if new[4] - x[4] > delta:  # the cloth gave way inside the step: find where
                    h *= 0.5
                    continue
                next_cloth = _STARTS
        elif may_grip and next_cloth == _STARTS and _grip_holds(_rates(new, mode, start, c, law, mu_s, near, _GRIPS), new, c, mu_s):
            next_cloth = _GRIPS
        y = 1.0 + c[6] * new[4] + v
        work = _work(new[4], new[5], c)
        s = sqrt(a1 * a1 + a2 * a2)
        next_mode = mode
        if mode == _FAST_SLIP:
            if s < 0.5 * fast:
                next_mode = _SLIP
        elif mode == _SLIP:
            if s <= delta:
                next_mode = _STICK if _held(new, start, c, law, mu_s, near, cloth) else _CREEP
            elif s < 0.5 * creep and _settled(new, a1, a2, s, start, c, law, mu_s, near, cloth):
                next_mode = _CREEP
        elif mode == _STICK:
            if not _held(new, start, c, law, mu_s, near, cloth):
                if h > delta:  # it broke loose inside the step: find where
                    h *= 0.5
                    continue
                next_mode = _CREEP
        elif s > creep:
            if s > 2.0 * creep and h > delta:
                h *= 0.5
                continue
            next_mode = _SLIP
        elif k7[0] * a1 + k7[1] * a2 >= 0.0 and s > delta:  # friction no longer opposes the slip: it died inside the step
            if h > delta:
                h *= 0.5
                continue
            next_mode = _STICK if _held(new, start, c, law, mu_s, near, cloth) else _CREEP
        elif s <= delta and _held(new, start, c, law, mu_s, near, cloth):
            next_mode = _STICK
        if mode == _STICK and cloth == _GRIPS and c[9] != 0.0 and y < 1e3 * delta:
            return new, OK  # wedged between nose and cloth: both hold, so nothing moves across the nose, and no impulse frees the ball
        if n >= _KNIFE_EDGE:  # friction all but balances what drives a slip, which stays small and stiff: follow its limit
            near, creep = max(near, _STIFF), max(creep, 10.0 * _STIFF)
        if n >= _JAMMED and abs(y) < 1e-2:
            return new, OK  # friction balances the elastic force all but exactly: what moves across the nose creeps on without an end
        done = work <= target and not compressing
        if done or (compressing and y <= 0.0):
            r = continuous_extension(x, new, h, k1, k3, k4, k5, k6, k7)
            low = 0.0
            if compressing:
                low = _end_of_compression(r, c, 1e-3 * tol)
                compressing = False
                target = (1.0 - e * e) * _work(dense(r, 4, low), dense(r, 5, low), c)
                done = work <= target
            if done:
                if e > 0.0:
                    low = _end_of_restitution(r, c, target, low, 1e-3 * tol)
                return dense_all(r, low), OK
        h *= 3.0 if worst < 1e-3 * allowed else min(3.0, 0.9 * (allowed / worst) ** 0.2)
        x, k1, b1_old, b2_old = new, k7, b1, b2
        if next_mode != mode or (next_cloth != cloth and (next_cloth == _GRIPS or cloth == _GRIPS)):
            mode, cloth = next_mode, next_cloth
            k1 = _rates(x, mode, start, c, law, mu_s, near, cloth)
            h = p_full if mode == _STICK else creep if mode == _CREEP else 0.4 * h_slip
        cloth = next_cloth
        if mode == _SLIP:
            h = min(h, h_slip)
        elif x[4] < p_full:
            h = min(h, 1.01 * (p_full - x[4]))
        if may_grip and cloth == _SLIDES:
            size = hypot(b1, b2)
            along = (b1 * (c[2] * k1[0] + _KB * k1[2]) + b2 * (c[5] * k1[4] + c[3] * k1[1] + _KB * k1[3])) / (size + 1e-300)
            if along < 0.0 and size < 1000.0 * max(tol, delta):
                # Past these steps the method is unstable on a slip this small or leaps over its end, and an error of its size is not seen.
                h = min(h, 0.4 * size / max(0.2 * _KB * hypot(k1[2], k1[3]), -along))
    return x, TOO_MANY_STEPS
