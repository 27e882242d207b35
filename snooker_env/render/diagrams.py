"""Which diagrams are there? Of one shot, of options side by side, of a fan over top and side, of where a ball stops: with matplotlib.

Each returns its axes and draws on those that it is given. The picture is seen from above, baulk left and black right: the axes' horizontal
axis is y [m] to the right, the vertical one x [m] down.
"""

from .compare_diagram import compare
from .density_diagram import density
from .fan_diagram import fan
from .shot_diagram import plot

__all__ = ["compare", "density", "fan", "plot"]
