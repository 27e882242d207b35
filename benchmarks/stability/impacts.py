"""Which impacts break at the extremes? Cuts near 90 degrees, no slip, any speed and spin, restitution and
friction at their ends.

Used by ``python -m benchmarks.stability``.
"""

from itertools import product
from typing import Any

import numpy as np

import snooker_env as sn

from ..fuzz import R
from .worst import EXACT_FIDELITIES, merge, note

IMPACT_LIMITS = {"unsolved": 0, "energy": 1e-6, "momentum": 1e-6, "parting": 1e-3, "mirror": 1e-6}
"""Of an impact: how many do not end; energy gained over the energy; momentum of the pair changed by more than
the cloth can, over the impulse; still closing after it, over the closing speed; mirrored input against
mirrored output, over the incoming speed."""


def impact_energy(v, w):
    """Per unit mass; v, w (..., 3)."""
    return 0.5 * (v * v).sum(-1) + 0.2 * R * R * (w * w).sum(-1)


def collide(case, physics, fidelity):
    """The impact of a case (v1, w1, v2, w2, normal), or of (v, w, normal) with a cushion, as rows; None if it
    does not end."""
    try:
        play: Any = sn.collide_balls if len(case) == 5 else sn.collide_cushion
        return np.array(play(*case, physics, fidelity))
    except sn.SimulationError:
        return None


def mirror_rows(rows):
    """x -> -x for velocities, normals (even rows) and spins (odd rows), which are axial."""
    return [
        np.asarray(a) * ((1, -1, -1) if k % 2 and k < len(rows) - len(rows) % 2 else (-1, 1, 1))
        for k, a in enumerate(rows)
    ]


def impact_figures(cases, physics, fidelities=EXACT_FIDELITIES):
    """The worst of every invariant of ``IMPACT_LIMITS``."""
    physics = sn.Physics.of(physics)
    worst: dict = dict.fromkeys(IMPACT_LIMITS, -np.inf) | {"unsolved": 0}
    law = physics.friction_law
    for case, fidelity in product(cases, fidelities):
        case = [np.asarray(a, float) for a in case]
        out, n = collide(case, physics, fidelity), case[-1]
        if out is None:
            worst["unsolved"] += 1
            continue
        before, after = np.array(case[:-1]), out
        energy = [impact_energy(a[::2], a[1::2]).sum() for a in (before, after)]
        speed = np.sqrt(2 * energy[0])
        if len(case) == 5:
            closing, still = (before[0] - before[2]) @ n, (after[0] - after[2]) @ n
            impulse, push = (
                np.abs((after - before)[::2] @ n).max(),
                np.hypot(*(after[0] + after[2] - before[0] - before[2])[:2]),
            )
            share = 0.0 if fidelity == "fast" else physics.mu_s * (law[0] + law[1])
            note(worst, "momentum", (push - share * (impulse + push) - 1e-14 * speed) / max(impulse, 1e-300))
        else:
            closing, still = before[0] @ n, after[0] @ n
        note(worst, "energy", (energy[1] - energy[0]) / energy[0])
        if closing > 1e-60:
            note(worst, "parting", (still - 1e-14 * speed) / closing)
        other = collide(mirror_rows(case), physics, fidelity)
        scale = np.where(np.arange(len(out))[:, None] % 2, R, 1.0) / speed
        note(
            worst,
            "mirror",
            np.inf if other is None else np.abs((other - np.array(mirror_rows(out))) * scale).max(),
        )
    return worst


def ball_impact(speed, cut, w1=(0, 0, 0), v2=(0, 0, 0), w2=(0, 0, 0)):
    """Ball 1 moving along +x at this speed; cut: angle [rad] from there to the line of centres."""
    return (speed, 0, 0), w1, v2, w2, (np.cos(cut), np.sin(cut), 0)


def any_impacts(n, seed, spin=1.0):
    """n impacts with random directions, speeds 0.05 to 7 m/s, both balls spinning and a third of the second
    ones moving."""
    rng = np.random.default_rng(seed)
    out = []
    while len(out) < n:
        speed, turn = rng.uniform(0.05, 7), rng.uniform(-np.pi, np.pi)
        v2 = rng.normal(size=3) * (0.5 * speed, 0.5 * speed, 0) * (rng.random() < 0.3)
        case = ball_impact(
            speed,
            rng.uniform(-1.55, 1.55),
            rng.normal(size=3) * spin * speed / R,
            v2,
            rng.normal(size=3) * spin * speed / R,
        )
        c, s = np.cos(turn), np.sin(turn)
        case = [np.array(a, float) @ np.array([(c, s, 0), (-s, c, 0), (0, 0, 1)]) for a in case]
        if (case[0] - case[2]) @ case[4] > 0:
            out.append(case)
    return out


