"""What will safeties leave? Where the cue ball and the first ball that it meets come to rest is predicted under a few errors
(``cue_ball_path``), and a learned worth says what that brings the other player. No shot is simulated."""

from typing import NamedTuple

import numpy as np

from ..._lib.types import Bools, Floats, Ints
from ...game.balls import N_BALLS, VALUES
from ...tasks import cue_ball_path as path
from ...tasks.options import Rules
from ..aims import Dynamics, law_of
from ..positions import Positions
from ..prospects import in_parts
from ..sobol import normal_points
from ..stroke_columns import COLUMNS
from ..worth import pass_after_miss
from .learned_worth import LearnedWorth

SAMPLES = 4
"""Errors under which each stroke is predicted; the first is none."""
FOUL = 8.0
"""What a predicted foul costs beside what the balls as they lie bring the other [points]."""
POTTED = 0.5
"""Of the safeties that are predicted to pot a ball that is on, about so many do."""
_SEED = 7  # of the errors, which are the same for all


class Foreseen(NamedTuple):
    """What is predicted of m strokes under k errors: what they are worth [points], (m, k); what is seen of
    the two balls, (m, k, 2, SEEN); whether they foul, pot the ball that they meet, and meet none, (m, k)."""

    gains: Floats
    seen: Floats
    foul: Bools
    potted: Bools
    missed: Bools


class Foresight:
    """Predicts strokes without a pot under the errors of ``rules``, and judges what they leave by ``worth``."""

    def __init__(self, rules: Rules, dynamics: Dynamics, worth: LearnedWorth):
        self.worth: LearnedWorth = worth
        self.dynamics: Dynamics = dynamics
        self._noise = rules.noise.pack(dynamics.physics.R, real=len(dynamics.rails) > 0)
        self._errors = np.ascontiguousarray(normal_points(SAMPLES, _SEED)[:, :COLUMNS])
        self._errors[0] = 0.0

    def promise(self, at: Positions, rows: Ints, strokes: Floats, samples: int) -> Floats:
        """What strokes (m, 5) in ``at[rows]`` promise on average of ``samples`` errors: (m,) [points]."""
        missed, goes_on = self.worth(pass_after_miss(at)), self.worth(at)
        balls = missed.astype(np.float64), goes_on.astype(np.float64)
        return self.foresee(at, rows, strokes, *balls, samples).gains.mean(axis=1)

    def foresee(
        self,
        at: Positions,
        rows: Ints,
        strokes: Floats,
        missed: Floats,
        goes_on: Floats,
        samples: int = SAMPLES,
    ) -> Foreseen:
        """What strokes (m, 5) in ``at[rows]`` are predicted to lead to. ``missed``, ``goes_on`` (n,): what the other and the
        striker make of the balls of ``at`` as they lie [points]."""
        m, k, errors = len(rows), samples, self._errors[:samples]
        balls, law = (at.positions, at.on_table, at.game), law_of(self.dynamics, at)
        out, places = np.empty((m * k, 2, path.SEEN)), np.empty((m * k, N_BALLS, 2))
        met, legal = np.empty(m * k, np.int64), np.empty(m * k, np.bool_)

        def predict(part: slice) -> None:
            all_of, some = slice(k * part.start, k * part.stop), (rows[part], strokes[part])
            left = places[all_of], met[all_of], legal[all_of]
            path.predict_contacts(balls, *some, errors, self._noise, law, out[all_of], left)

        in_parts(m, self.worth.value.threads, predict)
        of, lost = np.repeat(rows, k), out[..., path.LOST] > 0.0
        foul, potted = ~legal | lost[:, 0], legal & lost[:, 1] & ~lost[:, 0]
        gains = -missed[of]
        gains[potted] += POTTED * (VALUES[met] + goes_on[of] + missed[of])[potted]
        gains[foul] = np.minimum(gains[foul], 0.0) - FOUL
        rest = np.flatnonzero(~foul & ~potted)
        left = pass_after_miss(at[of[rest]])
        left.positions[:] = places[rest]
        gains[rest] = -self.worth(left)
        fates = (one.reshape(m, k) for one in (foul, potted, met == 0))
        return Foreseen(gains.reshape(m, k), out.reshape(m, k, 2, path.SEEN), *fates)
