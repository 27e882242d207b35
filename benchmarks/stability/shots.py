"""Which shots break at the extremes? Balls frozen, wedged and met at once, any speed and spin, constants at
their ends, a minute of play.

Used by ``python -m benchmarks.stability``.
"""

from typing import Any

import numpy as np

import snooker_env as sn
from snooker_env import Table
from snooker_env.game.balls import SPOTS
from snooker_env.physics.engine import Status
from snooker_env.physics.impact import contact
from snooker_env.physics.table import PLAY

from .. import fuzz
from .._common import invariants as invariants
from ..fuzz import D, R
from .worst import EXACT_FIDELITIES, merge

EXACT = float(np.nextafter(D, 1))
GAPS = (0.0, 1e-15, 1e-12, 1e-9)
MOST_EVENTS = 20_000

SHOT_LIMITS = {
    "lost": 0,
    "events": MOST_EVENTS,
    "energy": 1e-9,
    "momentum": 1e-6,
    "parting": 1e-5,
    "overlap": 1e-9,
    "in cushion": 1e-9,
    "rest": 1e-9,
    "log": 1e-12,
}
"""Of a shot: see ``_invariants.WHAT``; "log" is the worst of its finite, clock, jump and account."""


def shot_figures(p, v, w, table: Any = "match", physics: Any = "paper", fidelities=EXACT_FIDELITIES):
    """Play (b, n, ...) shots at each fidelity; the worst of every invariant of ``SHOT_LIMITS``."""
    table, physics, here = Table.of(table), sn.Physics.of(physics), np.ones(p.shape[:2], bool)
    balls, codes = (p, v, w, here), map(contact.parse_fidelity, fidelities)
    return merge([summary(invariants.play(balls, physics, table, code, MOST_EVENTS)) for code in codes])


def summary(found):
    """The figures of ``SHOT_LIMITS`` of some ``Checked``."""
    worst = found.worst.max(0, initial=-np.inf, where=(found.status == Status.OK)[:, None])
    by = dict(zip(invariants.NAMES, worst.tolist(), strict=True))
    return {
        "lost": int((found.status != Status.OK).sum()),
        "events": int(found.n_events.max()),
        "energy": max(by["energy at impact"], by["energy between"]),
        "momentum": by["momentum"],
        "parting": by["parting"],
        "overlap": by["overlap"],
        "in cushion": by["in cushion"],
        "rest": by["rest"],
        "log": max(by[name] for name in ("finite", "clock", "jump", "account")),
    }


def strike_balls(p, speed, aim, side: Any = 0.0, top: Any = 0.0):
    """Velocities and spins of b tables whose first ball has just been struck, by arrays of b or numbers."""
    b, n = p.shape[:2]
    v, w, (speed, aim, side, top) = (
        np.zeros((b, n, 2)),
        np.zeros((b, n, 3)),
        np.broadcast_arrays(speed, aim, side, top, np.zeros(b))[:4],
    )
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
        # a triangle of 15
        steps = [(k * far * np.sqrt(0.75), (j - k / 2) * far) for k in range(5) for j in range(k + 1)]
    rest = np.stack([x * along + y * across for x, y in steps], 1)
    free = -rng.uniform(0.06, 0.4, (b, 1)) * along + rng.uniform(-0.03, 0.03, (b, 1)) * across
    return np.concatenate([free[:, None], rest], 1)


def make_frozen_groups(gap):
    """Pairs, lines and triangles frozen at this gap, on unbounded cloth."""
    rng, out = np.random.default_rng(7), []
    for kind in ("pair", "line", "rack"):
        p = chains(rng, gap, kind)
        to = p[:, 1] - p[:, 0]
        aim = np.arctan2(to[:, 1], to[:, 0]) + (
            rng.uniform(-np.pi, np.pi, 100) if kind == "pair" else rng.uniform(-0.15, 0.15, 100)
        )
        tips = rng.uniform(-0.35, 0.35, (2, 100))
        out.append(shot_figures(p, *strike_balls(p, rng.uniform(0.2, 7, 100), aim, *tips), None))
    return 900, merge(out)


def at_cushions(gap):
    """A ball frozen to a nose or in a jaw, struck any way or struck by a ball; every second with another ball
    frozen to it."""
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
    out = [shot_figures(alone, *strike_balls(alone, rng.uniform(0.01, 7, b), any_way, *tips))]
    out += [
        shot_figures(q, *strike_balls(q, rng.uniform(0.01, 7, b), any_way, *tips)) for q in (p, p[:, ::-1])
    ]
    into = p[:, ::-1]
    out.append(shot_figures(into, *strike_balls(into, 3.0, np.arctan2(*(into[:, 1] - into[:, 0]).T[::-1]))))
    return 12 * b, merge(out)


