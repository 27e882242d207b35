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
"""The lowest and highest value of each constant that is drawn. All are fields of ``Physics`` but
"mu_bb_scale", the factor of its friction between balls at every slip speed: dirt and polish.

* mu_s: measured [MJP14 2.4.2]. mu_r: 0.0128 is a deceleration of 0.126 m/s^2 [MJP14]; 0.0100 is what a ball
  off a ramp needs on a heated table with new cloth (``python -m benchmarks.fit_cushion``).
* spin_decel: 22 rad/s^2 [MJP14 eq. 21]; for pool balls 5 to 15 are given; the lower end is our choice.
* e_b: about the 0.94 of the preset "match". mu_bb_scale: 30 % either way covers the throws measured with clean
  and with dirty balls about one law [Marlow]; the share is our choice.
* mu_c and e_c: about 0.14 and 0.98 [MJP10], which were fitted on one cushion; the widths are our choice.
* end_mass_ratio: 30 for common cues [TP A.31]; 25 for one that is heavier at the tip, our choice."""
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
