"""Where do the balls of a stroke stop under execution errors?"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .._lib.check import integer
from .._lib.types import Floats
from ..game.balls import CUE
from ..planning.positions import PositionsLike
from ..players.cue_stroke import CueStroke, StrokeLike
from ..tasks.noise import NoiseLike
from .practice import JUDGING, keys, one_position, practice_of, start_from


@dataclass(frozen=True, eq=False, kw_only=True)
class Destinations:
    """Where the balls of one stroke stop under execution errors, as returned by ``destinations``.

    Attributes
    ----------
    samples : int
        How often the stroke was played.
    object_ball : int
        Id of the ball that it strikes first without errors; -1 if none.
    cue : numpy.ndarray
        float64 (m, 2). Where the cue ball stopped [m], for the samples in which it stayed on the table.
    ball : numpy.ndarray
        float64 (m, 2). The same for the object ball, before respotting; (0, 2) if there is none.
    potted, in_off, foul, scored : float
        Shares of the samples in which the object ball or the cue ball was potted, with a foul, with points.
    points : float
        Mean points of the stroke.

    Examples
    --------
    >>> import snooker_env as sn
    >>> from snooker_env.advice import destinations
    >>> position = sn.Position(cue=(0.0, 0.9), black=(0.4, 1.3))
    >>> stops = destinations(position, {"speed": 1.8, "aim": 0.8}, noise="none")
    >>> stops.samples, stops.cue.shape, stops.foul
    (1, (1, 2), 0.0)
    """

    samples: int
    object_ball: int
    cue: Floats = field(repr=False)
    ball: Floats = field(repr=False)
    potted: float
    in_off: float
    foul: float
    scored: float
    points: float

    def to_dict(self) -> dict[str, Any]:
        """Return all attributes by name as JSON types; points as lists, rounded to 0.1 mm."""
        return vars(self) | {name: getattr(self, name).round(4).tolist() for name in ("cue", "ball")}


def destinations(
    position: PositionsLike,
    stroke: StrokeLike,
    *,
    noise: NoiseLike = "professional",
    samples: int = 500,
    seed: int = 0,
    options: object = None,
) -> Destinations:
    """Find where the balls of a stroke stop under execution errors, and how often it pots and fouls.

    Parameters
    ----------
    position, stroke, noise
        As in ``advise``; the stroke as intended, a ``CueStroke``, ``Suggestion`` or dict of ``CueStroke``.
    samples : int
        How often the stroke is played, in [1, 1000000]; once without noise.
    seed : int
        Seed of the noise samples, in [0, 2**63]. Every stroke meets the same errors with the same seed, so the
        places change smoothly with the stroke.
    options
        As in ``advise``.

    Returns
    -------
    Destinations
        ValueError if an argument is invalid, or there is no stroke to play.

    Examples
    --------
    >>> import snooker_env as sn
    >>> from snooker_env.advice import destinations
    >>> position = sn.Position(cue=(0.0, 0.9), black=(0.4, 1.3))
    >>> stops = destinations(position, {"speed": 1.8, "aim": 0.8}, samples=100)
    >>> stops.object_ball, stops.cue.shape[1]
    (21, 2)
    """
    integer("samples", samples, 1, 1_000_000)
    integer("seed", seed, 0, 2**63)
    practice, struck = practice_of(noise, options, position), CueStroke.of(stroke)
    start, row = start_from(one_position(position).as_visits(), struck), struck.numbers()[None]
    tries = 1 if practice.sure else samples
    rows = np.zeros(tries, np.int64)
    ball = int(practice.play(start, rows[:1], row).first[0])
    stops = practice.play(start, rows, np.repeat(row, tries, 0), keys(seed, JUDGING, tries))
    stayed = stops.potted[:, CUE] < 0
    here = stops.potted[:, ball] < 0 if ball > 0 else np.zeros(tries, np.bool_)
    return Destinations(
        samples=tries,
        object_ball=ball,
        cue=stops.places[stayed, CUE],
        ball=stops.places[here, max(0, ball)],
        potted=float(1.0 - here.mean()) if ball > 0 else 0.0,
        in_off=float(1.0 - stayed.mean()),
        foul=float((stops.penalty > 0).mean()),
        scored=float((stops.points > 0).mean()),
        points=float(stops.points.mean()),
    )
