"""Which strokes does ``action="strokes"`` choose from? A menu of complete strokes for the position: the lines of ``lines``,
up to ``POTS`` direct pots or, where there is none, others, each at every speed and height of the tip. The aim is solved for the stroke."""

import numpy as np
from gymnasium import spaces

from .._lib.jit import entry, kernel
from .._lib.types import Floats
from ..game.balls import bits
from ..game.frame_columns import strikeable
from ..game.pots import POT_COLUMNS
from ..physics.cue import squirt
from .declarations import A_DISCRETE, MENU
from .discrete_actions import Choices
from .lines import LINE_ROWS, POTS, aim_on, count_lines, list_lines

SPEEDS = tuple(round(1.1 * (4.2 / 1.1) ** (k / 4), 2) for k in range(5))
"""The cue speeds to choose from [m/s]: from 1.1 to 4.2 in equal ratios."""
TOPS = (-0.35, 0.0, 0.35)
"""The tip offsets to choose from, over R, upwards."""
STROKES = len(SPEEDS) * len(TOPS)
"""Strokes along each line: speeds x heights of the tip."""
MENU_SIZE = POTS * STROKES
"""Strokes on the menu."""


@kernel
def stroke_of(index):
    """(line, speed, height) of the stroke ``index`` of a menu: the last two are indices of ``SPEEDS`` and ``TOPS``."""
    along = index % STROKES
    return index // STROKES, along // len(TOPS), along % len(TOPS)


@kernel(seconds=1, uses=(aim_on,))
def solve_menu_stroke(index, positions, on_table, on, law, work):
    """(speed, side, top, aim, elevation) of the stroke ``index``, as ``box_actions.shot_of``; a line that is not there is
    the nearest that is."""
    line, at, height = stroke_of(index)
    many, pots = list_lines(positions, on_table, on, work.lines)
    stroke = SPEEDS[at], 0.0, TOPS[height], 0.0
    aim = aim_on(min(line, many - 1), pots, stroke, positions, on_table, on, law, work)
    return stroke[0], 0.0, stroke[2], aim - squirt(0.0, law.end_mass_ratio), 0.0


@entry
def menu_masks(which, positions, on_table, game, out):
    """Which strokes are on the menus of the tables ``which``: bool, one row of ``out`` (MENU_SIZE,) each."""
    rows = np.empty((LINE_ROWS, POT_COLUMNS))
    for j in range(which.shape[0]):
        k, many = which[j], 1
        if on_table[k, 0]:
            many = count_lines(positions[k], on_table[k], strikeable(game[k], bits(on_table[k])), rows)
        for c in range(MENU_SIZE):
            out[j, c] = c < STROKES * many


class Menu(Choices):
    """The action space of a menu: (line * 5 + speed) * 3 + height, of which those on the menu mean a stroke each, the others the
    same stroke along the last line that is there."""

    def __init__(self) -> None:
        super().__init__()
        self.choices = MENU_SIZE
        self.space = spaces.Discrete(self.choices)

    def pack(self) -> Floats:
        """The options for the kernels, in the columns ``A_*`` of ``declarations``."""
        packed = super().pack()
        packed[A_DISCRETE] = MENU
        return packed
