"""How does one impact change the balls? Ball on ball, ball on cushion, in the table frame, at any fidelity.

Tuples v = (vx, vy, vz) [m/s] and w = (wx, wy, wz) [rad/s], z up. Bodies that do not approach are unchanged.
"""

from math import hypot, sqrt

from ..._lib.check import refuse
from ..._lib.jit import inline, kernel
from ..._lib.types import Fidelity, Solver
from ..columns import (
    P_BALLS,
    P_E_B,
    P_E_C,
    P_E_J,
    P_E_KNEE,
    P_E_POWER,
    P_JAW,
    P_MU_BB_EXTRA,
    P_MU_BB_FADE,
    P_MU_BB_LEAST,
    P_MU_C,
    P_MU_S,
    P_R,
    P_RAIL,
    P_SIN,
)
from . import euler, impulse, inertia
from .coulomb import Friction, Problem, friction_coefficient
from .impulse import NO_IMPULSE, OK, Accuracy, solve
from .inertia import Slips
from .tables import ROLLS, look_up

FAST, STANDARD, REFERENCE, EULER = range(4)
_CODES = {"fast": FAST, "standard": STANDARD, "reference": REFERENCE}
FIDELITIES = (*_CODES, "euler:N")
MAX_EULER_STEPS = 10_000_000

# Errors against the tests' oracle, over the larger incoming speed: reference below 1e-9; standard below 1e-6
# in 99 % of impacts, 1e-5 in all. At a cushion they vary less: a larger tolerance keeps the same promise.
_STANDARD = Accuracy(tol=5e-8, delta=1e-7, creep=1e-3, order=12)
_STANDARD_CUSHION = _STANDARD._replace(tol=1.5e-7)
# "fast" has the cloth's reaction at a cushion (worth 7 % of the speed), and solves to a few per mille.
_LOOSE = Accuracy(tol=1e-4, delta=1e-5, creep=1e-2, order=8)

_NO_CLOSING = 1e-60
"""A smaller closing speed is zero [m/s]: the scaled slips would overflow. No physical effect."""


def parse_fidelity(fidelity: Fidelity) -> Solver:
    """The code of a fidelity, as the kernels read it.

    Parameters
    ----------
    fidelity : str
        "fast", "standard", "reference" or "euler:N" with N from 1 to 10,000,000.

    Returns
    -------
    code : int
        0 to 3, in this order.
    n_steps : int
        N of "euler:N", else 0.

    Raises
    ------
    ValueError
        For anything else.

    Examples
    --------
    >>> from snooker_env.checks import parse_fidelity
    >>> parse_fidelity("standard"), parse_fidelity("euler:5000")
    ((1, 0), (3, 5000))
    """
    if isinstance(fidelity, str):
        if fidelity in _CODES:
            return _CODES[fidelity], 0
        head, _, n = fidelity.partition(":")
        if head == "euler" and n.isascii() and n.isdigit() and len(n) < 10 and 1 <= int(n) <= MAX_EULER_STEPS:
            return EULER, int(n)
    names = ", ".join(f'"{name}"' for name in _CODES)
    raise refuse("fidelity", fidelity, f'must be {names} or "euler:N" with N in [1, {MAX_EULER_STEPS}]')


@kernel
def cushion_restitution(speed, phys):
    """e(v) = e_c up to the knee, e_c (v / knee)^(-power) above; v: horizontal speed into the cushion [m/s].

    v e(v) rises (power < 1). The form is that of loss by yielding, v^(-1/4) (Johnson, Contact Mechanics,
    1985, 11.5); power and knee are fitted (``Physics.preset``). It depends on the normal speed alone.
    """
    if phys[P_E_POWER] > 0.0 and speed > phys[P_E_KNEE]:
        return phys[P_E_C] * (speed / phys[P_E_KNEE]) ** -phys[P_E_POWER]
    return phys[P_E_C]


