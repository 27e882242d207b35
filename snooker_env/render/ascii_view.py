"""How is a scene drawn in a terminal? From above in characters, baulk left and black right. A ball is a
letter in the cell of its centre (N brown, K black), several reds are their number; the cue ball is never
hidden, and a line below the table names the balls that others cover."""

from itertools import pairwise
from textwrap import wrap

import numpy as np

from ..geometry import COLOUR_SPOTS
from .outline import BAULK_LINE, D_ARC, extent, has_lines
from .palette import LETTERS
from .scene import Scene

WIDTH = 100  # characters a line
_LEGEND = "W=cue  r=red (digit: several)  Y=yellow G=green N=brown B=blue P=pink K=black"
_LINE, _ARC, _SPOT, _PATH, _POCKET = "│", "·", "+", ".", "O"


class _Grid:
    """Characters on a table, ``columns`` by ``rows`` cells, each about twice as high as wide."""

    def __init__(self, columns, table):
        (self.left, self.right), (self.low, self.high) = extent(table).tolist()
        self.columns = columns
        rows = round(columns * (self.right - self.left) / (self.high - self.low) / 2)
        # odd, so that blue, brown, pink and black have a row of their own
        self.rows = min(max(9, rows), 400) | 1
        self.cells = np.full((self.rows, columns), " ")

    def cell(self, point):
        """Row and column of a point [m], or None if it lies outside the noses."""
        x, y = point
        if not (self.left <= x <= self.right and self.low <= y <= self.high):
            return None
        row, column = (x - self.left) / (self.right - self.left), (y - self.low) / (self.high - self.low)
        return min(int(row * self.rows), self.rows - 1), min(int(column * self.columns), self.columns - 1)

    def mark(self, point, character):
        if (at := self.cell(point)) is not None:
            self.cells[at] = character

    def line(self, points, character):
        """A polyline, drawn by points closer than the cells."""
        step = (self.high - self.low) / self.columns / 2
        for a, b in pairwise(points):
            for part in np.linspace(0.0, 1.0, 2 + int(np.hypot(*(b - a)) / step)):
                self.mark(a + part * (b - a), character)


def ansi(scene: Scene) -> str:
    """The scene as lines of text, with status and legend."""
    grid = _Grid(WIDTH - 2, scene.table)
    if has_lines(scene.table):
        grid.line(BAULK_LINE, _LINE)
        grid.line(D_ARC, _ARC)
        for spot in COLOUR_SPOTS:
            grid.mark(spot, _SPOT)
    for points in scene.paths.values():
        grid.line(points, _PATH)
    hidden = _balls(grid, scene)
    lines = _frame(grid, scene.table)
    if scene.text:
        lines.append(scene.text)
    lines += wrap(_LEGEND, WIDTH)
    if hidden:
        lines.append("hidden: " + ", ".join(hidden))
    return "\n".join(lines)


def _balls(grid, scene):
    """Put the balls' letters on the grid. Returns the balls that have no cell of their own, as "r under W"."""
    shared = {}
    for ball, point in zip(scene.ids.tolist(), scene.positions, strict=True):
        at = grid.cell(np.clip(point, (grid.left, grid.low), (grid.right, grid.high)))
        shared.setdefault(at, []).append(ball)
    hidden = []
    for at, balls in shared.items():
        top = min(balls, key=lambda ball: (ball != 0, -ball))  # the cue ball, else the most valuable
        under = "".join(LETTERS[ball] for ball in balls if ball != top)
        grid.cells[at] = LETTERS[top]
        if LETTERS[top] == "r" and under:
            grid.cells[at] = str(len(balls)) if len(balls) < 10 else "*"
        elif under:
            hidden.append(f"{under} under {LETTERS[top]}")
    return hidden


def _frame(grid, table):
    """The grid's lines inside the rails, with the pockets in them."""
    side, wall = ("═", "║") if len(table.noses) else (" ", " ")
    rails = [[side] * grid.columns, [side] * grid.columns]
    corners = [" "] * 4 if not len(table.noses) else list("╔╗╚╝")
    middle = (grid.left + grid.right) / 2
    for x, y, _ in table.falls:
        bottom = int(x > middle)
        if grid.low + 1e-3 < y < grid.high - 1e-3:
            for end in (y - 1e-3, y + 1e-3):  # two cells where the middle falls between them
                rails[bottom][grid.cell((middle, end))[1]] = _POCKET
        else:
            corners[2 * bottom + int(y >= grid.high)] = _POCKET
    top, bottom = (corners[2 * k] + "".join(rails[k]) + corners[2 * k + 1] for k in (0, 1))
    return [top, *(wall + "".join(row) + wall for row in grid.cells.tolist()), bottom]
