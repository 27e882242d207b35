"""What is published about how well people and a robot play?"""

import numpy as np

from .pot_shots import DERIVED, LONG

AIM = {"professional": (0.02, 0.03), "amateur": (0.05, 0.05), "club": (0.08, 0.12)}
"""Total errors of direction [deg] that were derived from pot rates, with a corner pocket whose effective half
window is 22 mm."""
CHOSEN, LONG_POTS = (0.88, 0.95), (0.50, 0.65)
"""Shares of pots that professionals make: of what they choose, of long ones."""
ROBOT_POTS, ROBOT_PLACES = 0.90, (0.1, 0.2)
"""Share of pots that the robot made, and how far from its target it left the cue ball [m]."""
LIKELY = 0.5
"""A player of a match would rather play safe than try what is made less often than this."""


def by_derivation(level, pots=DERIVED):
    """(lowest, highest) mean share of these pots made with the level's published errors, by geometry."""
    low, high = AIM[level]
    return tuple(float(np.mean([pot.rate(deg) for pot in pots])) for deg in (high, low))


def of_pot(pot, level):
    """(lowest, highest) share of a pot made by a level; None where nothing is published."""
    if level == "professional" and pot in LONG:
        return LONG_POTS
    return by_derivation(level, (pot,)) if level in AIM and pot.pocket == 3 else None
