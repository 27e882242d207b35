"""What is a stroke of a frame worth, without playing it? Beside the pots of ``stroke_value``, safeties where no pot is likely: a
learned worth says what the balls, where they are predicted to stop, bring the other player; a network corrects both kinds."""

from typing import NamedTuple

import numpy as np

from ..._lib.types import Bools, Floats, Integers, Ints, Singles
from ...game import frame_columns as columns
from ...game.balls import BLACK, N_BALLS, PINK, VALUES
from ...tasks import cue_ball_path as path
from ...tasks.noise import Spread
from ...tasks.options import Rules
from ..aims import Dynamics, law_of
from ..judges import EASY
from ..positions import Positions, PositionsLike, check_has_stroke, seeds_of
from ..pot_geometry import in_parts
from ..proposals import safeties
from ..search import Ranked
from ..sobol import normal_points
from ..stroke_columns import COLUMNS, SIDE, SPEED, TOP
from ..strokes import Strokes
from ..worth import SPREAD, Chance, breaks_off, lead_of, left_of, pass_after_miss
from .dense_layers import Layers, Weights
from .learned_worth import LearnedWorth
from .stroke_value import LEARNED, LOOKS, POINTS, StrokeValue
from .stroke_value import SIZE as POT_SIZE

SAMPLES = 4  # errors under which each safety is predicted; the first is none
FOUL = 8.0  # what a predicted foul costs beside what the balls as they lie bring the other [points]
POTTED = 0.5  # of the safeties that are predicted to pot a ball that is on, about so many do
_SEED = 7  # of the errors, which are the same for all
SAFETIES = 60  # those that are looked at
STROKES = LOOKS + SAFETIES
SHARED, SAFE_SIZE = 5, 24
SIZE = SHARED + POT_SIZE + SAFE_SIZE
"""What is seen of a stroke: what it seems to be worth, what the balls as they lie are worth to the other and to the striker,
reds, whether it is a pot; what ``stroke_value`` sees of a pot; what is predicted of a safety."""
FOULS = SHARED + POT_SIZE + 4  # the column of the share of errors under which a safety is a foul
_CHANCE = 2  # the column of what ``stroke_value`` sees that is the pot's chance


class Foreseen(NamedTuple):
    """Of m strokes under k errors: worth [points], (m, k); what is seen of the two balls, (m, k, 2, SEEN); fates, (m, k)."""

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
        self, at: Positions, rows: Ints, strokes: Floats, missed: Floats, goes_on: Floats, samples: int
    ) -> Foreseen:
        """What strokes lead to, where the other and the striker make ``missed`` and ``goes_on`` (n,) of the balls as they lie."""
        m, k, errors = len(rows), samples, self._errors[:samples]
        rows = np.ascontiguousarray(rows)  # one type, one compile
        balls, law, of = (at.positions, at.on_table), law_of(self.dynamics, at), np.repeat(rows, k)
        out, places = np.empty((m * k, 2, path.SEEN)), np.empty((m * k, N_BALLS, 2))
        met, legal, no_pots = np.empty(m * k, np.int64), np.empty(m * k, np.bool_), np.empty((0, 2), np.int64)

        def predict(part: slice) -> None:
            all_of, some = slice(k * part.start, k * part.stop), (rows[part], strokes[part], no_pots)
            path.predict(balls, *some, errors, self._noise, law, out[all_of], met[all_of])

        in_parts(m, self.worth.value.threads, predict)
        path.leave_contacts((*balls, at.game), of, met, out, (places, legal))
        lost = out[..., path.LOST] > 0.0
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


class Looked(NamedTuple):
    """The strokes of n positions that are looked at, pots first; whether each is there, and what is seen: (n, STROKES, ...)."""

    strokes: Floats
    there: Bools
    seen: Singles


