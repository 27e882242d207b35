"""How wide is a pocket's window? Which paths of one ball drop into it, found by a scan and by bisection of
both ends.

A window is what drops of a range of one number s, everything else fixed: the angle by which the path is
turned about its start [rad], or how far it is shifted sideways as a whole [m]. A scan finds the runs of pots,
bisection their ends. A window may be in pieces: a firm ball that just touches a jaw may rattle out between
paths that drop. Its width is that of all its pieces; gaps and pieces thinner than a step of the scan may be
missed. Nothing is random and nothing is timed.
"""

import os
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

import snooker_env as sn
from snooker_env import simulation
from snooker_env.geometry import POCKET_AIMS
from snooker_env.physics.impact import contact

STANDARD = contact.parse_fidelity("standard")[0]
CORNER, MIDDLE = 3, 2
"""Indices of the two pockets that stand for their kind: top right, middle right."""
REACH = 0.075
"""The scan goes so far [m] to either side of the aim point ..."""
SCAN = 151
"""... in so many steps, here of 1 mm."""
HALVINGS = 18
"""Halvings of a step: 4e-9 m."""
FAR = 1000.0
"""Where the noses of a pocket alone end [m]; a ball rolls 360 m at 9 m/s."""
AT_POCKET = 0.25
"""Noses that end and jaws whose centre is nearer than this to a pocket [m] are its own."""
NEAR = 0.05
"""A ball that would stop less than this [m] past the aim point is not counted as arriving: its speed decides,
not the pocket."""


class Paths(NamedTuple):
    """Paths of one ball; each is a number or an array."""

    angle: Any
    """Off the pocket's axis [rad]."""
    distance: Any
    """From the aim point [m]."""
    speed: Any
    """At the start [m/s]."""
    rolling: Any
    """Whether the ball rolls at the start; else it has no spin."""
    turned: Any
    """As in ``strokes``."""


@dataclass(frozen=True)
class LonePocket:
    """One pocket alone: a ball that comes out of it meets nothing that could send it back."""

    table: sn.Table
    aim: tuple[float, float]
    axis: float
    """Direction into the pocket [rad]."""


def endless(noses, x, y):
    """The noses with an end near (x, y), their other ends so far away that no ball comes round them."""
    out, level, kept = noses.copy(), noses[:, 1] * noses[:, 2], np.zeros(len(noses), bool)
    for end, other in ((3, 4), (4, 3)):
        far = np.hypot(
            np.where(noses[:, 0] == 0, level, noses[:, end]) - x,
            np.where(noses[:, 0] == 0, noses[:, end], level) - y,
        )
        out[far < AT_POCKET, other] = FAR if other == 4 else -FAR
        kept |= far < AT_POCKET
    return out[kept]


def alone(table, pocket):
    """Pocket number ``pocket`` of a preset, or of a table like it: its fall, its jaws, and the noses that end
    at it."""
    x, y, _ = table.falls[pocket]
    ax, ay, ux, uy, _ = POCKET_AIMS[pocket]
    jaws = table.jaws[np.hypot(table.jaws[:, 0] - x, table.jaws[:, 1] - y) < AT_POCKET]
    here = sn.Table(f"pocket {pocket} alone", endless(table.noses, x, y), jaws, table.falls[[pocket]])
    return LonePocket(here, (float(ax), float(ay)), float(np.arctan2(uy, ux)))


def reach(speed, rolling, physics):
    """How far [m] a ball goes on free cloth."""
    roll = 0.5 / (physics.mu_r * physics.g)
    slide = 12 / 49 / (physics.mu_s * physics.g) + 25 / 49 * roll
    return np.asarray(speed) ** 2 * np.where(rolling, roll, slide)


def strokes(pocket, s, angle, distance, speed, rolling, turned, physics):
    """Start, velocity and spin of each path, (n, 2), (n, 2), (n, 3). angle: off the axis [rad]; turned: s is
    an angle, else a shift."""
    course = pocket.axis + angle
    x = pocket.aim[0] - distance * np.cos(course) - np.where(turned, 0.0, s) * np.sin(course)
    y = pocket.aim[1] - distance * np.sin(course) + np.where(turned, 0.0, s) * np.cos(course)
    course = course + np.where(turned, s, 0.0)
    vx, vy = speed * np.cos(course), speed * np.sin(course)
    roll = np.where(rolling, 1.0 / physics.R, 0.0)
    return np.stack([x, y], -1), np.stack([vx, vy], -1), np.stack([-vy * roll, vx * roll, 0.0 * vx], -1)


