"""Is a touching rack resolved rightly by pairwise impacts in sequence? Breaks by three models of the touching balls, compared.

    python -m benchmarks.rack [--shots 100] [--orders 100] [--racks 30] [--physics paper] [--json FILE] [--out PNG]

* **Sequence**: this engine. Touching balls collide two by two at one instant, ties in the order of ball ids.
* **Simultaneous**: one linear complementarity problem over all touching contacts, no friction, solved by projected Gauss-Seidel: the
  compression impulses L >= 0 with closing speeds u <= 0 and L u = 0, times 1 + e. With one e for all contacts and no friction this is
  both Newton's law in Moreau's form (u+ + e u- complementary to L) and Poisson's (L grows by e L in restitution). Then the engine.
* **Compliant**: the yardstick. All balls, contacts as springs with dampers, in micro-steps of 0.1 us for 10 ms; then the engine.
  F = k d^p + c d^q d', never pulling, d the overlap. Hertz: p = 3/2, k = (4/3) (E / (2 (1 - nu^2))) sqrt(R / 2), the resin's E = 5 GPa and
  nu = 0.34: round figures, and what twice the stiffness changes is printed. q = 1/4 (Tsuji 1992) loses the same share at every speed;
  q = 1/2 (Kuwabara & Kono 1987) loses more at speed. Linear: p = 1, q = 0, with Hertz's contact time at 5 m/s. c is set so that one
  pair has the engine's restitution (q = 1/2: at 5 m/s). Friction between balls and on the cloth is Coulomb's, its impulse in a step at
  most what stops the slip. As in the engine's impact, friction may lift a ball or press it into the cloth, which answers with
  friction, and the vertical speed is dropped afterwards.

Energies are kinetic, spin included, 10 ms after the cue ball met the rack, over the cue ball's own before. "Misplaced": how much of it
a model has on other balls than Hertz does, or has lost: half the sum of the differences, the lost share included. "Sharers":
(sum E)^2 / sum E^2 over the reds, how many share their energy.
"""

import argparse
import json
import os
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from math import asin, cos, pi, sin, sqrt
from pathlib import Path

import numba
import numpy as np
from scipy.optimize import brentq, nnls

import snooker_env as sn
from snooker_env.game.balls import SPOTS
from snooker_env.physics.engine import EventKind
from snooker_env.physics.impulse import friction_coefficient

from ._command import at_least, pyplot

FILE = Path(__file__).parent / "pictures" / "rack.png"
R, M = sn.Physics().R, sn.Physics().M
REDUCED = M / 2
YOUNG, POISSON = 5e9, 0.34
HERTZ = 4 / 3 * YOUNG / (2 * (1 - POISSON**2)) * sqrt(R / 2)
"""Hertz's constant of two equal balls [N/m^1.5]."""

