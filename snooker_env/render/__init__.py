"""How does a table look? ``scene`` says what to draw, in metres; ``pygame_view`` draws it as a picture, ``ascii_view`` as text."""

from .ascii_view import ansi
from .pygame_view import Window, rgb_array, to_pixels
from .scene import Scene, ball_paths, scene, shot_scenes

__all__ = ["Scene", "Window", "ansi", "ball_paths", "rgb_array", "scene", "shot_scenes", "to_pixels"]
