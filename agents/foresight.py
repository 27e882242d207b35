"""What would the cue ball do? Some strokes at each pot, played without errors in the mind: the view of an agent that looks one shot ahead.

Behind ``view.with_pots`` come ``STROKES_SEEN`` rows, one for each stroke at each pot, with what it would lead to. The agent may play these
strokes and no others. Looking costs as many simulated shots as there are rows: the agent is slower than one that only sees the table, and
far quicker than ``search``.
"""

import numpy as np
from gymnasium import spaces

from snooker_env.envs.choices import POTS, SIDES, SIZE, SPEEDS, TOPS, choice_of
from snooker_env.envs.noise import Noise
from snooker_env.envs.vector import processors
from snooker_env.envs.visit import BALL_ON
from snooker_env.game.balls import HALF_LENGTH, HALF_WIDTH, BallOn

from .lookahead import BY_HAND, Copies, Position, prospects_of, spread_of
from .view import SHOWN, with_pots

SEEN_SPEEDS, SEEN_TOPS = (0, 2, 4, 6, 7), (0, 2, 4)
"""Places in ``SPEEDS`` and ``TOPS``; without side."""
PICKS = np.array([choice_of(p, s, SIDES.index(0.0), t) for p in range(POTS) for s in SEEN_SPEEDS for t in SEEN_TOPS])
"""The choices looked at."""
STROKES_SEEN = len(PICKS)
ENTRIES = 13
"""Numbers of a row: 1 if there is such a pot, chance of this pot, points / 7, 1 if the visit goes on, where the cue ball stops (x, y),
chances of the three likeliest next pots, value of the position by hand / 25, speed / 6.3, top / 0.4, 1 if a red was on."""
CUE_X = 4
SPACE = spaces.Box(-10.0, 10.0, (SHOWN + STROKES_SEEN * ENTRIES,), np.float32)
_CHOSEN = np.zeros(SIZE, bool)
_CHOSEN[PICKS] = True


class Foresight:
    """Looks ahead on the tables of a ``SnookerVectorEnv``."""

    space = SPACE

    def __init__(self, threads=None):
        self._threads, self._rules = threads or processors(), None

    def __call__(self, tables, observations, rows=None):
        """What is seen of the tables ``rows`` (all if None), whose observations are given: float32 (n, SHOWN + STROKES_SEEN * ENTRIES)."""
        v = tables.visits
        if self._rules is not v.rules:
            self._rules, shooter = v.rules, v.rules.shooter
            self._copies, self._spread = Copies(v.rules, Noise(), self._threads), spread_of(shooter.noise, shooter.physics)
        rows = np.arange(tables.num_envs) if rows is None else np.flatnonzero(rows)
        at = Position(v.positions[rows], v.on_table[rows], v.game[rows])
        ahead = self._ahead(at, tables.action_masks()[rows][:, PICKS])
        return np.concatenate([with_pots(observations), ahead.reshape(len(rows), -1)], 1)

    def _ahead(self, at, masks):
        n, (table, stroke) = len(at), np.nonzero(masks)
        now = prospects_of(at, self._spread)[1]
        points, goes_on, left, _ = self._copies.play(at, table, PICKS[stroke], np.zeros(len(table), np.uint64))
        values, chances = prospects_of(left, self._spread, most=8)
        row = np.zeros((len(table), ENTRIES), np.float32)
        row[:, 0], row[:, 1] = 1.0, now[table, stroke // (STROKES_SEEN // POTS)]
        row[:, 2], row[:, 3] = points / 7.0, goes_on
        row[:, 4:6] = left.positions[:, 0] / (HALF_WIDTH, HALF_LENGTH)
        row[:, 6:9] = -np.sort(-chances, axis=1)[:, :3]
        row[:, 9] = values / BY_HAND[0]
        row[:, 4:10] *= goes_on[:, None]
        row[:, 10], row[:, 11] = np.array(SPEEDS)[_SPEED[stroke]] / SPEEDS[-1], np.array(TOPS)[_TOP[stroke]] / TOPS[-1]
        row[:, 12] = at.game[table, BALL_ON] == BallOn.RED
        seen = np.zeros((n, STROKES_SEEN, ENTRIES), np.float32)
        seen[table, stroke] = row
        return seen

    def masks(self, tables):
        """Which choices may be played: those looked at, of those that there are."""
        return tables.action_masks() & _CHOSEN


_SPEED = np.tile(np.repeat(SEEN_SPEEDS, len(SEEN_TOPS)), POTS)
_TOP = np.tile(SEEN_TOPS, POTS * len(SEEN_SPEEDS))
