"""What is a stroke worth, without playing it? A policy proposes strokes at the pots, where each leaves the cue ball is predicted
(``cue_ball_path``), and a small network weighs the learned value of that against how sure the pot is."""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from ..._lib.types import Floats, Ints, Singles
from ...game.balls import N_BALLS, VALUES
from ...game.frame_columns import BALL_ON, VISIT_COLUMNS
from ...geometry import AIM_X, AIM_Y, IS_MIDDLE, POCKET_AIMS
from ...tasks import cue_ball_path as path
from ...tasks.discrete_actions import STROKES
from ...tasks.noise import Noise
from ..aims import Dynamics, law_of
from ..positions import Positions
from ..pot_geometry import Pots, in_parts, pots
from ..proposals import strokes_at
from ..sobol import normal_points
from ..stroke_columns import AIM, COLUMNS, SIDE, SPEED, TOP
from ..worth import SPREAD
from .dense_layers import Layers, Weights
from .learned_worth import LearnedValue
from .stroke_policy import PolicyProposals, StrokePolicy, draw_choices

SIZE = 33
POINTS = 10.0  # unit of the network's results [points]
LOOKS, SAMPLES = 60, 3  # strokes that are looked at; errors under which each is predicted, the first is none
LEARNED = 8.4e-4, 5e-3  # other errors of direction than it has learned from count as these [rad]
_SEED = 7  # of the errors, which are the same for all
_LEAST_SPEED = 0.03  # the least error of speed that is predicted: else all would come to the same place


class Candidates(NamedTuple):
    """m strokes (n, m, 5) of each of the n positions ``rows`` that have a pot, and what is seen of them (n, m, SIZE)."""

    rows: Ints
    strokes: Floats
    seen: Singles


