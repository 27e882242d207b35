"""How do bodies separate after a meeting in a shot? As the impact model says; slow ones by a small hop.

Spin can press a ball against a body, and the cloth damps each bounce: it would bounce more and more often
without end. So no pair separates at less than ``PART``: a faster one's restitution is raised as needed; a
slower one has no friction and takes the missing energy from the spins, as rubbing would. A lasting contact is
then a series of hops of about a micrometre and a millisecond. Energy never rises.
"""

from math import sqrt

from .._lib.jit import inline, kernel
from .columns import P_E_B, P_E_J, P_MU_BB_EXTRA, P_MU_BB_FADE, P_MU_BB_LEAST, P_MU_C, P_R
from .impact import free
from .impact.contact import collide_balls, collide_cushion, collide_from_above, cushion_restitution
from .impact.coulomb import Friction

PART = 2e-3  # m/s; too slow to matter in a shot: a ball at this speed rolls 16 micrometres


@kernel
def _hop(closing, spin_energy):
    """A slow contact: the speed of separation [m/s], and the factor on the spins, which give the energy. Per unit of reduced
    mass: closing^2 / 2 before, parting^2 / 2 after; ``spin_energy`` in the same unit [m^2/s^2]."""
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
def _scale(w, k):
    return w[0] * k, w[1] * k, w[2] * k


@inline
def meet(v1, w1, v2, w2, normal, law, series):
    """Two balls on the bed meet: ``collide_balls`` or, below ``PART``, a hop; vertical velocities as they would be off the bed."""
    (nx, ny), phys = normal, law.phys
    closing = (v1[0] - v2[0]) * nx + (v1[1] - v2[1]) * ny
    if closing <= PART:
        # two equal balls: the reduced mass is M/2, so the spin energy counts double
        parting, k = _hop(closing, 2.0 * (_spin_energy(w1, phys[P_R]) + _spin_energy(w2, phys[P_R])))
        dv = 0.5 * (closing + parting)
        u1, u2 = (v1[0] - dv * nx, v1[1] - dv * ny, 0.0), (v2[0] + dv * nx, v2[1] + dv * ny, 0.0)
        return u1, _scale(w1, k), u2, _scale(w2, k), True
    e = max(phys[P_E_B], PART / closing)
    v1, v2 = (v1[0], v1[1], 0.0), (v2[0], v2[1], 0.0)
    return collide_balls(v1, w1, v2, w2, normal, law, e, series)


@kernel
def energy_loss(before, after, R):
    """The energy per unit mass that two balls lose in an impact [m^2/s^2]; before and after: v1, w1, v2, w2."""
    energy = 0.0
    for k in (0, 2):
        v, w, u, s = before[k], before[k + 1], after[k], after[k + 1]
        energy += 0.5 * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2] - u[0] * u[0] - u[1] * u[1] - u[2] * u[2])
        energy += _spin_energy(w, R) - _spin_energy(s, R)
    return max(0.0, energy)


@kernel
def meet_in_air(vc, wc, vo, wo, normal, lies, law, series):
    """Two balls meet, C in the air, O lower or as high; ``lies``: O is on the bed; ``normal``: from C to O. -> v and w of C
    and O, the impulse that presses O into the bed (at most what gives back the energy lost), solved."""
    (x, y, z), phys = normal, law.phys
    dz = vc[2] - (0.0 if lies else vo[2])
    closing = (vc[0] - vo[0]) * x + (vc[1] - vo[1]) * y + dz * z
    if closing <= PART:
        give = 1.0 - z * z if lies else 1.0  # the bed holds one that lies
        parting, k = _hop(closing, (1.0 + give) * (_spin_energy(wc, phys[P_R]) + _spin_energy(wo, phys[P_R])))
        dv = (closing + parting) / (1.0 + give)
        vc = (vc[0] - dv * x, vc[1] - dv * y, vc[2] - dv * z)
        vo = (vo[0] + dv * x, vo[1] + dv * y, 0.0 if lies else vo[2] + dv * z)
        return vc, _scale(wc, k), vo, _scale(wo, k), 0.0, True
    e = max(phys[P_E_B], PART / closing)
    if lies:
        flat = vo[0], vo[1], 0.0
        a, wa, b, wb, press, solved = collide_from_above(vc, wc, flat, wo, normal, law, e, series)
        press = min(press, sqrt(2.0 * energy_loss((vc, wc, flat, wo), (a, wa, b, wb), phys[P_R])))
        return a, wa, b, wb, press, solved
    friction = Friction(phys[P_MU_BB_LEAST], phys[P_MU_BB_EXTRA], phys[P_MU_BB_FADE])
    vc, wc, vo, wo = free.between(vc, wc, vo, wo, normal, friction, e, phys[P_R])
    return vc, wc, vo, wo, 0.0, True


@kernel
def rebound_in_air(v, w, normal, jaw, phys):
    """A ball in the air meets a nose or a jaw; ``normal``: to its edge, in three dimensions."""
    x, y, z = normal
    closing = v[0] * x + v[1] * y + v[2] * z
    if closing <= PART:
        parting, k = _hop(closing, _spin_energy(w, phys[P_R]))
        dv = closing + parting
        return (v[0] - dv * x, v[1] - dv * y, v[2] - dv * z), _scale(w, k)
    e = max(phys[P_E_J] if jaw else cushion_restitution(closing, phys), PART / closing)
    return free.against(v, w, normal, phys[P_MU_C], e, phys[P_R])


@inline
def rebound(v, w, normal, jaw, law, series):
    """Impact with a nose or a jaw inside a shot, by the same rules; ``normal`` points into the cushion."""
    (nx, ny), phys = normal, law.phys
    closing = v[0] * nx + v[1] * ny
    if closing <= PART:
        parting, k = _hop(closing, _spin_energy(w, phys[P_R]))
        dv = closing + parting
        return (v[0] - dv * nx, v[1] - dv * ny, 0.0), _scale(w, k), True
    e = max(phys[P_E_J] if jaw else cushion_restitution(closing, phys), PART / closing)
    return collide_cushion((v[0], v[1], 0.0), w, normal, law, e, series)
