"""Which diagrams are there? One shot, shots side by side, where a ball stops, chances to win.

They draw with matplotlib on the axes that they are given, or on a new figure, and return the axes; tables with baulk left
and black right, y [m] to the right and x [m] down."""

from .chance_diagram import win_chance
from .density_diagram import density
from .shot_diagram import compare, plot

__all__ = ["compare", "density", "plot", "win_chance"]
