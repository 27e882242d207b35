"""How do tables differ? The ranges of the constants that measurements leave open, and draws from them."""

import numpy as np

from .._lib.types import Floats

RANGES: dict[str, tuple[float, float]] = {
    "mu_s": (0.178, 0.245),
    "mu_r": (0.0100, 0.0128),
    "spin_decel": (10.9, 22.0),
    "e_b": (0.92, 0.96),
    "mu_bb_scale": (0.7, 1.3),
    "mu_c": (0.10, 0.18),
    "e_c": (0.95, 0.98),
    "end_mass_ratio": (25.0, 30.0),
}
"""The lowest and highest value of each constant that is drawn; docs/environment/conditions.md has the sources. All are
fields of ``Physics`` but "mu_bb_scale", the factor of its friction between balls at every slip speed."""
NAMES = tuple(RANGES)
COLUMNS = len(NAMES)
LOW, HIGH = np.array(list(RANGES.values())).T.copy()
(MU_S, MU_R, SPIN_DECEL, E_B, MU_BB_SCALE, MU_C, E_C, END_MASS_RATIO) = range(COLUMNS)


def draw_constants(shares: Floats) -> Floats:
    """The constants (..., 8), in the order of ``NAMES``, at these shares of their ranges, in [0, 1)."""
    return LOW + (HIGH - LOW) * shares


def scale_to_unit(values: Floats) -> Floats:
    """Constants (..., 8) on a scale from -1 to 1, the ends of their ranges; beyond them the ends."""
    return np.clip(2.0 * (values - LOW) / (HIGH - LOW) - 1.0, -1.0, 1.0)
