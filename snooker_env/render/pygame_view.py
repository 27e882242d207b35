"""How is a scene drawn as a picture? From above like on television, baulk left and black right, with pygame-ce.

Pictures need no display and leave pygame's display alone; only ``Window`` opens one. The table is drawn once for each size, each
ball's picture is computed with exact edges for each quarter of a pixel, so one frame costs a few milliseconds.
"""

import os
from collections.abc import Iterable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._check import integer
from .._types import Floats, Vector, Vectors
from ..physics.table import Table, TableLike
from .palette import PALE
from .scene import BAULK_LINE, CUSHION, D_ARC, RAIL, SPOT_MARKS, Scene, extent, is_marked, outline

HEIGHT = 600
"""Height of a picture [pixels] unless told."""

_MARGIN = 0.02  # floor to be seen around the rails [m]
_STRIP = 0.055  # part of the height for the line of text
_LONGEST = 8.0  # a picture is at most this many times as wide as high
_FINE = 3  # the table is drawn this much larger and smoothed down

_FLOOR, _HOLE, _CUT = (20, 21, 24), (7, 7, 8), (0, 0, 0, 0)
_CLOTH, _CREAM, _EDGE, _CUSHION_TOP, _NOSE = (24, 122, 68), (222, 226, 196), (14, 66, 38), (32, 138, 80), (66, 170, 108)
_WOOD, _WOOD_EDGE, _LEATHER = (112, 56, 28), (62, 29, 14), (58, 38, 27)
_TEXT, _AIM, _GHOST = (228, 228, 222), (255, 240, 150), (235, 245, 235)


def _pygame():
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    try:
        import pygame
    except ImportError as error:
        raise ImportError('pictures need pygame-ce; install it, in a clone of snooker_env, with: pip install -e ".[render]"') from error
    return pygame


class _View(NamedTuple):
    """Where metres lie on a picture of a table: +y to the right, +x down."""

    width: int
    height: int
    scale: float
    """Pixels a metre."""
    x: float
    y: float
    """Pixel of the origin."""

    @classmethod
    def of(cls, height, table):
        height = integer("height", height, 100, 4320)
        strip = round(_STRIP * height)
        (half_width, half_length), (middle_x, middle_y) = _halves(table), extent(table).mean(axis=1)
        scale = (height - strip) / (2 * (half_width + RAIL + _MARGIN))
        scale = min(scale, _LONGEST * height / (2 * (half_length + RAIL + _MARGIN)))
        width = 2 * round(scale * (half_length + RAIL + _MARGIN))  # even, as video encoders want it
        return cls(width, height, scale, width / 2 - scale * middle_y, (height - strip) / 2 - scale * middle_x)

    def __call__(self, points):
        points = np.asarray(points, dtype=np.float64)
        return np.stack([self.x + self.scale * points[..., 1], self.y + self.scale * points[..., 0]], axis=-1)


def _halves(table):
    """Half of what is shown between the rails [m], in x and in y."""
    low, high = extent(table).T
    return ((high - low) / 2).tolist()


def to_pixels(points: Vector | Vectors, height: int = HEIGHT, table: TableLike = "match") -> Floats:
    """Column and row (float, origin at the picture's top left corner) of points (..., 2) [m] on a table's picture of that height."""
    return _View.of(height, Table.of(table))(points)


def rgb_array(scene: Scene, height: int = HEIGHT) -> NDArray[np.uint8]:
    """The picture as a fresh uint8 array (height, width, 3); its width follows from the height and the table, and is even."""
    pygame = _pygame()
    surface = _draw(pygame, scene, _View.of(height, scene.table))
    pixels = np.frombuffer(pygame.image.tobytes(surface, "RGB"), dtype=np.uint8)
    return pixels.reshape(surface.get_height(), surface.get_width(), 3).copy()


class Window:
    """A window on the screen. It opens at the first ``draw``, as wide as that table asks; its close button shuts it until ``close``."""

    def __init__(self, height: int = HEIGHT, title: str = "snooker"):
        self._height, self._title = integer("height", height, 100, 4320), title
        self._screen = None
        self._shut = False

    @property
    def is_open(self) -> bool:
        """False before the first ``draw`` and after the window was closed."""
        return self._screen is not None

    def draw(self, scene: Scene) -> bool:
        """Show one scene. Returns False, and does nothing, once the user has pressed the close button."""
        pygame = _pygame()
        if self._screen is not None and any(event.type == pygame.QUIT for event in pygame.event.get()):
            self.close()
            self._shut = True
        if self._shut:
            return False
        view = _View.of(self._height, scene.table)
        if self._screen is None:
            pygame.display.init()
            pygame.display.set_caption(self._title)
        if self._screen is None or self._screen.get_size() != (view.width, view.height):
            self._screen = pygame.display.set_mode((view.width, view.height))
        self._screen.blit(_draw(pygame, scene, view), (0, 0))
        pygame.display.flip()
        return True

    def play(self, scenes: Iterable[Scene], fps: float = 30.0) -> bool:
        """Show scenes (e.g. of ``shot_scenes``) at ``fps`` pictures a second; stops early, with False, if the window is closed."""
        clock = _pygame().time.Clock()
        for scene in scenes:
            if not self.draw(scene):
                return False
            clock.tick(fps)
        return True

    def close(self) -> None:
        """Close the window, if there is one. A later ``draw`` opens it again."""
        self._shut = False
        if self._screen is not None:
            self._screen = None
            _pygame().display.quit()


