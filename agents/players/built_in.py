"""How do the simplest players play? At random, the widest pot, the strokes of ``ppo_foresight`` by a rule, any pot that geometry finds.

The interface of a player:

* ``options``: how its actions are read, as arguments of ``SnookerEnv``.
* ``act(tables, observations, going)``: an action for each of the n tables of a ``SnookerVectorEnv`` with flat observations. Only those of
  the running tables, ``going`` (n,) bool, are played.
* ``rank(tables, observations, going)``, optional, for a player that compares strokes: for each running table its actions, best first, and
  its score of each, a list of (actions, scores). The first is the one that ``act`` plays. ``sn.advise`` shows them.
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
    """Uniformly random actions.

    Parameters
    ----------
    options : dict, optional
        How its actions are read; the discrete choices by default.
    seed : int
        Of its random numbers.

    Examples
    --------
    >>> import numpy as np
    >>> import snooker_env as sn
    >>> from agents.players.built_in import Random
    >>> player = Random(seed=1)
    >>> tables = sn.SnookerVectorEnv(2, **player.options)
    >>> observations, _ = tables.reset(seed=0)
    >>> player.act(tables, observations, np.ones(2, bool)).shape
    (2,)
    """

    def __init__(self, options=None, seed=0):
        self.options = DISCRETE if options is None else options
        self._rng, self._first, self._total = np.random.default_rng(seed), 0, 0

    def tables_of(self, first, total):
        """Its tables are a part of ``total``, from ``first`` on: it draws for all, so that each table gets the same in any part."""
        self._first, self._total = first, total

    def act(self, tables, observations, going):
        """Random actions; with discrete choices only the valid ones (the pots that exist)."""
        n = len(going)
        rows, total = slice(self._first, self._first + n), max(n, self._total)
        if self.options.get("action") != "discrete":
            return self._rng.uniform(-1.0, 1.0, (total, *tables.action_space.shape[1:])).astype(np.float32)[rows]
        order = self._rng.random((total, CHOICES))[rows]
        return np.argmax(np.where(tables.action_masks(), order, -1.0), axis=1)


class GhostBall:
    """The widest direct pot, aim solved, without spin, at one soft speed: a baseline without positional play.

    Parameters
    ----------
    speed : float
        Cue speed [m/s], one of ``snooker_env.tasks.SPEEDS``.
    """

    options = DISCRETE

    def __init__(self, speed=2.3):
        self._stroke = choice_of(0, SPEEDS.index(speed), SIDES.index(0.0), TOPS.index(0.0))

    def act(self, tables, observations, going):
        """The same stroke at every table's widest pot."""
        return np.full(len(going), self._stroke)

    def rank(self, tables, observations, going):
        """The same stroke at every pot of each running table, widest first; the score is the tolerance of its aim [rad]."""
        found = pots(Positions.of(tables)[going])
        there = [max(1, many) for many in (found.ball >= 0).sum(axis=1).tolist()]
        return [(self._stroke + STROKES * np.arange(many), found.tolerance[k, :many]) for k, many in enumerate(there)]


class ForesightRule:
    """The observation of ``ppo_foresight``, scored by a rule instead of a network: mean points plus the mean value of the afterstates."""

    options = DISCRETE

    def __init__(self):
        self._foresight = ForesightView()

    def act(self, tables, observations, going):
        """The stroke with the highest score on each running table."""
        picks = np.zeros(len(going), np.int64)
        picks[going] = PICKS[self._worth(tables, going).argmax(1)]
        return picks

    def rank(self, tables, observations, going):
        """The simulated strokes of each running table, best first, with their scores [points]."""
        ranked = []
        for worth in self._worth(tables, going):
            order = np.argsort(-worth, kind="stable")[: max(1, np.isfinite(worth).sum())]
            ranked.append((PICKS[order], worth[order]))
        return ranked

    def _worth(self, tables, going):
        """Scores of the simulated strokes on each running table [points]; -inf where there is no such pot."""
        at, masks = Positions.of(tables)[going], tables.action_masks()[going][:, PICKS]
        return worth_by_rule(self._foresight.ahead(tables, at, masks))


class Geometric:
    """Direct pots, else banks, plants and cannons (``indirect_pots``); aims are solved in the simulator without execution errors.

    Parameters
    ----------
    speed : float
        Cue speed [m/s] of its first attempt.
    """

    options = ABSOLUTE

    def __init__(self, speed=2.3):
        self._speed = speed
        self._tables: Any = None
        self._aimer: Any = None

    def act(self, tables, observations, going):
        """An aim and a speed for each running table: float32 (n, 4)."""
        if self._tables is not tables:
            self._tables, self._aimer = tables, Aimer(tables, self._speed)
        actions = np.zeros((len(going), 4), np.float32)
        actions[going] = self._aimer.actions(Positions.of(tables)[going])
        return actions
