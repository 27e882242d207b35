"""How do the built-in players play? At random, the widest pot, one shot ahead, or any pot that geometry finds; all behind one method.

A player says with ``options`` how it wants its tables (``SnookerEnv`` arguments), and ``act(tables, observations, going)`` gives an action
for each of the n tables of a ``SnookerVectorEnv`` with flat observations. Only the tables ``going`` (n,) bool matter; the others get any.

A player that compares strokes may say how: ``rank(tables, observations, going)`` gives for each table going its actions, best first, and
its own score of each, a list of (actions, scores). Its first is the one that it plays. ``sn.advise`` shows them.
"""

from typing import Any

import numpy as np

from snooker_env.planning import Positions, pots
from snooker_env.tasks import CHOICES, SIDES, SPEEDS, STROKES, TOPS, choice_of

from ..features.lookahead_features import PICKS, ForesightView, worth_by_rule
from .aim_search import Aimer

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

    def rank(self, tables, observations, going):
        """The same stroke at every pot of each table going, widest first; the score is the tolerance of its aim [rad]."""
        found = pots(Positions.of(tables)[going])
        there = [max(1, many) for many in (found.ball >= 0).sum(axis=1).tolist()]
        return [(self._stroke + STROKES * np.arange(many), found.tolerance[k, :many]) for k, many in enumerate(there)]


class Lookahead:
    """What ``ppo_foresight`` sees, rated by a rule of thumb instead of a network: the mean of points and the value of what is left."""

    options = DISCRETE

    def __init__(self):
        self._foresight = ForesightView()

    def act(self, tables, observations, going):
        """The stroke that promises most at each table going."""
        picks = np.zeros(len(going), np.int64)
        picks[going] = PICKS[self._worth(tables, going).argmax(1)]
        return picks

    def rank(self, tables, observations, going):
        """The strokes looked at on each table going, best first; the score is what each promises [points]."""
        ranked = []
        for worth in self._worth(tables, going):
            order = np.argsort(-worth, kind="stable")[: max(1, np.isfinite(worth).sum())]
            ranked.append((PICKS[order], worth[order]))
        return ranked

    def _worth(self, tables, going):
        """What the picks promise on each table going [points]; -inf where there is no such pot."""
        at, masks = Positions.of(tables)[going], tables.action_masks()[going][:, PICKS]
        return worth_by_rule(self._foresight.ahead(tables, at, masks))


class Geometric:
    """Pots found by geometry, their aims by the simulator without errors: direct, else banks, plants and cannons, see ``indirect_pots``."""

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
