"""How wide is a pocket's window? Which paths of one ball drop into it, found by a scan and by bisection of both ends.

A window is a range of one number s, everything else fixed: the angle by which the path is turned about its start [rad], or how far it is
shifted sideways as a whole [m]. The scan takes the run of pots around the centre line (the nearest one where that misses), bisection finds
its two ends; pots outside it are counted as islands. Nothing is random and nothing is timed: the same figures on every machine.
"""

import os
from dataclasses import dataclass, replace

import numpy as np

import snooker_env as sn
from snooker_env import simulation
from snooker_env.game.pots import POCKETS
from snooker_env.physics import contact

STANDARD = contact.parse_fidelity("standard")[0]
CORNER, MIDDLE = 3, 2
"""Indices of the two pockets that stand for their kind: top right, middle right."""
REACH = 0.075
"""The scan goes so far [m] to either side of the aim point ..."""
SCAN = 151
"""... in so many steps, here of 1 mm."""
HALVINGS = 18
"""Halvings of a step: 4e-9 m."""
NEAR = 0.05
"""A ball that would stop less than this [m] past the aim point is not counted as arriving: its speed decides, not the pocket."""


@dataclass(frozen=True)
class Engine:
    """What plays the shots: ``simulation._run`` of the product or of a copy, and the code of a fidelity."""

    run: object = simulation._run
    code: int = STANDARD


@dataclass(frozen=True)
class Pocket:
    """One pocket alone: a ball that comes out of it meets nothing that could send it back."""

    table: sn.Table
    aim: tuple[float, float]
    axis: float
    """Direction into the pocket [rad]."""


def alone(table, pocket):
    """Pocket number ``pocket`` of a preset, or of a table like it: its fall, its jaws, and the noses that end at it."""
    x, y, _ = table.falls[pocket]
    ax, ay, ux, uy, _ = POCKETS[pocket]

    def near(a, b):
        return np.hypot(a - x, b - y) < 0.25

    noses, ends = table.noses, []
    for end in (3, 4):
        level = noses[:, 1] * noses[:, 2]
        ends.append(near(np.where(noses[:, 0] == 0, level, noses[:, end]), np.where(noses[:, 0] == 0, noses[:, end], level)))
    jaws = table.jaws[near(table.jaws[:, 0], table.jaws[:, 1])]
    here = sn.Table(f"pocket {pocket} alone", noses[ends[0] | ends[1]], jaws, table.falls[[pocket]])
    return Pocket(here, (float(ax), float(ay)), float(np.arctan2(uy, ux)))


def along(pocket, x, y, direction):
    """The same pocket, aimed at from elsewhere: through (x, y), in that direction [rad]."""
    return replace(pocket, aim=(x, y), axis=direction)


def reach(speed, rolling, physics):
    """How far [m] a ball goes on free cloth."""
    roll = 0.5 / (physics.mu_r * physics.g)
    slide = 12 / 49 / (physics.mu_s * physics.g) + 25 / 49 * roll
    return np.asarray(speed) ** 2 * np.where(rolling, roll, slide)


def strokes(pocket, s, angle, distance, speed, rolling, turned, physics):
    """Start, velocity and spin of each path, (n, 2), (n, 2), (n, 3). angle: off the axis [rad]; turned: s is an angle, else a shift."""
    course = pocket.axis + angle
    x = pocket.aim[0] - distance * np.cos(course) - np.where(turned, 0.0, s) * np.sin(course)
    y = pocket.aim[1] - distance * np.sin(course) + np.where(turned, 0.0, s) * np.cos(course)
    course = course + np.where(turned, s, 0.0)
    vx, vy = speed * np.cos(course), speed * np.sin(course)
    roll = np.where(rolling, 1.0 / physics.R, 0.0)
    return np.stack([x, y], -1), np.stack([vx, vy], -1), np.stack([-vy * roll, vx * roll, 0.0 * vx], -1)


