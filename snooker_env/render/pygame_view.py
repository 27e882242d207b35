"""How does pygame-ce draw a scene, without a display? On the cached picture of the table, mostly from cached pictures:
balls with reflections of the lamps and soft shadows; paths in pieces, so that a growing path changes only at its end."""

import os
from collections.abc import Iterator, Sequence
from functools import lru_cache
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from .._lib.install import missing
from .._lib.types import Bytes, Floats
from ..game.balls import CUE
from .palette import COLOURS, PALE, PALETTE
from .scene import Scene, ScoreBar
from .table_picture import LAMP_HEIGHT, SIZE, Size, lamps, smooth, table_picture, to_line
from .table_picture import View as View

if TYPE_CHECKING:
    from pygame import Surface

FONTS = Path(__file__).parent / "fonts"
BOLD, MEDIUM = "Inter-Bold.otf", "Inter-Medium.otf"


def pygame_() -> ModuleType:
    """The module ``pygame``; an ImportError names the command that installs it."""
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    try:
        import pygame
    except ImportError as error:
        raise missing("pictures need pygame-ce", "render") from error
    return pygame


def typeset(text: str, colour: tuple[int, int, int], size: float, file: str = MEDIUM) -> "Surface":
    """A line of text as a surface, ``size`` pixels from a capital's top to the bottom of its descenders."""
    pygame = pygame_()
    if not pygame.font.get_init():
        pygame.font.init()
        _font.cache_clear()
    return _font(file, max(6, round(size))).render(text.replace("\0", " "), True, colour)


@lru_cache(maxsize=64)
def _font(file, size):
    return pygame_().font.Font(str(FONTS / file), size)


def surface_of(colour: Sequence[int] | Floats, alpha: Floats) -> "Surface":
    """A surface with transparency: its colours (3,) or (h, w, 3), from 0 to 255, and their opacities (h, w)."""
    image = np.empty((*alpha.shape, 4), np.uint8)
    image[..., :3], image[..., 3] = (np.clip(np.rint(part), 0, 255) for part in (colour, 255 * alpha))
    return pygame_().image.frombuffer(image, image.shape[1::-1], "RGBA")


_STEP = 3.0  # distance between the points of a path [pixels]
_POINTS = 16  # points in a piece
_LONGEST = 1e5  # pixels: a longer path is not drawn


def draw_paths(surface: "Surface", scene: Scene, view: View) -> None:
    """Put a scene's paths on a surface, later ones on top."""
    width = max(1.5, 0.0072 * view.scale)
    edge = width + 2 * max(0.9, 0.45 * width)
    for ball, points in scene.paths.items():
        pieces = list(_pieces(view(points)))
        for ink, wide in ((PALETTE["path_edge"], edge), (tuple(PALE[ball].tolist()), width)):
            surface.fblits([_piece(piece, ink, wide) for piece in pieces])


def _pieces(points):
    """The pieces of a line, each as evenly spaced points."""
    steps = np.hypot(*np.diff(points, axis=0).T)
    run = np.concatenate([[0.0], np.cumsum(steps)])
    if not 0.0 < run[-1] < _LONGEST:
        return
    at = np.append(np.arange(0.0, run[-1], _STEP), run[-1])
    even = np.stack([np.interp(at, run, points[:, k]) for k in (0, 1)], axis=1)
    for first in range(0, len(even) - 1, _POINTS):
        yield tuple(even[first : first + _POINTS + 1].ravel().tolist())


@lru_cache(maxsize=4096)
def _piece(numbers, colour, width):
    """One piece as a picture, and the place of its corner."""
    points = np.array(numbers).reshape(-1, 2)
    chord = points[-1] - points[0]
    off = np.abs((points - points[0]) @ np.array([-chord[1], chord[0]])) / max(np.hypot(*chord), 1e-9)
    if np.max(off) < 0.05:  # straight
        points = points[[0, -1]]
    reach = width / 2 + 1
    low, high = (np.floor(points.min(axis=0) - reach), np.ceil(points.max(axis=0) + reach))
    columns, rows = (np.arange(a, b) + 0.5 for a, b in zip(low, high, strict=True))
    far = to_line(rows[:, None], columns[None], points[:, ::-1], reach)
    return surface_of(colour, np.clip(width / 2 + 0.5 - far, 0, 1)), (int(low[0]), int(low[1]))


