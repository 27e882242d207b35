"""What breaks at the extremes? Impacts and shots at the edge of what can be asked for, each with its invariants; then a fuzz of a million.

    python -m benchmarks.stability [--fuzz 1000000] [--seed 0] [--threads 2] [--json FILE] [--out FILE]
    python -m benchmarks.stability --replay SEED BATCH INDEX

Exit code 1 if an invariant fails. ``--fuzz 0`` plays the extremes alone (10 s). Impacts are played at "fast", "standard" and
"reference", shots at these in turn; figures are the worst of all. The paper's Euler scheme has a table of its own.
"""

import argparse
import json
import sys
from collections import Counter
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

import snooker_env as sn
from snooker_env import Table
from snooker_env.game.balls import SPOTS
from snooker_env.physics import contact
from snooker_env.physics.engine import EventKind, Status
from snooker_env.physics.table import PLAY
from snooker_env.simulation import _run

from . import fuzz, invariants
from ._command import at_least, pyplot

R = 0.02625
D = 2 * R
EXACT = float(np.nextafter(D, 1))
GAPS = (0.0, 1e-15, 1e-12, 1e-9)
FILE = Path(__file__).parent / "pictures" / "stability.png"
EXACT_FIDELITIES = ("fast", "standard", "reference")
EULER_STEPS = (1, 2, 3, 5, 10, 20, 50, 100, 200, 1000, 10_000)
MOST_EVENTS = 20_000
CLOTH: Any = None
"""The table that is unbounded cloth."""

IMPACT_LIMITS = {"unsolved": 0, "energy": 1e-6, "momentum": 1e-6, "parting": 1e-3, "mirror": 1e-6}
"""Of an impact: how many do not end; energy gained over the energy; momentum of the pair changed by more than the cloth can, over the
impulse; still closing after it, over the closing speed; mirrored input against mirrored output, over the incoming speed."""
SHOT_LIMITS = {
    "lost": 0, "events": MOST_EVENTS, "energy": 1e-9, "momentum": 1e-6, "parting": 1e-5, "overlap": 1e-9, "in cushion": 1e-9,
    "rest": 1e-9, "log": 1e-12,
}  # fmt: skip
"""Of a shot: see ``invariants.WHAT``; "log" is the worst of its finite, clock, jump and account."""


# impacts -------------------------------------------------------------------------------------------------------------------------


def impact_energy(v, w):
    """Per unit mass; v, w (..., 3)."""
    return 0.5 * (v * v).sum(-1) + 0.2 * R * R * (w * w).sum(-1)


def collide(case, physics, fidelity):
    """The impact of a case (v1, w1, v2, w2, normal), or of (v, w, normal) with a cushion, as rows; None if it does not end."""
    try:
        play: Any = sn.collide_balls if len(case) == 5 else sn.collide_cushion
        return np.array(play(*case, physics, fidelity))
    except sn.SimulationError:
        return None


def mirrored(rows):
    """x -> -x for velocities, normals (even rows) and spins (odd rows), which are axial."""
    return [np.asarray(a) * ((1, -1, -1) if k % 2 and k < len(rows) - len(rows) % 2 else (-1, 1, 1)) for k, a in enumerate(rows)]


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
            impulse, push = np.abs((after - before)[::2] @ n).max(), np.hypot(*(after[0] + after[2] - before[0] - before[2])[:2])
            share = 0.0 if fidelity == "fast" else physics.mu_s * (law[0] + law[1])
            note(worst, "momentum", (push - share * (impulse + push) - 1e-14 * speed) / max(impulse, 1e-300))
        else:
            closing, still = before[0] @ n, after[0] @ n
        note(worst, "energy", (energy[1] - energy[0]) / energy[0])
        if closing > 1e-60:
            note(worst, "parting", (still - 1e-14 * speed) / closing)
        other = collide(mirrored(case), physics, fidelity)
        scale = np.where(np.arange(len(out))[:, None] % 2, R, 1.0) / speed
        note(worst, "mirror", np.inf if other is None else np.abs((other - np.array(mirrored(out))) * scale).max())
    return worst


def note(worst, name, figure):
    """Keep the worst; what is not a number is the worst of all."""
    worst[name] = max(worst[name], np.inf if np.isnan(figure) else float(figure))


def ball_impact(speed, cut, w1=(0, 0, 0), v2=(0, 0, 0), w2=(0, 0, 0)):
    """Ball 1 moving along +x at this speed; cut: angle [rad] from there to the line of centres."""
    return (speed, 0, 0), w1, v2, w2, (np.cos(cut), np.sin(cut), 0)


