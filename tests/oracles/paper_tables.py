"""What do the paper's Tables 1 and 2 hold, and which impact is each row? Its numbers, and the way from an
impact to its columns.

Source: Mathavan, Jackson & Parkin (2014), *Sports Engineering* 17, 227-237, with the slip that is noted
below.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class PaperRow:
    """One shot of the paper's Tables 1 and 2; ``_c`` the cue ball, ``_o`` the object ball, predicted unless
    ``measured_``.

    Speeds [m/s] and angles [deg, from the cue ball's incoming direction] after the slip; ``w_t`` topspin
    [rad/s]; ``cut`` angle [deg].
    """

    v0: float
    w_t: float
    cut: float
    v_c: float
    v_o: float
    angle_c: float
    angle_o: float
    measured_v_c: float
    measured_v_o: float
    measured_angle_c: float
    measured_angle_o: float


PAPER_PARAMETERS = {"R": 0.02625, "M": 0.1406, "e": 0.89, "mu_bb": 0.05, "mu_s": 0.21}

# Row 4's speed of the cue ball is printed as 0.128; 1.277 follows from the printed error (physics.md 1.2).
PAPER_ROWS = (
    PaperRow(1.539, 58.63, 33.83, 0.914, 0.831, 31.93, 32.20, 0.816, 0.836, 35.96, 33.83),
    PaperRow(1.032, 39.31, 26.36, 0.520, 0.599, 32.45, 25.07, 0.520, 0.629, 33.20, 26.36),
    PaperRow(1.364, 51.96, 40.52, 0.917, 0.676, 29.91, 38.62, 0.925, 0.700, 30.50, 40.51),
    PaperRow(1.731, 65.94, 46.50, 1.277, 0.780, 27.32, 44.38, 1.275, 0.787, 27.97, 46.50),
    PaperRow(0.942, 35.89, 18.05, 0.383, 0.579, 29.47, 17.15, 0.365, 0.581, 29.86, 18.05),
)


def incoming(row: PaperRow):
    """(v1, w1, v2, w2, normal) of a row: cue ball along +x with topspin, the object ball at rest at the cut
    angle to its left."""
    cut = math.radians(row.cut)
    still = np.zeros(3)
    return (
        np.array([row.v0, 0.0, 0.0]),
        np.array([0.0, row.w_t, 0.0]),
        still,
        still.copy(),
        np.array([math.cos(cut), math.sin(cut), 0.0]),
    )


def velocity_after_slip(v, w, *, R: float) -> np.ndarray:
    """Horizontal velocity (2,) [m/s] once the slip on the cloth has ended: v - 2/7 u, u = v + w x (-R z)
    (physics.md 1.3)."""
    v, w = np.asarray(v, dtype=float), np.asarray(w, dtype=float)
    slip = v[:2] + R * np.array([-w[1], w[0]])
    return v[:2] - 2.0 / 7.0 * slip


def after_slip(v1, w1, v2, w2, direction, *, R: float) -> tuple[float, float, float, float]:
    """The tables' columns: speeds [m/s] of balls 1 and 2 after slip, their angles [deg, >= 0] from
    ``direction`` (the incoming one)."""
    speeds, angles = [], []
    dx, dy = float(direction[0]), float(direction[1])
    for v, w in ((v1, w1), (v2, w2)):
        x, y = velocity_after_slip(v, w, R=R)
        speeds.append(math.hypot(x, y))
        angles.append(abs(math.degrees(math.atan2(dx * y - dy * x, dx * x + dy * y))))
    return speeds[0], speeds[1], angles[0], angles[1]
