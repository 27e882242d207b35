"""How likely is a pot? The chance that an error of the cue ball's direction stays within what the pot allows."""

from math import exp, hypot

import numpy as np

from .._lib.jit import entry, kernel
from .._lib.types import Floats
from ..game.pots import GHOST_X, GHOST_Y, POT_BALL, POT_POCKET, TOLERANCE
from ..geometry import AIM_X, AIM_Y, POCKET_AIMS
from ..tasks.noise import Spread, chance_within

FAR = 0.01  # decay of the chance per metre of both balls' paths [1/m]: the width alone nearly tells it


@kernel
def pot_chance(tolerance, length, spread):
    """The chance of a pot that allows errors of ``tolerance`` [rad], with paths of both balls of ``length`` [m] together.

    P(|error| < tolerance) by the ``Spread`` of the player's direction, times exp(-``FAR`` length).
    """
    return chance_within(tolerance, spread) * exp(-FAR * length)


@kernel
def length_of(positions, pot):
    """The paths of both balls together [m] at a row of ``find_pots``."""
    ball, pocket = int(pot[POT_BALL]), int(pot[POT_POCKET])
    path = hypot(pot[GHOST_X] - positions[0, 0], pot[GHOST_Y] - positions[0, 1])
    tx, ty = POCKET_AIMS[pocket, AIM_X], POCKET_AIMS[pocket, AIM_Y]
    return path + hypot(tx - positions[ball, 0], ty - positions[ball, 1])


@kernel
def chance_of(positions, pot, spread):
    """The chance of a row of ``find_pots`` for a stroke with this ``Spread``."""
    return pot_chance(pot[TOLERANCE], length_of(positions, pot), spread)


@entry
def _fill(tolerances, lengths, spread, chances):
    for k in range(len(chances)):
        chances[k] = pot_chance(tolerances[k], lengths[k], spread)


def pot_chances(tolerances: Floats, lengths: Floats, spread: Spread) -> Floats:
    """``pot_chance`` of n pots: float64 (n,)."""
    chances = np.empty(len(tolerances))
    _fill(tolerances, lengths, spread, chances)
    return chances
