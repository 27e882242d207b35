"""Pictures of a table: ``scene`` describes one in metres, ``pygame_view`` draws it as a picture,
``ascii_view`` as text.

``__all__`` is public: the geometry and the colours for drawing tables with another library.
"""

from .outline import BAULK_LINE, CUSHION, D_ARC, RAIL, SPOT_MARKS, Outline, outline, scene_data
from .palette import COLOURS, PALETTE

__all__ = [
    "BAULK_LINE",
    "COLOURS",
    "CUSHION",
    "D_ARC",
    "PALETTE",
    "RAIL",
    "SPOT_MARKS",
    "Outline",
    "outline",
    "scene_data",
]
