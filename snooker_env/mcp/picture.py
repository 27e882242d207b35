"""What does a model see of a table? The picture of ``rgb_array`` as a JPEG, the reds with their numbers."""

import io

from .._lib.types import Bools, Floats
from ..game.balls import N_REDS
from ..physics.table import Table
from ..render.pygame_balls import BOLD, pygame_, typeset
from ..render.pygame_view import View, draw
from ..render.scene import scene

SIZE = (1280, 720)  # with the score bar, which is cut off


def draw_jpeg(table: Table, positions: Floats, on_table: Bools) -> tuple[bytes, View]:
    """The JPEG of a table with balls (22, 2) [m], and where its points lie in the picture."""
    one, view, out = scene(table, positions, on_table), View.of(table, SIZE), io.BytesIO()
    pygame = pygame_()
    surface = pygame.image.frombuffer(draw(one, view), SIZE, "RGB")
    for ball, place in zip(one.ids.tolist(), view(one.positions).tolist(), strict=True):
        if 0 < ball <= N_REDS:
            number = typeset(str(ball), (255, 255, 255), 1.6 * one.ball_radius * view.scale, BOLD)
            surface.blit(number, number.get_rect(center=[round(x) for x in place]))
    pygame.image.save(surface.subsurface((0, 0, view.width, view.height - view.bar)), out, "table.jpg")
    return out.getvalue(), view
