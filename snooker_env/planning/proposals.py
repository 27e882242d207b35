"""Which strokes are worth a look? Continuous strokes at the direct pots, spread evenly over speed and tip, or at given pots and tips.

A pot gets the more strokes, the likelier it is: shares are proportional to chance^4 x worth. The strokes at a pot are consecutive points of
one scrambled Sobol sequence over the logarithm of the speed, the height of the tip and its side; half of them have no side. Where there is
no direct pot, as after a break-off, most strokes are contacts with the balls on that can be struck, from thin to full on both sides, and
every eighth goes in any direction; most of them are hard, since a ball then goes in by chance more often.
"""

from math import asin, atan2, cos, erf, exp, hypot, log, pi, sin, sqrt
from typing import NamedTuple

import numpy as np

from .._jit import entry, kernel
from .._types import Floats, Ints
from ..game.balls import N_BALLS, VALUES, balls_on_kernel, bits
from ..game.frame_columns import BALL_ON
from ..game.pots import GHOST_X, GHOST_Y, POT_BALL, POT_COLUMNS, POT_POCKET, TOLERANCE, find_pots
from ..geometry import AIM_X, AIM_Y, BALL_RADIUS, POCKET_AIMS
from ..tasks.arrays import Law
from ..tasks.box_actions import MAX_SPEED
from ..tasks.lines import new_work
from ..tasks.pot_aim import solved_aim
from .positions import Positions
from .prospects import FAR, FOLLOWS
from .sobol import sobol
from .strokes import Dynamics

SLOWEST, FASTEST = 0.8, 6.5
"""Cue speeds of the proposals at pots [m/s]."""
HIGHEST, WIDEST = 0.45, 0.35
"""Largest tip offsets over R, up or down and to a side; a corner is drawn in to the disc of radius ``RIM``."""
PLAIN = 0.5
"""Share of the strokes without side."""
RIM = 0.49
LOST = 0.01
"""Decay of a stroke's chance per metre of both balls' paths [1/m]: the width alone nearly says what errors leave of a pot."""
POWER = 4.0
"""Power of the chance in a pot's share of the strokes."""
ANYWHERE, TRIES = 8, 16
"""Of the strokes without a pot every ``ANYWHERE``-th goes in any direction; for each other one contacts are tried, at most ``TRIES``, until
no other ball is in the way."""
MOST_POTS = 16
"""Number of pots that strokes are shared among, the widest ones."""
SPEED, SIDE, TOP, AIM = range(4)
"""Columns of a stroke."""


class Proposals(NamedTuple):
    """m strokes for each of n positions, which a ``StrokeSearch`` then tries.

    Attributes
    ----------
    strokes : numpy.ndarray
        float64 (n, m, 4). Cue speed [m/s], side and top (tip offset over R), direction of the cue ball [rad].
    chances : numpy.ndarray
        float64 (n, m). Chance of each stroke's pot by its width; 1 for a contact without a pot.

    Examples
    --------
    >>> import numpy as np
    >>> from snooker_env.planning import Proposals
    >>> Proposals(np.zeros((2, 5, 4)), np.ones((2, 5))).chances.shape
    (2, 5)
    """

    strokes: Floats
    chances: Floats


@kernel
def pot_chance(positions, found, spread, far):
    """Chance of a pot by its width: the aim's error stays within the tolerance. ``far`` [1/m]: loss per metre of both balls' paths."""
    ball, pocket = int(found[POT_BALL]), int(found[POT_POCKET])
    path = hypot(found[GHOST_X] - positions[0, 0], found[GHOST_Y] - positions[0, 1])
    run = hypot(POCKET_AIMS[pocket, AIM_X] - positions[ball, 0], POCKET_AIMS[pocket, AIM_Y] - positions[ball, 1])
    return erf(found[TOLERANCE] / (spread * sqrt(2.0))) * exp(-far * (path + run))


@kernel
def _tip_on_rim(stroke):
    far = hypot(stroke[TOP], stroke[SIDE])
    if far > RIM:
        stroke[TOP] *= RIM / far
        stroke[SIDE] *= RIM / far


