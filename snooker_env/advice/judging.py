"""What comes of a stroke under errors? Chances, points expected and stops of strokes that all meet the same noise samples."""

from math import sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..game.balls import CUE
from ..planning import Positions, Stops, clear_paths
from . import seeds
from .practice import Practice, played_from
from .strokes import CueStroke
from .suggestions import Suggestion
from .visits import played_on
from .words import figures_words, stroke_words, what_words

Z = 1.959964
"""Of a 95 % interval."""


def wilson(made: int, tries: int) -> tuple[float, float]:
    """The 95 % interval of a chance of which ``made`` of ``tries`` samples are known (Wilson 1927).

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
    """Mean points of a visit and its 95 % interval, of ``points`` and ``goes_on`` (samples,) of a stroke, ``rest`` (visits,) of what followed.

    The mean is that of the stroke's points and, as often as the visit goes on, the mean of the rest. Its variance is that of the first
    mean over the samples and, by the share that goes on squared, that of the second over the visits (delta method).
    """
    n, follows = len(points), float(rest.mean()) if len(rest) else 0.0
    share, each = float(goes_on.mean()), points + goes_on * follows
    mean = float(each.mean())
    variance = float(each.var(ddof=1)) / n if n > 1 else 0.0
    variance += share * share * float(rest.var(ddof=1)) / len(rest) if len(rest) > 1 else 0.0
    half = Z * sqrt(variance)
    return mean, (max(0.0, mean - half), mean + half)


def intended(look: Stops, k: int, escape: bool) -> dict[str, Any]:
    """What stroke k of a look without errors does: kind, ball, pocket, first."""
    first, down = int(look.first[k]), np.flatnonzero(look.potted[k] >= 0).tolist()
    down = [ball for ball in down if ball != CUE]
    if look.points[k] > 0 and down:
        ball = first if first in down else down[0]
        return {"kind": "pot", "ball": ball, "pocket": int(look.potted[k, ball]), "first": first}
    kind = "foul" if look.penalty[k] else "escape" if escape else "safety"
    return {"kind": kind, "ball": first, "pocket": -1, "first": first}


def judged(
    practice: Practice, at: Positions, ranked: list[tuple[CueStroke, float | None]], *, samples: int, visits: int, seed: int
) -> list[Suggestion]:
    """Strokes at the one position ``at`` with what comes of each, in their order."""
    if not ranked:
        return []
    n = len(ranked)
    there = [played_from(at, stroke) for stroke, _ in ranked]
    starts = Positions(*(np.concatenate([getattr(one, name) for one in there]) for name in ("positions", "on_table", "game")))
    strokes = np.stack([stroke.numbers() for stroke, _ in ranked])
    look = practice.play(starts, np.arange(n), strokes)
    tries, again = (1, min(1, visits)) if practice.sure else (samples, visits)
    keys = seeds.keys(seed, seeds.JUDGING, tries)
    stops = practice.play(starts, np.repeat(np.arange(n), tries), np.repeat(strokes, tries, 0), np.tile(keys, n))
    rest = _rest(practice, stops, n, tries, again, seed)
    hidden = ~clear_paths(starts).any_part
    out = []
    for k, (stroke, score) in enumerate(ranked):
        own = slice(k * tries, (k + 1) * tries)
        does = intended(look, k, bool(hidden[k]))
        fair = stops.penalty[own] == 0
        made = fair & (stops.potted[own, does["ball"]] == does["pocket"]) if does["kind"] == "pot" else fair
        chance = float(made.mean())
        points, interval = points_expected(stops.points[own], stops.goes_on[own], rest[k])
        stayed = stops.potted[own, CUE] < 0
        places = stops.places[own, CUE][stayed]
        middle = places.mean(axis=0) if len(places) else None
        spread = None if middle is None else float(np.sqrt(((places - middle) ** 2).sum(axis=1).mean()))
        first = does["first"]
        distance = None if first < 0 else max(0.0, float(np.hypot(*(starts.positions[k, first] - starts.positions[k, CUE]))) - 0.0525)
        words = ", ".join((
            what_words(**does), stroke_words(stroke, distance, practice.options.rules.physics), figures_words(does["kind"], chance, points)
        ))  # fmt: skip
        out.append(Suggestion(
            **{name: getattr(stroke, name) for name in ("speed", "aim", "side", "top", "elevation", "place")}, **does,
            chance=chance, chance_interval=(chance, chance) if practice.sure else wilson(int(made.sum()), tries),
            points=points, points_interval=interval, foul=float(1.0 - fair.mean()), in_off=float(1.0 - stayed.mean()),
            stops=None if middle is None else (float(middle[0]), float(middle[1])), spread=spread, score=score, words=words,
        ))  # fmt: skip
    return out


def _rest(practice: Practice, stops: Stops, n: int, tries: int, visits: int, seed: int) -> list[NDArray[np.float64]]:
    """Of each of n strokes: what followed in the first ``visits`` of its samples in which the visit went on."""
    rows = [k * tries + np.flatnonzero(stops.goes_on[k * tries : (k + 1) * tries])[:visits] for k in range(n)]
    numbers = np.concatenate([np.arange(len(own)) for own in rows]).astype(np.int64)
    rest = played_on(practice, stops.afterstates[np.concatenate(rows).astype(np.int64)], numbers, seed)
    ends = np.cumsum([len(own) for own in rows])
    return np.split(rest, ends[:-1])