def any_impacts(n, seed, spin=1.0):
    """n impacts with random directions, speeds 0.05 to 7 m/s, both balls spinning and a third of the second ones moving."""
    rng = np.random.default_rng(seed)
    out = []
    while len(out) < n:
        speed, turn = rng.uniform(0.05, 7), rng.uniform(-np.pi, np.pi)
        v2 = rng.normal(size=3) * (0.5 * speed, 0.5 * speed, 0) * (rng.random() < 0.3)
        case = ball_impact(
            speed, rng.uniform(-1.55, 1.55), rng.normal(size=3) * spin * speed / R, v2, rng.normal(size=3) * spin * speed / R
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
        ball_impact(2, s * (np.pi / 2 - 10.0**-k), w1) for k in range(1, 10) for s in (1, -1) for w1 in ((0, 0, 0), roll(2), (0, -60, 40))
    ]
    gear = lambda cut, slip: (0, 0, (2 * np.sin(cut) + slip) / R)  # noqa: E731
    slips = (0.0, 1e-300, 1e-15, -1e-15, 1e-13, -1e-13, 1e-12, -1e-12)
    no_slip = [ball_impact(2, cut, gear(cut, slip)) for cut in (0.0, 0.3, 1.0, 1.5) for slip in slips]
    no_slip += [ball_impact(2, 0.0, (0, slip / R, 0)) for slip in slips]
    speeds = [ball_impact(v, c, w) for v in 10.0 ** np.arange(-9, 1.1) for c in (0.0, 0.7, 1.5) for w in ((0, 0, 0), roll(v))]
    speeds += [ball_impact(50, c, w) for c in (0.0, 0.7, 1.5) for w in ((0, 0, 0), roll(50))]
    at_speed = [
        ((v * np.sin(a), v * np.cos(a), 0), (-v * np.cos(a) / R, 0, s), (0, 1, 0))
        for v in (1e-9, 1e-3, 1, 50)
        for a in (0, 1.5)
        for s in (0, 9)
    ]
    rng = np.random.default_rng(1)
    spins = [
        ball_impact(10 ** rng.uniform(-4, 1), rng.uniform(-1.5, 1.5), 5000 * unit(rng), (0, 0, 0), 5000 * unit(rng)) for _ in range(300)
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
        "e_b = 1": (any_impacts(150, 3), ({"e_b": 1.0}, {"e_b": 1.0, "mu_bb": 0.0}, {"e_b": 1.0, "mu_bb": 1.0})),
        "e_c = 0 and 1": (cushion_impacts(150, 4), ({"e_c": 0.0}, {"e_c": 1.0})),
    }
    out = {}
    for name, (cases, worlds) in sets.items():
        out[name] = len(cases) * len(worlds), merge([impact_figures(cases, world) for world in worlds])
    for mu_s, mu_bb in product((0.0, 0.21, 1.0), (0.0, 0.05, 1.0)):
        out[f"mu_s {mu_s:g}, mu_bb {mu_bb:g}"] = 150, impact_figures(any_impacts(150, 5, spin=5.0), {"mu_s": mu_s, "mu_bb": mu_bb})
    for mu_s, mu_c in product((0.0, 0.21, 0.7, 1.0), (0.0, 0.14, 1.0)):
        out[f"cushion: mu_s {mu_s:g}, mu_c {mu_c:g}"] = 150, impact_figures(cushion_impacts(150, 6), {"mu_s": mu_s, "mu_c": mu_c})
    return out


def unit(rng):
    """A random direction."""
    a = rng.normal(size=3)
    return a / np.linalg.norm(a)


def merge(figures):
    """The worst of several."""
    return {name: sum(f[name] for f in figures) if name in ("unsolved", "lost") else max(f[name] for f in figures) for name in figures[0]}


# shots ---------------------------------------------------------------------------------------------------------------------------


def shot_figures(p, v, w, table: Any = "match", physics: Any = "paper", fidelities=EXACT_FIDELITIES):
    """Play (b, n, ...) shots at each fidelity; the worst of every invariant of ``SHOT_LIMITS``."""
    table, physics, here = Table.of(table), sn.Physics.of(physics), np.ones(p.shape[:2], bool)
    return merge([summary(invariants.play(p, v, w, here, physics, table, contact.parse_fidelity(f), MOST_EVENTS)) for f in fidelities])


def summary(found):
    """The figures of ``SHOT_LIMITS`` of some ``Checked``."""
    worst = found.worst.max(0, initial=-np.inf, where=(found.status == Status.OK)[:, None])
    by = dict(zip(invariants.NAMES, worst.tolist(), strict=True))
    return {
        "lost": int((found.status != Status.OK).sum()), "events": int(found.n_events.max()),
        "energy": max(by["energy at impact"], by["energy between"]), "momentum": by["momentum"], "parting": by["parting"],
        "overlap": by["overlap"], "in cushion": by["in cushion"], "rest": by["rest"],
        "log": max(by[name] for name in ("finite", "clock", "jump", "account")),
    }  # fmt: skip


