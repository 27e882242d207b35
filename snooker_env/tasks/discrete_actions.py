"""Which shots does ``action="discrete"`` choose from? One number means a pot, a speed, a side and a top; the aim is solved
for them, or is the straight line. Without a direct pot other ``lines`` take the pots' places; ``action_masks`` tells."""

from collections.abc import Collection
from math import atan2, cos, sin, sqrt

import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike

from .._lib.check import refuse, refuse_what
from .._lib.jit import entry, kernel
from .._lib.types import Action, Floats
from ..game.balls import N_BALLS, YELLOW, bits
from ..game.frame_columns import strikeable
from ..game.pots import GHOST_X, GHOST_Y, POT_COLUMNS
from ..geometry import BALL_RADIUS
from ..physics.cue import squirt
from ..physics.cue_room import EDGE, EDGE_AXIS, EDGE_LEVEL, EDGE_SIDE, RAIL, STEEPEST, TIP, least_elevation
from . import declarations
from .escapes import LINE_AIM
from .kernel_arrays import C_END_MASS, C_RAILS
from .lines import LINE_ROWS, POTS, aim_on, count_lines, list_lines

SPEEDS = (0.9, 1.3, 1.8, 2.3, 2.9, 3.6, 4.4, 5.3, 6.3)
"""The cue speeds to choose from [m/s]."""
SIDES = (-0.3, 0.0, 0.3)
"""The tip offsets to choose from, over R, to the right."""
TOPS = (-0.4, -0.2, 0.0, 0.2, 0.4)
"""The tip offsets to choose from, over R, upwards."""
STROKES = len(SPEEDS) * len(SIDES) * len(TOPS)
"""Number of strokes at one pot: speeds x sides x tops."""
SIZE = POTS * STROKES
"""Number of strokes to choose from: all choices without options of frames. Public as ``tasks.CHOICES``."""
_NEAR_RAIL, _NEAR_BALL = 0.035, 0.061
"""A real cue need not be steeper than ``STEEPEST`` for what is farther from the cue ball's centre [m]: the nose of a
rail; the centre of a ball."""
_BESIDE = 0.036  # a ball farther from the cue's line is not under a steep cue [m]
_LOW, _ASIDE = TIP - min(TOPS) * BALL_RADIUS + 1e-3, max(SIDES) * BALL_RADIUS
"""The lowest tip's reach below the centre, with 1 mm for the taper and for squirt, which turns the cue, and the tips'
reach to the side [m]."""


def choice_of(pot: int, speed: int, side: int, top: int) -> int:
    """Return the choice with these indices: ((pot * 9 + speed) * 3 + side) * 5 + top.

    Parameters
    ----------
    pot : int
        Index of the pot, widest first, in [0, 4).
    speed, side, top : int
        Indices into ``SPEEDS``, ``SIDES`` and ``TOPS``.

    Returns
    -------
    int
        The choice, in [0, 540). The indices are not checked.

    Examples
    --------
    >>> from snooker_env.tasks import choice_of
    >>> choice_of(0, 4, 1, 2)
    67
    """
    return pot * STROKES + (speed * len(SIDES) + side) * len(TOPS) + top


