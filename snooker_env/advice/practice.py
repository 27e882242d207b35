"""Where are trial strokes played for advice? On a ``Practice``: with and without execution errors."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from .._check import choice, refuse, refuse_what
from .._types import Floats
from ..game.frame_columns import POINTS
from ..game.in_hand import place_cue
from ..planning import RULE_OF_THUMB, SURE, Planner, Positions, Stops, prospects_of, spread_of
from ..planning.positions import bare
from ..tasks.noise import Noise, NoiseLike
from ..tasks.options import Options
from ..tasks.tables import Tables
from .strokes import CueStroke

PHYSICAL_OPTIONS = tuple(name for name in Options.group("shot") if name != "noise")
"""The options that say where strokes are played. All others belong to a game."""
JUDGING, GOING_ON = 1, 2
"""Of noise samples: not those that chose a stroke judge it, so that a lucky choice is not overestimated."""


class Practice:
    """A table for trial strokes, with the player's execution errors (``noisy``) and without (``exact``)."""

    def __init__(self, options: Options):
        self.options = options
        self.noisy: Planner = Planner(options)
        self.exact: Planner = Planner(options, noise="none")
        physical: Any = {name: getattr(options, name) for name in PHYSICAL_OPTIONS}
        self._choices = Planner(Options(action="discrete", **physical))
        self.noise: Noise = options.rules.noise
        self.sure: bool = self.noise.silent
        self._spread = spread_of(self.noise, options.rules.physics)

    def play(self, at: Positions, rows: Any, strokes: Floats, keys: Any = None) -> Stops:
        """Play strokes (n, 5) on copies of ``at[rows]``: with errors if there are ``keys``, else without."""
        planner = self.exact if keys is None else self.noisy
        return planner.stops(at, rows, strokes=strokes, keys=None if self.sure else keys)

    def chosen(self, at: Positions, rows: Any, choices: Any) -> Floats:
        """The strokes (n, 5) that choices of ``action="discrete"`` mean on ``at[rows]``."""
        return self._choices.strokes_of(at, rows, choices)[0]

    def prospects(self, at: Positions) -> tuple[Floats, Floats]:
        """Values of positions for this player by the rule of thumb, and chances of their four widest pots."""
        rule = SURE if self.sure else RULE_OF_THUMB
        return prospects_of(
            at, self._spread, rule, threads=self.exact.threads, rails=self.options.rules.rails
        )


def practice_of(noise: NoiseLike, options: Any = None, source: Any = None) -> Practice:
    """The practice table for a noise and ``options``; None: those of an environment ``source``."""
    if options is None:
        options = getattr(bare(source), "options", None)
        options = options if isinstance(options, Options) else {}
    if isinstance(options, Options):
        names = PHYSICAL_OPTIONS if options.task == "visit" else (*PHYSICAL_OPTIONS, *Options.group("frame"))
        same: dict[str, Any] = {name: getattr(options, name) for name in names}
        same |= {} if options.task == "visit" else {"task": "frame"}
    elif isinstance(options, Mapping):
        for key in options:
            choice("key of options", key, PHYSICAL_OPTIONS)
        same = dict(options)
    else:
        allowed = f"must be None, an Options, or a dict with keys of {PHYSICAL_OPTIONS}"
        raise refuse_what("options", f"a {type(options).__name__}", allowed)
    return Practice(Options(noise=Noise.of(noise), **same))


def one_position(source: Any) -> Positions:
    """The one position in a source, with no points in its visit; ValueError if there is not one to play."""
    tables = getattr(bare(source), "tables", None)
    if isinstance(tables, Tables) and not tables.begun.all():
        words = "must have a position: call reset() first"
        raise refuse_what("position", "an environment before reset()", words)
    at = Positions.of(source)
    if len(at) != 1:
        raise refuse_what("position", f"{len(at)} positions", "must be one position")
    if at.over[0]:
        raise refuse("position.over", True, "must be False: the visit has ended, there is no stroke to play")
    at = at.copy()
    at.game[:, POINTS] = 0  # only future points count, and no break can exceed what a table allows
    return at


def played_from(at: Positions, stroke: CueStroke) -> Positions:
    """``at`` as a visit, with a cue ball in hand at the free place nearest to that of the stroke."""
    at = at.as_visits()
    if stroke.place is None:
        return at
    if not at.in_hand[0]:
        raise refuse("place", stroke.place, "must be None: the cue ball is not in hand")
    at = at.copy()
    at.positions[0, 0] = place_cue(at.positions[0], at.on_table[0], *stroke.place)
    return at


def keys(seed: int, purpose: int, n: int, *more: int) -> Any:
    """n keys of noise samples, uint64 (n,): the same for equal arguments; a larger n begins with the same."""
    return np.random.default_rng((seed, purpose, *more)).integers(0, 2**64 - 1, n, dtype=np.uint64)