@kernel
def _to_frame(a, nx, ny):
    """A vector of the table in the contact's frame (tangent, normal, up): X = Y x Z = (ny, -nx)."""
    return a[0] * ny - a[1] * nx, a[0] * nx + a[1] * ny, a[2]


@kernel
def _to_table(a, nx, ny):
    """The inverse of ``_to_frame``."""
    return a[0] * ny + a[1] * nx, a[1] * ny - a[0] * nx, a[2]


@kernel
def _friction_impulse_free(xa, za, ya, friction, e):
    """Two free spheres: friction impulse (at most what ends the slip) and normal, per unit mass [m/s]."""
    pn = 0.5 * (1.0 + e) * ya
    s = hypot(xa, za)
    if s == 0.0:
        return 0.0, 0.0, pn
    # for free spheres the same in both tangential directions
    pt = min(friction_coefficient(s, friction) * pn, s / inertia.BALLS.k1)
    return -pt * xa / s, -pt * za / s, pn


@inline
def _balls_in_frame(vc, wc, vo, wo, law, e, series):
    """Two balls in the contact frame (X tangent, Y from C to O, Z up) that approach each other."""
    phys, fidelity, n_steps = law.phys, law.fidelity, law.n_steps
    R = phys[P_R]
    friction = Friction(phys[P_MU_BB_LEAST], phys[P_MU_BB_EXTRA], phys[P_MU_BB_FADE])
    if fidelity == EULER:
        return euler.balls(vc, wc, vo, wo, friction, phys, e, n_steps)
    ya = vc[1] - vo[1]
    xa = (vc[0] - R * wc[2]) - (vo[0] + R * wo[2])
    za = (vc[2] + R * wc[0]) - (vo[2] - R * wo[0])
    q = 2.5 / R
    if fidelity == FAST:
        f1, f2, p = _friction_impulse_free(xa, za, ya, friction, e)
        vc, vo = (vc[0] + f1, vc[1] - p, vc[2] + f2), (vo[0] - f1, vo[1] + p, vo[2] - f2)
        wc, wo = (wc[0] + q * f2, wc[1], wc[2] - q * f1), (wo[0] + q * f2, wo[1], wo[2] - q * f1)
        return vc, wc, vo, wo, True
    accuracy = impulse.REFERENCE if fidelity == REFERENCE else _STANDARD
    # no slip, and nothing between two balls starts one: there is only the normal impulse
    if hypot(xa, za) <= accuracy.delta * ya:
        p = 0.5 * (1.0 + e) * ya
        return (vc[0], vc[1] - p, vc[2]), wc, (vo[0], vo[1] + p, vo[2]), wo, True
    # za < 0: friction presses O into the cloth; za > 0: C, the same problem from the other side (half a turn
    # about Z, names swapped): x and y of all vectors and za change sign, xa stays.
    swapped = za > 0.0
    sign = -1.0 if swapped else 1.0
    vp, wp = (vc, wc) if swapped else (vo, wo)  # the pressed ball
    b1, b2 = sign * (vp[0] - R * wp[1]), sign * (vp[1] + R * wp[0])
    start = Slips(xa / ya, -abs(za) / ya, b1 / ya, b2 / ya, 1.0)
    scaled = Friction(friction.least, friction.extra, friction.fade * ya)
    solved, x = False, NO_IMPULSE
    rolls_on_resting = abs(start.b1) + abs(start.b2) + abs(start.a2 + 1.0) < ROLLS
    if rolls_on_resting and fidelity != REFERENCE and phys[P_BALLS] > 0.0 and e == phys[P_E_B]:
        solved, x = look_up(phys, int(phys[P_BALLS]), start.a1)
    if not solved:
        x, status = solve(Problem(inertia.BALLS, start, scaled, phys[P_MU_S], e), accuracy, series)
        solved = status == OK
    f1, f2, g1, g2, p = x.F1 * ya, x.F2 * ya, x.G1 * ya, x.G2 * ya, x.p * ya
    # lifted: (f1, -p, f2), spin q (f2, 0, -f1); pressed: (g1 - f1, p + g2, 0), spin q (f2 + g2, -g1, -f1)
    lift_v, lift_w = (sign * f1, -sign * p, f2), (sign * q * f2, 0.0, -q * f1)
    press_v, press_w = (
        (sign * (g1 - f1), sign * (p + g2), 0.0),
        (sign * q * (f2 + g2), -sign * q * g1, -q * f1),
    )
    if swapped:
        return _add(vc, press_v), _add(wc, press_w), _add(vo, lift_v), _add(wo, lift_w), solved
    return _add(vc, lift_v), _add(wc, lift_w), _add(vo, press_v), _add(wo, press_w), solved


