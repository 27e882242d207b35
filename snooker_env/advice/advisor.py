"""What must a player do that gives advice? Rank strokes at one position; from that ``Advisor`` plays on any number of tables as well."""

from abc import ABC, abstractmethod
from typing import Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .._types import Bools
from ..planning import Positions
from .practice import Practice, practice_of
from .strokes import CueStroke

Ranked: TypeAlias = list[tuple[CueStroke, float | None]]
"""Strokes, best first, each with the player's own score of it if it has one."""


class Advisor(ABC):
    """A player that ranks strokes.

    ``act`` makes it a player of tables, as all are: ``options`` says how its actions are read, and it gives one for each table.
    """

    name: ClassVar[str]
    options: ClassVar[dict[str, Any]] = {"aim": "absolute", "placement": True}

    def __init__(self) -> None:
        self._decisions = 0

    @abstractmethod
    def rank(self, practice: Practice, at: Positions, n: int, seed: int) -> Ranked:
        """At least one stroke at the one position ``at``, best first, about n or more if there are so many."""

    def act(self, tables: Any, observations: Any, going: Bools) -> NDArray[np.float32]:
        """An action for each table of a ``SnookerVectorEnv`` with these ``options``; of those not ``going`` any."""
        options, at = tables.options, Positions.of(tables)
        practice = practice_of(options.rules.noise, options)
        actions = np.zeros((len(going), options.rules.actions.size), np.float32)
        shape = {name: getattr(options, name) for name in ("elevation", "placement", "decision")}
        for k in np.flatnonzero(going).tolist():
            (stroke, _), *_ = self.rank(practice, at[k : k + 1], 1, self._decisions)
            actions[k] = stroke.action(**shape)
        self._decisions += 1
        return actions