PANEL = 0.55  # length of a lamp [m]
_FADED = 0.42
_SPOT = np.cos(np.radians(17.0))
_SPOTS = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], dtype=np.float64)
_ALL_DARK = 0.62
_CUE_LENGTH, _CUE_PARTS = 1.45, (0.008, 0.95)  # where tip and shaft end, from the tip [m]
_CUE_INKS = np.array([(60, 106, 156), (217, 178, 124), (32, 19, 13)])  # of tip, shaft and butt
EYE = 2.0  # height of the eye above the bed [m]: a flying ball looks larger


def draw_balls(surface: "Surface", scene: Scene, view: View) -> None:
    """Put a scene's balls, their shadows and faded ghosts on a surface."""
    radius, over, where = scene.ball_radius * view.scale, lamps(scene.table), view(scene.positions)
    faded = _colour(CUE), round(radius, 2), _FADED, None
    images = [_at(place, _body, *faded) for place in view(scene.ghosts)]
    images += _shadows(scene.positions, scene.heights / scene.ball_radius, over, where, radius)
    for k in np.argsort(scene.heights, kind="stable").tolist():
        ball, place, size = int(scene.ids[k]), where[k], radius * (1.0 + float(scene.heights[k]) / EYE)
        turn = scene.turn if ball == CUE else None
        make = _body if turn is None else _sphere
        images.append(_at(place, make, _colour(ball), round(size, 2), 1.0, turn))
    images += _reflections(scene.positions, over, where, radius)
    surface.fblits(images)


def _colour(ball):
    return tuple(COLOURS[ball].tolist())


