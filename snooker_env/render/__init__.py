"""Pictures of a table. Public (``__all__``): the scene of a table, for drawing with another library."""

from .scene import scene_data

__all__ = ["scene_data"]