def struck(p, speed, aim, side: Any = 0.0, top: Any = 0.0):
    """Velocities and spins of b tables whose first ball has just been struck, by arrays of b or numbers."""
    b, n = p.shape[:2]
    v, w, (speed, aim, side, top) = np.zeros((b, n, 2)), np.zeros((b, n, 3)), np.broadcast_arrays(speed, aim, side, top, np.zeros(b))[:4]
    v[:, 0] = np.column_stack([speed * np.cos(aim), speed * np.sin(aim)])
    w[:, 0] = 2.5 * np.column_stack([-top * v[:, 0, 1], top * v[:, 0, 0], side * speed]) / R
    return v, w


def chains(rng, gap, kind):
    """100 layouts of balls frozen to each other at this gap; ball 0 stands free, but for the pair."""
    b, far, turn = 100, EXACT + gap, rng.uniform(-np.pi, np.pi, 100)
    along = np.stack([np.cos(turn), np.sin(turn)], -1)
    if kind == "pair":
        return np.stack([np.zeros((b, 2)), far * along], 1)
    across = np.stack([-along[:, 1], along[:, 0]], -1)
    if kind == "line":
        steps = [(k * far, 0.0) for k in range(6)]
    else:
        steps = [(k * far * np.sqrt(0.75), (j - k / 2) * far) for k in range(5) for j in range(k + 1)]  # a triangle of 15
    rest = np.stack([x * along + y * across for x, y in steps], 1)
    free = -rng.uniform(0.06, 0.4, (b, 1)) * along + rng.uniform(-0.03, 0.03, (b, 1)) * across
    return np.concatenate([free[:, None], rest], 1)


def frozen(gap):
    """Pairs, lines and triangles frozen at this gap, on unbounded cloth."""
    rng, out = np.random.default_rng(7), []
    for kind in ("pair", "line", "rack"):
        p = chains(rng, gap, kind)
        to = p[:, 1] - p[:, 0]
        aim = np.arctan2(to[:, 1], to[:, 0]) + (rng.uniform(-np.pi, np.pi, 100) if kind == "pair" else rng.uniform(-0.15, 0.15, 100))
        tips = rng.uniform(-0.35, 0.35, (2, 100))
        out.append(shot_figures(p, *struck(p, rng.uniform(0.2, 7, 100), aim, *tips), None))
    return 900, merge(out)


def at_cushions(gap):
    """A ball frozen to a nose or in a jaw, struck any way or struck by a ball; every second with another ball frozen to it."""
    rng, table = np.random.default_rng(8), Table.preset("match")
    places = [
        (side * (level - R - gap), y) if axis == 0 else (y, side * (level - R - gap))
        for axis, side, level, lo, hi in table.noses
        for y in np.linspace(lo, hi, 12)
    ]
    for cx, cy, radius, ux, uy, cos_half in table.jaws:
        for turn in np.arctan2(uy, ux) + np.arccos(cos_half) * np.array([-0.9, -0.4, 0.0, 0.4, 0.9]):
            places.append(
                (
                    cx + (radius + R) * (1 + 1e-15) * np.cos(turn) + gap * np.cos(turn),
                    cy + (radius + R) * (1 + 1e-15) * np.sin(turn) + gap * np.sin(turn),
                )
            )
    first = np.array(places)
    first = first[fuzz.legal(first, table)]
    second = first - (EXACT + gap) * first / np.hypot(*first.T)[:, None]
    p = np.stack([first, second], 1)
    p = p[fuzz.legal(second, table)]
    b = len(p)
    alone, any_way, tips = p[:, :1], rng.uniform(-np.pi, np.pi, b), rng.uniform(-0.4, 0.4, (2, b))
    out = [shot_figures(alone, *struck(alone, rng.uniform(0.01, 7, b), any_way, *tips))]
    out += [shot_figures(q, *struck(q, rng.uniform(0.01, 7, b), any_way, *tips)) for q in (p, p[:, ::-1])]
    into = p[:, ::-1]
    out.append(shot_figures(into, *struck(into, 3.0, np.arctan2(*(into[:, 1] - into[:, 0]).T[::-1]))))
    return 12 * b, merge(out)


