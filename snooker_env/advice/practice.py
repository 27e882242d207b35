"""Where are trial strokes played for advice? On a ``Practice`` table: planners with and without execution noise, made once and reused."""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._check import choice, refuse, refuse_what
from ..game.balls import SPOTS
from ..game.frame_columns import POINTS
from ..game.in_hand import place_cue
from ..geometry import BAULK_Y, D_RADIUS
from ..planning import Planner, Positions, Stops, prospects_of, spread_of
from ..planning.positions import bare
from ..planning.prospects import RULE_OF_THUMB, SURE
from ..tasks.noise import Noise, NoiseLike
from ..tasks.options import Options
from .strokes import CueStroke

PHYSICAL_OPTIONS = ("physics", "table", "fidelity")
"""The options that say where strokes are played. All others belong to a game."""
PLACES = tuple((x * D_RADIUS, BAULK_Y - y * D_RADIUS) for y in (0.0, 0.4) for x in (-0.85, -0.6, -0.3, 0.0, 0.3, 0.6, 0.85))
"""Places in the D [m] that are tried with the cue ball in hand, or the nearest free ones."""


class Practice:
    """A table for trial strokes, with the player's execution errors (``noisy``) and without (``exact``)."""

    def __init__(self, options: Options):
        self.options = options
        self.noisy: Planner = Planner(options)
        self.exact: Planner = Planner(options, noise="none")
        physical: Any = {name: getattr(options, name) for name in PHYSICAL_OPTIONS}
        self._choices = Planner(Options(action="discrete", **physical))
        self.spread: float = spread_of(self.noise, options.rules.physics)
        self.sure: bool = self.noise.silent
        self._thumb = SURE if self.sure else RULE_OF_THUMB

    @property
    def noise(self) -> Noise:
        """The player's execution errors."""
        return self.options.rules.noise

    def play(self, at: Positions, rows: Any, strokes: NDArray[np.float64], keys: NDArray[np.uint64] | None = None) -> Stops:
        """Play strokes (n, 5) on copies of ``at[rows]``: with execution errors if ``keys`` are given, else as intended."""
        planner = self.exact if keys is None else self.noisy
        return planner.stops(at, rows, strokes=strokes, keys=None if self.sure else keys)

    def chosen(self, at: Positions, rows: Any, choices: NDArray[np.int64]) -> NDArray[np.float64]:
        """The strokes (n, 5) that choices of ``action="discrete"`` mean on ``at[rows]``."""
        return self._choices.strokes_of(at, rows, choices)[0]

    def prospects(self, at: Positions) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Values of positions for this player by the rule of thumb, and the chances of their four widest pots."""
        return prospects_of(at, self.spread, self._thumb, threads=self.exact.threads)


def practice_of(noise: NoiseLike, options: Any = None, source: Any = None) -> Practice:
    """The practice table for a noise and ``options``: a mapping with keys of ``PHYSICAL_OPTIONS``, an ``Options``, or None.

    None takes the options of ``source`` if that is an environment, else the defaults. Raises ValueError for anything else.
    """
    if options is None:
        options = getattr(bare(source), "options", None)
        options = options if isinstance(options, Options) else {}
    if isinstance(options, Options):
        given = {name: getattr(options, name) for name in PHYSICAL_OPTIONS}
    elif isinstance(options, Mapping):
        for key in options:
            choice("key of options", key, PHYSICAL_OPTIONS)
        given = dict(options)
    else:
        raise refuse_what("options", f"a {type(options).__name__}", f"must be None, an Options, or a dict with keys of {PHYSICAL_OPTIONS}")
    return _practice(Options(noise=Noise.of(noise), elevation=True, **given))  # type: ignore[arg-type]


@lru_cache(maxsize=16)
def _practice(options: Options) -> Practice:
    return Practice(options)


def one_position(source: Any) -> Positions:
    """The one position in a source of positions, with the points of its visit set to 0; ValueError if there are several."""
    at = Positions.of(source).as_visits()
    if len(at) != 1:
        raise refuse_what("position", f"{len(at)} positions", "must be one position")
    if at.over[0]:
        raise refuse("position.over", True, "must be False: the visit has ended, there is no stroke to play")
    at = at.copy()
    at.game[:, POINTS] = 0  # only future points count, and no break can exceed what a table allows
    return at


def placed(at: Positions, places: Any) -> Positions:
    """Copies of the one position ``at``, with the cue ball at each of ``places`` in the D, or at the nearest free place."""
    out = at[np.zeros(len(places), np.int64)]
    for k, (x, y) in enumerate(places):
        out.positions[k, 0] = place_cue(at.positions[0], at.on_table[0], float(x), float(y))
    return out


def starts(practice: Practice, at: Positions, most: int = 3) -> Positions:
    """The positions to play from: the one position or, with the cue ball in hand, the ``most`` best places in the D."""
    if not at.in_hand[0]:
        return at
    tried = placed(at, (*PLACES, SPOTS[0]))
    values, _ = practice.prospects(tried)
    return tried[np.argsort(-values, kind="stable")[:most]]


def played_from(at: Positions, stroke: CueStroke) -> Positions:
    """The position that a stroke is played from: ``at``, with the cue ball at the stroke's place. ValueError if it may not be placed."""
    if stroke.place is None:
        return at
    if not at.in_hand[0]:
        raise refuse("place", stroke.place, "must be None: the cue ball is not in hand")
    return placed(at, [stroke.place])


def stroke_of_row(row: NDArray[np.float64], start: Positions, in_hand: bool) -> CueStroke:
    """The stroke of a row (5,), played from the one position ``start``."""
    speed, side, top, aim, elevation = row.tolist()
    place = tuple(start.positions[0, 0].tolist()) if in_hand else None
    return CueStroke(speed=speed, side=side, top=top, aim=aim, elevation=elevation, place=place)
