"""The game of snooker: balls, rules, frames, layouts, without physics and Gymnasium; public: ``__all__``."""

from .balls import COLOUR_NAMES, CUE, N_BALLS, NAMES, SPOTS, TOUCH, VALUES, BallOn, balls_on
from .layouts import HELD_OUT, LAYOUTS, POT_WINDOWS, layout

__all__ = [
    "COLOUR_NAMES",
    "CUE",
    "HELD_OUT",
    "LAYOUTS",
    "NAMES",
    "N_BALLS",
    "POT_WINDOWS",
    "SPOTS",
    "TOUCH",
    "VALUES",
    "BallOn",
    "balls_on",
    "layout",
]