@kernel
def _spread_stroke(i, seed, stroke):
    """Stroke i of a pot: speed, side and top from a Sobol point."""
    stroke[SPEED] = SLOWEST * exp(log(FASTEST / SLOWEST) * sobol(i, 0, seed))
    stroke[TOP] = HIGHEST * (2.0 * sobol(i, 1, seed) - 1.0)
    u = (sobol(i, 2, seed) - PLAIN) / (1.0 - PLAIN)
    stroke[SIDE] = 0.0 if u < 0.0 else WIDEST * (2.0 * u - 1.0)
    _tip_on_rim(stroke)


@kernel
def _struck_first(positions, on_table, ux, uy):
    """Id of the ball that the cue ball meets first on a straight line in the direction (ux, uy); 0 if none."""
    first, nearest = 0, 1e9
    for b in range(1, N_BALLS):
        if not on_table[b]:
            continue
        x, y = positions[b, 0] - positions[0, 0], positions[b, 1] - positions[0, 1]
        along, across = x * ux + y * uy, ux * y - uy * x
        if along > 0.0 and abs(across) < 2.0 * BALL_RADIUS:
            far = along - sqrt(4.0 * BALL_RADIUS**2 - across**2)
            if far < nearest:
                first, nearest = b, far
    return first


@kernel
def _towards(positions, on_table, on, which, turned):
    """Direction of a contact with the ball on number ``which``: full at ``turned`` = 0, a graze at -1 and 1."""
    for ball in range(1, N_BALLS):
        if on_table[ball] and (on >> ball) & 1:
            if which == 0:
                x, y = positions[ball, 0] - positions[0, 0], positions[ball, 1] - positions[0, 1]
                return atan2(y, x) + asin(min(1.0, 2.0 * BALL_RADIUS / hypot(x, y))) * turned
            which -= 1
    return 0.0


