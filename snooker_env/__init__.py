"""snooker_env: whole snooker shots, frictional impacts, and the Gymnasium environment ``Snooker-v0``.

The public names are those in ``__all__`` of this package and of these modules. Everything else may change in
any version:

* ``snooker_env.planning``: strokes played on copies of positions, and the geometry that finds them
* ``snooker_env.players``: functions of positions and a seed; the only place where a name becomes one
* ``snooker_env.advice``: the strokes that a player would play in a position, and their outcomes
* ``snooker_env.geometry``: where everything on a table is, and how large
* ``snooker_env.game``: balls, values, balls on, layouts and the tables that they deal
* ``snooker_env.tasks``: what actions, observations and execution errors mean, in numbers
* ``snooker_env.kernels``: for your own kernels: how they are compiled, and which they may call
* ``snooker_env.checks``: reporting bad input as the package does
* ``snooker_env.progress``: how far a long command is, for your own commands too
* ``snooker_env.render``: the scene of a table, and its pictures
* ``snooker_env.replays``: what was played, as a page, as data and as a film
* ``snooker_env.benchmark``: named tasks with frozen options, and how agents are judged on them
* ``snooker_env.sb3``: many tables for Stable-Baselines3
"""

import typing as _typing

from gymnasium.envs import registration as _gymnasium

from ._lib.registration import register as _register
from .geometry import POCKETS, Pocket
from .physics.engine import EventKind
from .physics.parameters import Physics
from .physics.table import Table
from .simulation import simulate, simulate_batch
from .simulation.impacts import collide_balls, collide_cushion, strike
from .simulation.shot import Shot, ShotBatch, SimulationError

if _typing.TYPE_CHECKING:
    from . import planning
    from .advice import advise
    from .benchmark.warmup import warmup
    from .envs import match_env
    from .envs.match_vector import MatchVectorEnv
    from .envs.snooker import SnookerEnv
    from .envs.vector import SnookerVectorEnv
    from .planning import Planner, Position, Positions
    from .players import player, players
    from .replays import Replay, replay
    from .tasks.options import Options

__version__ = "1.0.0"

__all__ = [
    "POCKETS",
    "EventKind",
    "MatchVectorEnv",
    "Options",
    "Physics",
    "Planner",
    "Pocket",
    "Position",
    "Positions",
    "Replay",
    "Shot",
    "ShotBatch",
    "SimulationError",
    "SnookerEnv",
    "SnookerVectorEnv",
    "Table",
    "advise",
    "collide_balls",
    "collide_cushion",
    "match_env",
    "planning",
    "player",
    "players",
    "replay",
    "simulate",
    "simulate_batch",
    "strike",
    "warmup",
]

_LATER = {"Options": "tasks.options", "advise": "advice", "player": "players", "warmup": "benchmark.warmup"}
_LATER |= {"SnookerEnv": "envs.snooker", "SnookerVectorEnv": "envs.vector"}
_LATER |= {"match_env": "envs", "MatchVectorEnv": "envs.match_vector"}
_LATER |= dict.fromkeys(("Planner", "Position", "Positions"), "planning")
_LATER |= dict.fromkeys(("Replay", "replay"), "replays")
"""Modules of the names that are imported at their first use: simulating shots alone needs no environment."""

_register(_gymnasium)


def __getattr__(name: str) -> _typing.Any:
    from importlib import import_module

    if name in ("planning", "players"):  # the room of players is callable: players() returns their names
        return import_module(f".{name}", __name__)
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    thing = globals()[name] = getattr(import_module(f".{_LATER[name]}", __name__), name)
    return thing


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