class StrokeValue:
    """Proposes strokes at pots and says what they are worth; ``layers``: empty before it has learned, but for the policy."""

    def __init__(
        self, value: LearnedValue, policy: StrokePolicy, dynamics: Dynamics, noise: Noise, layers: Weights
    ):
        self.value: LearnedValue = value
        self.proposals: PolicyProposals = PolicyProposals(policy)
        self.dynamics: Dynamics = dynamics
        self._layers = Layers(layers, "relu") if layers else None
        noise = replace(noise, speed_rel=max(noise.speed_rel, _LEAST_SPEED))
        self._noise = noise.pack(dynamics.physics.R, real=len(dynamics.rails) > 0)
        self._errors = np.ascontiguousarray(normal_points(SAMPLES, _SEED)[:, :COLUMNS])
        self._errors[:, AIM:] = 0.0  # the pot's chance knows those of the aim
        self._errors[0] = 0.0

    def candidates(self, at: Positions, m: int, seeds: Ints) -> Candidates:
        """The strokes that are looked at in visits whose cue ball is on the table."""
        direct = pots(at)
        rows = np.flatnonzero(direct.ball[:, 0] >= 0)
        if not len(rows):
            return Candidates(rows, np.zeros((0, m, 5)), np.zeros((0, m, SIZE), np.float32))
        some: Any = [part[rows] for part in direct]
        at, direct = at[rows], Pots(*some)
        scores, masks = self.proposals.scores(at, self.dynamics.rails)
        picks, tips = draw_choices(scores, masks, m, seeds[rows])
        strokes, chances = strokes_at(at, picks // STROKES, tips, self.value.spread, self.dynamics)
        every = np.arange(len(at))[:, None]
        which = np.minimum(picks // STROKES, (direct.ball >= 0).sum(axis=1)[:, None] - 1)
        pot = Pots(*(part[every, which] for part in some))
        likely = scores[every, picks]
        columns = [
            np.maximum(likely, -50.0) / 20.0,  # what the policy says of it, and beside its best
            np.maximum(likely - scores.max(axis=1, keepdims=True), -40.0) / 10.0,
            *self._pots(at, strokes, chances, pot),
            *self._ahead(at, strokes, pot),
            np.full(picks.shape, np.log(np.clip(self.value.spread.core, *LEARNED) / SPREAD)),
        ]
        return Candidates(rows, strokes, np.stack(columns, axis=-1).astype(np.float32))

    def scores(self, seen: Singles) -> Singles:
        """What the strokes seen (n, m, SIZE) are worth [points]: float32 (n, m)."""
        if self._layers is None:
            return seen[..., 0]
        return POINTS * self._layers(seen.reshape(-1, SIZE)).reshape(seen.shape[:2])

    def _pots(self, at: Positions, strokes: Floats, chances: Floats, pot: Pots) -> list[Floats]:
        """What is seen of the pots and of the strokes: columns (n, m)."""
        lies = at.positions[np.arange(len(at))[:, None], pot.ball]
        target, cue = POCKET_AIMS[pot.pocket][..., [AIM_X, AIM_Y]], at.positions[:, None, 0]
        return [
            chances,
            np.log(chances + 1e-3) - np.log(1.0 - chances + 1e-3),
            pot.cut,
            np.log10(pot.tolerance + 1e-6) + 2.0,
            np.log(strokes[..., SPEED]),
            strokes[..., TOP],
            strokes[..., SIDE],
            np.abs(strokes[..., SIDE]),
            np.hypot(*np.moveaxis(target - lies, -1, 0)),  # the paths of both balls [m]
            np.hypot(*np.moveaxis(lies - cue, -1, 0)),
            POCKET_AIMS[pot.pocket, IS_MIDDLE],
            VALUES[pot.ball] / 7.0,
        ]

    def _ahead(self, at: Positions, strokes: Floats, pot: Pots) -> list[Floats]:
        """What is predicted: columns (n, m)."""
        out, values = self._predict(at, strokes, pot)
        first, mean = out[:, :, 0], out.mean(axis=2)
        values = values / 20.0
        return [
            values[..., 0],
            values.mean(axis=2),
            values.min(axis=2),
            values.max(axis=2),
            values.std(axis=2),
            mean[..., path.NOSES] / 3.0,
            mean[..., path.BALLS] / 2.0,
            mean[..., path.LENGTH] / 3.0,
            mean[..., path.LOST],
            first[..., path.HIT],
            mean[..., path.MISSED],
            5.0 * np.minimum(out[..., path.NEAR].min(axis=2), 0.3),
            first[..., path.REACH],
            out[..., path.REACH].min(axis=2),
            np.log(first[..., path.OBJECT] + 0.05),
            np.log10(np.abs(first[..., path.ASIDE]) + 1e-5) + 3.0,
            np.hypot(out[..., path.X].std(axis=2), out[..., path.Y].std(axis=2)),  # between the places [m]
            strokes[..., SPEED] * np.cos(pot.cut),  # what a stun shot gives the object ball [m/s]
        ]

    def _predict(self, at: Positions, strokes: Floats, pot: Pots) -> tuple[Floats, Floats]:
        """What is predicted of strokes under each error, (n, m, k, SEEN), and the values of what they leave, (n, m, k)."""
        n, m = strokes.shape[:2]
        k, rows = len(self._errors), np.repeat(np.arange(n), m)
        at_pots = np.stack([pot.ball.reshape(-1), pot.pocket.reshape(-1)], axis=1)
        flat, each = strokes.reshape(-1, COLUMNS), n * m * k
        of, pots_of = np.repeat(rows, k), np.repeat(at_pots, k, axis=0)
        out, on, no_balls = np.empty((each, 1, path.SEEN)), np.empty(each, np.int64), np.empty(0, np.int64)
        places, there = np.empty((each, N_BALLS, 2)), np.empty((each, N_BALLS), np.bool_)
        balls, law = (at.positions, at.on_table), law_of(self.dynamics, at)

        def predict(part: slice) -> None:
            all_of = slice(k * part.start, k * part.stop)
            some = rows[part], flat[part], at_pots[part]
            path.predict(balls, *some, self._errors, self._noise, law, out[all_of], no_balls)

        in_parts(len(rows), self.value.threads, predict)
        seen = out[:, 0]
        path.leave_pots((*balls, at.ball_on.copy()), of, pots_of, seen, (places, there, on))
        game, values = np.zeros((each, VISIT_COLUMNS), np.int64), np.zeros(each)
        game[:, BALL_ON] = on
        live = np.flatnonzero((on < path.NONE) & (seen[:, path.LOST] == 0.0) & (seen[:, path.MISSED] == 0.0))
        values[live] = self.value(Positions(places[live], there[live], game[live]))
        return out.reshape(n, m, k, -1), values.reshape(n, m, k)
