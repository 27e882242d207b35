"""Which shots do the comparisons play? Pots with two balls and on full tables, kicks and head-on stun shots, aimed
as a player would.

A pot is aimed so that the object ball, alone with the cue ball on unbounded cloth, leaves exactly towards the
pocket. The aim allows for throw, squirt and swerve, as good players do. The shot is then struck with a
professional's errors (``tasks.noise``), so that some pots are centred, some rattle and some miss.
"""

from dataclasses import dataclass
from math import hypot, radians, sqrt
from typing import Any

import numpy as np

import snooker_env as sn
from snooker_env.game.layouts import layout as deal
from snooker_env.game.pots import pots
from snooker_env.geometry import POCKET_AIMS
from snooker_env.physics.cue import MAX_ELEVATION
from snooker_env.physics.engine import EventKind
from snooker_env.physics.table import UNBOUNDED
from snooker_env.tasks.noise import Noise

R, HALF_WIDTH, HALF_LENGTH = 0.02625, 0.889, 1.7845
TOLERANCE = 5e-4
"""Pots with a smaller tolerance of aim [rad] are not played. This is about half of a professional's standard
deviation."""
AIM_ERROR = np.radians(0.02)
"""Aims that leave the object ball further than this [rad] from its line are discarded (thin cuts that do not
converge)."""


@dataclass(frozen=True, eq=False)
class Shots:
    """n shots with b balls, the cue ball first; every ball is on the table."""

    positions: np.ndarray
    """(n, b, 2) [m]"""
    stroke: np.ndarray
    """(n, 4) as intended: speed [m/s], aim [rad], side and top offset over R."""
    ball: np.ndarray
    """(n,) the ball to pot or hit."""
    physics: sn.Physics

    def struck(self, seed=None, aim=0.0, errors: Any = "professional"):
        """Velocities (n, b, 2) and spins (n, b, 3) just after the strokes, each turned by ``aim`` [rad], and, if
        seeded, with the execution errors of ``noise``."""
        n, b = self.positions.shape[:2]
        v, w = np.zeros((n, b, 2)), np.zeros((n, b, 3))
        noise, rng = Noise.of("none" if seed is None else errors), np.random.default_rng(seed)
        for k, (speed, line, side, top) in enumerate(self.stroke):
            speed, side, top, line, elevation = _execute(speed, side, top, line, noise, rng)
            inside = max(1.0, hypot(side, top) / self.physics.max_offset)  # as in the environment, no miscues
            side, top = side / inside, top / inside
            v3, w[k, 0] = sn.strike(speed, line + aim, side, top, elevation, self.physics)
            v[k, 0] = v3[:2]
        return v, w


def _execute(speed, side, top, aim, noise, rng):
    """A level stroke with the errors of a ``Noise``, from six numbers of ``rng``; its elevation comes last."""
    if noise.silent:
        return speed, side, top, aim, 0.0
    z, more = noise.draw_errors(rng, 1)[0], hypot(1.0, noise.growth * speed)
    tip, turn = more * 1e-3 * noise.offset_mm / R, more * radians(noise.aim_deg)
    speed = max(0.0, speed + z[0] * sqrt(noise.speed_abs**2 + (noise.speed_rel * speed) ** 2))
    elevation = min(MAX_ELEVATION, max(0.0, z[4] * radians(noise.elevation_deg)))
    return speed, side + z[1] * tip, top + z[2] * tip, aim + z[3] * turn, elevation


def _inside(place, margin=0.01):
    """Whether there is room for a ball, clear of cushions and pockets."""
    room = np.abs(place) < np.array([HALF_WIDTH, HALF_LENGTH]) - R - margin
    return room.all() and np.hypot(*(POCKET_AIMS[:, :2] - place).T).min() > 0.1


def _turn(d, angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * d[0] - s * d[1], s * d[0] + c * d[1]])


def _settle(positions, stroke, ball, target, physics):
    """Turn the aims until each object ball leaves towards its target. Returns the shots that converged."""
    pair = np.stack([positions[:, 0], positions[np.arange(len(ball)), ball]], 1)
    line = target - pair[:, 1]
    ghost = pair[:, 1] - 2 * R * line / np.hypot(*line.T)[:, None] - pair[:, 0]
    far, bearing = np.hypot(*ghost.T), np.arctan2(*line.T[::-1])
    stroke[:, 1] = np.arctan2(*ghost.T[::-1])
    gain = 2 * R * np.cos(stroke[:, 1] - bearing) / far  # aim per angle of the object ball's path
    error = np.full(len(ball), np.pi)
    for _ in range(8):
        shots = Shots(pair, stroke, ball, physics)
        free = sn.simulate_batch(pair, *shots.struck(), table=UNBOUNDED, physics=physics)  # pyright: ignore[reportArgumentType]
        end = free.positions[:, 1] - pair[:, 1]
        error = (np.arctan2(*end.T[::-1]) - bearing + np.pi) % (2 * np.pi) - np.pi
        stroke[:, 1] += gain * error
    good = np.abs(error) < AIM_ERROR
    return Shots(positions[good], stroke[good], ball[good], physics)


def _join(parts, n):
    positions, stroke, ball = (
        np.concatenate([getattr(p, a) for p in parts])[:n] for a in ("positions", "stroke", "ball")
    )
    return Shots(positions, stroke, ball, parts[0].physics)


def _strokes(rng, n, speed, spin):
    """Draw strokes without an aim: speeds in a range, the tip anywhere in an upright box (0.25 R by 0.35 R, scaled by
    ``spin``)."""
    return np.column_stack(
        [
            rng.uniform(*speed, n),
            np.zeros(n),
            spin * rng.uniform(-0.25, 0.25, n),
            spin * rng.uniform(-0.35, 0.35, n),
        ]
    )


