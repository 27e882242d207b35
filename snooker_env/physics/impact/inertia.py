"""How do impulses change the slips of an impact? Linearly: eleven constants for two balls and eleven for a
cushion, from the masses.

An impact has two frictional contacts: A, where the ball meets the other ball or the nose of a cushion, and
the contact with the cloth under the ball that is pressed down. All impulses are per unit mass, so M and R
cancel, and R times a spin is a speed.

**One sphere.** Its moment of inertia is 2/5 M R^2. An impulse J on its surface, at R n from the centre (n: a
unit vector), gives

    dv = J        R dw = 5/2 n x J                                                                                          (1)

and the surface at R m moves by du = dv + R dw x m. In particular a tangential impulse moves its own point of
a free sphere by 7/2 J.

**Frame.** X is the tangent, Y points into the other body (from ball C to ball O; into the cushion), Z points
up. The normal impulse p and the friction F = (F1, F2) act at A. The friction G = (G1, G2) along X and Y and
the reaction N along Z, which gives no spin, act at the cloth. The slip at A is a = (a1, a2), the slip at the
cloth b = (b1, b2) = (u_X, u_Y) at m = -Z.

**Two balls**, O pressed (if C is pressed, the problem is the same from the other side). A lies at Y from C
and at -Y from O. C receives (F1, -p, F2) and is free; O receives the opposite, and G and N. N keeps O's
vertical velocity at zero: N = F2. With (1)

    C:  dv = (F1, -p, F2)             R dw = 5/2 (F2, 0, -F1)
    O:  dv = (G1 - F1, p + G2, 0)     R dw = 5/2 (F2 + G2, -G1, -F1)

    da1 = u_X(C) - u_X(O) = (1 + 5/2) F1 - (-(1 + 5/2) F1 + G1)         =          7 F1 - G1
    da2 = u_Z(C) - u_Z(O) = (1 + 5/2) F2 - (-5/2 F2 - 5/2 G2)           =          6 F2 + 5/2 G2
    db1 = dv_X(O) - R dw_Y(O)                                           =           -F1 + 7/2 G1
    db2 = dv_Y(O) + R dw_X(O)                                           =      p + 5/2 F2 + 7/2 G2
    d(closing) = dv_Y(C) - dv_Y(O)                                      =   -2 p          - G2

**A cushion**, its nose at R sin(t) above the centre. A lies at m = (0, cos t, sin t); the second tangent is
(0, -sin t, cos t). The ball receives F1 X + F2 (0, -sin t, cos t) - p m, and G and N. Its vertical velocity Z
stays zero while N = p sin t - F2 cos t is positive; a negative load lifts the ball: N = 0 and Z grows. With
(1) and m x X = (0, sin t, -cos t), m x (0, -sin t, cos t) = X

    dv = (F1 + G1, -p cos t - F2 sin t + G2, Z)      R dw = 5/2 (F2 + G2, F1 sin t - G1, -F1 cos t)

    da1 = dv_X + R (dw_Y sin t - dw_Z cos t)         =                       7/2 F1 + (1 - 5/2 sin t) G1
    da2 = -dv_Y sin t + dv_Z cos t + R dw_X          =     p sin t cos t + (5/2 + sin^2 t) F2 + (5/2 - sin t) G2 + Z cos t
    db1 = dv_X - R dw_Y                              =             (1 - 5/2 sin t) F1 + 7/2 G1
    db2 = dv_Y + R dw_X                              =          -p cos t + (5/2 - sin t) F2 + 7/2 G2
    d(closing) = dv_Y cos t + dv_Z sin t             =        -p cos^2 t - F2 sin t cos t + G2 cos t + Z sin t

**A ball in the air on one that lies on the bed**: C is higher, Y points from C down to O by the angle t, so Y = (0, cos t,
-sin t) in axes X, h (horizontal), z; the second tangent at A is (0, sin t, cos t). C is free. O's vertical velocity Z stays
zero while N = p sin t + F2 cos t is positive. With (1), and with G along X and h

    C:  dv = F1 X + F2 (0, sin t, cos t) - p Y                  R dw = 5/2 (F2 X - F1 (0, sin t, cos t))
    O:  dv = (G1 - F1, p cos t - F2 sin t + G2, Z)              R dw = 5/2 (F2 + G2, -F1 sin t - G1, -F1 cos t)

    da1         =  7 F1 + (5/2 sin t - 1) G1
    da2         =  -p sin t cos t + (6 + sin^2 t) F2 + (5/2 - sin t) G2 - Z cos t
    db1         =  (5/2 sin t - 1) F1 + 7/2 G1
    db2         =  p cos t + (5/2 - sin t) F2 + 7/2 G2
    d(closing)  =  -(1 + cos^2 t) p + F2 sin t cos t - G2 cos t + Z sin t

t = 0 gives the constants of two balls.

All have the form of ``Contact``. The effect of F2 and G2 on the closing speed is that of p on a2 and b2 with
the opposite sign: this is the symmetry of the inverse inertia. ``tests/physics/test_inertia.py`` derives it
again, symbolically, from the laws of Newton and Euler.
"""

