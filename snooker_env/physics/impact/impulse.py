"""How does a frictional impact unfold? Two coupled Coulomb contacts integrated over the normal impulse, events located.

Ball against ball [MJP14] and ball against cushion [MJP10] are the same problem with other constants. In the plane of the impact's
contact A live its slip ``a = (a1, a2)`` and the friction impulse ``F = (F1, F2)``; under the ball pressed into the cloth live the
cloth's slip ``b = (b1, b2)`` and friction impulse ``G = (G1, G2)``. With p the accumulated normal impulse per unit mass and work W::

    a1 = a1_0         + k1 F1 + c1 G1                     Everything is linear in F, G, p and the lift Z,
    a2 = a2_0 + d_a p + k2 F2 + c2 G2 + l_a Z             so F, G, p, W and Z are
    b1 = b1_0         + c1 F1 + 7/2 G1                    the whole state.
    b2 = b2_0 + d_b p + c2 F2 + 7/2 G2
    y  = y_0  + d_y p - d_a F2 - d_b G2 + l_y Z           closing speed; W' = y
    N' = n0 + n2 F2'  while that is positive and the ball is down (Z = 0); else N' = 0, Z' = -(n0 + n2 F2')    (it lifts)

Coulomb: F' = -mu(|a|) a/|a|, G' = -mu_s N' b/|b|. Where a slip is zero, friction holds it there if it can; if not, slip starts in
the direction the other forces drive it. Compression ends at y = 0 with W = Wc, the impact at W = (1 - e^2) Wc (energetic
restitution, Stronge).

Method: where A slips, t with dp = |a| dt is the variable: F' = -mu a is regular there, and the end of slip, where its direction turns
like a power of |a|, is approached exponentially instead of as a singularity. While both contacts slip all is analytic in t, and a Taylor
series spans most of an impact or all of it (``taylor.py``). What is left, a contact that sticks or creeps, a ball that lifts, a cloth
that may hold the pressed ball, is rare in play and takes Runge-Kutta steps (``dormand_prince.py``). Both leave a polynomial, in which the
ends of compression and restitution are found. All speeds are divided by y_0 first, so tolerances are relative to the impulse.
"""

from math import hypot, sqrt

from ..._jit import kernel
from . import dormand_prince, taylor
from .coulomb import CREEP, GRIPS, KB, SLIDES, SLIP, STARTS, STICK, friction_coefficient, grip_holds, held, rates, settled, slips, wedged
from .polynomial import ROW, W, Y, state_at, time_of, value_at

OK, TOO_MANY_STEPS = 0, 1
_MAX_STEPS, _JAMMED, _KNIFE_EDGE = 20_000, 5_000, 1_000  # steps; an impact of play takes 1 to 30
_STIFF = 1e-4  # slips, in closing speeds, that would take more steps than that
_NEAR = 10.0  # cloth slips below this many delta count as zero; wider than the shortest step, so that a slip which friction stops is caught
_SERIES = 40.0  # allowed of a series' last terms over tol: their sum is far above what a step errs by (measured)
_ZERO = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@kernel
def _end_of_compression(w, n, span, y, near):
    """When the closing speed falls to zero, in a step of degree n that lasts ``span`` and ends with closing speed y <= 0."""
    y0, y1 = w[Y], w[ROW + Y]
    bend = (y - y0 - y1 * span) / (span * span)
    root = y1 * y1 - 4.0 * bend * y0
    guess = 2.0 * y0 / (sqrt(root) - y1) if root > 0.0 and y1 < 0.0 else 0.5 * span
    return time_of(w, n, Y, 0.0, 0.0, span, guess, near)


@kernel
def _end_of_restitution(w, n, low, span, work, top, target, near):
    """When the work, which was ``top`` at most, falls to the target; at ``low`` it is above, at ``span``, with ``work``, it is not."""
    now = sqrt(max(top - value_at(w, n, W, low)[0], 0.0))  # the root of the work given back grows all but evenly
    guess = low + (span - low) * (sqrt(top - target) - now) / (sqrt(top - work) - now)
    return time_of(w, n, W, target, low, span, guess, near)


@kernel
def _turns_at(w, n, span, o1, o2, start, c):
    """When in a step the cloth's slip, less (o1, o2), is at right angles to where it pointed at first; it points backwards at the end."""
    low, high = 0.0, span
    for _ in range(50):
        t = 0.5 * (low + high)
        _1, _2, b1, b2, _y = slips(state_at(w, n, t), start, c)
        low, high = (low, t) if taylor.turned(w, b1 - o1, b2 - o2) else (t, high)
    return high


