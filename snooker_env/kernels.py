"""How does one write kernels that run beside those of the package? Its two decorators, and the inner kernels that others may call.

``entry`` compiles a kernel that Python calls and keeps its machine code on disk, as safely as the package's own; ``kernel`` one that only
kernels call. Both are strict IEEE and release the GIL. Arguments that are masks of balls have bit i for ball i.
"""

from ._jit import entry, kernel
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
from .tasks.box_actions import line_of
from .tasks.noise import executed

__all__ = [
    "COS_CUT", "GHOST_X", "GHOST_Y", "POT_BALL", "POT_COLUMNS", "POT_POCKET", "TOLERANCE", "balls_on", "bits", "clear_segment", "entry",
    "executed", "find_pots", "kernel", "line_of", "window",
]  # fmt: skip