def _draw(pygame, scene, view):
    surface = _table(pygame, scene.table, view).copy()
    for ball, points in scene.paths.items():
        _line(pygame, surface, view, points, PALE[ball].tolist())
    if scene.aim is not None:
        _line(pygame, surface, view, scene.aim, _AIM)
    if scene.ghost is not None:
        turn = np.linspace(0.0, 2 * np.pi, 49)
        ring = scene.ghost + scene.ball_radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)
        _line(pygame, surface, view, ring, _GHOST)
    radius = scene.ball_radius * view.scale
    where = view(scene.positions)
    _put(pygame, surface, where + 0.35 * radius, [("shadow", radius)] * len(where))
    _put(pygame, surface, where, [(tuple(colour.tolist()), radius) for colour in scene.colours])
    _text(pygame, surface, view, scene.text)
    return surface


def _line(pygame, surface, view, points, colour):
    if len(points) > 1:
        pygame.draw.aalines(surface, colour, False, (view(points) - 0.5).tolist())  # whole numbers are the middles of pixels here


def _put(pygame, surface, where, what):
    """Blit sprites centred at ``where`` (k, 2), to a quarter of a pixel."""
    quarters = np.rint(np.clip(where, -1e5, 1e5) * 4).astype(int)
    whole, part = quarters // 4, quarters % 4
    for at, (fx, fy), (look, radius) in zip(whole.tolist(), part.tolist(), what, strict=True):
        sprite = _sprite(look, radius, fx, fy)
        half = sprite.shape[0] // 2
        image = pygame.image.frombuffer(sprite, sprite.shape[:2], "RGBA")
        surface.blit(image, (at[0] - half, at[1] - half))


@lru_cache(maxsize=1024)
def _sprite(look, radius, fx, fy):
    """A ball or its shadow as RGBA (n, n, 4); its centre lies fx / 4, fy / 4 pixels right of and below the middle pixel's corner."""
    half = int(np.ceil(1.6 * radius)) + 2
    x, y = np.meshgrid(np.arange(-half, half + 1) + 0.5 - fx / 4, np.arange(-half, half + 1) + 0.5 - fy / 4)
    d = np.hypot(x, y)
    image = np.zeros((2 * half + 1, 2 * half + 1, 4))
    if look == "shadow":
        image[..., 3] = 150 * np.clip((1.35 * radius - d) / (0.7 * radius), 0, 1)
    else:
        light = np.hypot(x + 0.35 * radius, y + 0.4 * radius) / radius  # distance from the lamp's reflection, in radii
        shade = np.clip(1.08 - 0.16 * light**2, 0, 1.1)[..., None]
        gloss = (0.9 * np.clip(1.25 - light / 0.30, 0, 1))[..., None]
        image[..., :3] = (np.array(look) * shade) * (1 - gloss) + 255 * gloss
        image[..., 3] = 255 * np.clip(radius + 0.5 - d, 0, 1)
    return np.ascontiguousarray(np.clip(np.rint(image), 0, 255).astype(np.uint8))


def _text(pygame, surface, view, text):
    if not text:
        return
    if not pygame.font.get_init():
        pygame.font.init()
    strip = round(_STRIP * view.height)
    line = pygame.font.Font(None, max(10, round(0.80 * strip))).render(text, True, _TEXT)
    room = view.width - strip
    if line.get_width() > room:
        line = pygame.transform.smoothscale(line, (int(room), line.get_height()))
    surface.blit(line, line.get_rect(midleft=(strip / 2, view.height - strip / 2)))


