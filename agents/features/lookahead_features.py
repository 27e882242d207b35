"""What does an agent with a one-shot lookahead observe? Simulated outcomes of strokes at the two widest pots.

The observation is ``pot_view.with_pots`` followed by ``STROKES_SEEN`` rows, one for each of 12 strokes at
each of these pots: means of its outcomes over the errors of ``EVEN_SAMPLES``, scaled by the execution noise
of the tables (one sample if there is none): one outcome does not show how errors affect the next pot. The
agent may play only these strokes. A decision costs 120 simulated shots: slower than an agent that observes
the table alone, far quicker than ``search``.
"""

from typing import Any

import numpy as np
from gymnasium import spaces

from snooker_env.game import BallOn
from snooker_env.geometry import HALF_LENGTH, HALF_WIDTH
from snooker_env.planning import RULE_OF_THUMB, Planner, action_masks, prospects_of, spread_of
from snooker_env.planning.learned.pot_view import SHOWN, with_pots
from snooker_env.planning.sobol import EVEN_SAMPLES
from snooker_env.tasks import CHOICES, SIDES, SPEEDS, STROKES, TOPS, choice_of

POTS_SEEN = 2
SEEN_SPEEDS, SEEN_TOPS = (1, 3, 5, 7), (0, 2, 4)
"""Places in ``SPEEDS`` and ``TOPS``; without side."""
PICKS = np.array(
    [choice_of(p, s, SIDES.index(0.0), t) for p in range(POTS_SEEN) for s in SEEN_SPEEDS for t in SEEN_TOPS]
)
"""The choices that are simulated."""
STROKES_SEEN = len(PICKS)
(THERE, CHANCE, SCORED, GOES_ON, POINTS, CUE_X, CUE_Y) = range(7)
(FIRST, SECOND, THIRD, VALUE, SPREAD, SPEED, TOP, RED_ON) = range(7, 15)
"""Places in a row: 1 if there is such a pot, its chance by its width; share of samples that score, that go
on; mean points / 7; of those that go on: where the cue ball stops (x, y), chances of the three likeliest next
pots; mean value, by the rule of thumb, of what is left / 25 (0 for a visit that ended), its standard
deviation; speed / 6.3, top / 0.4, 1 if a red was on."""
ENTRIES = RED_ON + 1
SPACE = spaces.Box(-10.0, 10.0, (SHOWN + STROKES_SEEN * ENTRIES,), np.float32)
_CHOSEN = np.zeros(CHOICES, bool)
_CHOSEN[PICKS] = True
_SPEEDS = np.array(SPEEDS)[PICKS % STROKES // (len(SIDES) * len(TOPS))] / SPEEDS[-1]
_TOPS = np.array(TOPS)[PICKS % len(TOPS)] / TOPS[-1]


class ForesightView:
    """The observation with a one-shot lookahead, bound to rules by ``at``."""

    space = SPACE

    def __init__(self, threads=None):
        self._threads = threads
        self._planner: Any = None
        self._samples: Any = None
        self._spread = 0.0
        self._cue: Any = "free"

    def at(self, options):
        """The view under the rules and the noise of ``options``."""
        bound = ForesightView(self._threads)
        choices = options.but(action="discrete", elevation=False, placement=False, decision=False)
        bound._planner = planner = Planner(choices, threads=self._threads)
        bound._samples = np.array(EVEN_SAMPLES[:1] if planner.noise.silent else EVEN_SAMPLES, np.uint64)
        bound._spread = spread_of(planner.noise, planner.physics)
        bound._cue = choices.cue
        return bound

    def __call__(self, at, observations):
        """The view of n ``Positions`` with these flat observations, as ``SPACE``: float32."""
        ahead = self.ahead(at, action_masks(at, cue=self._cue)[:, PICKS])
        return np.concatenate([with_pots(observations), ahead.reshape(len(at), -1)], 1)

    def ahead(self, at, masks):
        """The rows (n, STROKES_SEEN, ENTRIES) of ``Positions``; 0 where not ``masks`` (n, STROKES_SEEN)."""
        table, stroke = np.nonzero(masks)
        k, m = len(self._samples), len(table)
        # the samples of a stroke in succession: its aim is solved once for all of them
        each = np.repeat(table, k), np.repeat(PICKS[stroke], k), np.tile(self._samples, m)
        points, goes_on, left, _ = self._planner.play(at, *each)
        on = np.flatnonzero(goes_on)
        values, chances = np.zeros(k * m), np.zeros((k * m, 3))
        values[on], likely = prospects_of(left[on], self._spread, most=8, threads=self._planner.threads)
        chances[on] = -np.sort(-likely, axis=1)[:, :3]
        values, points, goes_on = values.reshape(m, k), points.reshape(m, k), goes_on.reshape(m, k)
        share = (goes_on / np.maximum(1, goes_on.sum(1))[:, None])[:, :, None]
        row = np.empty((m, ENTRIES), np.float32)
        row[:, THERE] = 1.0
        row[:, CHANCE] = prospects_of(at, self._spread)[1][table, PICKS[stroke] // STROKES]
        row[:, SCORED], row[:, GOES_ON] = (points > 0).mean(1), goes_on.mean(1)
        row[:, POINTS] = points.mean(1) / 7.0
        places = (left.positions[:, 0] / (HALF_WIDTH, HALF_LENGTH)).reshape(m, k, 2)
        row[:, CUE_X : CUE_Y + 1] = (share * places).sum(1)
        row[:, FIRST : THIRD + 1] = (share * chances.reshape(m, k, 3)).sum(1)
        row[:, VALUE], row[:, SPREAD] = values.mean(1) / RULE_OF_THUMB[0], values.std(1) / RULE_OF_THUMB[0]
        row[:, SPEED], row[:, TOP] = _SPEEDS[stroke], _TOPS[stroke]
        row[:, RED_ON] = at.ball_on[table] == BallOn.RED
        seen = np.zeros((*masks.shape, ENTRIES), np.float32)
        seen[table, stroke] = row
        return seen

    def allowed(self, masks):
        """Which of the available choices may be played: the simulated ones."""
        return masks & _CHOSEN


def worth_by_rule(ahead):
    """Expected points of the strokes of rows (n, STROKES_SEEN, ENTRIES), with what they leave; else -inf."""
    worth = 7.0 * ahead[..., POINTS] + RULE_OF_THUMB[0] * ahead[..., VALUE]
    return np.where(ahead[..., THERE] > 0, worth, -np.inf)