@kernel
def _add(a, b):
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@kernel
def collide_balls(v1, w1, v2, w2, normal, law, e, series):
    """Impact of two equal balls -> v1, w1, v2, w2 [m/s, rad/s] and whether it was solved. [MJP14] 2.1 to 2.4.

    normal: unit vector (nx, ny) from ball 1 to ball 2; ``e``: restitution; ``series``: ``polynomial.WORK``
    numbers. The lifted ball's vertical velocity is in the result.
    """
    nx, ny = normal
    if not (v1[0] - v2[0]) * nx + (v1[1] - v2[1]) * ny > _NO_CLOSING:
        return v1, w1, v2, w2, True
    vc, wc, vo, wo, solved = _balls_in_frame(
        _to_frame(v1, nx, ny),
        _to_frame(w1, nx, ny),
        _to_frame(v2, nx, ny),
        _to_frame(w2, nx, ny),
        law,
        e,
        series,
    )
    return _to_table(vc, nx, ny), _to_table(wc, nx, ny), _to_table(vo, nx, ny), _to_table(wo, nx, ny), solved


@kernel
def collide_from_above(vc, wc, vo, wo, normal, law, e, series):
    """Impact of a ball C in the air with a ball O on the bed -> v and w of C, of O, the impulse of friction between them that
    presses O into the bed [m/s], and whether it was solved.

    normal: unit vector from C to O, not upwards; ``e``: restitution. They approach. O leaves with a vertical velocity
    where friction lifts it; the bed takes what presses it. "euler:N" solves it as "standard".
    """
    phys, fidelity = law.phys, law.fidelity
    R, sin_t = phys[P_R], min(1.0, max(0.0, -normal[2]))
    cos_t = hypot(normal[0], normal[1])
    hx, hy = (normal[0] / cos_t, normal[1] / cos_t) if cos_t > 0.0 else (1.0, 0.0)
    vcx, vch, vcz = _to_frame(vc, hx, hy)
    wcx, wch, wcz = _to_frame(wc, hx, hy)
    vox, voh, _ = _to_frame(vo, hx, hy)
    wox, woh, woz = _to_frame(wo, hx, hy)
    # off O's plane C moves as fast as it will; O's vertical velocity is zero
    dx, dh, dz = vcx - vox, vch - voh, vcz
    closing = dh * cos_t - dz * sin_t
    if not closing > _NO_CLOSING:
        return vc, wc, vo, wo, 0.0, True
    start = Slips(
        (dx - R * ((wch + woh) * sin_t + (wcz + woz) * cos_t)) / closing,
        (dh * sin_t + dz * cos_t + R * (wcx + wox)) / closing,
        (vox - R * woh) / closing,
        (voh + R * wox) / closing,
        1.0,
    )
    friction = Friction(phys[P_MU_BB_LEAST], phys[P_MU_BB_EXTRA], phys[P_MU_BB_FADE] * closing)
    accuracy = impulse.REFERENCE if fidelity == REFERENCE else _LOOSE if fidelity == FAST else _STANDARD
    problem = Problem(inertia.tilt_pair(sin_t, cos_t), start, friction, phys[P_MU_S], e)
    x, status = solve(problem, accuracy, series)
    if status != OK:  # rare (one shot in 160,000 of a fuzz)
        x, status = solve(problem, _LOOSE, series)
    f1, f2, g1, g2 = x.F1 * closing, x.F2 * closing, x.G1 * closing, x.G2 * closing
    p, lift, q = x.p * closing, x.Z * closing, 2.5 / R
    vc = (vcx + f1, vch + f2 * sin_t - p * cos_t, vcz + f2 * cos_t + p * sin_t)
    wc = (wcx + q * f2, wch - q * f1 * sin_t, wcz - q * f1 * cos_t)
    vo = (vox + g1 - f1, voh + p * cos_t - f2 * sin_t + g2, lift)
    wo = (wox + q * (f2 + g2), woh - q * (f1 * sin_t + g1), woz - q * f1 * cos_t)
    return (
        _to_table(vc, hx, hy),
        _to_table(wc, hx, hy),
        _to_table(vo, hx, hy),
        _to_table(wo, hx, hy),
        max(0.0, f2 * cos_t),
        status == OK,
    )