def wedged(gap):
    """A ball between two others, between two jaws that it touches both, and in a channel of ``PLAY`` (narrower ones are refused)."""
    rng, b = np.random.default_rng(9), 20
    aim, tips, speed = rng.uniform(-np.pi, np.pi, b), rng.uniform(-0.4, 0.4, (2, b)), rng.uniform(0.05, 7, b)
    far = EXACT + gap
    between = np.tile([(0.0, 0.0), (far, 0.0), (-far, 0.0)], (b, 1, 1))
    out = [shot_figures(between, *struck(between, speed, aim, *tips), None)]
    half = R + (PLAY + 1e-12 + gap) / 2
    channel = Table("channel", np.array([(0, -1, half, -9, 9), (0, 1, half, -9, 9)]), np.zeros((0, 6)), np.zeros((0, 3)))
    one = np.zeros((b, 1, 2))
    out.append(shot_figures(one, *struck(one, speed, aim, *tips), channel))
    radius = 0.1
    apart = (radius + R) * np.sqrt(0.75)
    jaws = Table(
        "two jaws",
        np.zeros((0, 5)),
        np.array([(s * apart, -(radius + R) / 2 - gap, radius, -s * np.sqrt(0.75), 0.5, -0.5) for s in (-1, 1)]),
        np.zeros((0, 3)),
    )
    out.append(shot_figures(one, *struck(one, speed, aim, *tips), jaws))
    return 9 * b, merge(out)


def at_once(offset):
    """The cue ball and two object balls side by side that it meets at the same time, or ``offset`` [m] from it."""
    p = np.tile([(-0.3, 0.0), (0.0, R + 1e-4), (0.0, -R - 1e-4)], (60, 1, 1))
    p[:, 2, 0] += offset
    return p, struck(p, np.linspace(0.3, 7, 60), 0.0, np.repeat([0.0, 0.3], 30), np.tile([-0.4, 0.0, 0.4], 20))


def three_at_once():
    """Their invariants, in both orders (the lower ball goes first), and on the table itself: three meeting in the middle."""
    out = [shot_figures(p, *motion, None) for p, motion in (at_once(0.0), at_once(1e-15), at_once(1e-9))]
    turns = 2 * np.pi * np.arange(3) / 3
    ring = np.column_stack([np.cos(turns), np.sin(turns)])
    p = np.tile(0.3 * ring, (60, 1, 1))
    v = -np.linspace(0.5, 7, 60)[:, None, None] * ring
    out.append(shot_figures(p, v, np.zeros((60, 3, 3)), None))
    return 720, merge(out)


def clear_of_balls(p, here):
    """Is the cue ball clear of the balls on the table?"""
    far = np.hypot(*(p[:, 1:] - p[:, :1]).transpose(2, 0, 1))
    return np.where(here[:, 1:], far, 9.0).min(1) > D


def long_play():
    """Strokes on 12 tables of 22 balls, each from where the one before left it, until 60 s have been played: does overlap build up?"""
    rng, b, figures = np.random.default_rng(10), 12, []
    p, here, played = np.tile(SPOTS, (b, 1, 1)), np.ones((b, 22), bool), np.zeros(b)
    p[:, 0] = (0.1, -1.2)
    while played.min() < 60:
        to = p[np.arange(b), rng.integers(1, 22, b)] - p[:, 0]
        v, w = struck(p, rng.uniform(1, 6, b), np.arctan2(to[:, 1], to[:, 0]), *rng.uniform(-0.3, 0.3, (2, b)))
        sn.simulate_batch(p, v, w, on_table=here, threads=1)  # it refuses a layout that is not sound
        found = invariants.play(p, v, w, here, sn.Physics(), Table.preset("match"), contact.parse_fidelity("standard"))
        figures.append(summary(found))
        p, here, played = found.positions.copy(), found.on_table.copy(), played + found.duration
        p[~here[:, 0], 0], here[:, 0] = (0.1, -1.2), True
        while not (clear := clear_of_balls(p, here)).all():  # the cue ball in hand
            p[~clear, 0] = rng.uniform((-0.29, -1.3), (0.29, -1.05), ((~clear).sum(), 2))
    return b * len(figures), merge(figures)


def slow_cloth():
    """22 balls on cloth of rolling resistance 2e-4, so that one shot lasts more than a minute."""
    p = np.tile(SPOTS, (12, 1, 1))
    p[:, 0] = (0.1, -1.2)
    return 36, shot_figures(p, *struck(p, np.linspace(1.5, 5, 12), np.pi / 2 + np.linspace(-0.12, 0.1, 12), 0.2), "match", {"mu_r": 2e-4})


