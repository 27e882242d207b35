"""What are the pots of a position worth, with what follows them? A rule of thumb."""

from math import exp

from .._lib.jit import kernel
from ..game.balls import N_BALLS, VALUES, BallOn
from ..game.pots import POT_BALL
from .pot_chance import FAR, length_of, plain_chance

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
