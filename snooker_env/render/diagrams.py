"""Which diagrams are there? One shot, shots side by side, a fan over top and side, where a ball stops, and how
likely each player of a frame was to win.

``plot``, ``compare``, ``fan`` and ``density`` draw with matplotlib on the axes that they are given, or on a
new figure, and return the axes: baulk left and black right, y [m] to the right and x [m] down.
``win_chance`` does so over the strokes of a frame, without a table.
``bandwidth_of``, ``density_of`` and ``level_of`` are what ``density`` draws, as numbers.
"""

from .chance_diagram import win_chance
from .density_diagram import bandwidth_of, density, density_of, level_of
from .fan_diagram import fan
from .shot_diagram import compare, plot

__all__ = ["bandwidth_of", "compare", "density", "density_of", "fan", "level_of", "plot", "win_chance"]