STEP, SPAN = 1e-7, 10e-3
"""The micro-step, and when the engine takes over [s]."""
TOUCHING = 2e-6
"""Gap [m] up to which the simultaneous solution counts two balls as touching."""
CORNERS = (11, 15)
MIRRORED = np.array([0, *(1 + k for row in range(5) for k in range(row * (row + 1) // 2 + row, row * (row + 1) // 2 - 1, -1))])
"""Which ball is the mirror image of ball i in the rack."""
CENTRE = SPOTS[1:16].mean(0)
NEAR = 0.25
"""A red within this distance [m] of the rack's centre has hardly left it."""

# Speeds after an elastic break by Hertz contacts without friction, dead centre, the cue ball at 10 units, by ball (the mirror images left
# out): the computed answer to "Perfectly centered break of a perfectly aligned pool ball rack" (MathOverflow, 2014).
PUBLISHED = {0: 1.79, 1: 1.20, 2: 1.57, 4: 1.42, 5: 0.12, 7: 1.31, 8: 0.25, 11: 5.60, 12: 2.57, 13: 2.63}


@dataclass(frozen=True)
class Law:
    """A contact law F = k d^p + c d^q d'."""

    p: float
    q: float
    k: float


def contact_time(speed):
    """How long two balls touch [s], Hertz without loss: 2.943 d / v with d the greatest overlap."""
    return 2.943 / speed * (1.25 * REDUCED * speed**2 / HERTZ) ** 0.4


LAWS = {
    "Hertz": Law(1.5, 0.25, HERTZ),
    "Hertz, q = 1/2": Law(1.5, 0.5, HERTZ),
    "linear": Law(1.0, 0.0, REDUCED * (pi / contact_time(5.0)) ** 2),
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
    """c that gives one pair the restitution e at that closing speed [m/s] (for q = (p - 1) / 2: at every speed)."""
    if e == 1.0:
        return 0.0
    unit = float(brentq(lambda c: _unit_restitution(law.p, law.q, c) - e, 0.0, 2.0, xtol=1e-10))  # pyright: ignore[reportArgumentType]
    length = (REDUCED * speed**2 / law.k) ** (1 / (law.p + 1))
    return unit * REDUCED * speed / length ** (1 + law.q)


@numba.njit(nogil=True)
def micro_steps(r, v, w, p, q, k, c, g, mu_s, friction, dt, steps):
    """Balls r (n, 2), v (n, 3), w (n, 3) through ``steps`` steps, in place: half a drift, the impulses of all contacts, half a drift.

    Returns the energy [J] gone into dampers, friction between balls, friction on the cloth, lifting and landing; the greatest overlap [m].
    """
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
                f = min(friction_coefficient(s, friction) * pn, M * s / 7.0)
                fx, fy, fz = -f * sx / s, -f * sy / s, -f * sz / s
                lost[1] += f * s
            ax, ay, az = (fx - pn * nx) / M, (fy - pn * ny) / M, fz / M
            dv[i, 0] += ax
            dv[i, 1] += ay
            dv[i, 2] += az
            dv[j, 0] -= ax
            dv[j, 1] -= ay
            dv[j, 2] -= az
            tx, ty, tz = spin * ny * fz, -spin * nx * fz, spin * (nx * fy - ny * fx)  # n x f, the same for both balls
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
    """Balls after ``span`` seconds of micro-steps: r (n, 2), v (n, 3), w (n, 3), energy lost (4,) [J], greatest overlap [m]."""
    r, v, w = r.copy(), np.column_stack([v, np.zeros(len(v))]), w.copy()
    law = Law(law.p, law.q, law.k * stiffer)
    constants = law.p, law.q, law.k, damping(law, physics.e_b), physics.g, physics.mu_s, physics.friction_law
    return r, v, w, *micro_steps(r, v, w, *constants, dt, round(span / dt))


@numba.njit(nogil=True)
def _gauss_seidel(i, j, nx, ny, v, e, tolerance):
    """The simultaneous solution: velocities v (n, 2) become those after the impact; returns the sweeps taken."""
    impulse, moved = np.zeros(len(i)), v.copy()
    sweeps, change = 0, np.inf
    while change >= tolerance:
        sweeps, change = sweeps + 1, 0.0
        for m in range(len(i)):
            a, b = i[m], j[m]
            closing = (moved[a, 0] - moved[b, 0]) * nx[m] + (moved[a, 1] - moved[b, 1]) * ny[m]
            more = max(-impulse[m], 0.5 * closing)
            impulse[m] += more
            moved[a, 0] -= more * nx[m]
            moved[a, 1] -= more * ny[m]
            moved[b, 0] += more * nx[m]
            moved[b, 1] += more * ny[m]
            change = max(change, abs(more))
    v += (1.0 + e) * (moved - v)
    return sweeps


def contacts(r):
    """Touching pairs i, j and the unit vectors (nx, ny) from i to j."""
    i, j = np.triu_indices(len(r), 1)
    d = r[j] - r[i]
    far = np.hypot(*d.T)
    near = far < 2 * R + TOUCHING
    return i[near], j[near], d[near, 0] / far[near], d[near, 1] / far[near]


def simultaneous(r, v, e):
    """Velocities (n, 2) after the simultaneous impact of all touching balls."""
    v = v.copy()
    _gauss_seidel(*contacts(r), v, e, 1e-13 * np.abs(v).max())
    return v


def simultaneous_by_nnls(r, v, e):
    """The same by another road: the velocities nearest to v that close no contact are those of a non-negative least squares problem."""
    i, j, nx, ny = contacts(r)
    rows = np.zeros((len(i), len(r), 2))
    for m in range(len(i)):
        rows[m, i[m]], rows[m, j[m]] = (-nx[m], -ny[m]), (nx[m], ny[m])
    rows = rows.reshape(len(i), -1)
    impulse, _ = nnls(rows.T, -v.ravel(), maxiter=100_000)
    return v + (1 + e) * (rows.T @ impulse).reshape(-1, 2)


def meet(r, direction, start):
    """Where the cue ball, going along ``direction`` from ``start``, first touches another ball."""
    a = r[1:] - start
    along, off = a @ direction, a[:, 0] * direction[1] - a[:, 1] * direction[0]
    hit = np.abs(off) < 2 * R
    return start + direction * (along[hit] - np.sqrt((2 * R) ** 2 - off[hit] ** 2)).min()


def rolling(r, direction, speed):
    """Velocities and spins when the cue ball rolls and the rest is still."""
    v, w = np.zeros((len(r), 2)), np.zeros((len(r), 3))
    v[0] = speed * direction
    w[0, :2] = speed / R * np.array([-direction[1], direction[0]])
    return v, w


def apex_break(speed, offset, gap=0.0, rng=None):
    """The cue ball meets the foremost of 15 reds, the colours off the table; ``offset`` [R] of its line from the rack's axis.

    gap [m]: the rack's pitch is 2 R + gap; with ``rng`` each red is also moved at random within gap / 2, so that gaps are 0 to 2 gap.
    """
    r = SPOTS[:16].copy()
    r[1:] = r[1] + (r[1:] - r[1]) * (1 + gap / (2 * R))
    if rng is not None:
        angle, size = rng.uniform(0, 2 * pi, 15), 0.5 * gap * np.sqrt(rng.uniform(0, 1, 15))
        r[1:] += np.column_stack([size * np.cos(angle), size * np.sin(angle)])
    along = np.array([0.0, 1.0])
    tilt = asin(offset / 2)
    r[0] = r[1] + 2 * R * np.array([sin(tilt), -cos(tilt)])
    return r, *rolling(r, along, speed)


def break_off(rng):
    """A break-off as it is played: all 22 balls, the cue ball from the D thin onto the end red of the back row."""
    r = SPOTS.copy()
    start = np.array([rng.uniform(0.08, 0.2), SPOTS[0, 1] - rng.uniform(0, 0.1)])
    to = r[15] + [rng.uniform(0.01, 0.04), 0] - start
    direction = to / np.hypot(*to)
    r[0] = meet(r, direction, start)
    return r, *rolling(r, direction, rng.uniform(2.5, 4.5))


def shares(v, w, speed):
    """Each ball's energy over the rolling cue ball's."""
    return ((v[:, :2] ** 2).sum(1) + 0.4 * R**2 * (w**2).sum(1)) / (1.4 * speed**2)


def misplaced(a, b):
    """Of two lists of shares: how much would have to change its place, what is lost being a place too."""
    return 0.5 * float(np.abs(a - b).sum() + abs(a.sum() - b.sum()))


def sharers(x):
    return float(x[1:16].sum() ** 2 / (x[1:16] ** 2).sum())


def apart(r):
    """Positions with the last nanometres of overlap taken out, as the engine wants them."""
    r = r.copy()
    for _ in range(1000):
        d = r[None] - r[:, None]
        far = np.hypot(*d.transpose(2, 0, 1))
        bad = np.argwhere(np.triu(far < 2 * R, 1))
        if not len(bad):
            break
        for i, j in bad:
            push = (0.5 * (2 * R - far[i, j]) + 1e-10) * d[i, j] / far[i, j]
            r[i] -= push
            r[j] += push
    return r


class Models:
    """The models, by name: from balls at impact to their state after SPAN, and to rest."""

    def __init__(self, physics):
        self.physics = physics
        self.slippery = sn.Physics.preset("paper", e_b=physics.e_b, mu_bb=0.0)
        self.names = (*LAWS, "sequence", "simultaneous")

    def after(self, name, r, v, w, physics=None):
        """r, v, w after SPAN."""
        physics = physics or self.physics
        if name in LAWS:
            return compliant(r, v, w, physics, LAWS[name])[:3]
        if name == "simultaneous":
            v = simultaneous(r, v, physics.e_b)
        return sn.simulate(r, v, w, "match", physics).at(SPAN)

    def energy(self, name, r, v, w, physics=None):
        """Shares (n,) after SPAN."""
        _, v1, w1 = self.after(name, r, v, w, physics)
        return shares(v1, w1, np.hypot(*v[0]))

    def to_rest(self, name, r, v, w):
        """The whole shot (a ``Shot`` that starts after SPAN for contact laws), and the shares (n,) after SPAN."""
        speed = np.hypot(*v[0])
        if name in LAWS:
            r, v, w = self.after(name, r, v, w)
            return sn.simulate(apart(r), v[:, :2], w, "match", self.physics), shares(v, w, speed)
        if name == "simultaneous":
            v = simultaneous(r, v, self.physics.e_b)
        shot = sn.simulate(r, v, w, "match", self.physics)
        _, v, w = shot.at(SPAN)
        return shot, shares(v, w, speed)


def checks(models):
    """Is the yardstick itself right?"""
    print("The yardstick checked\n  one pair against this project's impact model (rolling cue ball; largest difference over the speed)")
    figures = {}
    floating = sn.Physics.preset("paper", g=1e-9)  # the impact model has no weight
    for name, law in LAWS.items():
        row = {}
        for speed in (0.05, 1.0, 5.0):
            worst = 0.0
            for cut in (0.0, 0.5, 1.0):
                n = np.array([sin(cut), cos(cut)])
                r = np.array([[0, 0], 2 * R * n])
                v, w = rolling(r, np.array([0.0, 1.0]), speed)
                # the law with q = 1/2 has the wanted restitution at 5 m/s along the line of centres only: compare where it has
                if law.q == 0.5 and (cut or speed < 5.0):
                    continue
                dt, span = (STEP, 1e-3) if speed > 0.5 else (5 * STEP, 2e-3)
                _, v1, w1, *_ = compliant(r, v, w, floating, law, dt, span)
                v3 = np.column_stack([v, np.zeros(2)])
                a, wa, b, wb = sn.collide_balls(v3[0], w[0], v3[1], w[1], (*n, 0.0), floating, "reference")
                d = np.abs(np.concatenate([v1[0] - a, v1[1] - b, R * (w1[0] - wa), R * (w1[1] - wb)]))
                worst = max(worst, float(d.max()) / speed)
            if worst:
                row[speed] = worst
        figures[f"pair {name}"] = row
        print(f"    {name:15s}" + "".join(f"   {speed:g} m/s {x:.1e}" for speed, x in row.items()))
    elastic = sn.Physics.preset("paper", e_b=1.0, mu_bb=0.0, mu_s=1e-9, g=1e-9)
    print("  the published elastic break without friction (largest difference of a speed; cue ball 10): ", end="")
    for speed in (0.05, 5.0):
        r, v, w = apex_break(speed, 0.0)
        _, v1, _, _, deepest = compliant(r, v, 0 * w, elastic, dt=2 * STEP, span=SPAN * (5 / speed) ** 0.2)
        found = 10 / speed * np.hypot(v1[:, 0], v1[:, 1])
        worst = max(abs(found[i] - x) for i, x in PUBLISHED.items())
        figures[f"published {speed}"] = float(worst)
        print(f"{worst:.3f} at {speed:g} m/s (overlap {deepest / R:.4f} R)", end="; " if speed < 5 else "\n")
    r, v, w = apex_break(5.0, 0.1)
    parts = []
    for dt in (4e-7, 2e-7, 1e-7, 5e-8):
        _, v1, w1, lost, _ = compliant(r, v, w, models.physics, dt=dt)
        left = 0.5 * M * ((v1**2).sum() + 0.4 * R**2 * (w1**2).sum())
        parts.append((dt, shares(v1, w1, 5.0), 1 - (left + lost.sum()) / (0.7 * M * 25)))
    print("  halving the step (break at 5 m/s, offset 0.1 R): energy misplaced against the next; energy unaccounted for")
    for (dt, x, open_), (_, y, _) in pairwise(parts):
        figures[f"step {dt:g}"] = {"misplaced": misplaced(x, y), "unaccounted": open_}
        print(f"    {dt * 1e6:4.2f} us  {misplaced(x, y):.1e}  {open_:+.1e}")
    x = parts[2][1]
    _, v1, w1, *_ = compliant(r, v, w, models.physics, stiffer=2.0)
    figures["stiffer"] = misplaced(x, shares(v1, w1, 5.0))
    print(f"  twice the stiffness misplaces {figures['stiffer']:.1e}")
    figures["lcp"] = float(np.abs(simultaneous(r, v, 0.89) - simultaneous_by_nnls(r, v, 0.89)).max() / 5)
    print(f"  the simultaneous solution against non-negative least squares: {figures['lcp']:.1e} of the speed\n")
    return figures


def cradle(models):
    """Lines of 2 to 5 touching balls, the first at 1 m/s, no spin."""
    print(f"Newton's cradle: speeds after it, the first ball at 1 m/s (e = 1, then {models.physics.e_b:g})")
    figures = {}
    for e in (1.0, models.physics.e_b):
        floating = sn.Physics.preset("paper", e_b=e, g=1e-9)
        for n in (2, 3, 4, 5):
            r = np.column_stack([np.zeros(n), 2 * R * np.arange(n)])
            v, w = np.zeros((n, 2)), np.zeros((n, 3))
            v[0, 1] = 1.0
            row = {
                "sequence": sn.simulate(r, v, w, "match", sn.Physics.preset("paper", e_b=e)).at(1e-9)[1][:, 1],
                "simultaneous": simultaneous(r, v, e)[:, 1],
                **{name: compliant(r, v, w, floating, law, span=5e-3)[1][:, 1] for name, law in LAWS.items() if law.q != 0.5},
            }
            figures[f"{n} balls, e {e:g}"] = {name: x.tolist() for name, x in row.items()}
            for name, x in row.items():
                print(f"  {n if name == 'sequence' else ' '}  {name:14s}" + "".join(f"{s:8.4f}" for s in x))
    print()
    return figures


def head_on(models, speed=5.0):
    """A break on the rack's axis."""
    print(f"Head-on at {speed:g} m/s, touching rack: energies [% of the cue ball's]; momentum, mirror error of velocities [of its speed]")
    print(" " * 28 + "  cue   apex  corners (left, right)  back 3  other 9   lost   sharers  momentum  mirror   misplaced")
    r, v, w = apex_break(speed, 0.0)
    figures, states = {}, {}
    cases = [(name, models.physics) for name in models.names] + [("Hertz", models.slippery), ("sequence", models.slippery)]
    reference = {}
    for name, physics in cases:
        _, v1, w1 = models.after(name, r, v, w, physics)
        v1, x = v1[:, :2], shares(v1, w1, speed)
        reference.setdefault(id(physics), x)
        label = name if physics is models.physics else f"{name}, no ball friction"
        mirror = float(np.abs(v1 - v1[MIRRORED] * [-1, 1]).max() / speed)
        other = x[2:11].sum()
        row = {
            "cue": x[0], "apex": x[1], "left": x[11], "right": x[15], "back": x[12:15].sum(), "other": other, "lost": 1 - x.sum(),
            "sharers": sharers(x), "momentum": v1[:, 1].sum() / speed, "mirror": mirror, "misplaced": misplaced(x, reference[id(physics)]),
        }  # fmt: skip
        figures[label] = {key: float(value) for key, value in row.items()}
        states[label] = v1, x
        print(
            f"  {label:26s}{100 * x[0]:5.1f}  {100 * x[1]:5.1f}       {100 * x[11]:5.1f}  {100 * x[15]:5.1f}"
            f"         {100 * row['back']:5.1f}    {100 * other:5.1f}  {100 * row['lost']:5.1f}   {row['sharers']:5.2f}"
            f"     {row['momentum']:6.3f}   {mirror:.1e}"
            f"   {100 * row['misplaced']:5.1f}"
        )
    print("  misplaced: against Hertz with the same friction between the balls\n")
    return figures, states


def offsets(models):
    """Breaks at several speeds and offsets."""
    print("Touching rack, other breaks: energy misplaced against Hertz [%]; sharers")
    others = models.names[1:]
    print("  m/s  offset R" + "".join(f"{name:>16s}" for name in others) + "     sharers: " + ", ".join(models.names))
    figures = []
    for speed in (2.0, 5.0, 8.0):
        for offset in (0.0, 0.05, 0.1, 0.25, 0.5, 1.0, 1.5):
            q = apex_break(speed, offset)
            x = {name: models.energy(name, *q) for name in models.names}
            row = {name: misplaced(x[name], x["Hertz"]) for name in others}
            share = {name: sharers(x[name]) for name in models.names}
            figures.append({"speed": speed, "offset": offset, "misplaced": row, "sharers": share})
            print(
                f"  {speed:3g}  {offset:8g}" + "".join(f"{100 * row[name]:16.1f}" for name in others)
                + "     " + "  ".join(f"{x:5.2f}" for x in share.values())
            )  # fmt: skip
    print()
    return figures


def gaps(models, racks, rng, workers):
    """Racks that do not quite touch."""
    print(f"Loose racks ({racks} at random for each mean gap; 5 m/s, offset 0.1 R): the corner balls' energy, mean (deviation) [%]")
    print("   gap m     Hertz: left      right     sequence: left    right     misplaced: each rack, mean racks   lost: Hertz, sequence")
    figures = []
    for gap in (0.0, 1e-9, 1e-6, 1e-5, 1e-4, 1e-3):
        layouts = [apex_break(5.0, 0.1, gap, rng) for _ in range(racks if gap else 1)]
        a = np.array(list(workers.map(lambda q: models.energy("Hertz", *q), layouts)))
        b = np.array(list(workers.map(lambda q: models.energy("sequence", *q), layouts)))
        row = {
            "gap": gap, "hertz": a[:, CORNERS].mean(0).tolist(), "hertz_sd": a[:, CORNERS].std(0).tolist(),
            "sequence": b[:, CORNERS].mean(0).tolist(), "sequence_sd": b[:, CORNERS].std(0).tolist(),
            "misplaced": float(np.mean([misplaced(x, y) for x, y in zip(a, b, strict=True)])),
            "misplaced_means": misplaced(a.mean(0), b.mean(0)), "lost": [1 - float(x.sum(1).mean()) for x in (a, b)],
        }  # fmt: skip
        figures.append(row)
        text = "   ".join(
            f"{100 * m:5.1f} ({100 * s:4.1f})"
            for model in ("hertz", "sequence") for m, s in zip(row[model], row[model + "_sd"], strict=True)
        )  # fmt: skip
        print(
            f"  {gap:6g}    {text}    {100 * row['misplaced']:12.1f} {100 * row['misplaced_means']:12.1f}"
            f"            {100 * row['lost'][0]:5.1f}  {100 * row['lost'][1]:5.1f}"
        )
    print()
    return figures


def orders(models, n, rng):
    """The same touching rack with its balls numbered otherwise, or seen in a mirror."""
    print(f"Order of ties ({n} random numberings of the reds, 5 m/s): corner balls' share, left and right [%]; energy misplaced [%]")
    print("  offset R                 as shipped     mean          deviation      each against as shipped   mean against Hertz   mirrored")
    figures = []
    for offset in (0.0, 0.1, 0.5):
        r, v, w = apex_break(5.0, offset)
        image = apex_break(5.0, -offset)
        for name in ("sequence", "Hertz"):
            base = models.energy(name, r, v, w)
            found = []
            for _ in range(n if name == "sequence" else min(n, 5)):
                ids = np.concatenate([[0], 1 + rng.permutation(15)])
                x = np.zeros(16)
                x[ids] = models.energy(name, r[ids], v, w)
                found.append(x)
            found = np.array(found)
            hertz = base if name == "Hertz" else models.energy("Hertz", r, v, w)
            row = {
                "offset": offset, "model": name, "shipped": base[list(CORNERS)].tolist(), "mean": found.mean(0)[list(CORNERS)].tolist(),
                "sd": found.std(0)[list(CORNERS)].tolist(), "misplaced": float(np.mean([misplaced(x, base) for x in found])),
                "mean_misplaced": misplaced(found.mean(0), hertz),
                "mirrored": misplaced(models.energy(name, *image)[MIRRORED], base),
            }  # fmt: skip
            figures.append(row)
            text = "   ".join(f"{100 * row[key][0]:5.1f} {100 * row[key][1]:5.1f}" for key in ("shipped", "mean", "sd"))
            print(
                f"  {offset:8g}  {name:12s}  {text}    {100 * row['misplaced']:18.1e}   {100 * row['mean_misplaced']:18.1f}"
                f"   {100 * row['mirrored']:12.1e}"
            )
    print()
    return figures


def spread(shot):
    """Of a shot at rest: mean distance [m] of the reds left from the rack's centre, reds near it, balls at a cushion, balls potted."""
    far = np.hypot(*(shot.positions[1:16][shot.on_table[1:16]] - CENTRE).T)
    rail = shot.events["i"][np.isin(shot.events["kind"], (EventKind.CUSHION, EventKind.JAW))]
    return far.mean(), (far < NEAR).sum(), len(np.unique(rail)), (shot.potted >= 0).sum()


def whole_shots(models, n, rng, workers):
    """Where everything ends."""
    kinds = {
        "apex, touching": lambda: apex_break(rng.uniform(3, 8), rng.uniform(-1, 1)),
        "apex, gaps of 20 um": lambda: apex_break(rng.uniform(3, 8), rng.uniform(-1, 1), 2e-5, rng),
        "apex, gaps of 2 mm": lambda: apex_break(rng.uniform(3, 8), rng.uniform(-1, 1), 2e-3, rng),
        "break-off": lambda: break_off(rng),
    }
    print(f"Whole shots to rest ({n} of each kind, the same for all models): mean and standard error")
    print(f"  {'':20s} {'':15s} reds' distance m   reds within {NEAR:g} m  balls at a cushion  potted              energy misplaced %")
    figures, samples = {}, {}
    for kind, make in kinds.items():
        layouts = [make() for _ in range(n)]
        hertz = []
        for name in models.names:
            shots, energies = zip(*workers.map(lambda q, m=name: models.to_rest(m, *q), layouts), strict=True)
            hertz = hertz or energies
            wrong = [100 * misplaced(x, y) for x, y in zip(energies, hertz, strict=True)]
            x = np.array([(*spread(shot), m) for shot, m in zip(shots, wrong, strict=True)], float)
            mean, error = x.mean(0), x.std(0) / sqrt(n)
            figures[f"{kind}; {name}"] = {"mean": mean.tolist(), "error": error.tolist()}
            samples[kind, name] = x[:, 0]
            cells = "   ".join(f"{m:6.3f} +- {s:.3f}" for m, s in zip(mean, error, strict=True))
            print(f"  {kind if name == 'Hertz' else '':20s} {name:15s} {cells}")
    print()
    return figures, samples


def cost(models, repeats=5):
    """What does each take?"""
    r, v, w = apex_break(5.0, 0.1)

    def median(work):
        found = []
        for _ in range(repeats):
            t = time.perf_counter()
            work()
            found.append(time.perf_counter() - t)
        return float(np.median(found)) * 1e6

    pairs = contacts(r)
    shot = sn.simulate(r, v, w, "match", models.physics)
    at_once = int((shot.events["time"] < 1e-9).sum())
    sweeps = _gauss_seidel(*pairs, v.copy(), models.physics.e_b, 5e-13)
    figures: dict = {
        "sequence, the whole shot": median(lambda: sn.simulate(r, v, w, "match", models.physics)),
        "simultaneous": median(lambda: _gauss_seidel(*pairs, v.copy(), models.physics.e_b, 5e-13)),
    }
    print("Cost of one break at 5 m/s, offset 0.1 R, one core")
    print(f"  sequence, the whole shot to rest, {at_once} impacts of it at once  {figures['sequence, the whole shot']:9.0f} us")
    print(f"  simultaneous, {len(pairs[0])} contacts, {sweeps} sweeps                    {figures['simultaneous']:9.0f} us")
    fine = compliant(r, v, w, models.physics, dt=STEP / 2, span=2e-3)
    fine = shares(fine[1], fine[2], 5.0)
    for dt in (1e-5, 5e-6, 2e-6, 1e-6, STEP):
        us = median(lambda dt=dt: compliant(r, v, w, models.physics, dt=dt, span=2e-3))
        x = compliant(r, v, w, models.physics, dt=dt, span=2e-3)
        error = misplaced(shares(x[1], x[2], 5.0), fine)
        figures[f"compliant {dt:g}"] = {"us": us, "misplaced": error}
        print(f"  compliant, 2 ms in steps of {dt * 1e6:4.1f} us: misplaces {100 * error:.4f} %   {us:9.0f} us")
    print()
    return figures


def verdict(models, figures):
    """The choice, in words that the figures make."""
    rows = figures["offsets"]
    mean = {name: float(np.mean([row["misplaced"][name] for row in rows])) for name in models.names[1:]}
    own = max(mean[name] for name in LAWS if name != "Hertz")
    nearer = sum(row["misplaced"]["sequence"] < row["misplaced"]["simultaneous"] for row in rows)
    shots = figures["whole shots"]
    lines = [
        f"Over {len(rows)} breaks of a touching rack the sequence misplaces {100 * mean['sequence']:.0f} % of the energy on average, the "
        f"simultaneous solution {100 * mean['simultaneous']:.0f} %, another contact law at most {100 * own:.0f} %. Of the two rigid rules "
        f"the sequence is the nearer to Hertz in {nearer} of {len(rows)}.",
    ]
    on_axis = figures["head-on"]
    a, b = on_axis["sequence"], on_axis["Hertz"]
    lines.append(
        f"Head-on the corner balls get {100 * a['left']:.0f} and {100 * a['right']:.0f} % from the sequence, {100 * b['left']:.0f} and "
        f"{100 * b['right']:.0f} % from Hertz; {a['sharers']:.1f} reds share the energy, by Hertz {b['sharers']:.1f}."
    )
    for row in figures["gaps"]:
        if row["gap"] in (1e-6, 1e-3):
            lines.append(
                f"In racks with gaps of {row['gap'] * 1e6:g} um the sequence misplaces {100 * row['misplaced']:.0f} % in each, "
                f"{100 * row['misplaced_means']:.0f} % on the average of racks."
            )
    for kind in dict.fromkeys(key.split(";")[0] for key in shots):
        of = {name: shots[f"{kind}; {name}"]["mean"] for name in models.names}
        laws = [of[name][0] for name in LAWS]
        lines.append(
            f"{kind}: reds end {of['sequence'][0]:.2f} m from the rack's centre by the sequence, {of['simultaneous'][0]:.2f} m by the "
            f"simultaneous solution, {min(laws):.2f} to {max(laws):.2f} m by contact laws; energy misplaced {of['sequence'][-1]:.0f}, "
            f"{of['simultaneous'][-1]:.0f} and at most {max(of[name][-1] for name in LAWS):.0f} %."
        )
    micro, shot = figures["cost"]["compliant 5e-06"], figures["cost"]["sequence, the whole shot"]
    lines.append(
        f"Choice: of the rigid rules {min(('sequence', 'simultaneous'), key=lambda name: mean[name])}. "
        + (
            "The sequence is as near to Hertz as contact laws are to each other: good enough."
            if mean["sequence"] <= own
            else f"The sequence is {mean['sequence'] / own:.1f} times as far from Hertz as contact laws are from each other: "
            "micro-steps are better."
        )
        + f" In steps of 5 us they misplace {100 * micro['misplaced']:.2f} % and take {micro['us'] / shot:.2f} times as long as "
        "the whole shot by the sequence."
    )
    print("\n".join(lines))
    return lines


def picture(file, states, figures, samples):
    """The head-on break by three models; loose racks; whole shots."""
    plt = pyplot()
    from matplotlib.patches import Circle

    fig, axes = plt.subplots(2, 3, figsize=(13, 9.2), layout="constrained")
    r = apex_break(5.0, 0.0)[0]
    colours = {"Hertz": "C0", "Hertz, q = 1/2": "C4", "linear": "C2", "sequence": "C3", "simultaneous": "C1"}
    for ax, name in zip(axes[0], ("Hertz", "sequence", "simultaneous"), strict=True):
        v, x = states[name]
        for i in range(16):
            shade = plt.get_cmap("Reds")(min(1.0, 0.04 + 3.0 * x[i])) if i else "white"
            ax.add_patch(Circle(r[i], R, facecolor=shade, edgecolor="0.25", lw=0.8))
            ax.text(*r[i], f"{100 * x[i]:.1f}" if x[i] < 0.0995 else f"{100 * x[i]:.0f}", ha="center", va="center", fontsize=8,
                    color="white" if i and x[i] > 0.12 else "black")  # fmt: skip
            if np.hypot(*v[i]) > 0.1:
                start = r[i] + v[i] / np.hypot(*v[i]) * R
                ax.annotate("", start + 0.045 * v[i], start, arrowprops={"arrowstyle": "-|>", "color": colours[name], "lw": 1.3})
        ax.set(xlim=(-0.235, 0.235), ylim=(r[0, 1] - 0.19, r[15, 1] + 0.18), aspect="equal", xticks=[], yticks=[])
        what = {"Hertz": "compliant (Hertz)"}.get(name, name)
        ax.set_title(f"{what}: energy of each ball [%], {100 * (1 - x.sum()):.0f} % lost", fontsize=10, color=colours[name])
    ax = axes[1, 0]
    found = figures["gaps"]
    place = np.arange(len(found))
    for model, shift in (("hertz", -0.08), ("sequence", 0.08)):
        for side, marker in ((0, "<"), (1, ">")):
            mean = [100 * row[model][side] for row in found]
            sd = [100 * row[model + "_sd"][side] for row in found]
            name = "Hertz" if model == "hertz" else model
            ax.errorbar(place + shift + 0.05 * side, mean, sd, fmt=marker, color=colours[name], capsize=2, ms=6,
                        label=f"{name}, {'left' if side == 0 else 'right'} corner ball")  # fmt: skip
    ax.set_xticks(place, [f"{row['gap'] * 1e6:g}" for row in found])
    ax.set(xlabel="mean gap of the rack [um]", ylabel="share of the energy [%], mean and deviation over racks", ylim=(0, 45))
    ax.set_title("loose racks, 5 m/s, 0.1 R off the axis", fontsize=10)
    ax.legend(fontsize=8, ncols=2, loc="upper right")
    for ax, kind in zip(axes[1, 1:], ("apex, touching", "break-off"), strict=True):
        for name, colour in colours.items():
            x = np.sort(samples[kind, name])
            ax.step(x, np.arange(1, len(x) + 1) / len(x), where="post", color=colour, label=name, lw=1.8 if name == "sequence" else 1.2)
        ax.set(xlabel="reds' mean distance from the rack's centre, at rest [m]", ylabel="share of shots below", ylim=(0, 1))
        ax.set_title({"apex, touching": "whole shots: apex of a touching rack"}.get(kind, f"whole shots: {kind}"), fontsize=10)
        ax.legend(fontsize=8)
    file.parent.mkdir(parents=True, exist_ok=True)
    fig.savefig(file, dpi=110)
    print(file)


def main():
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shots", type=at_least(1), default=100, help="whole shots of each kind")
    parser.add_argument("--orders", type=at_least(1), default=100, help="numberings of the rack")
    parser.add_argument("--racks", type=at_least(1), default=30, help="loose racks for each gap")
    parser.add_argument("--physics", choices=("paper", "match"), default="paper", help="restitution and friction")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=Path, help="also write every figure there")
    parser.add_argument("--out", type=Path, default=FILE, help="the picture")
    options = parser.parse_args()
    pyplot()  # before the work: can the picture be drawn?
    models = Models(sn.Physics.preset(options.physics))
    rng = np.random.default_rng(options.seed)
    figures: dict = {"physics": options.physics, "seed": options.seed, "checks": checks(models), "cradle": cradle(models)}
    figures["head-on"], states = head_on(models)
    figures["offsets"] = offsets(models)
    with ThreadPoolExecutor(os.cpu_count()) as workers:
        figures["gaps"] = gaps(models, options.racks, rng, workers)
        figures["orders"] = orders(models, options.orders, rng)
        figures["whole shots"], samples = whole_shots(models, options.shots, rng, workers)
    figures["cost"] = cost(models)
    figures["verdict"] = verdict(models, figures)
    picture(options.out, states, figures, samples)
    if options.json:
        options.json.write_text(json.dumps(figures, indent=1) + "\n")


if __name__ == "__main__":
    main()