@kernel
def _contacts(positions, on_table, on, seed, strokes, chances):
    """Fill the strokes (m, 4) with contacts at the balls on that can be struck, from thin to full, and with strokes in any direction."""
    count = 0
    for ball in range(1, N_BALLS):
        count += on_table[ball] and (on >> ball) & 1
    tried = 0
    for i in range(len(strokes)):
        anywhere = i % ANYWHERE == 0  # two sequences: every n-th point of one would fill a part of the cube only
        k, own = (i // ANYWHERE, seed ^ 0xA5A5) if anywhere else (i - i // ANYWHERE - 1, seed)
        _spread_stroke(k, own, strokes[i])
        strokes[i, SPEED] = max(SLOWEST, MAX_SPEED * sobol(k, 0, own) ** (1.0 / 3.0))  # few balls go in by chance unless the stroke is hard
        strokes[i, AIM] = pi * (2.0 * sobol(k, 4, own) - 1.0)
        chances[i] = 1.0
        for _ in range(0 if anywhere else TRIES):
            aim = _towards(positions, on_table, on, min(count - 1, int(sobol(tried, 3, seed) * count)), 2.0 * sobol(tried, 4, seed) - 1.0)
            tried += 1
            if (on >> _struck_first(positions, on_table, cos(aim), sin(aim))) & 1:
                strokes[i, AIM] = aim
                break


@kernel
def _aim(stroke, positions, pot, law, work):
    """Solve the aim of a stroke at a pot."""
    pocket, ghost = int(pot[POT_POCKET]), (pot[GHOST_X], pot[GHOST_Y])
    target, level = (POCKET_AIMS[pocket, AIM_X], POCKET_AIMS[pocket, AIM_Y]), 0.0
    played = stroke[SPEED], stroke[SIDE], stroke[TOP], level
    stroke[AIM] = solved_aim(positions, int(pot[POT_BALL]), target, ghost, played, law, work)


@entry(what="the proposals of strokes", seconds=2, uses=(solved_aim,))
def _propose(positions, on_table, game, seeds, which, spread, phys, end_mass_ratio, fidelity, n_steps, strokes, chances):
    """Fill strokes (n, m, 4) and chances (n, m) of n positions.

    ``which`` (n, m): at which pot each stroke is, widest first, its speed and tip being given; without rows, all are spread.
    """
    found, weights = np.empty((MOST_POTS, POT_COLUMNS)), np.empty(MOST_POTS)
    law, work = Law(phys, end_mass_ratio, fidelity, n_steps), new_work()
    m = strokes.shape[1]
    for k in range(len(strokes)):
        p, here, seed = positions[k], on_table[k], seeds[k]
        on = balls_on_kernel(game[k, BALL_ON], bits(here))
        many = find_pots(p, here, on, BALL_RADIUS, found)
        if many == 0:
            _contacts(p, here, on, seed, strokes[k], chances[k])
            continue
        total = 0.0
        for j in range(many):
            weights[j] = pot_chance(p, found[j], spread, FAR) ** POWER * (VALUES[int(found[j, POT_BALL])] + FOLLOWS) + 1e-12
            total += weights[j]
        j, reached = 0, weights[0] / total
        for i in range(m):
            if which.shape[0]:
                j = min(which[k, i], many - 1)
                _tip_on_rim(strokes[k, i])
            else:
                while j < many - 1 and i >= int(m * reached + 0.5):
                    j += 1
                    reached += weights[j] / total
                _spread_stroke(i, seed, strokes[k, i])
            _aim(strokes[k, i], p, found[j], law, work)
            chances[k, i] = pot_chance(p, found[j], spread, LOST)


_NOT_GIVEN = np.empty((0, 0), np.int64)


def spread_strokes(at: Positions, m: int, seeds: Ints, spread: float, dynamics: Dynamics) -> Proposals:
    """Propose m strokes for each of n positions, spread over all direct pots, speeds and tips.

    Parameters
    ----------
    at : Positions
        The n positions.
    m : int
        Number of strokes for each.
    seeds : numpy.ndarray
        int64 (n,), in [0, 2**32): of the Sobol scrambles.
    spread : float
        Standard deviation of the cue ball's direction [rad], as returned by ``spread_of``.
    dynamics : tuple
        Physics and fidelity with which the aims are solved: ``StrokeSearch.dynamics``.

    Returns
    -------
    Proposals
        The strokes and the chances of their pots.

    Examples
    --------
    >>> import numpy as np
    >>> from snooker_env.planning import Position, Positions, StrokeSearch, spread_strokes
    >>> search, at = StrokeSearch({"noise": "club"}), Positions.of(Position(cue=(0.0, 0.9), black=(0.4, 1.3)))
    >>> spread_strokes(at, 5, np.array([7]), search.spread, search.dynamics).strokes.shape
    (1, 5, 4)
    """
    return _proposed(at, np.empty((len(at), m, 4)), seeds, _NOT_GIVEN, spread, dynamics)


def strokes_at(at: Positions, which: Ints, speeds_and_tips: Floats, seeds: Ints, spread: float, dynamics: Dynamics) -> Proposals:
    """Propose strokes at given pots with given speeds and tips; their aims are solved.

    Where there is no direct pot, the strokes are the contacts of ``spread_strokes``.

    Parameters
    ----------
    at : Positions
        The n positions.
    which : numpy.ndarray
        int64 (n, m). Index of each stroke's pot, widest first as of ``pots``; beyond the last pot, the last one.
    speeds_and_tips : numpy.ndarray
        float64 (n, m, 3). Cue speed [m/s], side and top (tip offset over R). A tip outside the disc of radius 0.49 is drawn in to it.
    seeds, spread, dynamics
        As for ``spread_strokes``.

    Returns
    -------
    Proposals
        The strokes and the chances of their pots.

    Examples
    --------
    >>> import numpy as np
    >>> from snooker_env.planning import Position, Positions, StrokeSearch, strokes_at
    >>> search, at = StrokeSearch({"noise": "club"}), Positions.of(Position(cue=(0.0, 0.9), black=(0.4, 1.3)))
    >>> given = np.array([[[2.0, 0.0, 0.2], [2.0, 0.0, -0.9]]])
    >>> strokes_at(at, np.zeros((1, 2), int), given, np.array([7]), search.spread, search.dynamics).strokes[0, :, :3].tolist()
    [[2.0, 0.0, 0.2], [2.0, 0.0, -0.49]]
    """
    n, m = which.shape
    strokes = np.empty((n, m, 4))
    strokes[..., :AIM] = speeds_and_tips
    return _proposed(at, strokes, seeds, np.ascontiguousarray(which, np.int64), spread, dynamics)


def _proposed(at, strokes, seeds, which, spread, dynamics):
    physics, (code, n_steps) = dynamics
    chances = np.empty(strokes.shape[:2])
    keys = np.asarray(seeds, np.int64)
    _propose(
        at.positions, at.on_table, at.game, keys, which, spread, physics.pack(), physics.end_mass_ratio, code, n_steps, strokes, chances
    )  # fmt: skip
    return Proposals(strokes, chances)