def cushion_impacts(n, seed):
    """n impacts with a cushion: any incidence up to 1.5 rad, any spin, half of them rolling."""
    rng = np.random.default_rng(seed)
    out = []
    for k in range(n):
        turn, incidence, speed = rng.uniform(-np.pi, np.pi), rng.uniform(-1.5, 1.5), rng.uniform(0.05, 7)
        v = speed * np.array([np.cos(turn + incidence), np.sin(turn + incidence), 0])
        w = np.array([-v[1], v[0], rng.normal() * speed]) / R if k % 2 else rng.normal(size=3) * speed / R
        out.append((v, w, np.array([np.cos(turn), np.sin(turn), 0])))
    return out


def impact_extremes():
    """Name -> (number of impacts, figures)."""
    roll = lambda v: (0, v / R, 0)  # noqa: E731
    near_90 = [
        ball_impact(2, s * (np.pi / 2 - 10.0**-k), w1)
        for k in range(1, 10)
        for s in (1, -1)
        for w1 in ((0, 0, 0), roll(2), (0, -60, 40))
    ]
    gear = lambda cut, slip: (0, 0, (2 * np.sin(cut) + slip) / R)  # noqa: E731
    slips = (0.0, 1e-300, 1e-15, -1e-15, 1e-13, -1e-13, 1e-12, -1e-12)
    no_slip = [ball_impact(2, cut, gear(cut, slip)) for cut in (0.0, 0.3, 1.0, 1.5) for slip in slips]
    no_slip += [ball_impact(2, 0.0, (0, slip / R, 0)) for slip in slips]
    speeds = [
        ball_impact(v, c, w)
        for v in 10.0 ** np.arange(-9, 1.1)
        for c in (0.0, 0.7, 1.5)
        for w in ((0, 0, 0), roll(v))
    ]
    speeds += [ball_impact(50, c, w) for c in (0.0, 0.7, 1.5) for w in ((0, 0, 0), roll(50))]
    at_speed = [
        ((v * np.sin(a), v * np.cos(a), 0), (-v * np.cos(a) / R, 0, s), (0, 1, 0))
        for v in (1e-9, 1e-3, 1, 50)
        for a in (0, 1.5)
        for s in (0, 9)
    ]
    rng = np.random.default_rng(1)
    spins = [
        ball_impact(
            10 ** rng.uniform(-4, 1), rng.uniform(-1.5, 1.5), 5000 * unit(rng), (0, 0, 0), 5000 * unit(rng)
        )
        for _ in range(300)
    ]
    cushion_spins = [((0.3, 10 ** rng.uniform(-4, 1), 0), 5000 * unit(rng), (0, 1, 0)) for _ in range(300)]
    sets = {
        "cut to 90 deg - 1e-9": (near_90, ({},)),
        "slip 0 and to 1e-12": (no_slip, ({}, {"mu_bb": 1.0}, {"mu_bb": "marlow"})),
        "speeds 1e-9 to 50 m/s": (speeds, ({}, "match")),
        "... at a cushion": (at_speed, ({}, "match")),
        "spins of 5,000 rad/s": (spins, ({}, "match")),
        "... at a cushion, 5,000 rad/s": (cushion_spins, ({}, "match")),
        "e_b = 0": (any_impacts(150, 2), ({"e_b": 0.0}, {"e_b": 0.0, "mu_bb": 1.0})),
        "e_b = 1": (
            any_impacts(150, 3),
            ({"e_b": 1.0}, {"e_b": 1.0, "mu_bb": 0.0}, {"e_b": 1.0, "mu_bb": 1.0}),
        ),
        "e_c = 0 and 1": (cushion_impacts(150, 4), ({"e_c": 0.0}, {"e_c": 1.0})),
    }
    out = {}
    for name, (cases, constants) in sets.items():
        out[name] = (
            len(cases) * len(constants),
            merge([impact_figures(cases, physics) for physics in constants]),
        )
    for mu_s, mu_bb in product((0.0, 0.21, 1.0), (0.0, 0.05, 1.0)):
        out[f"mu_s {mu_s:g}, mu_bb {mu_bb:g}"] = (
            150,
            impact_figures(any_impacts(150, 5, spin=5.0), {"mu_s": mu_s, "mu_bb": mu_bb}),
        )
    for mu_s, mu_c in product((0.0, 0.21, 0.7, 1.0), (0.0, 0.14, 1.0)):
        out[f"cushion: mu_s {mu_s:g}, mu_c {mu_c:g}"] = (
            150,
            impact_figures(cushion_impacts(150, 6), {"mu_s": mu_s, "mu_c": mu_c}),
        )
    return out


def unit(rng):
    """A random direction."""
    a = rng.normal(size=3)
    return a / np.linalg.norm(a)
