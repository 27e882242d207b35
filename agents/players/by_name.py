"""Which player does a name stand for? A built-in player, a pre-trained model, a model's file or run folder, or MODULE:CLASS.

MODULE:CLASS is a class of your own whose constructor takes no arguments (``built_in`` defines the interface); its module is imported.
Such a player chooses how its actions are read (``hyperparameters.ACTION_OPTIONS``); the evaluation sets all other options. To play frames
its options may hold whatever those of an opponent may. The code that reads models is imported only when it is needed.
"""

import importlib
import re
from pathlib import Path

from snooker_env import Options, SnookerVectorEnv
from snooker_env.checks import choice, refuse

from .built_in import ABSOLUTE, ForesightRule, Geometric, GhostBall, Random
from .stroke_players import NAMES as STROKE_PLAYERS
from .stroke_players import StrokePlayer, is_stroke_player, stroke_player

NAMES = ("random", "random_absolute", "ghost_ball", "geometric", "lookahead_foresight", "search", *STROKE_PLAYERS)


def is_player(name):
    """Whether that is the name of a player, built in or MODULE:CLASS, and not of a model."""
    own = re.fullmatch(r"[^\W\d]\w*(\.[^\W\d]\w*)*:[^\W\d]\w*", name) and not Path(name).exists()
    return name in NAMES or is_stroke_player(name) or bool(own)


def _own(name, frames):
    """The player MODULE:CLASS, who can play visits, or frames."""
    from ..learning.hyperparameters import ACTION_OPTIONS

    module, _, maker = name.partition(":")
    try:
        player = getattr(importlib.import_module(module), maker)()
        if frames:
            Options(task="frame", opponent=player)  # checks which options there are
            Options(task="frame", **player.options)
        else:
            for key in player.options:
                choice("key of options", key, ACTION_OPTIONS)
            SnookerVectorEnv(1, **player.options).close()
        if not callable(player.act):
            raise TypeError("act cannot be called")
    except Exception as error:  # it is the user's code
        raise refuse("agent", name, f"must be MODULE:CLASS of a player ({type(error).__name__}: {error})") from error
    return player


def player_of(name, *, budget=2000, seed=0, frames=False):
    """The player or pre-trained model of that name, the model in that file or run folder, or MODULE:CLASS. ValueError if there is none.

    ``budget``: simulated shots a decision of "search". ``frames``: one's own player is to play frames; otherwise visits.
    """
    makers = {
        "random": lambda: Random(seed=seed),
        "random_absolute": lambda: Random(ABSOLUTE, seed),
        "ghost_ball": GhostBall,
        "geometric": Geometric,
        "lookahead_foresight": ForesightRule,
        "search": lambda: StrokePlayer("lookahead", budget, seed=seed),
    }
    if name in makers:
        return makers[name]()
    if is_stroke_player(name):
        return stroke_player(name, seed)
    if is_player(name):
        return _own(name, frames)
    from ..learning.models import PRETRAINED, pretrained
    from .trained import load_player

    if name in pretrained():
        return load_player(PRETRAINED / f"{name}.zip")
    if not Path(name).exists():
        known = ", ".join((*NAMES, *pretrained()))
        raise refuse("agent", name, f"must be {known}, a model's .zip or a folder that holds model.zip")
    return load_player(Path(name))