def make_wedges(gap):
    """A ball between two others, between two jaws that it touches both, and in a channel of ``PLAY``
    (narrower ones are refused)."""
    rng, b = np.random.default_rng(9), 20
    aim, tips, speed = rng.uniform(-np.pi, np.pi, b), rng.uniform(-0.4, 0.4, (2, b)), rng.uniform(0.05, 7, b)
    far = EXACT + gap
    between = np.tile([(0.0, 0.0), (far, 0.0), (-far, 0.0)], (b, 1, 1))
    out = [shot_figures(between, *strike_balls(between, speed, aim, *tips), None)]
    half = R + (PLAY + 1e-12 + gap) / 2
    channel = Table(
        "channel", np.array([(0, -1, half, -9, 9), (0, 1, half, -9, 9)]), np.zeros((0, 6)), np.zeros((0, 3))
    )
    one = np.zeros((b, 1, 2))
    out.append(shot_figures(one, *strike_balls(one, speed, aim, *tips), channel))
    radius = 0.1
    apart = (radius + R) * np.sqrt(0.75)
    jaws = Table(
        "two jaws",
        np.zeros((0, 5)),
        np.array(
            [(s * apart, -(radius + R) / 2 - gap, radius, -s * np.sqrt(0.75), 0.5, -0.5) for s in (-1, 1)]
        ),
        np.zeros((0, 3)),
    )
    out.append(shot_figures(one, *strike_balls(one, speed, aim, *tips), jaws))
    return 9 * b, merge(out)


def at_once(offset):
    """The cue ball and two object balls side by side that it meets at the same time, or ``offset`` [m] from
    it."""
    p = np.tile([(-0.3, 0.0), (0.0, R + 1e-4), (0.0, -R - 1e-4)], (60, 1, 1))
    p[:, 2, 0] += offset
    return p, strike_balls(
        p, np.linspace(0.3, 7, 60), 0.0, np.repeat([0.0, 0.3], 30), np.tile([-0.4, 0.0, 0.4], 20)
    )


def three_at_once():
    """Their invariants, in both orders (the lower ball goes first), and on the table itself: three meeting in
    the middle."""
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
    """Strokes on 12 tables of 22 balls, each from where the one before left it, until 60 s have been played:
    does overlap build up?"""
    rng, b, figures = np.random.default_rng(10), 12, []
    p, here, played = np.tile(SPOTS, (b, 1, 1)), np.ones((b, 22), bool), np.zeros(b)
    p[:, 0] = (0.1, -1.2)
    while played.min() < 60:
        to = p[np.arange(b), rng.integers(1, 22, b)] - p[:, 0]
        v, w = strike_balls(
            p, rng.uniform(1, 6, b), np.arctan2(to[:, 1], to[:, 0]), *rng.uniform(-0.3, 0.3, (2, b))
        )
        sn.simulate_batch(p, v, w, on_table=here, threads=1)  # it refuses a layout that is not sound
        code = contact.parse_fidelity("standard")
        found = invariants.play((p, v, w, here), sn.Physics(), Table.preset("match"), code)
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
    return 36, shot_figures(
        p,
        *strike_balls(p, np.linspace(1.5, 5, 12), np.pi / 2 + np.linspace(-0.12, 0.1, 12), 0.2),
        "match",
        {"mu_r": 2e-4},
    )


def shot_extremes():
    """Name -> (number of shots, figures)."""
    rng, b = np.random.default_rng(11), 60
    p = np.tile([(-0.2, 0.0), (0.1, 0.02), (0.5, 0.3)], (b, 1, 1))
    p[:, 0, 1] = rng.uniform(-0.05, 0.05, b)
    speeds = np.geomspace(1e-9, 50, b)
    out = {
        "speeds 1e-9 to 50 m/s": (3 * b, shot_figures(p, *strike_balls(p, speeds, 0.07, 0.3, -0.4))),
        "spins of 5,000 rad/s": (3 * b, spinning(p, rng)),
    }
    for gap in GAPS:
        out[f"frozen pair, line, rack, gap {gap:g}"] = make_frozen_groups(gap)
    for gap in GAPS:
        out[f"frozen to nose or jaw, gap {gap:g}"] = at_cushions(gap)
    for gap in GAPS:
        out[f"wedged between two, gap {gap:g}"] = make_wedges(gap)
    out["three balls meet at once"] = three_at_once()
    constants = {
        "e_b, e_c": (0.0, 1.0),
        "mu_bb": (0.0, 1.0),
        "mu_c": (0.0, 1.0),
        "mu_s": (1e-3, 0.5, 1.0),
        "mu_r": (1e-3, 1.0),
        "spin_decel": (0.0,),
    }
    q = np.tile(SPOTS, (20, 1, 1))
    q[:, 0] = (0.1, -1.2)
    motion = strike_balls(
        q, rng.uniform(1, 7, 20), np.pi / 2 + rng.uniform(-0.12, 0.1, 20), *rng.uniform(-0.3, 0.3, (2, 20))
    )
    for name, values in constants.items():
        for value in values:
            out[f"{name} = {value:g}"] = (
                60,
                shot_figures(q, *motion, "match", dict.fromkeys(name.split(", "), value)),
            )
    out["60 s of strokes, 22 balls"] = long_play()
    out["one shot of 60 s and more"] = slow_cloth()
    return out


def spinning(p, rng):
    """All balls moving a little, with 5,000 rad/s about any axis."""
    w = rng.normal(size=(*p.shape[:2], 3))
    return shot_figures(p, rng.normal(size=p.shape), 5000 * w / np.linalg.norm(w, axis=-1, keepdims=True))
