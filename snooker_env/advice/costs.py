"""What do strokes cost a player? Points of a frame lost by potting, position and safety (docs/play/coach.md)."""

from typing import Any

import numpy as np

from .._types import Floats, Ints
from ..planning import Positions, pots
from ..planning.proposals import strokes_at
from ..planning.sobol import sobol_points
from ..planning.worth import lead_of, passed
from .judging import joined
from .practice import JUDGING, Practice, keys, one_position
from .recorded import Recorded

PARTS = ("potting", "position", "safety")
# Strokes tried at a called pot, the best of them, how often these are played
LOOKS, BEST, SAMPLES = 24, 4, 24
SLOW, FAST, TIP = 0.8, 4.5, 0.35  # of these strokes: cue speeds [m/s], the largest height of the tip over R


def lost(strokes: list[Recorded], bench: Practice, seed: int) -> tuple[Floats, Ints]:
    """Points lost against the errors of ``bench``, (n, 3) by ``PARTS``; how many strokes tell each, (3,)."""
    parts, counts = np.zeros((len(strokes), 3)), np.zeros(3, np.int64)
    known = [k for k, one in enumerate(strokes) if one.after is not None]
    at = {k: one_position(strokes[k].position, strokes[k].scores) for k in known}
    worths = worth_of(bench, [at[k] for k in known])
    left = values(bench, [strokes[k] for k in known])
    for k, worth, value in zip(known, worths, left, strict=True):
        one = strokes[k]
        if one.ball is None:
            parts[k, 2] = worth - value
            counts[2] += 1
            continue
        best = best_at(bench, at[k], one, seed) if one.potted is not None else None
        if best is None:
            continue
        p, made, missed = best
        parts[k, 0] = (p - bool(one.potted)) * (made - missed)
        parts[k, 1 if one.potted else 2] = (made if one.potted else missed) - value
        counts += [1, bool(one.potted), not one.potted]
    return parts, counts


def worth_of(bench: Practice, at: list[Positions]) -> Floats:
    """What positions of frames are worth to their strikers (n,)."""
    return np.asarray(bench.judge.worth(joined(at)), np.float64) if at else np.empty(0)


def values(bench: Practice, strokes: list[Recorded]) -> Floats:
    """What strokes were worth as they came (n,): points, and the worth of what they left."""
    out = np.array([float(one.points - one.penalty) for one in strokes])
    going = [k for k, one in enumerate(strokes) if one.after is not None and not one.after.over]
    after = []
    for one in (strokes[k] for k in going):
        scores = one.scores[0] + one.points, one.scores[1] + one.penalty
        scores = tuple(min(score, 1000) for score in (scores if one.goes_on else scores[::-1]))
        after.append(one_position(one.after, scores))
    signs = np.array([1.0 if strokes[k].goes_on else -1.0 for k in going])
    out[going] += signs * worth_of(bench, after)
    return out


def best_at(bench: Practice, at: Positions, one: Recorded, seed: int) -> tuple[float, float, float] | None:
    """The target's best stroke at the called pot: chance, worth if made and if missed; None if not direct."""
    direct = pots(at, 16)
    which = np.flatnonzero((direct.ball[0] == one.ball) & (direct.pocket[0] == one.pocket))
    if not len(which):
        return None
    u = sobol_points(LOOKS, 2, seed)
    tips = np.column_stack([SLOW * (FAST / SLOW) ** u[:, 0], np.zeros(LOOKS), TIP * (2.0 * u[:, 1] - 1.0)])
    asked, before, each = bench.judge, lead_of(at), np.full((1, LOOKS), which[0])
    proposed = strokes_at(at.as_visits(), each, tips[None], asked.spread, asked.dynamics)
    strokes, chances = proposed.strokes[0], proposed.chances[0]

    def outcomes(tried: Floats, samples: Any) -> tuple[Any, Floats]:
        rows = np.zeros(len(tried), np.int64)
        stops = bench.play(at, rows, tried, samples)
        went = (stops.potted[:, one.ball] == one.pocket) & (stops.penalty == 0)
        return went, asked.valued(np.repeat(before, len(tried)), stops.afterstates)[:, 1]

    went, worth = outcomes(strokes, None)
    looks = np.where(went, chances * worth, -np.inf)
    best = np.argsort(-looks, kind="stable")[:BEST]
    many = 1 if bench.sure else SAMPLES
    samples = None if bench.sure else np.tile(keys(seed, JUDGING, many), len(best))
    played = outcomes(np.repeat(strokes[best], many, 0), samples)
    went, worth = (part.reshape(len(best), many) for part in played)
    k = int(worth.mean(axis=1).argmax())
    if not went[k].any():
        return None
    made = float(worth[k][went[k]].mean())
    # where it is never missed: a miss would leave the balls about as they lie
    left = float(worth[k][~went[k]].mean()) if not went[k].all() else -float(asked.worth(passed(at))[0])
    return float(went[k].mean()), made, left
