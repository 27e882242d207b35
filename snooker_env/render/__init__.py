"""Pictures of a table. Public (``__all__``): geometry and colours for drawing with another library."""

from .outline import BAULK_LINE, CUSHION, D_ARC, RAIL, SPOT_MARKS, outline, scene_data
from .palette import COLOURS, PALETTE

__all__ = [
    "BAULK_LINE",
    "COLOURS",
    "CUSHION",
    "D_ARC",
    "PALETTE",
    "RAIL",
    "SPOT_MARKS",
    "outline",
    "scene_data",
]
