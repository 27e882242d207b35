"""How do a pool table's pockets compare with Alciatore's effective target sizes? His formulas, and his
pockets as tables of their own.

TP 3.5 (side pocket) and TP 3.6 (corner pocket), "Effective target sizes for slow shots at different angles":
straight facings, sharp points, mirror reflections without friction, no spin, no speed; a ball drops where its
centre reaches the circle of the hole. The target size is the width of parallel paths that drop: theta off the
axis, R of the ball, p the mouth from point to point, alpha between a facing and the axis (facings converge),
R_h of the hole, b the shelf from the mouth to the hole; lengths in inches, angles in radians.
"""

from dataclasses import dataclass
from math import cos, pi, radians, sin, sqrt
from typing import Any

import numpy as np

import snooker_env as sn

from .windows import FAR, LonePocket, Paths, windows

INCH = 0.0254
PHYSICS = {"R": 1.125 * INCH, "sin_theta": 0.27}
"""Pool's ball, and its nose at 63.5 % of the ball's diameter (WPA equipment specifications)."""
MIRROR: dict[str, Any] = {"R": 1.125 * INCH, "e_c": 1.0, "mu_c": 0.0, "mu_s": 1e-9, "mu_r": 1e-9}
"""Alciatore's assumptions."""
DISTANCE = 0.4
"""The ball starts so far [m] before the middle of the mouth: at 0.5 m/s it arrives with 0.39."""
SPEEDS = {"slow": 0.5, "medium": 2.0, "fast": 6.0}
# m: length of a facing; radius of the arc that stands for it (0.02 mm off a straight line)
_FACING, _FLAT = 0.14, 100.0


@dataclass(frozen=True)
class Pool:
    """One pocket of his, in inches and radians."""

    p: float
    alpha: float
    R_h: float
    b: float
    R: float = 1.125
    L: float = 96.0

    def far_wall(self, beta, theta):
        """How far the ball runs from the far facing to the edge of the hole, after it has met the near point
        at the angle beta."""
        turn = 2 * beta - theta - self.alpha
        past = (
            self.p / 2 * cos(self.alpha)
            - self.R
            - self.R_h * cos(turn)
            - (self.R_h + self.b) * sin(self.alpha)
        )
        return past / sin(turn)

    def by_wall(self, beta, theta):
        """Zero where the ball reaches the edge of the hole at a tangent: from the point over the far
        facing."""
        run, turn = self.far_wall(beta, theta), 4 * beta - 2 * theta - 2 * self.alpha
        there = self.p / 2 * cos(2 * beta - theta) + (self.R_h + self.b) * sin(2 * beta - theta)
        return self.R * sin(beta) + run * sin(turn) + self.R_h * cos(turn) + there

    def direct(self, beta, theta):
        """The same: from the point straight to the hole."""
        return (
            -self.R * sin(beta)
            + self.R_h
            - self.p / 2 * cos(2 * beta - theta)
            - (self.R_h + self.b) * sin(2 * beta - theta)
        )

    def by_two_walls(self, beta, theta):
        """The same: from the point over the far facing and the near one."""
        a, R, R_h, half, deep = self.alpha, self.R, self.R_h, self.p / 2, self.R_h + self.b
        first = 2 * beta - pi / 2 - theta - 2 * a
        second = first - 2 * a
        run2 = (half * cos(a) - deep * sin(a) + R_h * sin(second + a) - R) / cos(second + a)
        run1 = (half * cos(a) - R + run2 * cos(second - a) - R_h * sin(second - a) - deep * sin(a)) / cos(
            first + a
        )
        way = (
            -run1 * cos(2 * beta - theta + first)
            + run2 * cos(2 * beta - theta - second)
            + R_h * sin(2 * beta - theta - second)
        )
        return -R * sin(beta) + way - half * cos(2 * beta - theta) - deep * sin(2 * beta - theta)

    def root(self, f, theta, guess):
        """The root of f over beta that lies nearest to a guess; infinite if there is none."""
        grid = np.radians(np.linspace(0.5, 120, 2400)).tolist()
        values, roots = [f(x, theta) for x in grid], []
        for low, high, a, b in zip(grid, grid[1:], values, values[1:], strict=False):
            if a * b < 0 and max(abs(a), abs(b)) < 20:  # beyond 20 inches the sign changes at a pole
                for _ in range(50):
                    x = 0.5 * (low + high)
                    low, high = (x, high) if f(x, theta) * a > 0 else (low, x)
                roots.append(low)
        return min(roots, key=lambda x: abs(x - guess), default=np.inf)

    def side_by_point(self, theta):
        """Offset of the last path to one side that drops, off the near point."""
        guess = radians(20) + 70 / 130 * (theta + radians(60))
        beta = min(self.root(self.by_wall, theta, guess), self.root(self.direct, theta, guess))
        return self.p / 2 * cos(theta) - self.R * sin(beta)

    def side_by_wall(self, theta):
        """The same, off the facing alone."""
        theta = -theta
        turn = 2 * theta + 2 * self.alpha
        return (
            self.far_wall(pi / 2, theta) * sin(turn) - self.R_h * cos(turn) - (self.R_h + self.b) * sin(theta)
        )

    def side_by_both_walls(self, theta):
        """The same, off one facing and then the other."""
        after = theta - 2 * self.alpha
        return (
            self.p / 2 * (cos(theta) + cos(after))
            - 2 * self.R * cos(theta - self.alpha)
            + self.side_by_wall(after)
        )

    def side_by_rail(self, f, theta):
        """The same, off the rail beside a corner pocket first: ``f`` of the direction after it."""
        return self.p / 2 * (cos(theta) + sin(theta)) - 2 * self.R * cos(pi / 4 - theta) + f(theta - pi / 2)


