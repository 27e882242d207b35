"""How is a scene drawn as a picture? From above as on television, baulk left and black right, with pygame-ce.

Pictures need no display and do not touch pygame's; only ``Window`` opens one.
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
    """The pixels of points: column and row from the top left corner of a picture. Whole numbers are corners of pixels.

    Parameters
    ----------
    points : array_like, float (..., 2)
        Points in the table frame [m].
    height : int, optional
        Height of the picture, as in ``rgb_array`` [pixels].
    table : str, Table or None
        The table of the picture.
    size : (int, int), optional
        Size of the picture, as in ``rgb_array`` [pixels].

    Returns
    -------
    float64 (..., 2)
        Column and row [pixels].

    Raises
    ------
    ValueError
        For a size that is out of range.
    """
    return View.of(Table.of(table), height, size)(np.asarray(points, dtype=np.float64))


def rgb_array(scene: Scene, height: int | None = None, *, size: tuple[int, int] | None = None) -> NDArray[np.uint8]:
    """The picture of a scene.

    Parameters
    ----------
    scene : Scene
        The scene.
    height : int, optional
        Height of the picture [pixels], 100 to 4320. Its width follows from the table, and is even.
    size : (int, int), optional
        Width and height [pixels], each 100 to 8192; the table is drawn as large as fits. With neither argument: ``SIZE``, 1920 x 1080.

    Returns
    -------
    uint8 (height, width, 3)
        The picture, a new array.

    Raises
    ------
    ValueError
        For a size that is out of range, and for both arguments together.
    ImportError
        If pygame-ce is not installed; the message says how to install it.
    """
    pygame_()
    return draw(scene, View.of(scene.table, height, size))
