"""How likely is a pot? The chance that an error of the cue ball's direction stays within what the pot allows."""

from math import atan2, exp, hypot

import numpy as np

from .._lib.jit import entry, kernel
from .._lib.types import Floats
from ..game.pots import GHOST_X, GHOST_Y, POT_BALL, POT_POCKET, TOLERANCE
from ..geometry import AIM_X, AIM_Y, BALL_RADIUS, POCKET_AIMS
from ..physics.cue_room import STEEPEST, least_elevation
from .noise import TWICE, Spread, chance_within, widen

FAR = 0.01  # decay of the chance per metre of both balls' paths [1/m]: the width alone nearly tells it


@kernel
def pot_chance(tolerance, length, spread):
    """The chance of a pot that allows errors of ``tolerance`` [rad], with paths of both balls of ``length`` [m]
    together: P(|error| < tolerance) by the ``Spread`` of the player's direction, times exp(-``FAR`` length)."""
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


@kernel
def at_elevation(spread, elevation):
    """``spread`` of a stroke whose cue is raised to ``elevation`` [rad]: errors grow with it (``tasks.noise``)."""
    return widen(spread, 1.0 + min(elevation, STEEPEST) / TWICE)  # a tip goes up before a cue does further


@kernel
def raised_spread(spread, side, top, aim, positions, on_table, rails):
    """``spread`` of a stroke whose cue, pointing in the direction ``aim`` [rad], must be raised."""
    if rails.shape[0] == 0:
        return spread
    least = least_elevation((side, top, aim, 0.0), positions, on_table, rails, BALL_RADIUS)
    return at_elevation(spread, least)


@kernel
def plain_chance(positions, on_table, pot, spread, rails):
    """The chance of a row of ``find_pots`` for a stroke in the middle of the cue ball, raised as it must be."""
    aim = atan2(pot[GHOST_Y] - positions[0, 1], pot[GHOST_X] - positions[0, 0])
    return chance_of(positions, pot, raised_spread(spread, 0.0, 0.0, aim, positions, on_table, rails))


@entry
def _fill(tolerances, lengths, spread, chances):
    for k in range(len(chances)):
        chances[k] = pot_chance(tolerances[k], lengths[k], spread)


def pot_chances(tolerances: Floats, lengths: Floats, spread: Spread) -> Floats:
    """``pot_chance`` of n pots: float64 (n,)."""
    chances = np.empty(len(tolerances))
    _fill(tolerances, lengths, spread, chances)
    return chances