@kernel
def _breaks_loose_at(w, start, c, law, mu_s, near, cloth):
    """The fraction of a Runge-Kutta step after which friction no longer holds the slip at A at zero."""
    low, high = 0.0, 1.0
    for _ in range(40):
        t = 0.5 * (low + high)
        if held(state_at(w, dormand_prince.DEGREE, t), start, c, law, mu_s, near, cloth):
            low = t
        else:
            high = t
    return high


@kernel(seconds=8)
def solve(start, c, law, mu_s, e, accuracy, w):
    """Integrate one impact. Speeds in units of the closing speed (so that is 1); returns (F1, F2, G1, G2, p, W, Z), status.

    start: (a1, a2, b1, b2) before the impact. c: (k1, k2, c1, c2, d_a, d_b, d_y, n0, n2, l_a, l_y), see the module's text.
    accuracy = (tol, delta, creep, order), the first three in units of the closing speed: tol the local error allowed in a step; slips
    below delta count as zero; a slip that has broken loose is followed with its limiting direction until it exceeds creep; order: the
    highest of the Taylor series. w: a work array of ``polynomial.WORK`` numbers.
    """
    tol, delta, creep, order = accuracy
    x = _ZERO
    a1, a2, b1, b2 = start
    y = 1.0
    s = sqrt(a1 * a1 + a2 * a2)
    most = friction_coefficient(0.0, law)
    p_full = -1.05 * (1.0 + e) / c[6]  # a guess that overshoots a little
    # past three times this step Runge-Kutta is unstable on a' = -k mu a: a slip that should die would hover at the size of the tolerance
    h_slip = 1.0 / (c[0] * most + 1e-9)
    near = _NEAR * delta
    may_grip = KB * mu_s * (c[7] + abs(c[8]) * most) >= abs(c[5]) - abs(c[3]) * most  # else no cloth slip is ever held
    calm = b1 * b1 + b2 * b2 <= near * near
    cloth = GRIPS if may_grip and calm else STARTS if calm else SLIDES
    # the load on the cloth stays positive: the normal impulse outweighs the friction at A, or that alone presses, and a2 keeps its sign
    pressed = c[7] >= abs(c[8]) * most or (c[7] == 0.0 and c[8] * a2 <= 0.0)
    analytic = pressed and not may_grip  # ... while A slips
    if s > delta:
        mode, h = SLIP, min(p_full / s, 0.4 * h_slip)
    else:
        mode, h = STICK if held(x, start, c, law, mu_s, near, cloth) else CREEP, p_full
    k1 = _ZERO
    if not (analytic and mode == SLIP):
        k1 = rates(x, mode, start, c, law, mu_s, near, cloth)
        if cloth == GRIPS and not grip_holds(k1, x, c, mu_s):
            cloth = STARTS
            if s <= delta:
                mode = STICK if held(x, start, c, law, mu_s, near, cloth) else CREEP
            k1 = rates(x, mode, start, c, law, mu_s, near, cloth)
    compressing, top, target = True, 0.0, 0.0
    located = False
    b1_old, b2_old = b1, b2
    for n in range(_MAX_STEPS):
        if analytic and mode == SLIP:
            left = max(p_full - x[4], 0.1 * p_full)
            degree, span = taylor.expand(w, x, a1, a2, b1, b2, y, cloth == STARTS, left, c, law, mu_s, _SERIES * tol, order)
            o1, o2 = (b1, b2) if cloth == STARTS else (0.0, 0.0)  # what is left of a slip that counts as zero may point anywhere
            new = state_at(w, degree, span)
            a1, a2, b1, b2, y = slips(new, start, c)
            if taylor.turned(w, b1 - o1, b2 - o2):
                span = _turns_at(w, degree, span, o1, o2, start, c)
                new = state_at(w, degree, span)
                a1, a2, b1, b2, y = slips(new, start, c)
            k7, worst = k1, tol
        else:
            degree, span = dormand_prince.DEGREE, 1.0
            new, k7, worst = dormand_prince.step(w, x, h, k1, mode, start, c, law, mu_s, near, cloth)
            if worst > tol and h > 1e-13:
                h *= max(0.2, 0.9 * (tol / worst) ** 0.2)
                continue
            if mode == SLIP and new[4] - x[4] > 2.0 * max(p_full - x[4], 0.1 * p_full):
                h *= 0.5  # the slip grew: the step's polynomial is no good over several impacts' impulse
                continue
            a1, a2, b1, b2, y = slips(new, start, c)
            if b1 * b1_old + b2 * b2_old < 0.0 and mu_s * (c[7] + abs(c[8]) * most) * (new[4] - x[4]) > delta and h > 1e-13:
                h *= 0.25  # the cloth's slip turned right round inside the step, where the stages may not have looked
                continue
            if new[6] < -10.0 * tol and x[6] > 0.0 and h > 1e-13:
                h *= 0.5  # the ball came down inside the step: find where
                continue
        next_cloth = SLIDES if b1 * b1 + b2 * b2 > near * near else STARTS
        if cloth == GRIPS:
            next_cloth = GRIPS
            if not grip_holds(k7, new, c, mu_s):
                if new[4] - x[4] > delta:  # the cloth gave way inside the step: find where
                    h *= 0.5
                    continue
                next_cloth = STARTS
        elif may_grip and next_cloth == STARTS and grip_holds(rates(new, mode, start, c, law, mu_s, near, GRIPS), new, c, mu_s):
            next_cloth = GRIPS
        s = sqrt(a1 * a1 + a2 * a2)
        next_mode = mode
        if mode == SLIP:
            if s <= delta:
                next_mode = STICK if held(new, start, c, law, mu_s, near, cloth) else CREEP
            elif s < 0.5 * creep and settled(new, a1, a2, s, start, c, law, mu_s, near, cloth):
                next_mode = CREEP
        elif mode == STICK:
            if not held(new, start, c, law, mu_s, near, cloth):
                if h > delta and not located:  # it broke loose inside the step: take the step to there
                    dormand_prince.leave_polynomial(w, x, new, h, c)
                    h *= _breaks_loose_at(w, start, c, law, mu_s, near, cloth)
                    located = True
                    continue
                next_mode = CREEP
        elif s > creep:
            if s > 2.0 * creep and h > delta:
                h *= 0.5
                continue
            next_mode = SLIP
        elif k7[0] * a1 + k7[1] * a2 > 0.0 and s > delta:  # friction does not oppose the slip
            o1, o2, _1, _2, _y = slips(x, start, c)
            if h > delta and k1[0] * o1 + k1[1] * o2 <= 0.0:  # it did before: the slip died inside the step
                h *= 0.5
                continue
            next_mode = STICK if held(new, start, c, law, mu_s, near, cloth) else CREEP
        elif s <= delta and held(new, start, c, law, mu_s, near, cloth):
            next_mode = STICK
        if n >= _KNIFE_EDGE:  # friction all but balances what drives a slip, which stays small and stiff: follow its limit
            near, creep = max(near, _STIFF), max(creep, 10.0 * _STIFF)
        if n >= _JAMMED and abs(y) < 1e-2:
            return new, OK  # friction balances the elastic force all but exactly: what moves across the nose creeps on without an end
        if (compressing and y <= 0.0) or (not compressing and new[5] <= target):
            if not (analytic and mode == SLIP):
                dormand_prince.leave_polynomial(w, x, new, h, c)
            low, close = 0.0, 0.01 * tol * span
            if compressing:
                low = _end_of_compression(w, degree, span, y, close)
                compressing = False
                top = value_at(w, degree, W, low)[0]
                target = (1.0 - e * e) * top
            if new[5] <= target:
                if e > 0.0:
                    low = _end_of_restitution(w, degree, low, span, new[5], top, target, close)
                return state_at(w, degree, low), OK
        h *= 3.0 if worst < 1e-3 * tol else min(3.0, 0.9 * (tol / worst) ** 0.2)
        x, k1, b1_old, b2_old, located = new, k7, b1, b2, False
        if next_mode != mode or (next_cloth != cloth and (next_cloth == GRIPS or cloth == GRIPS)):
            mode, cloth = next_mode, next_cloth
            if mode == STICK and cloth == GRIPS and c[9] != 0.0:
                if wedged(c, law, mu_s):
                    return new, OK
                cloth = STARTS
                mode = STICK if held(x, start, c, law, mu_s, near, cloth) else CREEP
            k1 = rates(x, mode, start, c, law, mu_s, near, cloth)
            h = p_full if mode == STICK else creep if mode == CREEP else 0.4 * h_slip
        elif next_cloth != cloth:
            cloth = next_cloth
        if mode == SLIP:
            h = min(h, h_slip, max(p_full - x[4], 0.1 * p_full) / s)
        elif x[4] < p_full:
            h = min(h, 1.01 * (p_full - x[4]))
        if may_grip and cloth == SLIDES:
            size = hypot(b1, b2)
            along = (b1 * (c[2] * k1[0] + KB * k1[2]) + b2 * (c[5] * k1[4] + c[3] * k1[1] + KB * k1[3])) / (size + 1e-300)
            if along < 0.0 and size < 1000.0 * max(tol, delta):
                # Past these steps the method is unstable on a slip this small or leaps over its end, and an error of its size is not seen.
                h = min(h, 0.4 * size / max(0.2 * KB * hypot(k1[2], k1[3]), -along))
    return x, TOO_MANY_STEPS
