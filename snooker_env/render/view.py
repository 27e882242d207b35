"""How do metres map to pixels? The table in the middle, +y to the right and +x down, the score bar below."""

from typing import NamedTuple

import numpy as np

from .._check import integer, refuse
from .._types import Floats
from ..physics.table import Table
from .outline import RAIL, extent

SIZE = (1920, 1080)
"""Default width and height of a picture [pixels]."""

_MARGIN = 0.012  # floor shown around the rails [m]
_BAR = 1 / 15  # part of the height for the score bar
_LONGEST = 8.0  # largest width over height, for a width that follows from the table
_LEAST, _MOST = 100, 8192


class View(NamedTuple):
    """A picture of a table."""

    width: int
    height: int
    bar: int  # rows of the score bar, at the bottom
    scale: float  # pixels per metre
    x: float  # column of the origin
    y: float  # row of the origin

    @classmethod
    def of(cls, table: Table, height: int | None = None, size: tuple[int, int] | None = None) -> "View":
        """``size`` (width, height): as large as fits; ``height``: that table's width; neither: ``SIZE``."""
        low, high = extent(table).T
        (tall, wide), (middle_x, middle_y) = high - low + 2 * (RAIL + _MARGIN), (low + high) / 2
        if height is not None and size is not None:
            raise refuse("size", size, "must be None where height is given")
        if height is not None:
            height = integer("height", height, _LEAST, 4320)
            bar = round(_BAR * height)
            scale = min((height - bar) / tall, _LONGEST * height / wide)
            width = 2 * round(scale * wide / 2)  # even, for video encoders
        else:
            width, height = _checked(SIZE if size is None else size)
            bar = round(_BAR * min(height, width * SIZE[1] / SIZE[0]))
            scale = min((height - bar) / tall, width / wide)
        x, y = width / 2 - scale * middle_y, (height - bar) / 2 - scale * middle_x
        return cls(width, height, bar, float(scale), float(x), float(y))

    def __call__(self, points: Floats) -> Floats:
        """Column and row of points (..., 2) [m]."""
        points = np.asarray(points, dtype=np.float64)
        return np.stack([self.x + self.scale * points[..., 1], self.y + self.scale * points[..., 0]], axis=-1)

    def metres(self, pixel: tuple[float, float]) -> Floats:
        """The point (2,) [m] at a column and row."""
        return np.array([(pixel[1] - self.y) / self.scale, (pixel[0] - self.x) / self.scale])


def _checked(size):
    if isinstance(size, str) or not hasattr(size, "__len__") or len(size) != 2:
        raise refuse("size", size, "must be (width, height)")
    return integer("size", size[0], _LEAST, _MOST), integer("size", size[1], _LEAST, _MOST)
