"""snooker_env: whole snooker shots, frictional impacts, and the Gymnasium environment ``Snooker-v0`` built on them."""

from .physics.engine import EventKind
from .physics.parameters import Physics
from .physics.table import POCKETS, Table
from .simulation import Shot, ShotBatch, SimulationError, collide_balls, collide_cushion, simulate, simulate_batch, strike, warmup

__all__ = [
    "POCKETS", "EventKind", "Physics", "Shot", "ShotBatch", "SimulationError", "Table", "collide_balls", "collide_cushion", "simulate",
    "simulate_batch", "strike", "warmup",
]  # fmt: skip