def shot_extremes():
    """Name -> (number of shots, figures)."""
    rng, b = np.random.default_rng(11), 60
    p = np.tile([(-0.2, 0.0), (0.1, 0.02), (0.5, 0.3)], (b, 1, 1))
    p[:, 0, 1] = rng.uniform(-0.05, 0.05, b)
    speeds = np.geomspace(1e-9, 50, b)
    out = {
        "speeds 1e-9 to 50 m/s": (3 * b, shot_figures(p, *struck(p, speeds, 0.07, 0.3, -0.4))),
        "spins of 5,000 rad/s": (3 * b, spinning(p, rng)),
    }
    for gap in GAPS:
        out[f"frozen pair, line, rack, gap {gap:g}"] = frozen(gap)
    for gap in GAPS:
        out[f"frozen to nose or jaw, gap {gap:g}"] = at_cushions(gap)
    for gap in GAPS:
        out[f"wedged between two, gap {gap:g}"] = wedged(gap)
    out["three balls meet at once"] = three_at_once()
    worlds = {
        "e_b, e_c": (0.0, 1.0),
        "mu_bb": (0.0, 1.0),
        "mu_c": (0.0, 1.0),
        "mu_s": (1e-3, 0.5, 1.0),
        "mu_r": (1e-3, 1.0),
        "spin_decel": (0.0,),
    }
    q = np.tile(SPOTS, (20, 1, 1))
    q[:, 0] = (0.1, -1.2)
    motion = struck(q, rng.uniform(1, 7, 20), np.pi / 2 + rng.uniform(-0.12, 0.1, 20), *rng.uniform(-0.3, 0.3, (2, 20)))
    for name, values in worlds.items():
        for value in values:
            out[f"{name} = {value:g}"] = 60, shot_figures(q, *motion, "match", dict.fromkeys(name.split(", "), value))
    out["60 s of strokes, 22 balls"] = long_play()
    out["one shot of 60 s and more"] = slow_cloth()
    return out


def spinning(p, rng):
    """All balls moving a little, with 5,000 rad/s about any axis."""
    w = rng.normal(size=(*p.shape[:2], 3))
    return shot_figures(p, rng.normal(size=p.shape), 5000 * w / np.linalg.norm(w, axis=-1, keepdims=True))


# measured, not judged ------------------------------------------------------------------------------------------------------------


def euler_table():
    """For each N: impacts that do not end, error against "reference" (median, worst), energy gained (e 0.89, e 1), shots lost of 40."""
    cases, out = any_impacts(200, 12), {}
    p = np.tile(SPOTS, (40, 1, 1))
    p[:, 0] = (0.1, -1.2)
    motion = struck(p, np.linspace(1, 6, 40), np.pi / 2 + np.linspace(-0.12, 0.1, 40))
    for n in EULER_STEPS:
        name, errors, unsolved = f"euler:{n}", [], 0
        for case in cases:
            got, want = collide(case, "paper", name), collide(case, "paper", "reference")
            if got is None or want is None:
                unsolved += 1
                continue
            errors.append(np.abs((got - want) * np.where(np.arange(4)[:, None] % 2, R, 1.0)).max() / np.linalg.norm(case[0]))
        row = {"unsolved": unsolved, "error_median": float(np.median(errors)), "error_worst": float(np.max(errors))}
        for e in (0.89, 1.0):
            row[f"gain e {e:g}"] = impact_figures(cases, {"e_b": e}, (name,))["energy"]
        if n <= 1000:
            physics = sn.Physics(e_b=1.0, e_c=1.0)
            state = p.copy(), *(a.copy() for a in motion), np.ones(p.shape[:2], bool)  # not checked on the way: speeds reach 1e150 m/s
            row["lost"] = int((_run(state, physics, Table.preset("match"), (contact.EULER, n), 3000, 0, 0).status != Status.OK).sum())
        out[n] = row
    return out


def symmetry_growth(shots=400):
    """How far a mirrored shot and one turned by 1 rad end from where they should, against the number of ball-ball contacts.

    Unbounded cloth, one ball into a loose cluster. Returns contacts (shots,), mirror (shots,), turned (shots,) [m]."""
    rng = np.random.default_rng(13)
    p = fuzz.layouts(rng, "scattered", 1, Table.of(None), shots)
    spots = rng.uniform(-0.25, 0.25, (4000, 2))
    keep = []
    for q in spots:
        if all(np.hypot(*(q - a)) > D + 0.004 for a in keep):
            keep.append(q)
    p = np.tile(np.array([(-0.8, 0.0), *keep[:14]]), (shots, 1, 1))
    v, w = struck(p, rng.uniform(0.5, 6, shots), rng.uniform(-0.25, 0.25, shots), *rng.uniform(-0.3, 0.3, (2, shots)))
    c, s = np.cos(1.0), np.sin(1.0)
    turn, turn3 = np.array([(c, s), (-s, c)]), np.array([(c, s, 0), (-s, c, 0), (0, 0, 1)])
    plain = sn.simulate_batch(p, v, w, CLOTH, events=True)
    flip = sn.simulate_batch(p * (-1, 1), v * (-1, 1), w * (1, -1, -1), CLOTH)
    turned = sn.simulate_batch(p @ turn, v @ turn, w @ turn3, CLOTH)
    contacts = np.array([(e["kind"] == EventKind.BALL_BALL).sum() for e in plain.events or []])
    gap = lambda a, b: np.hypot(*(a - b).transpose(2, 0, 1)).max(1)  # noqa: E731
    return contacts, gap(flip.positions, plain.positions * (-1, 1)), gap(turned.positions, plain.positions @ turn)