def played(pocket, start, physics, engine, log=0):
    """Play the strokes, one ball each: which drop, which start in a cushion (and are not played), and the run itself."""
    r, v, w = (np.ascontiguousarray(a)[:, None] for a in start)
    here = np.ones((len(r), 1), bool)
    here[pocket.table.unfit(r, physics.R)] = False
    threads = os.cpu_count() or 1
    out = engine.run([r, v, w, here.copy()], physics, pocket.table, (engine.code, 0), 10_000, log, 0, threads)
    if out.status[here[:, 0]].any():
        raise RuntimeError(f"shots {np.flatnonzero(out.status)} did not come to rest")
    return (out.potted[:, 0] >= 0) & here[:, 0], ~here[:, 0], out


def drops(pocket, angle, distance, speed, rolling, physics, engine, s=0.0, turned=False):
    """Does the ball on each path drop? Arrays of one shape, or numbers."""
    angle, distance, speed, rolling, s, turned = np.broadcast_arrays(angle, distance, speed, rolling, s, turned)
    flat = (a.ravel() for a in (s, angle, distance, speed, rolling, turned))
    return played(pocket, strokes(pocket, *flat, physics), physics, engine)[0].reshape(s.shape)


@dataclass(frozen=True)
class Windows:
    """Arrays of the shape that was asked for; not a number where no ball arrives."""

    low: np.ndarray
    high: np.ndarray
    """The ends of the window, in units of s."""
    islands: np.ndarray
    """How many separate runs of pots the scan met outside the window."""
    outside: np.ndarray
    """How wide they are in all, by the scan."""
    held: np.ndarray
    """Does the window end where the ball would start in a cushion?"""

    @property
    def width(self):
        """Of the connected window."""
        return self.high - self.low


def windows(pocket, angle, distance, speed, rolling, turned, physics, engine=None, half=None, scan=SCAN):
    """The windows of paths at ``angle`` [rad] off the axis, ``distance`` [m] from the aim point, with ``speed`` [m/s] at the start.

    rolling: the ball rolls at the start, else it has no spin. turned: as in ``strokes``. half: how far the scan goes to either side.
    The arguments may be arrays.
    """
    engine = engine or Engine()
    angle, distance, speed, rolling, turned = np.broadcast_arrays(angle, distance, speed, rolling, turned)
    shape = angle.shape
    cases = [a.ravel() for a in (angle, distance, speed, rolling, turned)]
    n = cases[0].size
    if half is None:
        half = np.where(cases[4], np.arctan2(REACH, cases[1]), REACH)
    half = np.broadcast_to(half, n)
    grid = half[:, None] * np.linspace(-1.0, 1.0, scan)

    def pots(s):
        """s (n, k) -> who drops, who starts in a cushion, both (n, k)."""
        k = s.shape[1]
        start = strokes(pocket, s.ravel(), *(np.repeat(a, k) for a in cases), physics)
        hit, held, _ = played(pocket, start, physics, engine)
        return hit.reshape(n, k), held.reshape(n, k)

    hit, _ = pots(grid)
    if hit[:, [0, -1]].any():
        raise RuntimeError("a window is wider than the scan")
    inside, outside = np.zeros((n, 2)), np.zeros((n, 2))
    islands, elsewhere = np.zeros(n, np.int64), np.zeros(n)
    for k in range(n):
        edges = np.flatnonzero(np.diff(hit[k].astype(np.int8)))  # between the points i and i + 1
        if len(edges):
            runs = edges.reshape(-1, 2)
            middle = (scan - 1) // 2
            away = np.maximum(0, np.maximum(runs[:, 0] + 1 - middle, middle - runs[:, 1]))
            first, last = runs[away.argmin()]
            inside[k], outside[k] = grid[k, [first + 1, last]], grid[k, [first, last + 1]]
            islands[k] = len(runs) - 1
            elsewhere[k] = (hit[k].sum() - (last - first)) * (grid[k, 1] - grid[k, 0])
    for _ in range(HALVINGS):
        between = 0.5 * (inside + outside)
        ok = pots(between)[0]
        inside, outside = np.where(ok, between, inside), np.where(ok, outside, between)
    held = pots(outside)[1].any(1)
    arrives = (reach(cases[2], cases[3], physics) > cases[1] + NEAR)[:, None]
    ends = np.where(arrives, inside, np.nan)
    return Windows(*(a.reshape(shape) for a in (ends[:, 0], ends[:, 1], islands, elsewhere, held)))
