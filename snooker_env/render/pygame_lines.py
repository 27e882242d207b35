"""How is a ball's path drawn? As a line with a dark edge, smooth at every angle, in kept pieces: a path that
grows changes only at its end. All edges are drawn before all lines, so that no piece darkens its
neighbour."""

from functools import lru_cache
from typing import Any

import numpy as np

from .._types import Floats
from .palette import PALETTE
from .pygame_library import surface_of

_STEP = 3.0
"""Distance between the points of a path [pixels]."""
_POINTS = 16
"""Points in a piece."""
_LONGEST = 1e5  # pixels: a longer path is not drawn


def line_width(scale: float) -> float:
    """Width of a path [pixels] at ``scale`` pixels per metre: 3.4 in a picture of 1920 x 1080."""
    return max(1.5, 0.0072 * scale)


def draw_lines(surface: Any, lines: list[tuple[Floats, tuple[int, int, int]]], width: float) -> None:
    """Draw polylines (points (m, 2) [pixels], colour), later ones on top."""
    for points, colour in lines:
        pieces = list(_pieces(points))
        edge = width + 2 * max(0.9, 0.45 * width)
        surface.fblits([_piece(*piece, PALETTE["path_edge"], edge) for piece in pieces])
        surface.fblits([_piece(*piece, colour, width) for piece in pieces])


def _pieces(points):
    """The pieces of a line: their points, and the cuts (point, direction, or None) that neighbours share."""
    steps = np.hypot(*np.diff(points, axis=0).T)
    run = np.concatenate([[0.0], np.cumsum(steps)])
    moved = np.concatenate([[True], steps > 1e-9])
    run, points = run[moved], points[moved]
    if len(points) < 2 or not run[-1] < _LONGEST:
        return
    at = np.append(np.arange(0.0, run[-1], _STEP), run[-1])
    even = np.stack([np.interp(at, run, points[:, k]) for k in (0, 1)], axis=1)
    cuts = range(_POINTS, len(even) - 1, _POINTS)
    edges = [None, *((*even[k].tolist(), *(even[k + 1] - even[k - 1]).tolist()) for k in cuts), None]
    for k, first in enumerate((0, *cuts)):
        yield tuple(even[first : first + _POINTS + 1].ravel().tolist()), edges[k], edges[k + 1]


@lru_cache(maxsize=4096)
def _piece(numbers, start, end, colour, width):
    """One piece as a picture, and the place of its corner."""
    points = np.array(numbers).reshape(-1, 2)
    chord = points[-1] - points[0]
    off = np.abs((points - points[0]) @ np.array([-chord[1], chord[0]])) / max(np.hypot(*chord), 1e-9)
    if np.max(off) < 0.05:  # straight
        points = points[[0, -1]]
    margin = width / 2 + 1
    low = np.floor(points.min(axis=0) - margin).astype(int)
    high = np.ceil(points.max(axis=0) + margin).astype(int)
    x, y = np.meshgrid(np.arange(low[0], high[0]) + 0.5, np.arange(low[1], high[1]) + 0.5)
    nearest, whose = np.full(x.shape, np.inf), np.zeros(x.shape, int)
    for k, ((ax, ay), (bx, by)) in enumerate(zip(points[:-1].tolist(), points[1:].tolist(), strict=True)):
        dx, dy = bx - ax, by - ay
        part = np.clip(((x - ax) * dx + (y - ay) * dy) / max(dx * dx + dy * dy, 1e-12), 0, 1)
        far = (x - ax - part * dx) ** 2 + (y - ay - part * dy) ** 2
        whose[far < nearest] = k
        np.minimum(nearest, far, out=nearest)
    image = np.empty((*x.shape, 4))
    image[..., :3] = colour
    image[..., 3] = 255 * np.clip(width / 2 + 0.5 - np.sqrt(nearest), 0, 1)
    for cut, segment, side in ((start, 0, -1), (end, len(points) - 2, 1)):
        if cut is not None:
            px, py, dx, dy = cut
            beyond = side * ((x - px) * dx + (y - py) * dy)
            image[..., 3][(whose == segment) & (beyond >= 0 if side > 0 else beyond > 0)] = 0
    return surface_of(image), (int(low[0]), int(low[1]))
