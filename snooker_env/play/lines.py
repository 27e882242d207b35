"""Which paths to the pockets are open, and what blocks the others? Straight lines for every ball on."""

from dataclasses import asdict, dataclass
from math import acos, atan2, degrees, erf, hypot, radians, sqrt
from typing import Any

import numpy as np

from .._types import Floats
from ..game.balls import CUE, NAMES, ids_of, mask_of_present
from ..geometry import BALL_RADIUS, POCKET_AIMS, POCKETS
from ..planning.geometry import obstructions, pots
from ..planning.positions import Positions
from ..tasks.noise import LEVELS

MOST = 126
"""Largest number of lines: from 21 balls to 6 pockets."""


@dataclass(frozen=True)
class Line:
    """A straight line from the cue ball through a ball to a pocket; lengths in metres, angles in radians."""

    ball: int
    pocket: int
    open: bool
    """Whether the ball can be potted straight, by the geometry of straight lines."""
    blocked_by: tuple[str, ...]
    """Names of the balls in the way of the ball to the pocket, or of the cue ball to the ball."""
    why: str
    """Any other reason why the line is not open: "cut too thin", "pocket too narrow from there"; else ""."""
    cut: float
    """Angle between the paths of the cue ball and of the ball."""
    to_ball: float
    to_pocket: float
    """Distances of the cue ball to the contact, and of the ball to the pocket."""
    aim: float
    """Direction of the cue ball's path, without throw and swerve."""
    tolerance: float
    """Largest error of the aim; 0 unless the line is open."""
    chance: float | None
    """Approximate probability, with the seat's noise, of keeping within the tolerance; None without noise."""

    def to_dict(self) -> dict[str, Any]:
        """The line as JSON types."""
        names = {"ball": NAMES[self.ball], "pocket": POCKETS[self.pocket]}
        return asdict(self) | names | {"blocked_by": list(self.blocked_by)}

    @property
    def words(self) -> str:
        """The line in words, without the ball's name."""
        way = f"{POCKETS[self.pocket]}: "
        if not self.open:
            return way + (", ".join(self.blocked_by) + " in the way" if self.blocked_by else self.why)
        cut = "straight" if self.cut < radians(1.0) else f"cut {degrees(self.cut):.0f} deg"
        likely = "" if self.chance is None else f", chance {100 * self.chance:.0f} %"
        far = f"cue ball {self.to_ball:.2f} m, ball {self.to_pocket:.2f} m, aim {self.aim:.4f} rad"
        return f"{way}open, {cut}, {far}, may err {degrees(self.tolerance):.2f} deg{likely}"


def lines_of(positions: list[Positions], on: int, noise: str) -> list[Line]:
    """Lines to pockets for the balls ``on``; ``positions``: the table, with a free ball also for colours."""
    errors = LEVELS[noise]
    sigma = 0.0 if errors.silent else radians(errors.direction_deg())
    tolerances = {}
    for position in positions:
        some = pots(position, most=MOST)
        columns = (each[0].tolist() for each in (some.ball, some.pocket, some.tolerance))
        for ball, pocket, tolerance in zip(*columns, strict=True):
            if ball >= 0:
                tolerances[ball, pocket] = tolerance
    at = positions[0]
    places, ids = at.positions[0], ids_of(on & mask_of_present(at.on_table[0]))
    ways = [(ball, pocket) for ball in ids for pocket in range(len(POCKETS))]
    if not ways:
        return []
    balls, pockets = (np.array(column) for column in zip(*ways, strict=True))
    aims = POCKET_AIMS[pockets, :2]
    ghosts = places[balls] - 2.0 * BALL_RADIUS * _unit(aims - places[balls])
    rows = np.zeros(len(ways), np.int64)
    skip: Any = np.column_stack([np.full(len(ways), CUE), balls])
    barred = obstructions(at, rows, places[balls], aims, ignore=skip)
    barred |= obstructions(at, rows, np.broadcast_to(places[CUE], ghosts.shape).copy(), ghosts, ignore=skip)
    each = zip(ways, ghosts, aims, barred, strict=True)
    return [_line(*way, places, *of_way, tolerances, sigma) for way, *of_way in each]


def _line(ball, pocket, places, ghost, aim, barred, tolerances, sigma):
    run, way = ghost - places[CUE], aim - places[ball]
    far, on = hypot(*run), hypot(*way)
    cos_cut = float(run @ way / max(far * on, 1e-12))
    cut = acos(min(1.0, max(-1.0, cos_cut)))
    tolerance = tolerances.get((ball, pocket), 0.0)
    blocked = () if tolerance else tuple(NAMES[i] for i in np.flatnonzero(barred))
    why = "cut too thin" if cos_cut <= 0.05 else "pocket too narrow from there"
    why = "" if tolerance or blocked else why
    chance = erf(tolerance / (sigma * sqrt(2.0))) if sigma and tolerance else None
    aim = atan2(run[1], run[0])
    return Line(ball, pocket, tolerance > 0.0, blocked, why, cut, far, on, aim, tolerance, chance)


def _unit(v: Floats) -> Floats:
    return v / np.maximum(np.hypot(*v.T), 1e-12)[:, None]
