"""Pictures of a table. Public (``__all__``): its geometry and colours, for drawing with another library."""

from .outline import scene_data

__all__ = ["scene_data"]
