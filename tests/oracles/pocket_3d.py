"""Does a ball that comes to a pocket fall in? One sphere in three dimensions, moved by small steps of the
forces.

An oracle for the engine. Nothing is predicted: no event is located and no impact is resolved in closed form.
A step drifts by dt/2, applies the impulses of the forces where the ball then is, and drifts by dt/2 again
(leapfrog, second order in the normal forces).

Forces per unit of mass, on a sphere of radius R whose centre is at ``r`` (moment of inertia 2/5 R^2):

* Gravity ``-g z``.
* Each jaw with the rail before it and the straight facing behind it is one smooth horizontal curve, the nose,
  at height ``H = (1 + sin_theta) R``. The sphere touches it when the distance from its centre to the curve is
  below R. Where a ball on the bed touches the nose its centre is R from the table's nose line and jaw arcs
  (that is how ``Table`` gives them), so the curve itself is ``R (1 - cos theta)`` nearer to the ball
  (``PROUD``). Compressed by ``x``, the nose pushes with ``k x``; from the largest compression ``X`` on, with
  ``(k / e^2) (x - (1 - e^2) X)``: a share ``e^2`` of the work comes back, Stronge's energetic restitution, at
  every speed and angle (Walton & Braun 1986, *J. Rheology* 30, 949). ``k = (pi / nose_time)^2``: the ball is
  pressed in for ``nose_time / 2``.
* The slate: a plane up to the circle of ``Table.falls``, from there rounded with radius ``edge`` and then a
  vertical wall. A spring and a dashpot that only push, of half period ``slate_time`` and of the damping that
  gives a restitution of a half.
* Coulomb friction at both, ``mu`` times the normal impulse of the step against the slip, at most what ends
  the slip (2/7 of it). Where the slate holds the ball without slip, a torque ``7/5 mu_r N R`` against the
  spin: it slows a rolling ball by ``mu_r g``. Where the slate touches the ball, the spin about its normal
  decays at ``spin_decel``.

Left out is the leather: the back of the pocket keeps what reaches it. Below its nose the cushion recedes so
far that nothing but the nose can be touched.

Units are SI, spins in rad/s. Table frame: right-handed, z up, the slate's top at z = 0; the centre of a ball
at rest is at z = R, less the 40 nm by which its weight presses it into the slate.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numba
import numpy as np

R, G, SIN_THETA = 0.02625, 9.81, 0.4
HEIGHT = (1.0 + SIN_THETA) * R
PROUD = R * (1.0 - math.sqrt(1.0 - SIN_THETA**2))  # how much nearer the curve is than the table's nose line
POTTED, BACK, UNDECIDED = 1, 0, 2
CLEAR = 1e-3  # [m] so far from nose and edge nothing but the cloth acts
AWAY = 0.12  # [m] a ball that moves away from the pocket so far outside the fall does not come back


HALF_BACK = 1.6039441357552195
"""The dashpot d [1/s] at which a contact x'' + d x' + (pi / time)^2 x = 0 that only pushes has restitution 1/2 is this over its
time: with b = d / 2 and w^2 = (pi / time)^2 - b^2, exp(-b / w (pi - atan2(2 b w, w^2 - b^2))) is 1/2. A contact ends when
the force is zero (Schwager & Poeschel 2007, *Granular Matter* 9, 465)."""


class Model(NamedTuple):
    """What the surfaces are like; ``stiff`` picks the times."""

    nose_time: float  # [s]
    slate_time: float  # [s]
    slate_damping: float  # [1/s]
    nose_e: float = 0.98
    nose_mu: float = 0.14
    slate_mu: float = 0.21
    mu_r: float = 0.0127
    spin_decel: float = 22.0  # [rad/s^2]
    edge: float = 5e-4  # [m]


def stiff(speed: float) -> Model:
    """A model for balls of about this speed [m/s] that comes near rigid surfaces: the nose is compressed by
    0.3 mm at most, for 0.5 ms.

    The slate must be much stiffer than the nose that presses the ball on to it, else it throws the ball up:
    off a rail with 8 % of its speed at a slate_time of 0.4 nose_time, with less than 1 % at a twelfth. And a
    contact must be too short for the cloth's friction under the ball's weight: one of 2 ms takes 15 mm/s of
    slip, which turns the path of a slow ball that grazes a rail.
    """
    time = 1e-3 / max(speed, 2.0)
    return Model(time, time / 12.0, HALF_BACK / (time / 12.0))


@numba.njit
def _nose(x, y, jaw):
    """Horizontal distance to the nose curve of one jaw and the unit vector towards it. jaw: centre, radius,
    normals of rail and facing."""
    px, py = x - jaw[0], y - jaw[1]
    # from the rail's normal to the facing's, anticlockwise or not
    turn = math.copysign(1.0, jaw[3] * jaw[6] - jaw[4] * jaw[5])
    if turn * (jaw[3] * py - jaw[4] * px) < 0.0:
        return px * jaw[3] + py * jaw[4] - jaw[2], -jaw[3], -jaw[4]
    if turn * (jaw[5] * py - jaw[6] * px) > 0.0:
        return px * jaw[5] + py * jaw[6] - jaw[2], -jaw[5], -jaw[6]
    d = math.sqrt(px * px + py * py)
    return d - jaw[2], -px / d, -py / d


@numba.njit
def _slate(x, y, z, fall, edge):
    """Distance from the centre to the slate and the unit vector towards it."""
    dx, dy = x - fall[0], y - fall[1]
    d = math.sqrt(dx * dx + dy * dy)
    if d >= fall[2]:
        return z, (0.0, 0.0, -1.0)
    across, up = fall[2] - d, z + edge
    far = math.sqrt(across * across + up * up)
    return far - edge, (dx / d * across / far, dy / d * across / far, -up / far)


@numba.njit
def _push(v, w, n, p, mu):
    """Normal impulse p at R n against n, then friction against the slip; does the friction hold? -> v, w, held."""
    v = (v[0] - p * n[0], v[1] - p * n[1], v[2] - p * n[2])
    sx = v[0] + R * (w[1] * n[2] - w[2] * n[1])
    sy = v[1] + R * (w[2] * n[0] - w[0] * n[2])
    sz = v[2] + R * (w[0] * n[1] - w[1] * n[0])
    along = sx * n[0] + sy * n[1] + sz * n[2]
    sx, sy, sz = sx - along * n[0], sy - along * n[1], sz - along * n[2]
    s = math.sqrt(sx * sx + sy * sy + sz * sz)
    if s == 0.0:
        return v, w, True
    f = min(mu * p, 2.0 / 7.0 * s)
    fx, fy, fz = -f * sx / s, -f * sy / s, -f * sz / s
    q = 2.5 / R
    w = (
        w[0] + q * (n[1] * fz - n[2] * fy),
        w[1] + q * (n[2] * fx - n[0] * fz),
        w[2] + q * (n[0] * fy - n[1] * fx),
    )
    return (v[0] + fx, v[1] + fy, v[2] + fz), w, f < mu * p


@numba.njit
def step(s, jaws, fall, m, dt):
    """Advance the state by dt, in place. s: r (3), v (3), w (3), then for each jaw the largest compression."""
    h = 0.5 * dt
    for c in range(3):
        s[c] += h * s[3 + c]
    v, w = (s[3], s[4], s[5] - G * dt), (s[6], s[7], s[8])
    k = (math.pi / m.nose_time) ** 2
    for j in range(jaws.shape[0]):
        gap, hx, hy = _nose(s[0], s[1], jaws[j])
        if gap >= R:
            s[9 + j] = 0.0
            continue
        rise = HEIGHT - s[2]
        d = math.sqrt(gap * gap + rise * rise)
        level, rise = gap / d, rise / d
        x = R - d
        if x <= 0.0:
            s[9 + j] = 0.0
            continue
        s[9 + j] = max(s[9 + j], x)
        e2 = m.nose_e**2
        f = k * x if x == s[9 + j] else k / e2 * max(0.0, x - (1.0 - e2) * s[9 + j])
        v, w, _ = _push(v, w, (hx * level, hy * level, rise), f * dt, m.nose_mu)
    d, n = _slate(s[0], s[1], s[2], fall, m.edge)
    if d < R:
        closing = v[0] * n[0] + v[1] * n[1] + v[2] * n[2]
        p = max(0.0, (math.pi / m.slate_time) ** 2 * (R - d) + m.slate_damping * closing) * dt
        v, w, held = _push(v, w, n, p, m.slate_mu)
        along = w[0] * n[0] + w[1] * n[1] + w[2] * n[2]
        less = math.copysign(min(abs(along), m.spin_decel * dt), along)
        w, along = (w[0] - less * n[0], w[1] - less * n[1], w[2] - less * n[2]), along - less
        if held:
            wx, wy, wz = w[0] - along * n[0], w[1] - along * n[1], w[2] - along * n[2]
            spin = math.sqrt(wx * wx + wy * wy + wz * wz)
            if spin > 0.0:
                share = min(1.0, 3.5 * m.mu_r * p / (R * spin))
                w = (w[0] - share * wx, w[1] - share * wy, w[2] - share * wz)
    for c in range(3):
        s[3 + c], s[6 + c] = v[c], w[c]
        s[c] += h * v[c]


@numba.njit
def trace(s, jaws, fall, m, dt, n):
    """Advance the state by n steps, in place."""
    for _ in range(n):
        step(s, jaws, fall, m, dt)


@numba.njit
def _approach(s, jaws, fall, m, dt):
    """Roll or slide a ball on the cloth, in steps of dt, until it is near a nose or the edge, at rest, or away."""
    while True:
        dx, dy = s[0] - fall[0], s[1] - fall[1]
        reach = math.sqrt(s[3] ** 2 + s[4] ** 2) * dt + CLEAR
        outside = math.sqrt(dx * dx + dy * dy) - fall[2]
        if outside < reach or (outside > AWAY and s[3] * dx + s[4] * dy > 0.0):
            return
        for j in range(jaws.shape[0]):
            if _nose(s[0], s[1], jaws[j])[0] < R + reach:
                return
        ux, uy = s[3] - R * s[7], s[4] + R * s[6]
        slip, speed = math.sqrt(ux * ux + uy * uy), math.sqrt(s[3] ** 2 + s[4] ** 2)
        if slip > 3.5 * m.slate_mu * G * dt:
            ax, ay = -m.slate_mu * G * ux / slip, -m.slate_mu * G * uy / slip
            s[6], s[7] = s[6] + 2.5 / R * ay * dt, s[7] - 2.5 / R * ax * dt
        elif speed == 0.0:
            s[6] = s[7] = 0.0
            return
        else:
            a = min(m.mu_r * G, speed / dt) / speed
            ax, ay = -a * s[3], -a * s[4]
            s[6], s[7] = -(s[4] + ay * dt) / R, (s[3] + ax * dt) / R
        s[8] -= math.copysign(min(abs(s[8]), m.spin_decel * dt), s[8])
        for c, a in ((0, ax), (1, ay)):
            s[c] += s[3 + c] * dt + 0.5 * a * dt * dt
            s[3 + c] += a * dt


@numba.njit
def _fate(s, jaws, fall, back, m, dt):
    """POTTED, BACK or UNDECIDED after 4 s. back: unit vector outward and how far along it the back
    of the pocket keeps a ball."""
    for n in range(int(4.0 / dt)):
        if n % 100 == 0 and abs(s[5]) < 1e-4 and abs(s[2] - R) < 1e-6:
            _approach(s, jaws, fall, m, 1e-4)
        step(s, jaws, fall, m, dt)
        if s[2] < 0.0 or s[0] * back[0] + s[1] * back[1] > back[2]:
            return POTTED
        if s[2] > HEIGHT:
            for j in range(jaws.shape[0]):
                if _nose(s[0], s[1], jaws[j])[0] < 0.0:
                    return BACK
        dx, dy = s[0] - fall[0], s[1] - fall[1]
        outside = math.sqrt(dx * dx + dy * dy) - fall[2]
        still = s[3] ** 2 + s[4] ** 2 < 1e-6 and s[6] ** 2 + s[7] ** 2 < 1e-6 / (R * R)
        if outside > 0.0 and (still or (outside > AWAY and s[3] * dx + s[4] * dy > 0.0)):
            return BACK
    return UNDECIDED


@numba.njit
def _fates(states, jaws, fall, back, m, dt):
    out = np.empty(states.shape[0], np.int64)
    for i in range(states.shape[0]):
        out[i] = _fate(states[i], jaws, fall, back, m, dt)
    return out


def pocket(table, index: int, nearer: float = 0.0):
    """One pocket of a ``Table``: its jaws (2, 7) as ``step`` reads them, its fall (3,), and its back (3,) as
    ``_fate`` reads it, which keeps a ball ``nearer`` [m] to the table than the fall's far end."""
    fall = np.array(table.falls[index])
    near = [jaw for jaw in table.jaws if math.hypot(jaw[0] - fall[0], jaw[1] - fall[1]) < 0.2]
    jaws = []
    for x, y, radius, ux, uy, cos_half in near:
        sin_half = math.sqrt(1.0 - cos_half**2)
        ends = [np.array([cos_half * ux - s * uy, cos_half * uy + s * ux]) for s in (sin_half, -sin_half)]
        ends.sort(key=lambda e: -math.hypot(x + radius * e[0] - fall[0], y + radius * e[1] - fall[1]))
        jaws.append([x, y, radius + PROUD, *ends[0], *ends[1]])
    outward = -np.sum(jaws, axis=0)[3:5]  # against the normals of the rails
    outward /= np.linalg.norm(outward)
    return np.array(jaws), fall, np.array([*outward, outward @ fall[:2] + fall[2] - R - nearer])


def at_rest(positions, velocities, spins, m: Model, n_jaws: int):
    """States (b, 9 + n_jaws) of balls on the bed, pressed into it by their weight. positions, velocities
    (b, 2), spins (b, 3)."""
    states = np.zeros((len(positions), 9 + n_jaws))
    states[:, :2], states[:, 3:5], states[:, 6:9] = positions, velocities, spins
    states[:, 2] = R - G * (m.slate_time / math.pi) ** 2
    return states


def default_step(m: Model) -> float:
    return min(m.nose_time / 50.0, m.slate_time / 10.0)


def fates(positions, velocities, spins, table, index: int, m: Model, nearer: float):
    """What becomes of balls that start on the bed: an array of POTTED, BACK, UNDECIDED (b,).

    positions, velocities (b, 2) [m, m/s]; spins (b, 3); table: a ``Table``; index: the pocket; nearer [m]: see ``pocket``.
    """
    jaws, fall, back = pocket(table, index, nearer)
    return _fates(at_rest(positions, velocities, spins, m, len(jaws)), jaws, fall, back, m, default_step(m))
