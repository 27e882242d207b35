"""Which diagrams are there? One shot, shots side by side, a fan over top and side, and where a ball stops.

``plot``, ``compare``, ``fan`` and ``density`` draw with matplotlib on the axes that they are given, or on a
new figure, and return the axes: baulk left and black right, y [m] to the right and x [m] down.
``bandwidth_of``, ``density_of`` and ``level_of`` are what ``density`` draws, as numbers.
"""

from .density_diagram import bandwidth_of, density, density_of, level_of
from .fan_diagram import fan
from .shot_diagram import compare, plot

__all__ = ["bandwidth_of", "compare", "density", "density_of", "fan", "level_of", "plot"]