SIDE = Pool(5.0625, radians(14), 3.0, 0.1875)
CORNER = Pool(4.5875, radians(7), 2.75, 1.125)
POOLS = {"corner": CORNER, "side": SIDE}
ANGLES = {"corner": (0, 10, 20, 30, 40), "side": (0, 15, 30, 45, 60)}


def _side(theta):
    """Offset to one side of the side pocket; his critical angles."""
    if abs(theta) >= radians(68.292):
        return 0.0
    return SIDE.side_by_wall(theta) if theta < radians(-49.964) else SIDE.side_by_point(theta)


def _corner(theta):
    """The same of the corner pocket."""
    if theta >= radians(44.058):
        far = CORNER.L - CORNER.p / cos(pi / 4) - 2 * CORNER.R
        return CORNER.p / 2 * cos(theta) + far * sin(pi / 4 - theta) - CORNER.R * cos(pi / 4 - theta)
    if theta >= radians(38.558):
        return CORNER.side_by_rail(CORNER.side_by_point, theta)
    if theta >= radians(28.167):
        return CORNER.side_by_rail(CORNER.side_by_both_walls, theta)
    return CORNER.p / 2 * cos(theta) - CORNER.R * sin(CORNER.root(CORNER.by_two_walls, theta, radians(75)))


def published(kind, degrees):
    """Alciatore's target size [in] of a slow shot."""
    half = _corner if kind == "corner" else _side
    return half(radians(degrees)) + half(-radians(degrees))


def pocket(kind):
    """His pocket as a table: the mouth's middle at the origin, the axis along +x of a side pocket, at 45
    degrees of a corner."""
    pool = POOLS[kind]
    axis = pi / 4 if kind == "corner" else 0.0
    u, left = np.array([cos(axis), sin(axis)]), np.array([-sin(axis), cos(axis)])
    half = pool.p / 2 * INCH
    jaws = []
    for side in (-1, 1):
        point = side * half * left
        jaws.append((*point, 0.0, 1.0, 0.0, -1.0))
        along = cos(pool.alpha) * u - side * sin(pool.alpha) * left
        into = cos(pool.alpha) * side * left + sin(pool.alpha) * u  # into the rubber
        centre = point + _FACING / 2 * along + sqrt(_FLAT**2 - _FACING**2 / 4) * into
        jaws.append((*centre, _FLAT, *-into, sqrt(_FLAT**2 - _FACING**2 / 4) / _FLAT))
    if kind == "corner":
        level = pool.p / 2 / sqrt(2) * INCH
        noses = [(0, 1, level, -FAR, -level), (1, 1, level, -FAR, -level)]  # without other ends
    else:
        noses = [(0, 1, 0.0, -FAR, -half), (0, 1, 0.0, half, FAR)]
    hole = (pool.R_h + pool.b) * INCH * u
    table = sn.Table(f"pool {kind}", np.array(noses), np.array(jaws), np.array([(*hole, pool.R_h * INCH)]))
    return LonePocket(table, (0.0, 0.0), axis)


def sizes(kind, engines):
    """Target sizes [m] against the angle: his; this engine's with his assumptions, and with mirrors but a
    ball that rolls on cloth, at 0.5 m/s; and with ``"match"`` at the three speeds. engines: "before" and
    "after".
    """
    here, angles = pocket(kind), np.radians(ANGLES[kind])
    found = {"Alciatore": np.array([published(kind, a) * INCH for a in ANGLES[kind]])}
    physics = sn.Physics(**MIRROR)
    found["his assumptions"] = windows(
        here, Paths(angles, DISTANCE, 0.5, False, False), physics, engines["before"]
    ).width
    physics = sn.Physics(R=PHYSICS["R"], e_c=1.0, mu_c=0.0)
    found["his, but it rolls"] = windows(
        here, Paths(angles, DISTANCE, 0.5, True, False), physics, engines["before"]
    ).width
    physics = sn.Physics.preset("match", **PHYSICS)
    for rule, engine in engines.items():
        for name, speed in SPEEDS.items():
            found[f"{name} {rule}"] = windows(
                here, Paths(angles, DISTANCE, speed, True, False), physics, engine
            ).width
    return found


def says(found):
    """Where and why each pocket differs from his, sizes in inches."""
    lines = []
    for kind, rows in found.items():
        his, angles = np.asarray(rows["Alciatore"]), ANGLES[kind]
        slow, fast = np.asarray(rows["slow after"]) - his, np.asarray(rows["fast after"]) - his
        most, least = int(np.abs(slow).argmax()), int(fast.argmin())
        spin = rows["his, but it rolls"][most] - his[most]
        lines.append(
            f"Pool, {kind} pocket: at 0.5 m/s {slow[most]:+.2f} in against Alciatore's at {angles[most]} deg, where they differ most: a"
            f" ball that has met a facing still rolls, which carries it on towards the hole (alone {spin:+.2f} in), and friction at the"
            f" nose takes part of that back; at 6 m/s {fast[least]:+.2f} in at {angles[least]} deg, since the ball meets the facings"
            " beyond the hole's edge before it has fallen."
        )
    return lines
