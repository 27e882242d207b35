"""How is a scene drawn in a terminal? From above in characters, baulk left and black right. A ball is a
letter in the cell of its centre (N brown, K black), several reds are their number; the cue ball is never
hidden, and a line below the table names the balls that others cover."""

from itertools import pairwise
from textwrap import wrap

import numpy as np

from ..geometry import COLOUR_SPOTS
from .palette import LETTERS
from .scene import BAULK_LINE, D_ARC, Scene, extent, has_lines

WIDTH = 100  # characters a line
_LEGEND = "W=cue  r=red (digit: several)  Y=yellow G=green N=brown B=blue P=pink K=black"
_LINE, _ARC, _SPOT, _PATH, _POCKET = "│", "·", "+", ".", "O"


class _Grid:
    """Characters on a table of n columns, whose cells are about twice as high as wide, and a rail of one cell around them."""

    def __init__(self, columns, table):
        self.low, self.high = extent(table).T
        width, length = self.high - self.low
        # rows are odd, so that blue, brown, pink and black have one of their own
        self.shape = np.array([min(max(9, round(columns * width / length / 2)), 400) | 1, columns])
        self.cells, self.step = np.full(self.shape + 2, " "), length / columns / 2
        if len(table.noses):
            self.cells[[0, -1]], self.cells[:, [0, -1]] = "═", "║"
            self.cells[[0, 0, -1, -1], [0, -1, 0, -1]] = list("╔╗╚╝")
        for x, y, _ in table.falls:
            row, column = (-int(far > 0.5) for far in ((x, y) - self.low) / (width, length))
            for end in (y - 1e-3, y + 1e-3):  # two cells where the middle falls between them
                inside = self.low[1] < end < self.high[1]
                self.cells[row, self.cell((x, end))[1] if inside else column] = _POCKET

    def cell(self, point):
        """Row and column of a point [m]: those of a rail beyond the noses."""
        part = (point - self.low) / (self.high - self.low)
        return tuple((np.floor(part * self.shape) - (part == 1.0)).astype(int).clip(-1, self.shape) + 1)

    def line(self, points, character):
        """A polyline, drawn by points closer than the cells, without what is beyond the noses."""
        for a, b in pairwise(points):
            for part in np.linspace(0.0, 1.0, 2 + int(np.hypot(*(b - a)) / self.step)):
                row, column = self.cell(a + part * (b - a))
                if 0 < row <= self.shape[0] and 0 < column <= self.shape[1]:
                    self.cells[row, column] = character


def ansi(scene: Scene) -> str:
    """The scene as lines of text, with status and legend."""
    grid = _Grid(WIDTH - 2, scene.table)
    if has_lines(scene.table):
        grid.line(BAULK_LINE, _LINE)
        grid.line(D_ARC, _ARC)
        for spot in COLOUR_SPOTS:
            grid.cells[grid.cell(spot)] = _SPOT
    for points in scene.paths.values():
        grid.line(points, _PATH)
    hidden = _balls(grid, scene)
    lines = ["".join(row) for row in grid.cells.tolist()]
    if scene.text:
        lines.append(scene.text)
    lines += wrap(_LEGEND, WIDTH)
    if hidden:
        lines.append("hidden: " + ", ".join(hidden))
    return "\n".join(lines)


def _balls(grid, scene):
    """Put the balls' letters on the grid. Returns the balls that have no cell of their own, as "r under W"."""
    shared, hidden = {}, []
    for ball, point in zip(scene.ids.tolist(), scene.positions, strict=True):
        shared.setdefault(grid.cell(point.clip(grid.low, grid.high)), []).append(ball)
    for at, balls in shared.items():
        top = min(balls, key=lambda ball: (ball != 0, -ball))  # the cue ball, else the most valuable
        under = "".join(LETTERS[ball] for ball in balls if ball != top)
        grid.cells[at] = LETTERS[top]
        if LETTERS[top] == "r" and under:
            grid.cells[at] = str(len(balls)) if len(balls) < 10 else "*"
        elif under:
            hidden.append(f"{under} under {LETTERS[top]}")
    return hidden
