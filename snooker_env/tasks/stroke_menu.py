"""Which strokes does ``action="strokes"`` choose from? A menu of complete strokes for the position: along up to ``POTS`` direct
pots or, where there is none, other ``lines``, at every speed and height of the tip. In frames safeties follow, along lines of
their own, and the decisions after a foul. The aim is solved for the stroke."""

import numpy as np
from gymnasium import spaces

from .._lib.jit import entry, kernel
from .._lib.types import Floats
from ..game import frame_columns as columns
from ..game.balls import bits
from ..game.pots import POT_COLUMNS
from ..physics.cue import squirt
from .declarations import A_DECISION, A_DISCRETE, FRAME_STROKES, MENU, MENU_STROKES
from .discrete_actions import Choices
from .lines import (
    LINE_ROWS,
    POTS,
    SAFE_LINES,
    aim_along,
    aim_on,
    break_off,
    count_lines,
    end_red_of_rack,
    find_safe_lines,
    list_lines,
)

SPEEDS = tuple(round(1.1 * (4.2 / 1.1) ** (k / 4), 2) for k in range(5))
"""The cue speeds at pots [m/s]: from 1.1 to 4.2 in equal ratios."""
TOPS = (-0.35, 0.0, 0.35)
"""The tip offsets at pots, over R, upwards."""
ALONG = len(SPEEDS) * len(TOPS)
"""Strokes along each pot: speeds x heights of the tip."""
SAFE_SPEEDS, SAFE_TOPS = (0.8, 1.4, 2.2, 3.4), (-0.3, 0.15)
"""The same of safeties."""
SAFE_ALONG = len(SAFE_SPEEDS) * len(SAFE_TOPS)
assert MENU_STROKES == POTS * ALONG and FRAME_STROKES == MENU_STROKES + SAFE_LINES * SAFE_ALONG
DECISIONS = 2
"""Choices after the strokes of a frame: the offender plays again; from the position before, or the striker from anywhere."""
MENU_SIZES = MENU_STROKES, FRAME_STROKES + DECISIONS
"""Choices of a visit, and of a frame."""


@kernel
def menu_stroke(index):
    """(line, speed, side, top) of the stroke ``index`` of a menu."""
    if index < MENU_STROKES:
        along = index % ALONG
        return index // ALONG, SPEEDS[along // len(TOPS)], 0.0, TOPS[along % len(TOPS)]
    safety = index - MENU_STROKES
    along = safety % SAFE_ALONG
    return safety // SAFE_ALONG, SAFE_SPEEDS[along // len(SAFE_TOPS)], 0.0, SAFE_TOPS[along % len(SAFE_TOPS)]


@kernel
def breaks_off(index, end_red):
    """Whether the stroke ``index`` is the break-off, which stands in the place of the first safety."""
    return index == MENU_STROKES and end_red > 0


@kernel(seconds=1, uses=(aim_along,))
def safe_stroke(index, end_red, lines, positions, on_table, on, law, work):
    """(speed, side, top, direction) of the safety ``index``, along rows of ``find_safe_lines``."""
    if breaks_off(index, end_red):
        return break_off(positions, end_red)
    line, speed, side, top = menu_stroke(index)
    aim = aim_along(lines[line], (speed, side, top, 0.0), positions, on_table, on, law, work)
    return speed, side, top, aim


@kernel(seconds=1, uses=(aim_on, safe_stroke))
def solve_menu_stroke(index, positions, on_table, on, law, work):
    """(speed, side, top, aim, elevation) of the choice ``index``, as ``box_actions.shot_of``; one that is not there is the same
    stroke along the last line that is, a decision the last stroke."""
    index = min(index, FRAME_STROKES - 1)
    line, speed, side, top = menu_stroke(index)
    if index < MENU_STROKES:
        many, pots = list_lines(positions, on_table, on, work.lines)
        stroke = speed, side, top, 0.0
        aim = aim_on(min(line, many - 1), pots, stroke, positions, on_table, on, law, work)
    else:
        many = find_safe_lines(positions, on_table, on, work.lines)
        index -= max(0, line - many + 1) * SAFE_ALONG
        end_red = end_red_of_rack(positions, on_table)
        speed, side, top, aim = safe_stroke(index, end_red, work.lines, positions, on_table, on, law, work)
    return speed, side, top, aim - squirt(side, law.end_mass_ratio), 0.0


@kernel
def decisions_of(row, rules):
    """Which of the ``DECISIONS`` the striker of a frame may choose now."""
    asked = row.shape[0] > columns.PHASE and row[columns.PHASE] == columns.CHOICE
    return asked, asked and columns.allowed_choice(row, columns.REPLACE, rules) != columns.PLAY


@entry(what="the menus of strokes", seconds=1)
def menu_masks(which, positions, on_table, game, rules, out):
    """What is on the menus of the tables ``which``: bool, one row of ``out`` each; ``rules``: the code of the rule set."""
    rows = np.empty((LINE_ROWS, POT_COLUMNS))
    for j in range(which.shape[0]):
        k, many, safe = which[j], 1, 1
        p, here = positions[k], on_table[k]
        on = columns.strikeable(game[k], bits(here))
        if here[0]:
            many = count_lines(p, here, on, rows)
            if out.shape[1] > MENU_STROKES:
                safe = find_safe_lines(p, here, on, rows)
        for c in range(out.shape[1]):
            out[j, c] = c < ALONG * many if c < MENU_STROKES else c < MENU_STROKES + SAFE_ALONG * safe
        if out.shape[1] > FRAME_STROKES:
            out[j, FRAME_STROKES], out[j, FRAME_STROKES + 1] = decisions_of(game[k], rules)


class Menu(Choices):
    """The action space of a menu: (line * 5 + speed) * 3 + height; of a frame then 60 + (line * 4 + speed) * 2 + height for
    safeties, and the decisions. What is not there is played as the same stroke along the last line that is."""

    def __init__(self, *, frame: bool = False) -> None:
        super().__init__()
        self.frame = frame
        self.choices = MENU_SIZES[frame]
        self.space = spaces.Discrete(self.choices)

    def pack(self) -> Floats:
        """The options for the kernels, in the columns ``A_*`` of ``declarations``."""
        packed = super().pack()
        packed[A_DISCRETE], packed[A_DECISION] = MENU, 0 if self.frame else -1
        return packed
