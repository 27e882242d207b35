"""How does a stroke turn out under execution errors? Chances, expected points and stopping points, on common noise samples."""

from math import hypot, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..game.balls import CUE
from ..geometry import BALL_RADIUS
from ..planning import Positions, Stops, clear_paths
from . import seeds
from .advisor import Ranked
from .practice import Practice, played_from
from .strokes import CueStroke
from .suggestions import Suggestion
from .visits import played_on
from .words import RAISED, contact_words, cushion_words, figures_words, stroke_words, what_words

Z = 1.959964
"""Standard deviations of a 95 % interval."""


def wilson(made: int, tries: int) -> tuple[float, float]:
    """The 95 % interval of a probability of which ``made`` of ``tries`` samples were successes (Wilson 1927).

    Examples
    --------
    >>> from snooker_env.advice.judging import wilson
    >>> [round(x, 4) for x in wilson(87, 100)]
    [0.7902, 0.9224]
    """
    share, z2 = made / tries, Z * Z / tries
    middle = (share + 0.5 * z2) / (1.0 + z2)
    half = Z * sqrt(share * (1.0 - share) / tries + 0.25 * z2 / tries) / (1.0 + z2)
    return max(0.0, min(share, middle - half)), min(1.0, max(share, middle + half))


def points_expected(
    points: NDArray[np.float64], goes_on: NDArray[np.bool_], rest: NDArray[np.float64]
) -> tuple[float, tuple[float, float]]:
    """Mean points of a visit and its 95 % interval, from ``points`` and ``goes_on`` (samples,) of the first stroke and ``rest`` (visits,).

    The mean is that of the stroke's points plus, as often as the visit goes on, the mean of the rest. The variance is the sum of two parts
    (delta method): the variance of the first mean over the samples, and that of the mean of the rest over the visits times the squared
    share of samples that go on.
    """
    n, follows = len(points), float(rest.mean()) if len(rest) else 0.0
    share, each = float(goes_on.mean()), points + goes_on * follows
    mean = float(each.mean())
    variance = float(each.var(ddof=1)) / n if n > 1 else 0.0
    variance += share * share * float(rest.var(ddof=1)) / len(rest) if len(rest) > 1 else 0.0
    half = Z * sqrt(variance)
    return mean, (max(0.0, mean - half), mean + half)


class Trial(NamedTuple):
    """What a stroke does without errors."""

    kind: str
    ball: int
    pocket: int
    first: int
    words: str
    """What it does and how it is struck, in words."""


def trials_of(practice: Practice, at: Positions, strokes: list[CueStroke]) -> tuple[Positions, list[Trial]]:
    """What strokes in the one position ``at`` do without errors, and the positions that they are played from, one row each."""
    there = [played_from(at, stroke) for stroke in strokes]
    places, on_table, game = (np.concatenate([getattr(one, name) for one in there]) for name in ("positions", "on_table", "game"))
    starts = Positions(places, on_table, game)
    trial = practice.play(starts, np.arange(len(strokes)), np.stack([stroke.numbers() for stroke in strokes]))
    hidden = ~clear_paths(starts).any_part
    return starts, [_trial(practice, starts, trial, k, stroke, bool(hidden[k])) for k, stroke in enumerate(strokes)]


def _trial(practice: Practice, starts: Positions, trial: Stops, k: int, stroke: CueStroke, hidden: bool) -> Trial:
    """What stroke k of the trial without errors does; ``hidden``: no straight path leads to a ball on."""
    first, pocket, how = int(trial.first[k]), -1, ""
    ball, (x, y) = first, starts.positions[k, CUE].tolist()
    dx, dy = (starts.positions[k, max(0, first)] - (x, y)).tolist()
    down = [ball for ball in np.flatnonzero(trial.potted[k] >= 0).tolist() if ball != CUE]
    if trial.points[k] > 0 and down:
        kind, ball = "pot", first if first in down else down[0]
        pocket = int(trial.potted[k, ball])
    elif trial.penalty[k]:
        kind = "in-off" if trial.potted[k, CUE] >= 0 else "foul"
    elif hidden:
        kind, how = "escape", cushion_words(x, y, stroke.aim) if stroke.elevation < RAISED else ""
    else:
        kind, how = "safety", contact_words(dx, dy, stroke.aim)
    distance = None if first < 0 else max(0.0, hypot(dx, dy) - 2.0 * BALL_RADIUS)
    words = f"{what_words(kind, ball, pocket, first, how)}, {stroke_words(stroke, distance, practice.options.rules.physics)}"
    return Trial(kind, ball, pocket, first, words)


