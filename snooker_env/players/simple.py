"""What do all built-in players share? They are bound to options, and place cue balls in hand."""

import copy
from typing import Any

import numpy as np

from .._check import refuse
from ..planning import Positions
from ..planning.planner import options_in
from ..planning.positions import seeds_of
from ..tasks.ghost_ball import put_in_hand
from ..tasks.options import Options
from .player import RulesLike


class BoundPlayer:
    """Base class of players: ``at`` binds a copy to options, for which subclasses have ``_bind``.

    Examples
    --------
    >>> from snooker_env.players import BoundPlayer
    >>> BoundPlayer().at({"noise": "club"}).options.noise
    'club'
    """

    name: str = ""
    training_shots: int | None = None
    """All simulated shots of its training; None: not known."""
    _options: Options | None = None

    def at(self, rules: RulesLike) -> Any:
        """Return a copy of this player bound to where it plays, see ``Player.at``."""
        bound = copy.copy(self)
        bound._options = options_in(rules)
        bound._bind(bound._options)
        return bound

    def _bind(self, options: Options) -> None:
        """What a player makes once for where it plays."""

    @property
    def options(self) -> Options:
        """Where the player plays; ValueError before ``at``."""
        if self._options is None:
            raise refuse("player", self.name, "must be bound first: player.at(options)")
        return self._options


def streams_of(seeds: Any) -> np.ndarray:
    """A random stream for each seed: uint64 (n, 2)."""
    streams = np.zeros((len(seeds), 2), np.uint64)
    streams[:, 0] = seeds
    return streams


def placed(at: Positions, seeds: Any) -> tuple[Positions, np.ndarray]:
    """Visits with cue balls in hand put where ``ghost_ball`` does, and these places (n, 2), else NaN."""
    places, keys = np.full((len(at), 2), np.nan), seeds_of(seeds, len(at))
    if not at.in_hand.any():
        return at.as_visits(), places
    moved = at.copy()
    put_in_hand(moved.positions, moved.on_table, moved.game, streams_of(keys))
    hand = at.in_hand
    places[hand] = moved.positions[hand, 0]
    return moved.as_visits(), places