def order_matters():
    """Two balls met at once by a stun ball at 2 m/s: speeds of the three just after, in the order of the rule and with names swapped."""
    p = np.array([(-0.3, 0.0), (0.0, R + 1e-4), (0.0, -R - 1e-4)])
    v = np.array([(2.0, 0.0), (0, 0), (0, 0)])
    w = np.zeros((3, 3))

    def after(places):
        shot = sn.simulate(places, v, w, CLOTH)
        hits = shot.events["time"][shot.events["kind"] == EventKind.BALL_BALL]
        return shot.at(hits[1])[1] / 2.0

    rule, nearer = after(p), after(p + np.array([(0, 0), (0, 0), (-1e-9, 0)]))
    speeds = np.hypot(*rule.T)
    return {
        "cue ball": float(speeds[0]), "lower number": float(speeds[1]), "higher number": float(speeds[2]),
        "other nearer by 1e-9 m": np.hypot(*nearer.T).tolist(),
    }  # fmt: skip


def order_lines(order):
    """What the rule does with two contacts at the same time."""
    return [
        "two balls met at the same time (stun, 2 m/s): the lower number first. Speeds after, over the cue ball's before:",
        f"  cue ball {order['cue ball']:.4f}, lower number {order['lower number']:.4f}, higher number {order['higher number']:.4f}",
        "  with the higher number nearer by 1e-9 m: " + ", ".join(f"{x:.4f}" for x in order["other nearer by 1e-9 m"]),
    ]


# report --------------------------------------------------------------------------------------------------------------------------


def shown(x):
    """A figure in a cell: counts whole, "-" where nothing of the kind happened."""
    return str(x) if isinstance(x, int) else "-" if x == -np.inf else f"{x:.2g}"


def verdict(figures, limits):
    """Names of the invariants that fail."""
    return [name for name, limit in limits.items() if not figures[name] <= limit]


def table_of(title, results, limits):
    """Lines: an extreme a row, an invariant a column, the worst figure in each; below zero there is no violation at all."""
    head = "".join(f"{name:>12}" for name in limits)
    lines = [f"{title:36}{'played':>8}{head}   verdict", f"{'(allowed)':36}{'':>8}" + "".join(f"{x:>12.3g}" for x in limits.values())]
    for name, (played, figures) in results.items():
        cells = "".join(f"{shown(figures[c]):>12}" for c in limits)
        failed = verdict(figures, limits)
        lines.append(f"{name:36}{played:>8}{cells}   {'FAIL: ' + ', '.join(failed) if failed else 'pass'}")
    return lines


def euler_lines(rows):
    """The table of the paper's scheme."""
    lines = [
        "the paper's scheme     not ended of 200   error median    worst   energy gained, e 0.89     e 1   shots not ended of 40 (e 1)"
    ]
    for n, r in rows.items():
        gains = "".join(f"{r[k]:>12.2g}" if r[k] > 0 else f"{'none':>12}" for k in ("gain e 0.89", "gain e 1"))
        lost = r.get("lost", "-")
        lines.append(f"  euler:{n:<14}{r['unsolved']:>16}{r['error_median']:>15.1e}{r['error_worst']:>9.1e}{gains:>32}{lost:>20}")
    return lines


def growth_lines(contacts, mirror, turned):
    """Symmetry."""
    lines = [
        f"mirrored shots end {mirror.max():.2g} m from the mirror image at the most (allowed 0)",
        "turned by 1 rad, unbounded cloth, by ball-ball contacts:",
    ]
    for low, high in ((0, 2), (3, 5), (6, 8), (9, 11), (12, 14), (15, 99)):
        some = turned[(contacts >= low) & (contacts <= high)]
        if len(some):
            lines.append(
                f"  {low:>2} to {high:<2} contacts: {len(some):>4} shots, deviation median {np.median(some):.1e}, worst {some.max():.1e} m"
            )
    slope = growth(contacts, turned)
    return [*lines, f"  a contact multiplies a deviation by about {slope:.1f}"]


def growth(contacts, turned):
    """The factor by which a contact multiplies a deviation: slope of the fit of its logarithm."""
    good = turned > 0
    return float(np.exp(np.polyfit(contacts[good], np.log(turned[good]), 1)[0]))


