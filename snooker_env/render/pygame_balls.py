"""How is a ball drawn? Shaded, with reflections of the lamps over the table and a faint shadow from each.
Pictures of these are kept for each colour, size and quarter of a pixel."""

from functools import lru_cache
from typing import Any

import numpy as np

from .._types import Floats
from ..game.balls import YELLOW
from .palette import COLOURS, LETTERS, PALETTE
from .pygame_library import BOLD, surface_of, typeset
from .scene import Scene
from .table_picture import LAMP_HEIGHT, lamps
from .turning import matrix
from .view import View

PANEL = 0.55
"""Length of a lamp [m]."""
_FADED = 0.42
_SPOT = np.cos(np.radians(17.0))
_SPOTS = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], dtype=np.float64)
_ALL_DARK = 0.62


def draw_balls(surface: Any, scene: Scene, view: View) -> None:
    """Put a scene's balls, their shadows and faded ghosts on a surface."""
    radius = scene.ball_radius * view.scale
    over = lamps(scene.table)
    images = []
    for ball, places in scene.ghosts.items():
        for place in view(places):
            images.append(_at(place, _body, tuple(COLOURS[ball].tolist()), round(radius, 2), _FADED))
    where = view(scene.positions)
    images += _shadows(scene.positions, over, where, radius)
    for ball, place in zip(scene.ids.tolist(), where, strict=True):
        colour = tuple(COLOURS[ball].tolist())
        if ball in scene.turns:
            images.append(_spotted(place, colour, radius, scene.turns[ball]))
        else:
            images.append(_at(place, _body, colour, round(radius, 2), 1.0))
    lettered = (scene.ids >= YELLOW) & scene.lettered
    images += _mirrored(scene.positions[~lettered], over, where[~lettered], radius)
    for ball, place in zip(scene.ids[lettered].tolist(), where[lettered], strict=True):
        letter = _letter(ball, round(radius, 1))
        x, y = place[0] - letter.get_width() / 2, place[1] - letter.get_height() / 2
        images.append((letter, (round(x), round(y))))
    surface.fblits(images)


