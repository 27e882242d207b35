"""Which result has the paper's own scheme? Explicit Euler over the normal impulse, eq. 14, as printed.

[MJP14] 2.2 to 2.4.3, and the same for the cushion of [MJP10]; impulses per unit mass. Ends are not located in
a step: compression ends with the first step to closing speed <= 0, the impact with the first to its work. So
the paper's discretisation error is kept; ``impulse.py`` is the accurate method.
"""

from math import hypot, sqrt

from ..._lib.jit import kernel
from ..columns import P_MU_C, P_MU_S, P_R, P_SIN
from .coulomb import friction_coefficient

_MAX_OVERRUN = 100
"""Steps over N after which the scheme is unsolved; one that ends takes about N."""


@kernel
def balls(vc, wc, vo, wo, friction, phys, e, n_steps):
    """Balls C, O (X tangent, Y from C to O, Z up), v [m/s], w [rad/s] -> after the impact, and solved."""
    vcx, vcy, vcz = vc
    wcx, wcy, wcz = wc
    vox, voy, voz = vo
    wox, woy, woz = wo
    R, mu_s = phys[P_R], phys[P_MU_S]
    dp = (1.0 + e) * (vcy - voy) / n_steps  # eq. 14, with the closing speed for V0 cos(theta)
    q = 2.5 / R
    work = target = 0.0
    compressing = True
    for _ in range(_MAX_OVERRUN * (n_steps + 1)):
        xa = (vcx - R * wcz) - (vox + R * woz)  # eq. 11b
        za = (vcz + R * wcx) - (voz - R * wox)
        ya = vcy - voy
        s = hypot(xa, za)
        dp1 = dp2 = dxc = dyc = dxo = dyo = nc = no = 0.0
        if s > 0.0:
            mu = friction_coefficient(s, friction)
            dp1, dp2 = -mu * xa / s * dp, -mu * za / s * dp  # eq. 6a, 6b
            if dp2 < 0.0:  # C is pressed into the cloth, eq. 7a, 8a, 8b
                nc = -dp2
                bx, by = vcx - R * wcy, vcy + R * wcx
                b = hypot(bx, by)
                if b > 0.0:
                    dxc, dyc = -mu_s * nc * bx / b, -mu_s * nc * by / b
            elif dp2 > 0.0:  # O is, eq. 7b, 8c, 8d
                no = dp2
                bx, by = vox - R * woy, voy + R * wox
                b = hypot(bx, by)
                if b > 0.0:
                    dxo, dyo = -mu_s * no * bx / b, -mu_s * no * by / b
        vcx += dp1 + dxc  # eq. 3a
        vcy += -dp + dyc  # eq. 3b
        vcz += dp2 + nc  # eq. 3c
        wcx += q * (dp2 + dyc)  # eq. 3d
        wcy -= q * dxc  # eq. 3e
        wcz -= q * dp1  # eq. 3f
        vox += -dp1 + dxo  # eq. 4, and the same for the other components
        voy += dp + dyo
        voz += -dp2 + no
        wox += q * (dp2 + dyo)
        woy -= q * dxo
        woz -= q * dp1
        closing = vcy - voy
        work += 0.5 * dp * (ya + closing)  # eq. 12
        if compressing and closing <= 0.0:
            compressing = False
            target = (1.0 - e * e) * work  # eq. 10c
        if not compressing and work <= target:  # eq. 15
            return (vcx, vcy, vcz), (wcx, wcy, wcz), (vox, voy, voz), (wox, woy, woz), True
    return (vcx, vcy, vcz), (wcx, wcy, wcz), (vox, voy, voz), (wox, woy, woz), False


@kernel
def cushion(v, w, phys, e, n_steps):
    """Ball and nose (X along it, Y into it, Z up) -> v [m/s], w [rad/s], solved. mu_c: [MJP10]'s mu_w."""
    R, mu_s, mu_c, sin_t = phys[P_R], phys[P_MU_S], phys[P_MU_C], phys[P_SIN]
    vx, vy, vz = v
    wx, wy, wz = w
    cos_t = sqrt(1.0 - sin_t * sin_t)
    yn = vy * cos_t + vz * sin_t
    dp = (1.0 + e) * yn / n_steps
    q = 2.5 / R
    work = target = 0.0
    compressing = True
    for _ in range(_MAX_OVERRUN * (n_steps + 1)):
        a1 = vx + R * (wy * sin_t - wz * cos_t)
        a2 = -vy * sin_t + vz * cos_t + R * wx
        s = hypot(a1, a2)
        f1 = f2 = g1 = g2 = 0.0
        if s > 0.0:
            f1, f2 = -mu_c * a1 / s * dp, -mu_c * a2 / s * dp
        load = dp * sin_t - f2 * cos_t
        lift = max(0.0, -load)
        load = max(0.0, load)
        bx, by = vx - R * wy, vy + R * wx
        b = hypot(bx, by)
        if b > 0.0:
            g1, g2 = -mu_s * load * bx / b, -mu_s * load * by / b
        vx += f1 + g1
        vy += -dp * cos_t - f2 * sin_t + g2
        vz += lift
        wx += q * (f2 + g2)
        wy += q * (f1 * sin_t - g1)
        wz -= q * f1 * cos_t
        after = vy * cos_t + vz * sin_t
        work += 0.5 * dp * (yn + after)
        yn = after
        if compressing and yn <= 0.0:
            compressing = False
            target = (1.0 - e * e) * work
        if not compressing and work <= target:
            return (vx, vy, vz), (wx, wy, wz), True
    return (vx, vy, vz), (wx, wy, wz), False
