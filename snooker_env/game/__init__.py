"""Snooker itself: balls, rules, frames and layouts, without physics and without Gymnasium. ``__all__`` is public, its modules are not."""

from .balls import (
    BALL_RADIUS,
    COLOUR_NAMES,
    CUE,
    HALF_LENGTH,
    HALF_WIDTH,
    N_BALLS,
    NAMES,
    SPOTS,
    TOUCH,
    VALUES,
    BallOn,
    balls_on,
    ids_of,
    mask_of,
)  # fmt: skip
from .layouts import LAYOUTS, POT_WINDOWS, Plan, layout, plan_of
from .opened import HELD_OUT
from .pots import POCKETS

__all__ = [
    "BALL_RADIUS", "COLOUR_NAMES", "CUE", "HALF_LENGTH", "HALF_WIDTH", "HELD_OUT", "LAYOUTS", "NAMES", "N_BALLS", "POCKETS", "POT_WINDOWS",
    "SPOTS", "TOUCH", "VALUES", "BallOn", "Plan", "balls_on", "ids_of", "layout", "mask_of", "plan_of",
]  # fmt: skip