def _at(place, make, *what):
    """A picture and the place of its corner, so that its middle is at ``place`` to a quarter of a pixel."""
    column, row = (round(4 * min(max(float(p), -1e5), 1e5)) for p in place)
    image = make(*what, column % 4, row % 4)
    return image, (column // 4 - image.get_width() // 2, row // 4 - image.get_height() // 2)


def _grid(half, fx, fy):
    """Columns and rows of pixels from a middle fx / 4, fy / 4 pixels right of and below a pixel's corner."""
    steps = np.arange(-half, half + 1) + 0.5
    return np.meshgrid(steps - fx / 4, steps - fy / 4)


def _shaded(colour, nz):
    """Colours (..., 3) where the z of the unit normal is ``nz``: lit from above, and by the cloth below."""
    nz = nz[..., None]
    lit = np.asarray(colour, dtype=np.float64) * (0.50 + 0.56 * nz)
    rim = (1 - nz) ** 2.5
    return lit * (1 - 0.35 * rim) + np.array(PALETTE["cloth"]) * 0.22 * rim + 26 * nz**6


@lru_cache(maxsize=2048)
def _body(colour, radius, strength, fx, fy):
    """A ball without reflections."""
    x, y = _grid(int(np.ceil(radius)) + 1, fx, fy)
    d = np.hypot(x, y)
    image = np.empty((*d.shape, 4))
    image[..., :3] = _shaded(colour, np.sqrt(np.clip(1 - (d / radius) ** 2, 0, 1)))
    image[..., 3] = 255 * strength * np.clip(radius + 0.5 - d, 0, 1)
    return surface_of(image)


def _spotted(place, colour, radius, turn):
    """A ball with six spots, after the rotation ``turn``."""
    column, row = float(place[0]), float(place[1])
    left, top = int(np.floor(column)), int(np.floor(row))
    x, y = _grid(int(np.ceil(radius)) + 1, 4 * (column - left), 4 * (row - top))
    d = np.hypot(x, y)
    nz = np.sqrt(np.clip(1 - (d / radius) ** 2, 0, 1))
    towards = matrix(turn) @ _SPOTS.T  # (3, 6) in the table frame: x down, y to the right, z to the eye
    seen = np.max(np.stack([y / radius, x / radius, nz], axis=-1) @ towards, axis=-1)
    spot = np.clip((seen - _SPOT) * radius * 3.4 + 0.5, 0, 1)[..., None]
    ink = np.array(COLOURS[1] if min(colour) > 120 else (250, 250, 245), dtype=np.float64)
    image = np.empty((*d.shape, 4))
    image[..., :3] = _shaded(colour, nz) * (1 - spot) + _shaded(ink, nz) * spot
    image[..., 3] = 255 * np.clip(radius + 0.5 - d, 0, 1)
    made = surface_of(image)
    return made, (left - made.get_width() // 2, top - made.get_height() // 2)


def _rays(positions, over):
    """From k balls to m lamps: the horizontal vectors (k, m, 2) [m] and the distances (k, m) [m]."""
    across = over[None] - positions[:, None]
    return across, np.sqrt((across**2).sum(axis=-1) + LAMP_HEIGHT**2)


def _mirrored(positions, over, where, radius):
    """Reflections: each lamp's where the normal is half-way between the lamp and the eye, straight above."""
    images = []
    ends = over[:, None] + np.array([(0.0, -0.5), (0.0, 0.0), (0.0, 0.5)])[None] * PANEL
    across, far = _rays(positions, ends.reshape(-1, 2))
    up = LAMP_HEIGHT / far + 1
    lean = across / far[..., None]
    lean /= np.sqrt((lean**2).sum(axis=-1) + up**2)[..., None]
    lean = lean.reshape(len(where), len(over), 3, 2)  # of each lamp its first end, middle and last end
    centre = where[:, None] + radius * lean[:, :, 1, ::-1]
    length = np.abs(lean[:, :, 2, 1] - lean[:, :, 0, 1]) * radius / 2
    for places, lengths in zip(centre, length, strict=True):
        for place, half in zip(places, lengths.tolist(), strict=True):
            images.append(_at(place, _lamp, round(4 * max(half, 0.07 * radius)), round(radius, 1)))
    return images


@lru_cache(maxsize=2048)
def _lamp(half, radius, fx, fy):
    """The reflection of a lamp, ``half / 4`` pixels to each side, with its glow."""
    along, across = half / 4, max(0.075 * radius, 0.4)
    x, y = _grid(int(np.ceil(along + 0.22 * radius)) + 1, fx, fy)
    d = np.hypot(np.maximum(np.abs(x) - along + across, 0), y)
    image = np.empty((*d.shape, 4))
    image[..., :3] = PALETTE["lamp"]
    small = min(1.0, 0.25 + radius / 12)  # fainter in a small ball, which it would hide
    bright, glow = 0.94 * np.clip(across + 0.5 - d, 0, 1), 0.30 * np.exp(-((d / (0.13 * radius)) ** 2))
    image[..., 3] = 255 * small * np.maximum(bright, glow)
    return surface_of(image)


def _shadows(positions, over, where, radius):
    """A soft shadow from each lamp, fainter for a lower light, and the dark place where the ball touches."""
    images = []
    across, far = _rays(positions, over)
    strength = (LAMP_HEIGHT / far) ** 3
    strength *= _ALL_DARK / strength.sum(axis=1, keepdims=True)
    centre = where[:, None] - (radius * across / LAMP_HEIGHT)[..., ::-1]
    for place, places, alphas in zip(where, centre, strength.tolist(), strict=True):
        for one, alpha in zip(places, alphas, strict=True):
            if alpha > 0.03:
                images.append(_at(one, _shadow, round(radius, 2), round(24 * alpha), 0.45))
        images.append(_at(place, _shadow, round(radius * 1.04, 2), 11, 0.30))
    return images


@lru_cache(maxsize=2048)
def _shadow(radius, alpha, soft, fx, fy):
    x, y = _grid(int(np.ceil(radius * (1 + soft))) + 1, fx, fy)
    t = np.clip((np.hypot(x, y) / radius - (1 - soft)) / (2 * soft), 0, 1)
    image = np.empty((*t.shape, 4))
    image[..., :3] = PALETTE["shadow"]
    image[..., 3] = 255 * alpha / 24 * (1 - t * t * (3 - 2 * t))
    return surface_of(image)


@lru_cache(maxsize=64)
def _letter(ball, radius):
    light = COLOURS[ball].astype(int) @ (3, 6, 1) > 1300
    return typeset(LETTERS[ball], (0, 0, 0) if light else (255, 255, 255), 1.25 * radius, BOLD)


def dot(ball: int, radius: float) -> Any:
    """A small ball for a score bar, its id and radius [pixels], as a surface with transparency."""
    image = _body(tuple(COLOURS[ball].tolist()), round(radius, 2), 1.0, 2, 2).copy()
    if COLOURS[ball].max() < 90:  # dark on a dark bar
        ring = _body(PALETTE["text_quiet"], round(radius + 0.8, 2), 0.8, 2, 2).copy()
        ring.blit(image, ((ring.get_width() - image.get_width()) // 2,) * 2)
        image = ring
    lamp = _lamp(max(1, round(0.8 * radius)), round(radius, 1), 2, 2)
    row = round(image.get_height() / 2 - lamp.get_height() / 2 - 0.35 * radius)
    image.blit(lamp, ((image.get_width() - lamp.get_width()) // 2, row))
    return image


def outline_of_a_ball(place: Floats, radius: float) -> Floats:
    """A closed circle as points (49, 2) [m]."""
    turn = np.linspace(0.0, 2 * np.pi, 49)
    return place + radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)
