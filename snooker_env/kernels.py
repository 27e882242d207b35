"""How does one write kernels that run beside those of the package? With its decorators.

``entry`` compiles a kernel that Python calls, and keeps its machine code on disk as the package keeps its
own. ``kernel`` compiles an inner kernel, which only kernels can call. Both use strict IEEE arithmetic and
release the GIL. In a mask of balls, bit i stands for ball i. The functions ``balls_on``, ``bits``,
``clear_segment``, ``execute_stroke``, ``find_pots`` and ``window`` are inner kernels: call them from
an ``entry`` of your own."""

from ._lib.jit import entry, kernel
from .game.balls import balls_on_kernel as balls_on
from .game.balls import bits
from .game.pots import (
    COS_CUT,
    GHOST_X,
    GHOST_Y,
    POT_BALL,
    POT_COLUMNS,
    POT_POCKET,
    TOLERANCE,
    clear_segment,
    find_pots,
    window,
)
from .tasks.noise import execute_stroke

__all__ = [
    "COS_CUT",
    "GHOST_X",
    "GHOST_Y",
    "POT_BALL",
    "POT_COLUMNS",
    "POT_POCKET",
    "TOLERANCE",
    "balls_on",
    "bits",
    "clear_segment",
    "entry",
    "execute_stroke",
    "find_pots",
    "kernel",
    "window",
]
