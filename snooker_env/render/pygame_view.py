"""How is a scene drawn as a picture? From above like on television, baulk left and black right, with pygame-ce.

Pictures need no display and leave pygame's display alone; only ``Window`` opens one. The table is drawn once for each size, as are the
balls for each quarter of a pixel and the pieces of paths, so that a frame is a copy of the table with a few small pictures on it.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._types import Floats, Vector, Vectors
from ..physics.table import Table, TableLike
from .palette import PALE, PALETTE
from .pygame_balls import draw_balls, outline_of_a_ball
from .pygame_bar import score_bar
from .pygame_library import pygame_
from .pygame_lines import draw_lines, line_width
from .scene import Scene
from .table_picture import table_picture
from .view import SIZE, View

__all__ = ["SIZE", "View", "draw", "rgb_array", "to_pixels"]


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


def draw(scene: Scene, view: View) -> NDArray[np.uint8]:
    """``rgb_array`` where the view is known.

    Parameters
    ----------
    scene : Scene
    view : View
        Of its table.

    Returns
    -------
    uint8 (height, width, 3)
    """
    pixels = table_picture(scene.table, view).copy()
    surface: Any = pygame_().image.frombuffer(pixels, (view.width, view.height), "RGB")  # draws into ``pixels``
    surface.set_clip((0, 0, view.width, view.height - view.bar))
    width = line_width(view.scale)
    draw_lines(surface, [(view(points), tuple(PALE[ball].tolist())) for ball, points in scene.paths.items()], width)
    if scene.aim is not None:
        draw_lines(surface, [(view(scene.aim), PALETTE["aim"])], 0.8 * width)
    if scene.ghost is not None:
        draw_lines(surface, [(view(outline_of_a_ball(scene.ghost, scene.ball_radius)), PALETTE["aim"])], 0.6 * width)
    draw_balls(surface, scene, view)
    surface.set_clip(None)
    if scene.bar is not None or scene.text:
        surface.blit(score_bar(scene.bar, scene.text, view.width, view.bar), (0, view.height - view.bar))
    return pixels