@kernel
def collide_cushion(v, w, normal, law, e, series):
    """Impact of a ball with a nose -> v [m/s], w [rad/s], solved. [MJP10], with Coulomb's law at zero slip.

    normal: unit vector (nx, ny) INTO the cushion. "fast" integrates loosely: no closed form has the cloth's
    reaction.
    """
    (nx, ny), phys, fidelity = normal, law.phys, law.fidelity
    sin_t = phys[P_SIN]
    cos_t = sqrt(1.0 - sin_t * sin_t)
    vx, vy, vz = _to_frame(v, nx, ny)
    closing = vy * cos_t + vz * sin_t
    if not closing > _NO_CLOSING:
        return v, w, True
    wx, wy, wz = _to_frame(w, nx, ny)
    R, mu_s, mu_c = phys[P_R], phys[P_MU_S], phys[P_MU_C]
    if fidelity == EULER:
        v, w, solved = euler.cushion((vx, vy, vz), (wx, wy, wz), phys, e, law.n_steps)
        return _to_table(v, nx, ny), _to_table(w, nx, ny), solved
    start = Slips(
        (vx + R * (wy * sin_t - wz * cos_t)) / closing,
        (-vy * sin_t + vz * cos_t + R * wx) / closing,
        (vx - R * wy) / closing,
        (vy + R * wx) / closing,
        1.0,
    )
    solved, x = False, NO_IMPULSE
    rolls = abs(start.b1) + abs(start.b2) + abs(start.a2 + (1.0 + sin_t) / cos_t) < ROLLS
    if rolls and fidelity != REFERENCE:
        at = int(phys[P_RAIL]) if e == phys[P_E_C] else int(phys[P_JAW]) if e == phys[P_E_J] else 0
        if at > 0:
            solved, x = look_up(phys, at, start.a1)
    if not solved:
        accuracy = (
            impulse.REFERENCE
            if fidelity == REFERENCE
            else _STANDARD_CUSHION
            if fidelity == STANDARD
            else _LOOSE
        )
        x, status = solve(
            Problem(inertia.cushion(sin_t, cos_t), start, Friction(mu_c, 0.0, 0.0), mu_s, e), accuracy, series
        )
        solved = status == OK
    f1, f2, g1, g2, p, lift = (
        x.F1 * closing,
        x.F2 * closing,
        x.G1 * closing,
        x.G2 * closing,
        x.p * closing,
        x.Z * closing,
    )
    q = 2.5 / R
    v = (vx + f1 + g1, vy - cos_t * p - sin_t * f2 + g2, vz + lift)
    w = (wx + q * (f2 + g2), wy + q * (sin_t * f1 - g1), wz - q * cos_t * f1)
    return _to_table(v, nx, ny), _to_table(w, nx, ny), solved
