"""How likely is a pot, and what are the pots of a position worth, with what follows them? The chance that an error of the cue
ball's direction stays within what the pot allows, and a rule of thumb."""

from math import atan2, exp, hypot

from .._lib.jit import entry, kernel
from ..game.balls import N_BALLS, VALUES, BallOn
from ..game.pots import GHOST_X, GHOST_Y, POT_BALL, POT_POCKET, TOLERANCE
from ..geometry import AIM_X, AIM_Y, BALL_RADIUS, POCKET_AIMS
from ..physics.cue_room import STEEPEST, least_elevation
from .noise import TWICE, chance_within, widen

FAR = 0.01  # decay of the chance per metre of both balls' paths [1/m]: the width alone nearly tells it
_ANY_COLOUR = int(BallOn.ANY_COLOUR)
FOLLOWS = 25.0  # points that the rest of the visit brings after a pot; fewer if fewer are left on the table
SECOND, THIRD = 0.15, 0.05
"""Shares of the second and third best pot that count: they leave a choice of where to play next."""
DISTANT = 0.09
"""Decay of what a pot is worth per metre of both balls' paths [1/m], beside its chance: from far the cue ball is hard to place."""
RULE_OF_THUMB = (FOLLOWS, SECOND, THIRD, DISTANT)
"""Constants of ``worth_of_pots`` for a player with execution errors: the four numbers above."""
SURE = (1e4, 1e-3, 0.0, -FAR)
"""The same for a player without execution errors, who takes all points that are left: the last one undoes the loss that
the chance has by the paths."""


@kernel
def pot_chance(tolerance, length, spread):
    """The chance of a pot that allows errors of ``tolerance`` [rad], with paths of both balls of ``length`` [m]
    together: P(|error| < tolerance) by the ``Spread`` of the player's direction, times exp(-``FAR`` length)."""
    return chance_within(tolerance, spread) * exp(-FAR * length)


@entry
def chance_at(tolerance, length, spread):
    """``pot_chance`` for Python."""
    return pot_chance(tolerance, length, spread)


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


@kernel
def points_left(on_table, ball_on):
    """Points on the table: a black with each red, and one after a red just potted."""
    left = 7.0 if ball_on == _ANY_COLOUR else 0.0
    for i in range(1, N_BALLS):
        if on_table[i]:
            left += 8.0 if VALUES[i] == 1 else VALUES[i]
    return left


@kernel
def worth_of_pots(lines, many, positions, on_table, left, spread, constants, rails, chances):
    """The worth [points] of the first ``many`` rows of ``find_pots`` together, with ``left`` points on the table, and the chances
    of the two that are worth most; ``chances`` takes those of the widest."""
    follows, second, third, distant = constants
    a = b = c = first = other = 0.0
    for j in range(many):
        ball = int(lines[j, POT_BALL])
        chance = plain_chance(positions, on_table, lines[j], spread, rails)
        if j < chances.shape[0]:
            chances[j] = chance
        rest = max(0.0, left - VALUES[ball])
        worth = chance * (VALUES[ball] + follows * (1.0 - exp(-rest / follows)))
        worth *= exp(-distant * length_of(positions, lines[j]))
        if worth > a:
            a, b, c = worth, a, b
            first, other = chance, first
        elif worth > b:
            b, c = worth, b
            other = chance
        elif worth > c:
            c = worth
    return a + second * b + third * c, first, other