def fuzz_lines(found, seed):
    """The fuzz's table, and its failures by kind with one to replay."""
    most = ", ".join(f"{scene} {n:,}" for scene, n in found.events.items())
    lines = [f"fuzz: {found.shots:,} shots in {found.seconds:.0f} s, seed {seed}; most events: {most}"]
    names = invariants.NAMES
    lines.append(f"{'worst of':14}" + "".join(f"{name:>17}" for name in names))
    for fidelity in sorted(found.worst):
        lines.append(f"{fidelity:14}" + "".join(f"{'-' if x == -np.inf else f'{x:.1e}':>17}" for x in found.worst[fidelity]))
    lines.append(f"{'(standard may)':14}" + "".join(f"{x:>17.0e}" for x in fuzz.allowed("standard")))
    kinds = Counter((what, world, fidelity) for _, _, what, _, _, world, fidelity in found.failures)
    lines.append(f"{len(found.failures)} failures")
    for kind, n in kinds.most_common():
        number, index, _, figure, scene, _, _ = next(f for f in found.failures if (f[2], f[5], f[6]) == kind)
        what, world, fidelity = kind
        lines.append(f"  {n:>6} {what} ({fidelity}, physics {world}), as --replay {seed} {number} {index} ({scene}, {figure:.3g})")
    return lines


def draw(path, impacts, shots, euler, symmetry, found):
    """Four pictures: margins, the paper's scheme, growth of rounding, the fuzz."""
    plt = pyplot()

    figure, axes = plt.subplots(2, 2, figsize=(16, 16), width_ratios=(1.25, 1), height_ratios=(1.6, 1), layout="constrained")
    margins(axes[0, 0], impacts, shots)
    scheme(axes[0, 1], euler)
    chaos(axes[1, 1], *symmetry)
    invariants_of_fuzz(axes[1, 0], found)
    figure.savefig(path, dpi=90)
    plt.close(figure)


LEAST_SHOWN = 1e-9


def margins(axis, impacts, shots):
    """Worst figure over what is allowed, of every extreme and invariant."""
    rows = [
        (name, limits, figures)
        for results, limits in ((impacts, IMPACT_LIMITS), (shots, SHOT_LIMITS))
        for name, (_, figures) in results.items()
    ]
    columns = list(dict.fromkeys([*IMPACT_LIMITS, *SHOT_LIMITS]))
    values = np.full((len(rows), len(columns)), np.nan)
    for k, (_, limits, figures) in enumerate(rows):
        for name, limit in limits.items():
            x = figures[name]
            ratio = (x + 0.1) / 0.2 * 10 if limit == 0 and x > 0 else 0.0 if limit == 0 else x / limit
            values[k, columns.index(name)] = np.log10(max(ratio, LEAST_SHOWN))
    shown = axis.imshow(values, aspect="auto", cmap="RdYlGn_r", vmin=-6, vmax=2)
    axis.set_xticks(range(len(columns)), columns, rotation=35, ha="right", fontsize=8)
    axis.set_yticks(range(len(rows)), [name for name, _, _ in rows], fontsize=7)
    axis.set_title("worst figure over what is allowed, log10 (red above 0: fails; white: does not apply)", fontsize=10)
    axis.figure.colorbar(shown, ax=axis, shrink=0.7)


def scheme(axis, euler):
    """Error and energy gained against N."""
    n = np.array(list(euler))
    for key, label, mark in (
        ("error_worst", "worst error / incoming speed", "o-"),
        ("error_median", "median error", "o:"),
        ("gain e 1", "energy gained, e = 1", "s-"),
        ("gain e 0.89", "energy gained, e = 0.89", "^-"),
    ):
        y = np.array([row[key] for row in euler.values()])
        axis.loglog(n[y > 0], y[y > 0], mark, label=label)
    axis.axhline(1.0, color="grey", lw=0.8)
    axis.set_xlabel("steps N of the paper's scheme (eq. 14)")
    axis.set_title("Where does euler:N break? 200 impacts", fontsize=10)
    axis.legend(fontsize=8)


def chaos(axis, contacts, mirror, turned):
    """Deviation against contacts."""
    axis.semilogy(contacts + np.linspace(-0.3, 0.3, len(contacts)), np.maximum(turned, 1e-17), ".", alpha=0.6, label="turned by 1 rad")
    at = np.arange(0, contacts.max() + 1)
    good = turned > 0
    axis.semilogy(
        at,
        np.exp(np.polyval(np.polyfit(contacts[good], np.log(turned[good]), 1), at)),
        "k-",
        lw=1,
        label=f"x {growth(contacts, turned):.1f} a contact",
    )
    axis.set_xlabel("ball-ball contacts of the shot")
    axis.set_ylabel("deviation of the places at rest [m]")
    axis.set_title(f"How rounding grows (mirrored shots: {mirror.max():.1g} m)", fontsize=10)
    axis.legend(fontsize=8)


