"""How is pygame-ce imported? At the first picture; an error says how to install it. And its font."""

import os
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from .._install import missing

FONTS = Path(__file__).parent / "fonts"
BOLD, MEDIUM = "Inter-Bold.otf", "Inter-Medium.otf"


def pygame_() -> Any:
    """The module ``pygame``, or an ImportError with the command that installs it."""
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    try:
        import pygame
    except ImportError as error:
        raise missing("pictures need pygame-ce", "render") from error
    return pygame


def typeset(text: str, colour: Any, size: float, file: str = MEDIUM) -> Any:
    """A line of text as a surface, ``size`` pixels from a capital's top to the bottom of its descenders."""
    pygame = pygame_()
    if not pygame.font.get_init():
        pygame.font.init()
        _font.cache_clear()
    return _font(file, max(6, round(size))).render(text.replace("\0", " "), True, colour)


@lru_cache(maxsize=64)
def _font(file, size):
    return pygame_().font.Font(str(FONTS / file), size)


def surface_of(rgba: Any) -> Any:
    """A surface with transparency from an array (h, w, 4) of floats from 0 to 255."""
    image = np.ascontiguousarray(np.clip(np.rint(rgba), 0, 255).astype(np.uint8))
    return pygame_().image.frombuffer(image, image.shape[1::-1], "RGBA")
