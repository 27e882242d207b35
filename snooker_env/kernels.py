"""How does one write kernels that run beside those of the package? With its decorators.

``entry`` compiles a kernel that Python calls, and keeps its machine code on disk as the package keeps its
own. ``kernel`` compiles an inner kernel, which only kernels can call, as ``balls_on`` and ``bits`` are. Both use
strict IEEE arithmetic and release the GIL. In a mask of balls, bit i stands for ball i."""

from ._lib.jit import entry, kernel
from .game.balls import balls_on_kernel as balls_on
from .game.balls import bits

__all__ = ["balls_on", "bits", "entry", "kernel"]
