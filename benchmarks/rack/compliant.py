"""How do touching balls move when their contacts are springs with dampers, followed in micro-steps? The
reference for the rack.

Used by ``python -m benchmarks.rack``, whose docstring states the contact laws, the constants and what the
cloth does.
"""

from dataclasses import dataclass
from functools import cache
from math import pi, sqrt
from typing import NamedTuple

import numba
import numpy as np
from scipy.optimize import brentq

import snooker_env as sn
from snooker_env.physics.impact import coulomb

R, M = sn.Physics().R, sn.Physics().M
REDUCED = M / 2
YOUNG, POISSON = 5e9, 0.34
HERTZ = 4 / 3 * YOUNG / (2 * (1 - POISSON**2)) * sqrt(R / 2)
"""Hertz's constant of two equal balls [N/m^1.5]."""

STEP, SPAN = 1e-7, 10e-3
"""The micro-step, and when the engine takes over [s]."""


@dataclass(frozen=True)
class ContactLaw:
    """A contact law F = k d^p + c d^q d'."""

    p: float
    q: float
    k: float


def contact_time(speed):
    """How long two balls touch [s], Hertz without loss: 2.943 d / v with d the greatest overlap."""
    return 2.943 / speed * (1.25 * REDUCED * speed**2 / HERTZ) ** 0.4


LAWS = {
    "Hertz": ContactLaw(1.5, 0.25, HERTZ),
    "Hertz, q = 1/2": ContactLaw(1.5, 0.5, HERTZ),
    "linear": ContactLaw(1.0, 0.0, REDUCED * (pi / contact_time(5.0)) ** 2),
}


@numba.njit(nogil=True)
def _unit_restitution(p, q, damping):
    """Restitution of x'' = -(x^p + damping x^q x'), never pulling, from x = 0, x' = 1."""
    dt = 1e-5
    x, v = 0.5 * dt, 1.0
    while True:
        force = x**p + damping * x**q * v
        if v < 0.0 and force <= 0.0:
            return -v
        v -= force * dt
        x += v * dt
        if x <= 0.0:
            return -v


@cache
def damping(law, e, speed=5.0):
    """c that gives one pair the restitution e at that closing speed [m/s] (for q = (p - 1) / 2: at every
    speed)."""
    if e == 1.0:
        return 0.0
    unit = float(brentq(lambda c: _unit_restitution(law.p, law.q, c) - e, 0.0, 2.0, xtol=1e-10))  # pyright: ignore[reportArgumentType]
    length = (REDUCED * speed**2 / law.k) ** (1 / (law.p + 1))
    return unit * REDUCED * speed / length ** (1 + law.q)


class Constants(NamedTuple):
    """What the micro-steps compute with: F = k d^p + c d^q d' at a contact, and gravity and friction."""

    p: float
    q: float
    k: float
    c: float
    g: float
    mu_s: float
    friction: coulomb.Friction