@lru_cache(maxsize=8)
def _table(pygame, table, view):
    """Everything that does not move, drawn large and smoothed down. Never drawn on: each frame takes a copy."""
    fine = view._replace(**{name: value * _FINE for name, value in view._asdict().items()})
    size = fine.width, fine.height
    parts, px = outline(table), lambda metres: max(1, round(metres * fine.scale))

    def layer():
        return pygame.Surface(size, pygame.SRCALPHA, 32)

    (low_x, high_x), (low_y, high_y) = extent(table)

    def box(extra):
        (left, top), (right, bottom) = fine((low_x - extra, low_y - extra)), fine((high_x + extra, high_y + extra))
        return pygame.Rect(round(left), round(top), round(right - left), round(bottom - top))

    picture = pygame.Surface(size, 0, 32)
    picture.fill(_FLOOR)
    pygame.draw.rect(picture, _HOLE if parts.cushions else _CLOTH, box(RAIL - 0.03))

    cloth = layer()  # the slate with its cloth, cut out at the falls
    pygame.draw.rect(cloth, _CLOTH, box(CUSHION))
    if is_marked(table):
        pygame.draw.lines(cloth, _CREAM, False, fine(BAULK_LINE).tolist(), px(0.0035))
        pygame.draw.lines(cloth, _CREAM, False, fine(D_ARC).tolist(), px(0.0035))
        for spot in fine(SPOT_MARKS):
            pygame.draw.circle(cloth, _CREAM, spot.tolist(), px(0.006))
    cloth.set_clip(box(RAIL - 0.03))
    for x, y, radius in parts.falls:
        pygame.draw.circle(cloth, _EDGE, fine((x, y)).tolist(), px(radius + 0.006))  # the cloth bends over the edge
        pygame.draw.circle(cloth, _CUT, fine((x, y)).tolist(), px(radius))
    picture.blit(cloth, (0, 0))

    picture.set_clip(box(CUSHION))
    shadow = pygame.Surface((view.width, view.height), pygame.SRCALPHA, 32)  # soft anyway: blurred small, then enlarged
    for polygon in parts.cushions:
        pygame.draw.polygon(shadow, (0, 0, 0, 130), view(polygon).tolist())
    shadow = pygame.transform.gaussian_blur(shadow, max(1, round(0.012 * view.scale)))
    picture.blit(pygame.transform.smoothscale(shadow, size), (0, 0))
    for polygon, nose in zip(parts.cushions, parts.noses, strict=True):
        pygame.draw.polygon(picture, _CUSHION_TOP, fine(polygon).tolist())
        pygame.draw.lines(picture, _NOSE, False, fine(nose).tolist(), px(0.004))
    picture.set_clip(None)

    if parts.cushions:
        rail = layer()
        pygame.draw.rect(rail, _WOOD_EDGE, box(RAIL), border_radius=px(0.09))
        pygame.draw.rect(rail, _WOOD, box(RAIL - 0.010), border_radius=px(0.08))
        _grain(pygame, rail)
        pygame.draw.rect(rail, _WOOD_EDGE, box(CUSHION + 0.006))
        for rim, colour in ((0.014, _LEATHER), (0.0, _CUT)):
            for x0, y0, x1, y1, half in parts.throats:
                a, b = fine((x0, y0)), fine((x1, y1))
                across = (half + rim) * fine.scale * np.array([a[1] - b[1], b[0] - a[0]]) / np.hypot(*(b - a))
                pygame.draw.polygon(rail, colour, np.array([a + across, b + across, b - across, a - across]).tolist())
                pygame.draw.circle(rail, colour, b.tolist(), px(half + rim))
        pygame.draw.rect(rail, _CUT, box(CUSHION))
        picture.blit(rail, (0, 0))

    small = pygame.transform.smoothscale(picture, (view.width, view.height))
    return _lit(pygame, small, view, table)


def _grain(pygame, rail):
    """Streaks along the wood, multiplied onto what is drawn; transparency stays."""
    width, height = rail.get_size()
    rng = np.random.default_rng(1)
    streaks = np.repeat(np.repeat(rng.normal(0.0, 1.0, (height // 3 + 1, width // 240 + 2)), 3, axis=0), 240, axis=1)
    streaks = (streaks + np.roll(streaks, 80, axis=1) + np.roll(streaks, 160, axis=1))[:height, :width]
    _multiply(pygame, rail, 0.94 + 0.03 * streaks)


def _lit(pygame, picture, view, table):
    """The table's lamps: bright in the middle, dimmer to the ends, and a little unrest as of nap."""
    half_width, half_length = _halves(table)
    middle = view(extent(table).mean(axis=1))
    x, y = np.meshgrid(
        (np.arange(view.width) - middle[0]) / (view.scale * half_length), (np.arange(view.height) - middle[1]) / (view.scale * half_width)
    )  # fmt: skip
    nap = np.random.default_rng(0).normal(0.0, 0.012, x.shape)
    _multiply(pygame, picture, 1.0 - 0.10 * x**2 - 0.08 * y**2 + nap)
    return picture


def _multiply(pygame, surface, light):
    grey = np.clip(np.rint(255 * light), 0, 255).astype(np.uint8)
    image = np.repeat(grey[..., None], 3, axis=-1)
    surface.blit(pygame.image.frombuffer(image, grey.shape[::-1], "RGB"), (0, 0), special_flags=pygame.BLEND_RGB_MULT)
