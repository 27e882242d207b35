"""snooker_env: whole snooker shots, frictional impacts, and the Gymnasium environment ``Snooker-v0`` built on them."""

import gymnasium as _gymnasium

from .match import match_env
from .physics.engine import EventKind
from .physics.parameters import Physics
from .physics.table import POCKETS, Table
from .simulation import Shot, ShotBatch, SimulationError, collide_balls, collide_cushion, simulate, simulate_batch, strike
from .warm import warmup

__version__ = "0.1.0"

__all__ = [
    "POCKETS", "EventKind", "Physics", "Shot", "ShotBatch", "SimulationError", "Table", "collide_balls", "collide_cushion", "match_env",
    "simulate", "simulate_batch", "strike", "warmup",
]  # fmt: skip

# A string entry point keeps this import light and the spec JSON-able; a second import (a reload) stays silent.
if "Snooker-v0" not in _gymnasium.registry:
    _gymnasium.register(
        id="Snooker-v0", entry_point="snooker_env.envs.snooker:SnookerEnv", vector_entry_point="snooker_env.envs.vector:SnookerVectorEnv"
    )
