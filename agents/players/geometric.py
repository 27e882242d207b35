"""How does the player ``geometric`` play? Direct pots, else banks, plants and cannons; aims are simulated."""

import numpy as np

from snooker_env.planning import Positions
from snooker_env.players import BoundPlayer, Strokes
from snooker_env.players.simple import placed

from .aim_search import Aimer


class Geometric(BoundPlayer):
    """Direct pots, else banks, plants and cannons (``indirect_pots``), aims without execution errors.

    Parameters
    ----------
    speed : float
        Cue speed [m/s] of its first attempt.
    """

    name, training_shots = "geometric", 0

    def __init__(self, speed=2.3):
        self._speed = speed

    def _bind(self, options):
        self._aimer = Aimer(options, self._speed)

    def play(self, positions, seeds):
        """See ``Player.play``."""
        _ = self.options  # it must be bound
        at = Positions.of(positions)
        visits, places = placed(at, seeds)
        parts = [self._aimer.strokes(visits[k : k + 1]) for k in range(len(at))]
        return Strokes(np.concatenate([np.empty((0, 5)), *parts]), places)
