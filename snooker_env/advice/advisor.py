"""What must a player do that gives advice? Rank strokes in one position. From that, ``Advisor`` also plays on any number of tables."""

from abc import ABC, abstractmethod
from typing import Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .._types import Bools
from ..planning import Positions
from .practice import Practice, practice_of
from .strokes import CueStroke

Ranked: TypeAlias = list[tuple[CueStroke, float | None]]
"""Strokes, best first, each with the player's own score of it, or None."""


class Advisor(ABC):
    """Base class of players that rank strokes. Subclasses implement ``rank`` and set ``name``.

    An advisor can also play on tables, as all players of this project: ``options`` holds the keywords of ``Options`` that define its
    action format, and ``act`` returns one action for each table.

    Examples
    --------
    >>> import snooker_env as sn
    >>> from snooker_env.advice import Advisor, CueStroke
    >>> class StraightAhead(Advisor):
    ...     name = "straight_ahead"
    ...     def rank(self, practice, at, n, seed):
    ...         return [(CueStroke(speed=2.0, aim=1.5707963), None)]
    >>> advice = sn.advise(sn.Position(cue=(0.0, 0.0), black=(0.0, 1.4605)), agent=StraightAhead(), samples=20, visits=0)
    >>> advice[0].kind, advice[0].speed
    ('contact', 2.0)
    """

    name: ClassVar[str]
    options: ClassVar[dict[str, Any]] = {"aim": "absolute", "placement": True}

    def __init__(self) -> None:
        self._decisions = 0

    @abstractmethod
    def rank(self, practice: Practice, at: Positions, n: int, seed: int) -> Ranked:
        """Rank strokes in one position.

        Parameters
        ----------
        practice : Practice
            Plays trial strokes: ``practice.play`` with and without the player's execution errors; ``practice.prospects`` for the values of
            positions.
        at : Positions
            The one position, with one row.
        n : int
            About how many strokes the caller needs; more or fewer may be returned.
        seed : int
            Seed of the player's random numbers.

        Returns
        -------
        list of (CueStroke, float or None)
            At least one stroke, best first, each with the player's own score, or None.
        """

    def begin(self, seed: int) -> None:
        """Restart the player's random numbers from a seed: the same decisions follow again.

        Parameters
        ----------
        seed : int
            The seed, in [0, 1024).
        """
        self._decisions = seed << 20

    def act(self, tables: Any, observations: Any, going: Bools) -> NDArray[np.float32]:
        """Choose an action for each table.

        Parameters
        ----------
        tables : SnookerVectorEnv
            The tables, made with this player's ``options``.
        observations : numpy.ndarray
            float32 (n, k). Their flat observations.
        going : numpy.ndarray
            bool (n,). The tables that need an action.

        Returns
        -------
        numpy.ndarray
            float32 (n, k). One action for each table; 0 for tables that need none.
        """
        options, at = tables.options, Positions.of(tables)
        practice = practice_of(options.rules.noise, options)
        actions = np.zeros((len(going), options.rules.actions.size), np.float32)
        shape = {name: getattr(options, name) for name in ("elevation", "placement", "decision")}
        for k in np.flatnonzero(going).tolist():
            seed = self._decisions + (k << 32)  # each table its own: what is drawn on one says nothing of another
            (stroke, _), *_ = self.rank(practice, at[k : k + 1], 1, seed)
            actions[k] = stroke.action(**shape)
        self._decisions += 1
        return actions