def _anywhere(rng):
    return rng.uniform([-HALF_WIDTH, -HALF_LENGTH], [HALF_WIDTH, HALF_LENGTH])


def by_the_rail(rng):
    """Draw a place 1 to 20 mm from a cushion and 0.2 to 0.6 m from a corner, from where a potted ball meets the
    jaw."""
    along, gap = rng.uniform(0.2, 0.6), R + rng.uniform(1e-3, 0.02)
    corner = np.array([HALF_WIDTH, HALF_LENGTH]) - ([along, gap] if rng.random() < 0.5 else [gap, along])
    return corner * rng.choice([-1.0, 1.0], 2)


def two_ball(
    n, physics, seed=0, *, cut=(0.0, 65.0), speed=(1.0, 4.5), run=(0.2, 1.5), spin=1.0, place=_anywhere
):
    """Draw n pots with cuts [deg], speeds [m/s] and distances to the pocket [m] in these ranges, with the object ball
    placed by ``place``."""
    rng, parts = np.random.default_rng(seed), []
    on_table = np.arange(22) < 2
    while sum(len(p.ball) for p in parts) < n:
        found, targets = [], []
        while len(found) < n:
            layout, b = np.zeros((22, 2)), place(rng)
            k = rng.integers(6)
            d = POCKET_AIMS[k, :2] - b
            far = np.hypot(*d)
            if not run[0] <= far <= run[1] or (place is _anywhere and not _inside(b)):
                continue
            d /= far
            angle = np.radians(rng.uniform(*cut)) * rng.choice([-1.0, 1.0])
            layout[0], layout[1] = b - 2 * R * d - rng.uniform(0.25, 1.3) * _turn(d, angle), b
            if not _inside(layout[0]):
                continue
            possible = pots(layout, on_table, 2)
            if (possible[possible[:, 1] == k, 5] >= TOLERANCE).any():
                found.append(layout[:2])
                targets.append(POCKET_AIMS[k, :2])
        parts.append(
            _settle(
                np.array(found), _strokes(rng, n, speed, spin), np.ones(n, int), np.array(targets), physics
            )
        )
    return _join(parts, n)


def full_table(n, physics, seed=0, *, speed=(1.0, 4.5)):
    """Draw n pots from the five widest of an opened table with all 22 balls (the held-out tables)."""
    rng, parts = np.random.default_rng(seed), []
    while sum(len(p.ball) for p in parts) < n:
        found, balls, targets = [], [], []
        while len(found) < n:
            layout, on_table = deal("held_out", rng)
            possible = pots(layout, on_table, 0x3FFFFE, most=5)
            possible = possible[possible[:, 5] >= TOLERANCE]
            if len(possible):
                row = rng.choice(possible)
                found.append(layout)
                balls.append(int(row[0]))
                targets.append(POCKET_AIMS[int(row[1]), :2])
        parts.append(
            _settle(
                np.array(found), _strokes(rng, n, speed, 1.0), np.array(balls), np.array(targets), physics
            )
        )
    return _join(parts, n)


def kicks(n, physics, seed=0, *, speed=(1.5, 4.0)):
    """Draw n shots that meet one cushion and then the object ball: the middle one of the successful aims in a
    fan."""
    rng, found, strokes = np.random.default_rng(seed), [], []
    while len(found) < n:
        p = np.array([_anywhere(rng), _anywhere(rng)])
        if not (_inside(p[0]) and _inside(p[1])) or np.hypot(*(p[1] - p[0])) < 0.3:
            continue
        axis, side = rng.integers(2), rng.choice([-1.0, 1.0])
        image = p[1].copy()
        image[axis] = 2 * side * (np.array([HALF_WIDTH, HALF_LENGTH])[axis] - R) - image[axis]
        fan = np.repeat(_strokes(rng, 1, speed, 0.6), 41, 0)
        fan[:, 1] = np.arctan2(*(image - p[0])[::-1]) + np.radians(np.linspace(-6, 6, 41))
        shots = Shots(np.repeat(p[None], 41, 0), fan, np.ones(41, int), physics)
        logs = sn.simulate_batch(
            shots.positions, *shots.struck(), physics=physics, events=True, threads=1
        ).events
        assert logs is not None
        good = [k for k, log in enumerate(logs) if _kick(log["kind"])]
        if good:
            found.append(p)
            strokes.append(fan[good[len(good) // 2]])
    return Shots(np.array(found), np.array(strokes), np.ones(n, int), physics)


def _kick(kinds):
    """Whether the first contact is a cushion and the second the other ball."""
    return kinds[kinds < EventKind.ROLL][:2].tolist() == [EventKind.CUSHION, EventKind.BALL_BALL]


def head_on(n, physics, seed=0):
    """Draw n full-ball shots far from every cushion in which the cue ball arrives without spin."""
    rng = np.random.default_rng(seed)
    gap, arrives = rng.uniform(0.05, 0.12, n), rng.uniform(0.5, 0.7, n)
    leaves = np.sqrt(arrives**2 + 2 * physics.mu_s * physics.g * gap)
    aim = np.pi / 2 + rng.uniform(-0.3, 0.3, n)
    p = np.zeros((n, 2, 2))
    p[:, 1] = rng.uniform([-0.3, -0.3], [0.3, 0.3], (n, 2))
    p[:, 0] = p[:, 1] - (2 * R + gap)[:, None] * np.column_stack([np.cos(aim), np.sin(aim)])
    # sliding adds spin (5/2) (leaves - arrives) / R; the strike gives (5/2) leaves top / R
    return Shots(
        p, np.column_stack([leaves, aim, np.zeros(n), -(leaves - arrives) / leaves]), np.ones(n, int), physics
    )