@numba.njit(nogil=True)
def micro_steps(r, v, w, constants, dt, steps):
    """Balls r (n, 2), v (n, 3), w (n, 3) through ``steps`` steps, in place: half a drift, the impulses of all
    contacts, half a drift.

    Returns the energy [J] gone into dampers, friction between balls, friction on the cloth, lifting and
    landing; the greatest overlap [m].
    """
    p, q, k, c, g, mu_s, friction = constants
    n = len(r)
    z = np.zeros(n)
    dv, dw = np.zeros((n, 3)), np.zeros((n, 3))
    first, second, n_near = np.zeros(n * n, np.int64), np.zeros(n * n, np.int64), 0
    lost, deepest = np.zeros(4), 0.0
    spin = 2.5 / (M * R)
    drift_per_list = 0.0
    for _ in range(steps):
        fastest = 0.0
        for i in range(n):
            r[i, 0] += 0.5 * dt * v[i, 0]
            r[i, 1] += 0.5 * dt * v[i, 1]
            fastest = max(fastest, abs(v[i, 0]) + abs(v[i, 1]))
        drift_per_list -= 2.0 * fastest * dt
        if drift_per_list <= 0.0:  # who may touch before two balls have closed by half a millimetre?
            n_near, drift_per_list = 0, 5e-4
            for i in range(n):
                for j in range(i + 1, n):
                    if (r[i, 0] - r[j, 0]) ** 2 + (r[i, 1] - r[j, 1]) ** 2 < (2.0 * R + 1e-3) ** 2:
                        first[n_near], second[n_near] = i, j
                        n_near += 1
        dv[:] = 0.0
        dw[:] = 0.0
        for m in range(n_near):
            i, j = first[m], second[m]
            nx, ny = r[j, 0] - r[i, 0], r[j, 1] - r[i, 1]
            d = nx * nx + ny * ny
            if d >= 4.0 * R * R:
                continue
            d = sqrt(d)
            nx, ny, depth = nx / d, ny / d, 2.0 * R - d
            deepest = max(deepest, depth)
            closing = (v[i, 0] - v[j, 0]) * nx + (v[i, 1] - v[j, 1]) * ny
            spring = k * depth**p
            force = max(0.0, spring + c * depth**q * closing)
            lost[0] += (force - spring) * closing * dt
            # slip of i on j at the contact: v_i - v_j + R (w_i + w_j) x n, without its normal part
            wz = w[i, 2] + w[j, 2]
            sx = v[i, 0] - v[j, 0] - closing * nx - R * wz * ny
            sy = v[i, 1] - v[j, 1] - closing * ny + R * wz * nx
            sz = v[i, 2] - v[j, 2] + R * ((w[i, 0] + w[j, 0]) * ny - (w[i, 1] + w[j, 1]) * nx)
            s = sqrt(sx * sx + sy * sy + sz * sz)
            pn = force * dt
            fx = fy = fz = 0.0
            if s > 0.0:
                f = min(coulomb.friction_coefficient(s, friction) * pn, M * s / 7.0)
                fx, fy, fz = -f * sx / s, -f * sy / s, -f * sz / s
                lost[1] += f * s
            ax, ay, az = (fx - pn * nx) / M, (fy - pn * ny) / M, fz / M
            dv[i, 0] += ax
            dv[i, 1] += ay
            dv[i, 2] += az
            dv[j, 0] -= ax
            dv[j, 1] -= ay
            dv[j, 2] -= az
            # n x f, the same for both balls
            tx, ty, tz = spin * ny * fz, -spin * nx * fz, spin * (nx * fy - ny * fx)
            dw[i, 0] += tx
            dw[i, 1] += ty
            dw[i, 2] += tz
            dw[j, 0] += tx
            dw[j, 1] += ty
            dw[j, 2] += tz
        for i in range(n):
            load, vz = 0.0, v[i, 2] + dv[i, 2] - g * dt
            if z[i] <= 0.0 and vz <= 0.0:
                lost[3] += 0.5 * M * v[i, 2] ** 2
                z[i], load, vz = 0.0, -M * vz, 0.0
            v[i, 2] = vz
            z[i] += vz * dt
            bx, by = v[i, 0] - R * w[i, 1], v[i, 1] + R * w[i, 0]
            s = sqrt(bx * bx + by * by)
            if load > 0.0 and s > 0.0:
                f = min(mu_s * load, M * s / 3.5)
                lost[2] += f * s
                fx, fy = -f * bx / s, -f * by / s
                dv[i, 0] += fx / M
                dv[i, 1] += fy / M
                dw[i, 0] += spin * fy
                dw[i, 1] -= spin * fx
            v[i, 0] += dv[i, 0]
            v[i, 1] += dv[i, 1]
            for a in range(3):
                w[i, a] += dw[i, a]
            r[i, 0] += 0.5 * dt * v[i, 0]
            r[i, 1] += 0.5 * dt * v[i, 1]
    lost[3] += M * g * z.sum()
    return lost, deepest


def compliant(r, v, w, physics, law=LAWS["Hertz"], dt=STEP, span=SPAN, stiffer=1.0):
    """Balls after ``span`` seconds of micro-steps: r (n, 2), v (n, 3), w (n, 3), energy lost (4,) [J],
    greatest overlap [m]."""
    r, v, w = r.copy(), np.column_stack([v, np.zeros(len(v))]), w.copy()
    law = ContactLaw(law.p, law.q, law.k * stiffer)
    friction = coulomb.Friction(*physics.friction_law)
    constants = Constants(law.p, law.q, law.k, damping(law, physics.e_b), physics.g, physics.mu_s, friction)
    return r, v, w, *micro_steps(r, v, w, constants, dt, round(span / dt))