@kernel
def solve_choice(index, positions, on_table, on, law, work):
    """(speed, side, top, aim, elevation) of choice ``index``, as ``box_actions.shot_of``."""
    # ``declarations`` reads what else the choice says; what may not be said now is played as a stroke
    index = index % SIZE
    pot, stroke = index // STROKES, index % STROKES
    speed = SPEEDS[stroke // (len(SIDES) * len(TOPS))]
    side, top = SIDES[stroke // len(TOPS) % len(SIDES)], TOPS[stroke % len(TOPS)]
    many, pots = list_lines(positions, on_table, on, work.lines)
    played = speed, side, top, 0.0
    aim = aim_on(min(pot, many - 1), pots, played, positions, on_table, on, law, work)
    return speed, side, top, aim - squirt(side, law.end_mass_ratio), 0.0


@kernel
def _lacks_room(positions, on_table, rails, ax, ay):
    """Whether a cue along (ax, ay), any cue if that is (0, 0), may have to be steeper than ``STEEPEST`` over a rail or ball; a
    free cue never. Over a rail: equations of ``cue_room`` at 45 degrees, tan(t) = 1 / sin(phi), solved for the largest D."""
    x, y, near, every = positions[0, 0], positions[0, 1], False, ax == 0.0 and ay == 0.0
    for m in range(0, rails.shape[0], EDGE):
        across, along = (x, ax) if rails[m + EDGE_AXIS] == 0.0 else (y, ay)
        far = rails[m + EDGE_LEVEL] - rails[m + EDGE_SIDE] * across
        if far < _NEAR_RAIL and not near:
            s = 1.0 if every else -rails[m + EDGE_SIDE] * along  # sin(phi)
            reach = _LOW * sqrt(1.0 + s * s) + (RAIL - BALL_RADIUS) * s + _ASIDE * sqrt(max(1.0 - s * s, 0.0))
            near = s > 0.0 and (every or far < reach)
    for i in range(1, N_BALLS if rails.shape[0] else 1):
        dx, dy = positions[i, 0] - x, positions[i, 1] - y
        if on_table[i] and dx * dx + dy * dy < _NEAR_BALL * _NEAR_BALL:
            near = near or (dx * ax + dy * ay <= 0.0 and abs(dx * ay - dy * ax) < _BESIDE)
    return near


@kernel
def _without_room(positions, on_table, cue, rows, pots, many, out):
    """Clear the choices in ``out`` (SIZE,) along ``many`` lines whose cue must be steeper than ``STEEPEST``, unless none were left."""
    rails, x, y, left = cue[C_RAILS:], positions[0, 0], positions[0, 1], 0
    for line in range(many):
        aim = atan2(rows[line, GHOST_Y] - y, rows[line, GHOST_X] - x) if pots else rows[line, LINE_AIM]
        if not _lacks_room(positions, on_table, rails, cos(aim), sin(aim)):
            left += STROKES
            continue
        for s in range(len(SIDES)):
            cue_aim, steep = aim - squirt(SIDES[s], cue[C_END_MASS]), True
            for t in range(len(TOPS)):  # the higher the tip, the lower the cue
                if steep:
                    stroke = SIDES[s], TOPS[t], cue_aim, 0.0
                    steep = least_elevation(stroke, positions, on_table, rails, BALL_RADIUS) > STEEPEST
                left += not steep
                for v in range(len(SPEEDS)):
                    out[line * STROKES + (v * len(SIDES) + s) * len(TOPS) + t] = not steep
    if left == 0:
        for c in range(many * STROKES):
            out[c] = True


@entry
def masks(which, positions, on_table, game, options, cue, out):
    """Available choices on the tables ``which``, of visits or frames: bool, one row of ``out`` each."""
    rows = np.empty((LINE_ROWS, POT_COLUMNS))
    for j in range(which.shape[0]):
        k, parts = which[j], 1 + declarations.COLOURS if options[declarations.A_NOMINATE] >= 0 else 1
        row, mask = game[k], bits(on_table[k])
        for n in range(parts):
            on, available = strikeable(row, mask), True
            if parts > 1:
                ball = declarations.nominated_ball(n, row)
                on = declarations.playable(row, mask, ball)
                available = n == 0 if ball <= 0 else ball == YELLOW + n - 1
            p, here, many, pots = positions[k], on_table[k], 1, False
            chooses = available and here[0]
            crowded = chooses and _lacks_room(p, here, cue[C_RAILS:], 0.0, 0.0)
            if crowded:  # the lines themselves are asked for
                many, pots = list_lines(p, here, on, rows)
            elif chooses:
                many = count_lines(p, here, on, rows)
            for c in range(SIZE):
                out[j, n * SIZE + c] = available and c < STROKES * many
            if crowded:
                _without_room(p, here, cue, rows, pots, many, out[j, n * SIZE : (n + 1) * SIZE])
        at = parts * SIZE
        for what, column in declarations.OPTION_OF:
            if options[column]:
                out[j, at] = declarations.may_declare(what, row)
                at += 1


class Choices:
    """The discrete action space and its meaning: ((pot * 9 + speed) * 3 + side) * 5 + top, see ``choice_of``.
    With "nominate" in ``says``, n * 540 + that: n = 0 nominates nothing, 1 to 6 yellow to black, and the pots are those
    of the ball that is then on. The last choices, as far as they are on: concede, claim, let the other player
    begin after the lot. What may not be said is played as the stroke of the same remainder."""

    size: int = 1
    placement: bool = False
    says: tuple[str, ...]
    declares: bool  # whether the last choices are declarations
    choices: int
    space: "spaces.Discrete[np.int64]"  # evaluated, it would need Gymnasium 1.2.2

    def __init__(self, says: Collection[str] = ()):
        self.says = tuple(name for name in declarations.SAYS if name in says)
        declares = sum(name in says for name in declarations.DECLARES)
        self.choices = SIZE * (1 + declarations.COLOURS * ("nominate" in says)) + declares
        self.declares, self.space = declares > 0, spaces.Discrete(self.choices)

    def check(self, actions: Action | ArrayLike, n: int | None = None) -> Floats:
        """One choice (1,), or those of n tables (n, 1), as float64; ValueError names the first that is none."""
        a = np.asarray(actions)
        whole = a.dtype.kind in "iu"
        if n is None:
            if not whole or a.size != 1 or not 0 <= a.item() < self.choices:
                raise refuse("action", actions, f"must be an integer in [0, {self.choices})")
            return a.astype(np.float64).reshape(1)
        if not whole or a.shape not in ((n,), (n, 1)):
            raise refuse_what("actions", f"array of {a.dtype} and shape {a.shape}", f"must be {n} integers")
        a = a.reshape(n, 1)
        for k in np.flatnonzero((a < 0) | (a >= self.choices))[:1].tolist():
            raise refuse(f"actions[{k}]", int(a[k, 0]), f"must be in [0, {self.choices})")
        return a.astype(np.float64)

    def pack(self) -> Floats:
        """The options for the kernels, in the columns ``A_*`` of ``declarations``."""
        where = 0 if "nominate" in self.says else -1, -1, -1
        declares = (name in self.says for name in declarations.DECLARES)
        return np.array([False, False, False, True, *where, *declares, 0], np.float64)
