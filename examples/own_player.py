"""How does your own player play the benchmark? As a class with ``at`` and ``play``. This one plays the widest pot,
more softly at shorter distances.

    python -m snooker_env.benchmark run SnookerBreak-v0 --agent examples.own_player:Softly --training-shots 0
    --episodes 50

``at`` binds the player to its environment; ``play`` returns a stroke for each position. Equal positions and seeds
give equal strokes.
"""

import numpy as np

from snooker_env.geometry import POCKET_AIMS
from snooker_env.planning import Planner, Positions, pots
from snooker_env.players import Strokes


class Softly:
    """Plays the widest direct pot without spin, at a speed that grows with the cue ball's distance; otherwise full at a
    ball on."""

    def __init__(self):
        self._planner = Planner({})  # solves aims, with throw and swerve

    def at(self, rules):
        """Returns itself, because it plays in the same way everywhere."""
        return self

    def play(self, positions, seeds):
        """Return a stroke for each position."""
        at = Positions.of(positions)
        lines, balls = pots(at, most=1), at.balls_on.argmax(axis=1)
        rows = np.flatnonzero(lines.ball[:, 0] >= 0)
        balls[rows] = lines.ball[rows, 0]
        x, y = (at.positions[np.arange(len(at)), balls] - at.positions[:, 0]).T
        speeds, aims, still = np.clip(1.5 + np.hypot(x, y), 0.5, 6.0), np.arctan2(y, x), np.zeros(len(at))
        targets = POCKET_AIMS[lines.pocket[rows, 0], :2]
        aims[rows] = self._planner.pot_aim(at, rows, balls[rows], targets, speeds[rows])
        return Strokes(np.column_stack([speeds, still, still, aims, still]))
