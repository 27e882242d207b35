"""How far does a ball run up and down the long axis, from cushion to cushion? This is the engine's motion in one
dimension, fast enough for a hundred thousand tries (``tests/physics/test_cushion_law.py`` compares the two).

Between cushions, the closed forms of docs/physics/model.md apply. At a cushion, the outcome divided by the incoming
speed depends only on e and the spin, so it is read from a table that the package's own impact fills.
"""

from math import expm1, log1p, sqrt

import numba
import numpy as np

import snooker_env as sn

G, MU_S = 9.81, sn.Physics().mu_s
SHARES = np.linspace(0.0, 1.0, 101)
"""Restitutions of the table."""
SPINS = np.linspace(-2.0, 2.0, 161)
"""Top spins of the table, relative to a rolling ball's."""


def impacts(**fields):
    """Rebound speed and spin, both divided by the incoming speed: (restitutions, spins, 2). Spin is R w, positive for a
    ball that rolls back the way it came."""
    radius = sn.Physics.preset("match", **fields).R
    out = np.empty((len(SHARES), len(SPINS), 2))
    for k, e in enumerate(SHARES):
        physics = sn.Physics.preset("match", e_c=float(e), e_c_power=0.0, tables=False, **fields)
        for j, spin in enumerate(SPINS):
            v, w = sn.collide_cushion((0, 1, 0), (-spin / radius, 0, 0), (0, 1, 0), physics, "fast")
            out[k, j] = -v[1], w[0] * radius
    return out


@numba.njit
def off(table, e, spin):
    """Interpolate (rebound speed, spin) divided by the incoming speed."""
    x = min(max(e, 0.0), 1.0) * 100.0
    y = (min(max(spin, -2.0), 2.0) + 2.0) * 40.0
    i, j = min(int(x), 99), min(int(y), 159)
    a, b = x - i, y - j
    low, high = (
        (1 - b) * table[i, j] + b * table[i, j + 1],
        (1 - b) * table[i + 1, j] + b * table[i + 1, j + 1],
    )
    both = (1 - a) * low + a * high
    return both[0], both[1]


@numba.njit
def leg(v, spin, left, mu_r, drag):
    """Roll a ball at v [m/s] with R w = spin [m/s], ``left`` metres before a cushion. Returns the distance [m], and
    its speed and spin there; speed 0 if it stops."""
    slip = v - spin
    slows = MU_S * G if slip > 0 else -MU_S * G
    ends = abs(slip) / (3.5 * MU_S * G)
    way = v * ends - 0.5 * slows * ends * ends
    if way >= left:
        t = (v - sqrt(v * v - 2.0 * slows * left)) / slows
        return left, v - slows * t, spin + 2.5 * slows * t
    v -= slows * ends
    rest, left = way, left - way
    a = mu_r * G
    if v <= 0.0:
        return rest, 0.0, 0.0
    stops = log1p(drag * v * v / a) / (2.0 * drag) if drag > 0 else v * v / (2.0 * a)
    if stops <= left:
        return rest + stops, 0.0, 0.0
    fading = -expm1(-2.0 * drag * left) / (2.0 * drag) if drag > 0 else left
    v = sqrt(v * v - 2.0 * (a + drag * v * v) * fading)
    return rest + left, v, v


@numba.njit
def travels(v, spin, start, length, constants, table):
    """The total distance [m] of a ball that starts at v [m/s] with R w = spin [m/s], ``start`` metres from the cushion
    behind it. ``length``: from cushion to cushion for its centre [m]. constants: e_c, e_c_knee,
    e_c_power, mu_r, roll_drag."""
    e_c, knee, power, mu_r, drag = constants
    way, left = 0.0, length - start
    for _ in range(100):
        gone, v, spin = leg(v, spin, left, mu_r, drag)
        way += gone
        if v <= 1e-9:
            break
        e = e_c if v <= knee or power == 0.0 else e_c * (v / knee) ** -power
        out, turned = off(table, e, spin / v)
        v, spin = out * v, turned * v
        left = length
    return way
