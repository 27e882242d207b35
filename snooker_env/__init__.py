"""snooker_env: whole snooker shots, frictional impacts, and the Gymnasium environment ``Snooker-v0`` built on them."""

from gymnasium.envs import registration as _gymnasium

from ._registration import register as _register
from ._warmup import warmup
from .geometry import POCKETS, Pocket
from .match import match_env
from .physics.engine import EventKind
from .physics.parameters import Physics
from .physics.table import Table
from .simulation import Shot, ShotBatch, SimulationError, collide_balls, collide_cushion, simulate, simulate_batch, strike

__version__ = "0.3.0.dev0"

__all__ = [
    "POCKETS", "EventKind", "Physics", "Pocket", "Shot", "ShotBatch", "SimulationError", "Table", "collide_balls", "collide_cushion",
    "match_env", "simulate", "simulate_batch", "strike", "warmup",
]  # fmt: skip

_register(_gymnasium)
