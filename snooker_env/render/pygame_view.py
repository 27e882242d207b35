"""How is a scene drawn as a picture? With pygame-ce, without a display; only ``Window`` opens one."""

import numpy as np
from numpy.typing import NDArray

from .._types import Floats, Vector, Vectors
from ..physics.table import Table, TableLike
from .pygame_library import pygame_
from .pygame_picture import draw
from .scene import Scene
from .view import SIZE as SIZE
from .view import View as View
from .window import Window as Window


def to_pixels(
    points: Vector | Vectors,
    height: int | None = None,
    table: TableLike = "match",
    *,
    size: tuple[int, int] | None = None,
) -> Floats:
    """Columns and rows [pixels] of points (..., 2) [m] in a picture of ``rgb_array`` of that size."""
    return View.of(Table.of(table), height, size)(np.asarray(points, dtype=np.float64))


def rgb_array(
    scene: Scene, height: int | None = None, *, size: tuple[int, int] | None = None
) -> NDArray[np.uint8]:
    """The picture of a scene, uint8 (height, width, 3), of a size, or a height that gives the width."""
    pygame_()
    return draw(scene, View.of(scene.table, height, size))
