"""How is a scene drawn as a picture? From above like on television, baulk left and black right, with pygame-ce.

Pictures need no display and leave pygame's display alone; only ``Window`` opens one.
"""

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
    points: Vector | Vectors, height: int | None = None, table: TableLike = "match", *, size: tuple[int, int] | None = None
) -> Floats:
    """Where points are on a picture: column and row from its top left corner, whole numbers being the pixels' corners.

    Parameters
    ----------
    points : array_like, float (..., 2)
        [m]
    height, size
        Those of the picture, as in ``rgb_array``.
    table : str, Table or None

    Returns
    -------
    float64 (..., 2)
    """
    return View.of(Table.of(table), height, size)(np.asarray(points, dtype=np.float64))


def rgb_array(scene: Scene, height: int | None = None, *, size: tuple[int, int] | None = None) -> NDArray[np.uint8]:
    """The picture of a scene.

    Parameters
    ----------
    scene : Scene
    height : int, optional
        [pixels], 100 to 4320: a picture so high, and as wide as its table asks (an even number of columns).
    size : (int, int), optional
        (width, height) [pixels], each 100 to 8192: the table as large as fits. Without both: ``SIZE``, 1920 x 1080.

    Returns
    -------
    uint8 (height, width, 3)
        Fresh.

    Raises
    ------
    ValueError
        For a size that cannot be.
    ImportError
        Without pygame-ce; the message says what to install.
    """
    pygame_()
    return draw(scene, View.of(scene.table, height, size))
