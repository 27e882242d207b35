"""Who plays? Random play, the widest pot, the search, or a trained model, all behind one method.

A player says with ``options`` how it wants its tables (``SnookerEnv`` arguments), and ``act(tables, observations, going)`` gives an action
for each of the n tables of a ``SnookerVectorEnv`` with flat observations. Only the tables ``going`` (n,) bool matter; the others get any.
Any class of such players, made without arguments, can be named as MODULE:CLASS: the module is imported and so runs, it is the user's own
code; of the environment it may choose how its actions are read (``recipes.READ``), the world is given.
"""

import importlib
import re
from pathlib import Path
from typing import Any

import numpy as np

from snooker_env import SnookerVectorEnv
from snooker_env.checks import choice, refuse
from snooker_env.planning import Positions
from snooker_env.tasks import CHOICES, SIDES, SPEEDS, TOPS, choice_of

from ..features.lookahead_features import PICKS, Foresight, worth_by_hand
from ..learning.hyperparameters import READ
from ..learning.models import PRETRAINED, load_player, pretrained
from .aim_search import Aimer
from .search import Search

DISCRETE = {"action": "discrete"}
ABSOLUTE = {"aim": "absolute"}


class Random:
    """Any action, each as likely."""

    def __init__(self, options=None, seed=0):
        self.options = DISCRETE if options is None else options
        self._rng = np.random.default_rng(seed)

    def act(self, tables, observations, going):
        """Random actions; of the choices only those that are there."""
        if self.options.get("action") != "discrete":
            return self._rng.uniform(-1.0, 1.0, tables.action_space.shape).astype(np.float32)
        order = self._rng.random((len(going), CHOICES))
        return np.argmax(np.where(tables.action_masks(), order, -1.0), axis=1)


class GhostBall:
    """The widest direct pot, aim solved, without spin, at one soft speed [m/s]: no thought of where the cue ball goes."""

    options = DISCRETE

    def __init__(self, speed=2.3):
        self._stroke = choice_of(0, SPEEDS.index(speed), SIDES.index(0.0), TOPS.index(0.0))

    def act(self, tables, observations, going):
        """The same stroke at every table's widest pot."""
        return np.full(len(going), self._stroke)


class Lookahead:
    """What ``ppo_foresight`` sees, judged by hand instead of by a network: the mean of points and the value of what is left."""

    options = DISCRETE

    def __init__(self):
        self._foresight = Foresight()

    def act(self, tables, observations, going):
        """The stroke that promises most at each table going."""
        at, picks = Positions.of(tables)[going], np.zeros(len(going), np.int64)
        masks = tables.action_masks()[going][:, PICKS]
        picks[going] = PICKS[worth_by_hand(self._foresight.ahead(tables, at, masks)).argmax(1)]
        return picks


class Geometric:
    """Pots found by geometry, their aims by the simulator without errors: direct, else banks, plants and cannons, see ``indirect``."""

    options = ABSOLUTE

    def __init__(self, speed=2.3):
        self._speed = speed
        self._tables: Any = None
        self._aimer: Any = None

    def act(self, tables, observations, going):
        """An aim and a speed for each table going."""
        if self._tables is not tables:
            self._tables, self._aimer = tables, Aimer(tables, self._speed)
        actions = np.zeros((len(going), 4), np.float32)
        actions[going] = self._aimer.actions(Positions.of(tables)[going])
        return actions


NAMES = ("random", "random_absolute", "ghost_ball", "geometric", "lookahead", "search")


def is_player(name):
    """Whether that is the name of a player, built in or MODULE:CLASS, and not of a model."""
    own = re.fullmatch(r"[^\W\d]\w*(\.[^\W\d]\w*)*:[^\W\d]\w*", name) and not Path(name).exists()
    return name in NAMES or bool(own)


def _own(name):
    """The player MODULE:CLASS."""
    module, _, maker = name.partition(":")
    try:
        player = getattr(importlib.import_module(module), maker)()
        for key in player.options:
            choice("key of options", key, READ)
        SnookerVectorEnv(1, **player.options).close()
        if not callable(player.act):
            raise TypeError("act cannot be called")
    except Exception as error:  # it is the user's code
        raise refuse("agent", name, f"must be MODULE:CLASS of a player ({type(error).__name__}: {error})") from error
    return player


def player_of(name, *, budget=2000, seed=0):
    """The player or pre-trained model of that name, the model in that file or run folder, or MODULE:CLASS. ValueError if there is none."""
    makers = {
        "random": lambda: Random(seed=seed),
        "random_absolute": lambda: Random(ABSOLUTE, seed),
        "ghost_ball": GhostBall,
        "geometric": Geometric,
        "lookahead": Lookahead,
        "search": lambda: Search(budget, seed=seed),
    }
    if name in makers:
        return makers[name]()
    if is_player(name):
        return _own(name)
    if name in pretrained():
        return load_player(PRETRAINED / f"{name}.zip")
    if not Path(name).exists():
        known = ", ".join((*NAMES, *pretrained()))
        raise refuse("agent", name, f"must be {known}, a model's .zip or a folder that holds model.zip")
    return load_player(Path(name))