def _at(place, make, *what):
    """A picture and the place of its corner, so that its middle is at ``place`` to a quarter of a pixel."""
    column, row = (round(4 * min(max(float(p), -1e5), 1e5)) for p in place)
    image = make(*what, column % 4, row % 4)
    return image, (column // 4 - image.get_width() // 2, row // 4 - image.get_height() // 2)


def _grid(half, fx, fy):
    """Columns and rows of pixels from a middle fx / 4, fy / 4 pixels right of and below a pixel's corner."""
    steps = np.arange(-half, half + 1) + 0.5
    return np.meshgrid(steps - fx / 4, steps - fy / 4)


def _shade(colour, nz):
    """Colours (..., 3) where the z of the unit normal is ``nz``: lit from above, and by the cloth below."""
    nz = nz[..., None]
    lit = np.asarray(colour, dtype=np.float64) * (0.50 + 0.56 * nz)
    rim = (1 - nz) ** 2.5
    return lit * (1 - 0.35 * rim) + np.array(PALETTE["cloth"]) * 0.22 * rim + 26 * nz**6


def _sphere(colour, radius, strength, turn, fx, fy):
    """A ball without reflections; with a rotation ``turn`` it has six red spots."""
    x, y = _grid(int(np.ceil(radius)) + 1, fx, fy)
    d = np.hypot(x, y)
    nz = np.sqrt(np.clip(1 - (d / radius) ** 2, 0, 1))
    shaded = _shade(colour, nz)
    if turn is not None:
        towards = turn @ _SPOTS.T  # (3, 6) in the table frame: x down, y to the right, z to the eye
        seen = np.max(np.stack([y / radius, x / radius, nz], axis=-1) @ towards, axis=-1)
        spot = np.clip((seen - _SPOT) * radius * 3.4 + 0.5, 0, 1)[..., None]
        shaded = shaded * (1 - spot) + _shade(COLOURS[1], nz) * spot
    return surface_of(shaded, strength * np.clip(radius + 0.5 - d, 0, 1))


_body = lru_cache(maxsize=2048)(_sphere)


def _rays(positions, over):
    """From k balls to m lamps: the horizontal vectors (k, m, 2) [m] and the distances (k, m) [m]."""
    across = over[None] - positions[:, None]
    return across, np.sqrt((across**2).sum(axis=-1) + LAMP_HEIGHT**2)


def _reflections(positions, over, where, radius):
    """Reflections of the lamps. Each lies where the normal is half-way between lamp and eye, which is straight above."""
    across, far = _rays(positions, over)
    lean, up = across / far[..., None], LAMP_HEIGHT / far + 1
    lean /= np.sqrt((lean**2).sum(axis=-1) + up**2)[..., None]
    centre = (where[:, None] + radius * lean[..., ::-1]).reshape(-1, 2)
    halves = np.rint(4 * radius * np.maximum(PANEL / (4 * far), 0.07)).astype(int).ravel().tolist()
    return [_at(place, _lamp, half, round(radius, 1)) for place, half in zip(centre, halves, strict=True)]


@lru_cache(maxsize=2048)
def _lamp(half, radius, fx, fy):
    """The reflection of a lamp, ``half / 4`` pixels to each side, with its glow."""
    along, across = half / 4, max(0.075 * radius, 0.4)
    x, y = _grid(int(np.ceil(along + 0.22 * radius)) + 1, fx, fy)
    d = np.hypot(np.maximum(np.abs(x) - along + across, 0), y)
    small = min(1.0, 0.25 + radius / 12)  # fainter on a small ball, or it would hide the ball
    bright, glow = 0.94 * np.clip(across + 0.5 - d, 0, 1), 0.30 * np.exp(-((d / (0.13 * radius)) ** 2))
    return surface_of(PALETTE["lamp"], small * np.maximum(bright, glow))


def _shadows(positions, heights, over, where, radius):
    """A soft shadow from each lamp, and one where the ball touches the cloth; ``heights`` in radii."""
    images = []
    across, far = _rays(positions, over)
    strength = (LAMP_HEIGHT / far) ** 3
    strength *= _ALL_DARK / strength.sum(axis=1, keepdims=True)
    centre = where[:, None] - (radius * (1.0 + heights[:, None, None]) * across / LAMP_HEIGHT)[..., ::-1]
    for place, places, alphas, high in zip(where, centre, strength.tolist(), heights.tolist(), strict=True):
        for one, alpha in zip(places, alphas, strict=True):
            if alpha > 0.03:
                images.append(_at(one, _shadow, round(radius, 2), round(24 * alpha), 0.45))
        if high < 1.0:
            images.append(_at(place, _shadow, round(radius * 1.04, 2), round(11 * (1.0 - high)), 0.30))
    return images


@lru_cache(maxsize=2048)
def _shadow(radius, alpha, soft, fx, fy):
    x, y = _grid(int(np.ceil(radius * (1 + soft))) + 1, fx, fy)
    t = np.clip((np.hypot(x, y) / radius - (1 - soft)) / (2 * soft), 0, 1)
    return surface_of(PALETTE["shadow"], alpha / 24 * (1 - smooth(t)))


def draw_cue(surface: "Surface", scene: Scene, view: View) -> None:
    """Put a scene's cue on a surface: tip, shaft and butt, thicker towards its end, with a shadow."""
    if (cue := scene.cue) is None:
        return
    back, flat, scale = -np.array([np.cos(cue.aim), np.sin(cue.aim)]), np.cos(cue.elevation), view.scale
    ends = view(cue.ball + (scene.ball_radius + cue.pull + np.array([[0.0], [_CUE_LENGTH * flat]])) * back)
    low, high = np.clip([ends.min(axis=0) - 20, ends.max(axis=0) + 20], 0, surface.get_size())
    columns, rows = (np.arange(int(a), int(b)) + 0.5 for a, b in zip(low, high, strict=True))
    x, y = np.meshgrid((columns - ends[0, 0]) / scale, (rows - ends[0, 1]) / scale)  # from the tip [m]
    along, across = (x * back[1] + y * back[0]) / flat, np.abs(x * back[0] - y * back[1])
    beyond = np.maximum(-along, along - _CUE_LENGTH)
    far = np.maximum(np.maximum(across - 0.0048 - 0.0065 * along, beyond), -1.0)
    body, shadow = np.clip(0.5 - far * scale, 0, 1), 0.35 * np.exp(-((np.maximum(far, 0) / 0.012) ** 2))
    alpha = body + (1 - body) * shadow
    colour = _CUE_INKS[np.searchsorted(_CUE_PARTS, along)] * (body / np.maximum(alpha, 1e-9))[..., None]
    surface.blit(surface_of(colour, cue.alpha * alpha), (int(low[0]), int(low[1])))


_ROWS, _STRIP = 72, 7  # of a bar in a picture of 1080 rows; of the shares of the chance to win, at its top
_SMALLEST = 36  # the words of a lower bar are larger [pixels]
_EDGE = 28  # beside and between words


@lru_cache(maxsize=64)
def score_bar(bar: ScoreBar | None, text: str, width: int, height: int) -> "Surface":
    """The bar, or without one the text, as a surface of this size [pixels]. It is cached: do not draw on it."""
    surface, unit = pygame_().Surface((width, height), 0, 24), height / _ROWS
    surface.fill(PALETTE["bar"])
    surface.fill(PALETTE["bar_edge"], (0, 0, width, max(1, round(2 * unit))))
    if bar is not None and bar.win_chance is not None:
        first, high = round(bar.win_chance * width), max(1, round(_STRIP * unit))
        surface.fill(PALETTE["first"], (0, 0, first, high))
        surface.fill(PALETTE["other"], (first, 0, width - first, high))
    x, size = _EDGE * unit, (27 if height >= _SMALLEST else 36) * unit
    for words, file in [(text, MEDIUM)] if bar is None else _words(bar):
        room, keep = width - x - _EDGE * unit, len(words)
        line = typeset(words, PALETTE["text"], size, file)
        while keep > 1 and line.get_width() > room:  # too long: it ends in "…"
            keep = max(1, min(keep - 1, int(keep * room / line.get_width()) + 1))
            line = typeset(words[:keep].rstrip() + "…", PALETTE["text"], size, file)
        if words and line.get_width() <= room:
            surface.blit(line, line.get_rect(midleft=(round(x), round(height / 2))))
            x += line.get_width() + _EDGE * unit
    return surface


def _words(bar: ScoreBar) -> Iterator[tuple[str, str]]:
    """The parts of a bar from left to right, each with its typeface: what the player at the table has is bold."""
    for k, (name, score) in enumerate(zip(bar.players, bar.scores, strict=True)):
        yield f"{name} {score}", BOLD if bar.striker == k else MEDIUM
    yield "" if bar.break_points is None else f"break {bar.break_points}", BOLD
    yield bar.ball_on and f"{bar.ball_on} on", MEDIUM
    yield "" if bar.points_on is None else f"{bar.points_on} left", MEDIUM
    yield bar.words, MEDIUM


def draw(scene: Scene, view: View) -> Bytes:
    """The picture of a scene in a view of its table: uint8 (height, width, 3), a new array."""
    pixels = table_picture(scene.table, view).copy()
    surface = pygame_().image.frombuffer(pixels, (view.width, view.height), "RGB")  # draws into it
    surface.set_clip((0, 0, view.width, view.height - view.bar))
    draw_paths(surface, scene, view)
    draw_balls(surface, scene, view)
    draw_cue(surface, scene, view)
    surface.set_clip(None)
    if scene.bar is not None or scene.text:
        surface.blit(score_bar(scene.bar, scene.text, view.width, view.bar), (0, view.height - view.bar))
    return pixels


def rgb_array(scene: Scene, *, size: Size = SIZE) -> Bytes:
    """The picture of a scene, uint8 (height, width, 3)."""
    return draw(scene, View.of(scene.table, size))