class FrameStrokes:
    """Ranks strokes of frames without a simulated shot; ``layers``: of the network, empty before it has learned."""

    chance: Chance | None = None  # it compares points: no law of the chance to win

    def __init__(self, rules: Rules, values: StrokeValue, worth: LearnedWorth, layers: Weights):
        self.rules: Rules = rules
        self.values: StrokeValue = values
        self.worth: LearnedWorth = worth
        self.dynamics: Dynamics = values.dynamics
        self.spread: Spread = values.value.spread
        self._layers = Layers(layers, "relu") if layers else None
        self._foresight = Foresight(rules, self.dynamics, worth)

    def rank(self, positions: PositionsLike, seeds: Integers) -> list[Ranked]:
        """As ``Search.rank``, by points; without strokes before a break-off, and where neither a pot nor a ball on is seen."""
        at = Positions.of(positions).known_to(self.rules)
        keys, rows = seeds_of(seeds, len(at)), np.flatnonzero(~breaks_off(at))
        check_has_stroke(at.as_visits(), np.arange(len(at)), self.rules.table, self.rules.physics.R)
        strokes, there, seen = self.look(at[rows], keys[rows])
        there &= self._sensible(at[rows], there, seen)
        scores = np.where(there, self.scores(seen), -np.inf)
        order, counts = np.argsort(-scores, axis=1, kind="stable"), there.sum(axis=1).tolist()
        none = np.zeros(0)
        ranked = [Ranked(Strokes(np.empty((0, COLUMNS))), none, none, none.astype(np.int64))] * len(at)
        for j, k in enumerate(rows.tolist()):
            best = order[j, : counts[j]]
            points, kinds = scores[j, best].astype(np.float64), (best >= LOOKS).astype(np.int64)
            ranked[k] = Ranked(Strokes(strokes[j, best]), points, points, np.zeros_like(best), kinds)
        return ranked

    def _sensible(self, at: Positions, there: Bools, seen: Singles) -> Bools:
        """Which strokes neither foul on purpose nor lose the frame by potting the pink, where there are others."""
        bad = there & (seen[..., FOULS] > 0.5)
        two = at.game[:, columns.ON_TABLE] == (1 << PINK) + (1 << BLACK)
        lost = two & (at.ball_on == VALUES[PINK]) & (lead_of(at) + left_of(at) < 0.0)
        bad[:, :LOOKS] |= there[:, :LOOKS] & lost[:, None]
        return ~bad | ~(there & ~bad).any(axis=1, keepdims=True)

    def scores(self, seen: Singles) -> Singles:
        """What the strokes seen (n, m, SIZE) are worth [points]: float32 (n, m)."""
        more = 0.0 if self._layers is None else self._layers(seen.reshape(-1, SIZE)).reshape(seen.shape[:-1])
        return POINTS * (seen[..., 0] + more)

    def look(self, at: Positions, seeds: Ints) -> Looked:
        """The strokes that are looked at in n positions, and what is seen of them."""
        n, visits = len(at), at.as_visits()
        strokes, there = np.zeros((n, STROKES, COLUMNS)), np.zeros((n, STROKES), np.bool_)
        seen = np.zeros((n, STROKES, SIZE), np.float32)
        # what the other and the striker make of the balls as they lie
        missed, goes_on = (self.worth(one).astype(np.float64) for one in (pass_after_miss(at), at))
        found, hard = self.values.candidates(visits, LOOKS, seeds), np.ones(n, np.bool_)
        rows, pots, kinds = found.rows, seen[:, :LOOKS], seen[:, LOOKS:]
        strokes[rows, :LOOKS], there[rows, :LOOKS] = found.strokes, True
        chances = found.seen[..., _CHANCE]
        pots[rows, :, 0] = (self.values.scores(found.seen) - (1.0 - chances) * missed[rows, None]) / POINTS
        pots[:, :, 4] = 1.0
        pots[rows, :, SHARED : SHARED + POT_SIZE] = found.seen
        short = lead_of(at) + left_of(pass_after_miss(at)) < 0.0  # it would need snookers at the next visit
        hard[rows] = (chances.max(axis=1) < EASY) | short[rows]
        others = np.flatnonzero(hard)
        made = safeties(self, visits[others], SAFETIES, seeds[others])
        j, c = np.nonzero(made.chances > 0.0)
        of = others[j]
        strokes[of, LOOKS + c], there[of, LOOKS + c] = made.strokes[j, c], True
        if len(of):
            seems, more = self._predict(at, of, made.strokes[j, c], missed, goes_on)
            kinds[of, c, 0], kinds[of, c, SHARED + POT_SIZE :] = seems, more
        seen[..., 1], seen[..., 2] = missed[:, None] / 40.0, goes_on[:, None] / 40.0
        seen[..., 3] = at.on_table[:, 1:16].sum(axis=1)[:, None] / 15.0
        return Looked(strokes, there, seen)

    def _predict(
        self, at: Positions, rows: Ints, strokes: Floats, missed: Floats, goes_on: Floats
    ) -> tuple[Floats, Floats]:
        """What safeties (m, 5) seem to be worth in units of ``POINTS``, and what is predicted: (m, SAFE_SIZE)."""
        told = self._foresight.foresee(at, rows, strokes, missed, goes_on, SAMPLES)
        m, gains, seen = len(rows), told.gains / 20.0, told.seen
        first, mean, cue = seen[:, 0], seen.mean(axis=1), seen[:, :, 0]
        columns_seen = [gains[:, 0], gains.min(axis=1), gains.max(axis=1), gains.std(axis=1)]
        columns_seen += [one.mean(axis=1) for one in (told.foul, told.potted, told.missed)]
        errs = np.log(np.clip(self.spread.core, *LEARNED) / SPREAD)
        columns_seen += [first[:, 0, path.LOST], np.full(m, errs)]
        for ball in (0, 1):
            columns_seen += [
                mean[:, ball, path.NOSES] / 3.0,
                mean[:, ball, path.BALLS] / 2.0,
                mean[:, ball, path.LENGTH] / 3.0,
                first[:, ball, path.HIT],
                5.0 * np.minimum(mean[:, ball, path.NEAR], 0.3),
            ]
        columns_seen += [strokes[:, SPEED] / 3.0, strokes[:, SIDE], strokes[:, TOP], np.abs(strokes[:, SIDE])]
        columns_seen.append(np.hypot(cue[..., path.X].std(axis=1), cue[..., path.Y].std(axis=1)))  # [m]
        return 20.0 / POINTS * gains.mean(axis=1), np.stack(columns_seen, axis=1)