def distinct(practice: Practice, at: Positions, ranked: Ranked) -> Ranked:
    """Keep only the first of several strokes with equal descriptions, apart from the speed of a pot."""
    _, trials = trials_of(practice, at, [stroke for stroke, _ in ranked])
    seen, kept = set(), []
    for one, trial in zip(ranked, trials, strict=True):
        what = trial.words.replace(f"{one[0].speed:.1f} m/s", "") if trial.kind == "pot" else trial.words
        if what not in seen:
            seen.add(what)
            kept.append(one)
    return kept


def judged(practice: Practice, at: Positions, ranked: Ranked, *, samples: int, visits: int, seed: int) -> list[Suggestion]:
    """Strokes in the one position ``at`` with their outcomes under execution errors, in their order."""
    n = len(ranked)
    starts, trials = trials_of(practice, at, [stroke for stroke, _ in ranked])
    strokes = np.stack([stroke.numbers() for stroke, _ in ranked])
    tries, again = (1, min(1, visits)) if practice.sure else (samples, visits)
    keys = seeds.keys(seed, seeds.JUDGING, tries)
    stops = practice.play(starts, np.repeat(np.arange(n), tries), np.repeat(strokes, tries, 0), np.tile(keys, n))
    rest = _rest(practice, stops, n, tries, again, seed)
    out = []
    for k, ((stroke, score), trial) in enumerate(zip(ranked, trials, strict=True)):
        own = slice(k * tries, (k + 1) * tries)
        fair = stops.penalty[own] == 0
        made = fair & (stops.potted[own, trial.ball] == trial.pocket) if trial.kind == "pot" else fair
        chance = float(made.mean())
        points, interval = points_expected(stops.points[own], stops.goes_on[own], rest[k])
        stayed = stops.potted[own, CUE] < 0
        middle, spread = _cloud(stops.places[own, CUE][stayed])
        out.append(Suggestion(
            **{name: getattr(stroke, name) for name in ("speed", "aim", "side", "top", "elevation", "place")},
            kind=trial.kind, ball=trial.ball, pocket=trial.pocket, first=trial.first,
            chance=chance, chance_interval=(chance, chance) if practice.sure else wilson(int(made.sum()), tries),
            points=points, points_interval=interval, foul=float((~fair).mean()), in_off=float((~stayed).mean()),
            stops=middle, spread=spread, score=score, words=f"{trial.words}, {figures_words(trial.kind, chance, points)}",
        ))  # fmt: skip
    return out


def _cloud(places: NDArray[np.float64]) -> tuple[tuple[float, float] | None, float | None]:
    """The mean of points (m, 2) and the root of their mean square distance from it; None, None if there are no points."""
    if not len(places):
        return None, None
    x, y = places.mean(axis=0).tolist()
    return (x, y), float(np.sqrt(((places - (x, y)) ** 2).sum(axis=1).mean()))


def _rest(practice: Practice, stops: Stops, n: int, tries: int, visits: int, seed: int) -> list[NDArray[np.float64]]:
    """For each of n strokes: the points that followed in the first ``visits`` of its samples in which the visit went on."""
    rows = [k * tries + np.flatnonzero(stops.goes_on[k * tries : (k + 1) * tries])[:visits] for k in range(n)]
    numbers = np.concatenate([np.arange(len(own)) for own in rows]).astype(np.int64)
    rest = played_on(practice, stops.afterstates[np.concatenate(rows).astype(np.int64)], numbers, seed)
    ends = np.cumsum([len(own) for own in rows])
    return np.split(rest, ends[:-1])