def play_strokes_at(pocket, start, physics, log=0):
    """Play the strokes, one ball each: which drop, which start in a cushion (and are not played), and the run
    itself."""
    r, v, w = (np.ascontiguousarray(a)[:, None] for a in start)
    here = np.ones((len(r), 1), bool)
    here[pocket.table.unfit(r, physics.R)] = False
    threads = os.cpu_count() or 1
    out = simulation._run(
        [r, v, w, here.copy()],
        physics,
        pocket.table,
        (STANDARD, 0),
        10_000,
        simulation.log_space(len(r), log, 0),
        threads,
    )
    if out.status[here[:, 0]].any():
        raise RuntimeError(f"shots {np.flatnonzero(out.status)} did not come to rest")
    return (out.potted[:, 0] >= 0) & here[:, 0], ~here[:, 0], out


def drops(pocket, angle, distance, speed, rolling, physics, s):
    """Does the ball on each path drop, shifted by s? Arrays, or numbers."""
    s, angle, distance, speed, rolling = np.broadcast_arrays(s, angle, distance, speed, rolling)
    start = strokes(
        pocket, s.ravel(), angle.ravel(), distance.ravel(), speed.ravel(), rolling.ravel(), False, physics
    )
    return play_strokes_at(pocket, start, physics)[0].reshape(s.shape)


@dataclass(frozen=True)
class Windows:
    """Arrays of the shape that was asked for; not a number where no ball arrives."""

    width: np.ndarray
    """All that drops, in units of s."""
    centre: np.ndarray
    """The piece around the centre line, or the nearest to it."""
    low: np.ndarray
    high: np.ndarray
    """The ends of the widest piece; not a number where there is none."""
    pieces: np.ndarray
    held: np.ndarray
    """Does a piece end where the ball would start in a cushion?"""


def windows(pocket, paths, physics):
    """The windows of ``Paths``."""
    angle, distance, speed, rolling, turned = np.broadcast_arrays(*paths)
    shape, n = angle.shape, angle.size
    angle, distance, speed, rolling, turned = (a.ravel() for a in (angle, distance, speed, rolling, turned))
    half = np.where(turned, np.arctan2(REACH, distance), REACH)
    grid = half[:, None] * np.linspace(-1.0, 1.0, SCAN)

    def pots(s, case):
        """Who drops, and who starts in a cushion."""
        start = strokes(
            pocket, s, angle[case], distance[case], speed[case], rolling[case], turned[case], physics
        )
        return play_strokes_at(pocket, start, physics)[:2]

    hit = pots(grid.ravel(), np.repeat(np.arange(n), SCAN))[0].reshape(n, SCAN)
    if hit[:, [0, -1]].any():
        raise RuntimeError("a window is wider than the scan")
    # each end of each run: between the points left and left + 1
    case, left = np.nonzero(hit[:, 1:] != hit[:, :-1])
    rising = hit[case, left + 1]
    inside, outside = grid[case, left + rising], grid[case, left + ~rising]
    for _ in range(HALVINGS):
        between = 0.5 * (inside + outside)
        ok, _ = pots(between, case)
        inside, outside = np.where(ok, between, inside), np.where(ok, outside, between)
    _, held = pots(outside, case)
    low, high, case = inside[0::2], inside[1::2], case[0::2]  # the runs, case by case
    held = held[0::2] | held[1::2]
    found = np.tile([[0.0], [0.0], [np.nan], [np.nan]], n)  # width, centre, low, high
    for k in np.unique(case):
        a, b = low[case == k], high[case == k]
        near, widest = np.maximum(0.0, np.maximum(a, -b)).argmin(), (b - a).argmax()
        found[:, k] = (b - a).sum(), b[near] - a[near], a[widest], b[widest]
    found[:, reach(speed, rolling, physics) <= distance + NEAR] = np.nan
    pieces, held = np.bincount(case, minlength=n), np.bincount(case, held, minlength=n) > 0
    width, centre, low, high = found.reshape(4, *shape)
    return Windows(width, centre, low, high, pieces.reshape(shape), held.reshape(shape))
