"""How does a player of one's own play the benchmark? A class with ``options`` and ``act``: the widest pot, struck the softer the nearer.

    python -m snooker_env.benchmark run SnookerBreak-v0 --agent examples.own_player:Softly --training-shots 0 --episodes 50

``options`` says how its actions are read; ``act`` gives an action for each table of a ``snooker_env.SnookerVectorEnv``.
"""

import numpy as np

from snooker_env.planning import Positions, pots
from snooker_env.tasks import SIDES, SPEEDS, TOPS, choice_of


class Softly:
    """The widest direct pot, without spin, at a speed that grows with the way of the cue ball."""

    options = {"action": "discrete"}  # noqa: RUF012 - a player's options are read, never changed

    def act(self, tables, observations, going):
        """A choice for each table; only those ``going`` count."""
        at = Positions.of(tables)
        found = pots(at, most=1)
        far = np.hypot(*(found.ghost[:, 0] - at.positions[:, 0]).T)
        wanted = np.clip(1.5 + far, SPEEDS[0], SPEEDS[-1])
        speeds = np.abs(np.subtract.outer(wanted, SPEEDS)).argmin(axis=1)
        return np.array([choice_of(0, int(speed), SIDES.index(0.0), TOPS.index(0.0)) for speed in speeds])
