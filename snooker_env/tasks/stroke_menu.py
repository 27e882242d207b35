"""Which strokes does ``action="strokes"`` choose from? A menu: along up to ``POTS`` pots or, where there is none, other ``lines``,
at every speed and height of the tip; in frames then safeties, along lines of their own, and the decisions after a foul."""

import numpy as np
from gymnasium import spaces

from .._lib.jit import entry, kernel
from .._lib.types import Floats
from ..game import frame_columns as columns
from ..game.balls import bits
from ..game.pots import POT_COLUMNS
from ..physics.cue import squirt
from . import lines
from .box_actions import FASTEST, MOST_TOP, SLOWEST
from .declarations import A_DECISION, A_SPEEDS
from .discrete_actions import Choices

SPEEDS = 9
"""Cue speeds along each pot, by default."""
LEAST_SPEEDS, MOST_SPEEDS = 2, 20
TOPS = (-MOST_TOP, 0.0, MOST_TOP)
"""The tip offsets at pots, over R, upwards."""
PER_SPEED = lines.POTS * len(TOPS)  # strokes at pots of each cue speed
SAFE_SPEEDS, SAFE_TOPS = (0.8, 1.4, 2.2, 3.4), (-0.3, 0.15)  # the same of safeties
SAFE_ALONG = len(SAFE_SPEEDS) * len(SAFE_TOPS)
SAFETIES = lines.SAFE_LINES * SAFE_ALONG
DECISIONS = 2
"""Choices after the strokes of a frame: the offender plays again; from the position before, or the striker from anywhere."""


def menu_size(speeds: int, frame: bool) -> int:
    """Choices of a visit or a frame with so many ``speeds`` along each pot."""
    return PER_SPEED * speeds + (SAFETIES + DECISIONS) * frame


def speeds_of(choices: int, frame: bool) -> int:
    """The speeds along each pot on a menu of so many ``choices``; 0: no menu has so many."""
    speeds, rest = divmod(choices - menu_size(0, frame), PER_SPEED)
    return speeds if rest == 0 and LEAST_SPEEDS <= speeds <= MOST_SPEEDS else 0


@kernel
def menu_stroke(index, speeds):
    """(line, speed, side, top) of the stroke ``index`` at pots, with speeds in equal ratios."""
    line, along = index // (speeds * len(TOPS)), index % (speeds * len(TOPS))
    speed = SLOWEST * (FASTEST / SLOWEST) ** ((along // len(TOPS)) / (speeds - 1))
    return line, speed, 0.0, TOPS[along % len(TOPS)]


@kernel
def safe_stroke(safety, end_red, rows, positions, on_table, on, law, work):
    """(speed, side, top, direction) of the ``safety``, along ``rows`` of ``find_lines``; the break-off is the first."""
    if safety == 0 and end_red > 0:
        return lines.break_off(positions, end_red)
    along = safety % SAFE_ALONG
    speed, side, top = SAFE_SPEEDS[along // len(SAFE_TOPS)], 0.0, SAFE_TOPS[along % len(SAFE_TOPS)]
    line = safety // SAFE_ALONG
    aim = lines.aim_along(rows[line], (speed, side, top, 0.0), positions, on_table, on, law, work)
    return speed, side, top, aim


@kernel
def solve_menu_stroke(index, speeds, positions, on_table, on, law, work):
    """(speed, side, top, aim, elevation) of the choice ``index``; of one that is not there, along the last line that is."""
    safety = min(index - speeds * PER_SPEED, SAFETIES - 1)
    if safety < 0:
        line, speed, side, top = menu_stroke(index, speeds)
        many, pots = lines.list_lines(positions, on_table, on, work.lines)
        stroke = speed, side, top, 0.0
        aim = lines.aim_on(min(line, many - 1), pots, stroke, positions, on_table, on, law, work)
    else:
        many = lines.find_lines(positions, on_table, on, work.lines, True)
        safety -= max(0, safety // SAFE_ALONG - many + 1) * SAFE_ALONG
        end_red = lines.end_red_of_rack(positions, on_table)
        speed, side, top, aim = safe_stroke(safety, end_red, work.lines, positions, on_table, on, law, work)
    return speed, side, top, aim - squirt(side, law.end_mass_ratio), 0.0


@kernel
def decisions_of(row, rules):
    """Which of the ``DECISIONS`` the striker of a frame may choose now."""
    asked = row.shape[0] > columns.PHASE and row[columns.PHASE] == columns.CHOICE
    return asked, asked and columns.allowed_choice(row, columns.REPLACE, rules) != columns.PLAY


@entry(what="the menus of strokes", seconds=1)
def menu_masks(which, positions, on_table, game, speeds, rules, out):
    """The strokes on the menus of the tables ``which``: bool, one row of ``out`` each; ``rules``: the code of the rule set."""
    rows, at_pots = np.empty((lines.LINE_ROWS, POT_COLUMNS)), speeds * PER_SPEED
    last = at_pots + SAFETIES
    for j in range(which.shape[0]):
        k, many, safe = which[j], 1, 1
        p, here = positions[k], on_table[k]
        on = columns.strikeable(game[k], bits(here))
        if here[0]:
            many = lines.count_lines(p, here, on, rows)
            if out.shape[1] > at_pots:
                safe = lines.find_lines(p, here, on, rows, True)
        for c in range(out.shape[1]):
            out[j, c] = c < many * speeds * len(TOPS) if c < at_pots else c < at_pots + SAFE_ALONG * safe
        if out.shape[1] > last:
            out[j, last], out[j, last + 1] = decisions_of(game[k], rules)


class Menu(Choices):
    """The action space of a menu: (line * speeds + speed) * 3 + height; of a frame then (line * 4 + speed) * 2 + height for
    safeties, and the decisions. A stroke that is not there is played along the last line that is."""

    def __init__(self, speeds: int = SPEEDS, *, frame: bool = False) -> None:
        super().__init__()
        self.frame: bool = frame
        self.speeds: int = speeds
        self.choices: int = menu_size(speeds, frame)
        self.space: spaces.Discrete[np.int64] = spaces.Discrete(self.choices)

    def pack(self) -> Floats:
        """The options for the kernels, in the columns ``A_*`` of ``declarations``."""
        packed = super().pack()
        packed[A_SPEEDS] = self.speeds
        packed[A_DECISION] = self.choices - DECISIONS if self.frame else -1
        return packed