from typing import NamedTuple

from ..._lib.jit import kernel

K_CLOTH = 3.5
"""Change of the slip at the pressed ball's lowest point per friction impulse on it: 1 + 5/2."""


class Impulses(NamedTuple):
    """The impulses so far, per unit mass, or their rates: the whole state of an impact."""

    F1: float
    """Friction at A."""
    F2: float
    G1: float
    """Friction at the cloth."""
    G2: float
    p: float
    """Normal impulse at A."""
    W: float
    """Work of p."""
    Z: float
    """Vertical velocity of a ball that has left the cloth."""


class Slips(NamedTuple):
    """The relative motion of the surfaces [m/s, or in units of the closing speed before the impact]."""

    a1: float
    """Slip at A."""
    a2: float
    b1: float
    """Slip at the cloth."""
    b2: float
    closing: float
    """Speed at which the bodies approach along the normal."""


class Contact(NamedTuple):
    """The constants of one kind of impact: the factors in the equations of ``impulse.py``."""

    k1: float
    """Effect of the friction at A on the slip at A, along X; k2: across it."""
    k2: float
    c1: float
    """Effect of the friction at either contact on the slip at the other, along X; c2: along Y."""
    c2: float
    d_a: float
    """Effect of the normal impulse on a2."""
    d_b: float
    """Effect of the normal impulse on b2."""
    d_n: float
    """Effect of the normal impulse on the closing speed."""
    n_p: float
    """Part of the normal impulse that presses the ball into the cloth."""
    n_f: float
    """Part of the friction F2 that presses the ball into the cloth."""
    l_a: float
    """Effect of the vertical velocity of a lifted ball on a2."""
    l_n: float
    """Effect of the vertical velocity of a lifted ball on the closing speed."""


BALLS = Contact(
    k1=7.0, k2=6.0, c1=-1.0, c2=2.5, d_a=0.0, d_b=1.0, d_n=-2.0, n_p=0.0, n_f=1.0, l_a=0.0, l_n=0.0
)
"""Two balls on the bed. The pressed one is never lifted: the load is the friction that presses it."""


@kernel
def tilt_pair(sin_t, cos_t):
    """The constants of an impact of a ball in the air with one that lies, lower by 2R sin(t)."""
    return Contact(
        7.0,
        6.0 + sin_t * sin_t,
        2.5 * sin_t - 1.0,
        2.5 - sin_t,  # k1, k2, c1, c2
        -sin_t * cos_t,
        cos_t,
        sin_t * sin_t - 2.0,  # d_a, d_b, d_n
        sin_t,
        cos_t,  # n_p, n_f
        -cos_t,
        sin_t,  # l_a, l_n
    )


@kernel
def cushion(sin_t, cos_t):
    """The constants of an impact with a nose at R sin(t) above the ball's centre."""
    return Contact(
        3.5,
        2.5 + sin_t * sin_t,
        1.0 - 2.5 * sin_t,
        2.5 - sin_t,  # k1, k2, c1, c2
        sin_t * cos_t,
        -cos_t,
        -cos_t * cos_t,  # d_a, d_b, d_n
        sin_t,
        -cos_t,  # n_p, n_f
        cos_t,
        sin_t,  # l_a, l_n
    )


@kernel
def slips_after(x, start, contact):
    """The slips after the impulses x, from the slips before the impact."""
    return Slips(
        start.a1 + contact.k1 * x.F1 + contact.c1 * x.G1,
        start.a2 + contact.d_a * x.p + contact.k2 * x.F2 + contact.c2 * x.G2 + contact.l_a * x.Z,
        start.b1 + contact.c1 * x.F1 + K_CLOTH * x.G1,
        start.b2 + contact.d_b * x.p + contact.c2 * x.F2 + K_CLOTH * x.G2,
        start.closing + contact.d_n * x.p - contact.d_a * x.F2 - contact.d_b * x.G2 + contact.l_n * x.Z,
    )
