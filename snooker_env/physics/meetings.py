"""How do bodies separate after a meeting in a shot? As the impact model says; slow ones by a small hop.

Spin can press a ball against a body, and the cloth damps each bounce: it would bounce more and more often
without end. So no pair separates at less than ``PART``: a faster one's restitution is raised as needed; a
slower one has no friction and takes the missing energy from the spins, as rubbing would. A lasting contact is
then a series of hops of about a micrometre and a millisecond. Energy never rises.
"""

from math import sqrt

from .._jit import inlined, kernel
from .columns import P_E_B, P_E_J, P_R
from .impact.contact import collide_balls, collide_cushion, cushion_restitution

PART = 2e-3  # m/s; too slow to matter in a shot: a ball at this speed rolls 16 micrometres


@kernel
def _hop(closing, spin_energy):
    """A slow contact: the speed of separation [m/s], and the factor on the spins, which give the energy.

    Per unit of reduced mass: closing^2 / 2 before, parting^2 / 2 after; ``spin_energy`` in the same unit
    [m^2/s^2].
    """
    closing = max(closing, 0.0)
    missing = min(0.5 * (PART * PART - closing * closing), 0.5 * spin_energy)
    if missing <= 0.0:
        return closing, 1.0
    return sqrt(closing * closing + 2.0 * missing) * (1.0 - 1e-12), sqrt(1.0 - missing / spin_energy)


@kernel
def _spin_energy(w, R):
    """Energy of a spin per unit mass, (1/5) R^2 w^2 [m^2/s^2]."""
    return 0.2 * R * R * (w[0] * w[0] + w[1] * w[1] + w[2] * w[2])


@kernel
def _scaled(w, k):
    return w[0] * k, w[1] * k, w[2] * k


@inlined
def meet(v1, w1, v2, w2, normal, law, series):
    """Ball-ball impact: as ``collide_balls`` or, below ``PART``, a hop; in the plane, as in the paper."""
    (nx, ny), phys = normal, law.phys
    closing = (v1[0] - v2[0]) * nx + (v1[1] - v2[1]) * ny
    if closing <= PART:
        # two equal balls: the reduced mass is M/2, so the spin energy counts double
        parting, k = _hop(closing, 2.0 * (_spin_energy(w1, phys[P_R]) + _spin_energy(w2, phys[P_R])))
        dv = 0.5 * (closing + parting)
        return (
            (v1[0] - dv * nx, v1[1] - dv * ny),
            _scaled(w1, k),
            (v2[0] + dv * nx, v2[1] + dv * ny),
            _scaled(w2, k),
            True,
        )
    e = max(phys[P_E_B], PART / closing)
    v1, v2 = (v1[0], v1[1], 0.0), (v2[0], v2[1], 0.0)
    a, wa, b, wb, solved = collide_balls(v1, w1, v2, w2, normal, law, e, series)
    return (a[0], a[1]), wa, (b[0], b[1]), wb, solved


@inlined
def rebound(v, w, normal, jaw, law, series):
    """Impact with a nose or a jaw inside a shot, by the same rules; ``normal`` points into the cushion."""
    (nx, ny), phys = normal, law.phys
    closing = v[0] * nx + v[1] * ny
    if closing <= PART:
        parting, k = _hop(closing, _spin_energy(w, phys[P_R]))
        dv = closing + parting
        return (v[0] - dv * nx, v[1] - dv * ny), _scaled(w, k), True
    e = max(phys[P_E_J] if jaw else cushion_restitution(closing, phys), PART / closing)
    a, wa, solved = collide_cushion((v[0], v[1], 0.0), w, normal, law, e, series)
    return (a[0], a[1]), wa, solved
