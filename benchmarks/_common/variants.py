"""How would a shot run without one of its models? A copy of the package has other impacts, because the package itself
has no such switches.

Additional text in the copy's ``contact.py`` and a condition in its ``engine.py`` add fidelities: each is
``standard`` without one model.
"""

from snooker_env.physics import parameters
from snooker_env.physics.impact.tables import TABLED

from . import package_copies

FREE_BALLS, LOOSE_CUSHION, SMOOTH_CLOTH, MIRROR, AT_ONCE = 101, 102, 103, 104, 105
"""Fidelities of the copy: balls as free spheres (the closed form of ``fast``); the cushion with the loose tolerance
of ``fast``; the cushion in closed form, with friction at the nose but not at the cloth; the cushion as a mirror
with a restitution; and a ball that drops as soon as its centre crosses the edge of a pocket."""

_FLIES = "if kind == events.POT and state[i] != FALLING"
"""The engine's test whether a ball at the edge of a pocket can meet a jaw behind it."""

_ADDED = '''

# Added by benchmarks/_common/variants.py.

from ..arrays import Law

_all_of_balls, _all_of_cushion = collide_balls, collide_cushion


@kernel
def _smooth_cushion(v, w, nx, ny, phys, e):
    """Friction at the nose in its first direction, capped where slip ends (3.5: a sphere); the cloth holds the ball down, smoothly."""
    sin_t = phys[P_SIN]
    cos_t = sqrt(1.0 - sin_t * sin_t)
    R = phys[P_R]
    vx, vy, vz = _to_frame(v, nx, ny)
    wx, wy, wz = _to_frame(w, nx, ny)
    p = (1.0 + e) * vy / cos_t
    a1, a2 = vx + R * (wy * sin_t - wz * cos_t), -vy * sin_t + R * wx
    s = hypot(a1, a2)
    k = min(phys[P_MU_C] * p / s, 1.0 / 3.5) if s > 0.0 else 0.0
    f1, f2 = -k * a1, -k * a2
    q = 2.5 / R
    after = (vx + f1, -e * vy - sin_t * f2, vz)
    return _to_table(after, nx, ny), _to_table((wx + q * f2, wy + q * sin_t * f1, wz - q * cos_t * f1), nx, ny), True


@kernel
def collide_balls(v1, w1, v2, w2, normal, law, e, work):
    code = FAST if law.fidelity == 101 else STANDARD if law.fidelity > 101 else law.fidelity
    return _all_of_balls(v1, w1, v2, w2, normal, Law(law.phys, code, law.n_steps), e, work)


@kernel
def collide_cushion(v, w, normal, law, e, work):
    (nx, ny), phys, fidelity = normal, law.phys, law.fidelity
    closing = v[0] * nx + v[1] * ny
    if fidelity == 104 and closing > 0.0:
        back = (1.0 + e) * closing
        return (v[0] - back * nx, v[1] - back * ny, v[2]), (w[0], w[1], w[2]), True
    if fidelity == 103 and closing > 0.0:
        return _smooth_cushion(v, w, nx, ny, phys, e)
    code = FAST if fidelity == 102 else STANDARD if fidelity > 100 else fidelity
    return _all_of_cushion(v, w, normal, Law(phys, code, law.n_steps), e, work)
'''


def load():
    """The copy's ``simulation`` module."""
    texts = package_copies.texts()
    texts["physics/impact/contact.py"] += _ADDED
    if texts["physics/engine.py"].count(_FLIES) != 1:
        raise RuntimeError(f"engine.py has changed: {_FLIES!r} is not in it once")
    texts["physics/engine.py"] = texts["physics/engine.py"].replace(
        _FLIES, f"{_FLIES} and law.fidelity != {AT_ONCE}"
    )
    # its shots use the package's constants, whose rolling impacts come from tables at these fidelities as well
    parameters.TABLED = (*TABLED, *range(FREE_BALLS, AT_ONCE + 1))
    return package_copies.load("snooker_env_variants", texts, ["simulation"])[0]
