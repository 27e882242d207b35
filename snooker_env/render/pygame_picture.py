"""How is a picture made? Paths, balls and the score bar are drawn on a copy of the table's kept picture."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .palette import PALE, PALETTE
from .pygame_balls import draw_balls, outline_of_a_ball
from .pygame_bar import score_bar
from .pygame_library import pygame_
from .pygame_lines import draw_lines, line_width
from .scene import Scene
from .table_picture import table_picture
from .view import View


def draw(scene: Scene, view: View) -> NDArray[np.uint8]:
    """The picture of a scene in a view of its table: uint8 (height, width, 3), a new array."""
    pixels = table_picture(scene.table, view).copy()
    # draws into ``pixels``
    surface: Any = pygame_().image.frombuffer(pixels, (view.width, view.height), "RGB")
    surface.set_clip((0, 0, view.width, view.height - view.bar))
    width, aim = line_width(view.scale), PALETTE["aim"]
    lines = [(view(points), tuple(PALE[ball].tolist())) for ball, points in scene.paths.items()]
    draw_lines(surface, lines, width)
    if scene.aim is not None:
        draw_lines(surface, [(view(scene.aim), aim)], 0.8 * width)
    if scene.ghost is not None:
        circle = outline_of_a_ball(scene.ghost, scene.ball_radius)
        draw_lines(surface, [(view(circle), aim)], 0.6 * width)
    draw_balls(surface, scene, view)
    surface.set_clip(None)
    if scene.bar is not None or scene.text:
        surface.blit(score_bar(scene.bar, scene.text, view.width, view.bar), (0, view.height - view.bar))
    return pixels