def invariants_of_fuzz(axis, found):
    """Worst of each invariant by fidelity, over what is allowed."""
    if not found:
        axis.set_axis_off()
        return
    names = [n for n in invariants.NAMES if n not in ("finite", "clock", "account")]
    for k, fidelity in enumerate(sorted(found.worst)):
        pick = [invariants.NAMES.index(n) for n in names]
        ratio = np.maximum((found.worst[fidelity] / np.maximum(fuzz.allowed(fidelity), 1e-300))[pick], LEAST_SHOWN)
        axis.semilogy(np.arange(len(names)) + 0.1 * (k - 3), ratio, "o", label=fidelity)
    axis.axhline(1.0, color="red", lw=1)
    axis.set_xticks(range(len(names)), names, rotation=30, ha="right", fontsize=8)
    axis.set_ylabel("worst figure over what is allowed")
    axis.set_title(f"{found.shots:,} random shots: the worst of each invariant (at the bottom: never violated at all)", fontsize=10)
    axis.legend(fontsize=7, ncols=6, loc="lower center", bbox_to_anchor=(0.5, 0.08))


def replay(seed, number, index):
    """Play one shot of the fuzz again and print what it breaks; True if nothing."""
    drawn = fuzz.batch(seed, number)
    found = fuzz.play(drawn)
    print(f"seed {seed}, batch {number}, shot {index}: {drawn.scene}, {drawn.fidelity}, table {drawn.table.name}, {drawn.physics}")
    print(
        f"positions {drawn.positions[index].tolist()}\nvelocities {drawn.velocities[index].tolist()}\nspins {drawn.spins[index].tolist()}"
    )
    print(f"{Status(found.status[index]).name} after {found.n_events[index]} events, {found.duration[index]:.6f} s")
    broken = found.worst[index] > fuzz.allowed(drawn.fidelity)
    for name, x, limit, bad in zip(invariants.NAMES, found.worst[index], fuzz.allowed(drawn.fidelity), broken, strict=True):
        print(f"  {name:18}{x:>12.3g}  allowed {limit:.1g}  {'FAIL' if bad else 'pass'}   {invariants.WHAT[name]}")
    return found.status[index] == Status.OK and not broken.any()


def main():
    """Command line; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fuzz", type=at_least(0), default=1_000_000, help="random shots; 0 for none")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--threads", type=at_least(1), default=2)
    parser.add_argument("--replay", type=int, nargs=3, metavar=("SEED", "BATCH", "INDEX"), help="play one shot of the fuzz again")
    parser.add_argument("--json", type=Path, help="also write every figure there")
    parser.add_argument("--out", type=Path, default=FILE, help="the picture")
    options = parser.parse_args()
    pyplot()  # before the work: can the picture be drawn?
    if options.replay:
        return int(not replay(*options.replay))
    impacts, shots = impact_extremes(), shot_extremes()
    print("\n".join(table_of("impacts (worst figures)", impacts, IMPACT_LIMITS)), end="\n\n")
    print("\n".join(table_of("shots (worst figures)", shots, SHOT_LIMITS)), end="\n\n")
    euler, symmetry, order = euler_table(), symmetry_growth(), order_matters()
    print("\n".join([*euler_lines(euler), "", *growth_lines(*symmetry), "", *order_lines(order)]), end="\n\n", flush=True)
    found = None
    if options.fuzz:
        found = fuzz.run(options.fuzz, options.seed, options.threads, lambda line: print("\r" + line, end="", file=sys.stderr, flush=True))
        print(file=sys.stderr)
        print("\n".join(fuzz_lines(found, options.seed)))
    failed = [
        f"{name}: {bad}"
        for results, limits in ((impacts, IMPACT_LIMITS), (shots, SHOT_LIMITS))
        for name, (_, f) in results.items()
        for bad in verdict(f, limits)
    ]
    failed += ["mirror symmetry"] * bool(symmetry[1].max() > 0) + ["fuzz"] * bool(found and found.failures)
    print("\nall invariants hold" if not failed else "\nFAILED: " + "; ".join(failed))
    if options.json:
        figures = {
            "impacts": {k: f | {"played": n, "failed": verdict(f, IMPACT_LIMITS)} for k, (n, f) in impacts.items()},
            "shots": {k: f | {"played": n, "failed": verdict(f, SHOT_LIMITS)} for k, (n, f) in shots.items()},
            "allowed": {"impacts": IMPACT_LIMITS, "shots": SHOT_LIMITS}, "euler": euler, "three at once": order,
            "symmetry": {"mirror": float(symmetry[1].max()), "factor a contact": growth(symmetry[0], symmetry[2])},
        }  # fmt: skip
        if found:
            worst = {k: dict(zip(invariants.NAMES, x.tolist(), strict=True)) for k, x in found.worst.items()}
            figures["fuzz"] = {
                "shots": found.shots, "seconds": found.seconds, "seed": options.seed, "worst": worst, "events": found.events,
                "failures": found.failures,
            }  # fmt: skip
        options.json.write_text(json.dumps(figures, indent=1) + "\n")
    draw(options.out, impacts, shots, euler, symmetry, found)
    return int(bool(failed))


if __name__ == "__main__":
    sys.exit(main())
