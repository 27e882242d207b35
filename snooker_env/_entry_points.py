"""Which parts of a higher layer does a lower one call? Named as text and imported at their first use, as Gymnasium's entry points are."""

from importlib import import_module
from typing import Any

PLAYER = "snooker_env.advice.players:playing"
"""The player that a name stands for: ``playing(name, trust=...)``."""
NAMES = "snooker_env.advice.players:names"
"""The names of players: ``names()``."""
SEAT = "snooker_env.envs.at_frames:Seat"
"""A player's own tables, which show those of frames: ``Seat(player, n, game)``."""


def load(entry_point: str) -> Any:
    """What an entry point names."""
    module, _, name = entry_point.partition(":")
    return getattr(import_module(module), name)
