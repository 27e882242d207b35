"""Players: functions of positions and a seed."""

import sys as _sys
from types import ModuleType as _ModuleType

from .choices import ChoicePlayer
from .opponents import OpponentPool
from .player import FRAMES, VISITS, BoundPlayer, Player, Ranked, Strokes, ask_player, decision_seeds
from .resolver import player, players
from .seen import Seen, SeenPlayer

__all__ = [
    "FRAMES",
    "VISITS",
    "BoundPlayer",
    "ChoicePlayer",
    "OpponentPool",
    "Player",
    "Ranked",
    "Seen",
    "SeenPlayer",
    "Strokes",
    "ask_player",
    "decision_seeds",
    "player",
    "players",
]


class _Room(_ModuleType):
    """This package as ``snooker_env.players``: called, it returns the names of players."""

    def __call__(self) -> list[str]:
        return players()


# an import sets the attribute of snooker_env to this package, not to the function
_sys.modules[__name__].__class__ = _Room
