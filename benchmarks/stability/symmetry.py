"""Is a shot as symmetric as its physics? Shots mirrored and turned, and two balls met at once, where the
order of their numbers decides.

Used by ``python -m benchmarks.stability``, which fails if a mirrored shot is not mirrored to the last bit, on
the table or on unbounded cloth; the rest is measured, not judged.
"""

from typing import Any

import numpy as np

import snooker_env as sn
from snooker_env import Table
from snooker_env.physics.engine import EventKind

from .. import fuzz
from ..fuzz import D, R
from .shots import strike_balls

CLOTH: Any = None
"""The table that is unbounded cloth."""


def images(drawn, axis, rows=slice(None)):
    """How ``rows`` of a fuzz's batch end, and how their mirror images (x or y reversed) do, seen in the
    mirror: positions and durations."""
    p, v = (part[rows] for part in drawn.states())
    w, how = drawn.spins[rows], (drawn.table, drawn.physics, drawn.fidelity)
    flip = np.ones(p.shape[-1])
    flip[axis] = -1.0
    spin = np.array([-flip[0], -flip[1], -1.0])  # spins are axial
    here, there = sn.simulate_batch(p, v, w, *how), sn.simulate_batch(p * flip, v * flip, w * spin, *how)
    return (here.positions, here.duration), (there.positions * flip[:2], there.duration)


def mirrored_fuzz(batches=20, seed=5):
    """Shots of the fuzz and their images in either axis: how many were compared, and by how much [m, s] each
    one's end differs."""
    gaps = []
    for number in range(batches):
        for axis in (0, 1):
            here, there = images(fuzz.batch(seed, number), axis)
            gaps.append(np.maximum(np.abs(here[0] - there[0]).max((1, 2)), np.abs(here[1] - there[1])))
    return np.concatenate(gaps)


def symmetry_growth(shots=400):
    """How far a mirrored shot and one turned by 1 rad end from where they should, against the number of
    ball-ball contacts.

    Unbounded cloth, one ball into a loose cluster. Returns contacts (shots,), mirror (shots,), turned
    (shots,) [m]."""
    rng = np.random.default_rng(13)
    p = fuzz.layouts(rng, "scattered", 1, Table.of(None), shots)
    spots = rng.uniform(-0.25, 0.25, (4000, 2))
    keep = []
    for q in spots:
        if all(np.hypot(*(q - a)) > D + 0.004 for a in keep):
            keep.append(q)
    p = np.tile(np.array([(-0.8, 0.0), *keep[:14]]), (shots, 1, 1))
    v, w = strike_balls(
        p, rng.uniform(0.5, 6, shots), rng.uniform(-0.25, 0.25, shots), *rng.uniform(-0.3, 0.3, (2, shots))
    )
    c, s = np.cos(1.0), np.sin(1.0)
    turn, turn3 = np.array([(c, s), (-s, c)]), np.array([(c, s, 0), (-s, c, 0), (0, 0, 1)])
    plain = sn.simulate_batch(p, v, w, CLOTH, events=True)
    flip = sn.simulate_batch(p * (-1, 1), v * (-1, 1), w * (1, -1, -1), CLOTH)
    turned = sn.simulate_batch(p @ turn, v @ turn, w @ turn3, CLOTH)
    contacts = np.array([(e["kind"] == EventKind.BALL_BALL).sum() for e in plain.events or []])
    gap = lambda a, b: np.hypot(*(a - b).transpose(2, 0, 1)).max(1)  # noqa: E731
    return (
        contacts,
        gap(flip.positions, plain.positions * (-1, 1)),
        gap(turned.positions, plain.positions @ turn),
    )


def order_matters():
    """Two balls met at once by a stun ball at 2 m/s: speeds of the three just after, in the order of the rule
    and with names swapped."""
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
        "cue ball": float(speeds[0]),
        "lower number": float(speeds[1]),
        "higher number": float(speeds[2]),
        "other nearer by 1e-9 m": np.hypot(*nearer.T).tolist(),
    }


def order_lines(order):
    """What the rule does with two contacts at the same time."""
    return [
        "two balls met at the same time (stun, 2 m/s): the lower number first. Speeds after, over the cue ball's before:",
        f"  cue ball {order['cue ball']:.4f}, lower number {order['lower number']:.4f}, higher number {order['higher number']:.4f}",
        "  with the higher number nearer by 1e-9 m: "
        + ", ".join(f"{x:.4f}" for x in order["other nearer by 1e-9 m"]),
    ]


def growth_lines(contacts, mirror, turned, fuzzed):
    """Symmetry."""
    lines = [
        f"mirrored shots end {mirror.max():.2g} m from the mirror image at the most (allowed 0)",
        f"of {len(fuzzed):,} shots of the fuzz, on tables too, {np.count_nonzero(fuzzed)} do not end as their mirror images (allowed 0)",
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
