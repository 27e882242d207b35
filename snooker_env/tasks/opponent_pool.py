"""How does one train against several opponents? One is drawn for each frame, from the table's own stream."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from .._check import integer, number, refuse
from .._types import Ints
from ..game.frame_columns import OPPONENT
from .frame import Frames, Generators, Opponent, Turn
from .opponents import drawn


class OpponentPool:
    """Several opponents, one of whom is drawn for each table and frame, by their weights.

    The draw comes from the table's own stream and is part of its state: the same seed meets the same
    opponents. Members may be added at any time, as past selves during training.

    Parameters
    ----------
    members : iterable, optional
        What ``opponent=`` of an environment accepts, except another pool. Default: none yet.
    weights : iterable of float, optional
        One weight for each member, at least 0; default 1 for each.

    Examples
    --------
    >>> from snooker_env.tasks import OpponentPool
    >>> pool = OpponentPool(["random", "ghost_ball"], weights=[1, 3])
    >>> pool.add("random")
    >>> pool.weights
    (1.0, 3.0, 1.0)
    """

    def __init__(self, members: Iterable[Any] | None = None, weights: Iterable[float] | None = None):
        self._members: list[Any] = []
        self._weights: list[float] = []
        listed = [] if members is None else list(members)
        if members is not None and not listed:
            allowed = "must hold one member at least; leave them out where add(...) follows"
            raise refuse("members", listed, allowed)
        each = [1.0] * len(listed) if weights is None else list(weights)
        if len(each) != len(listed):
            raise refuse("weights", each, f"must be {len(listed)} numbers, one for each member")
        for member, weight in zip(listed, each, strict=True):
            self.add(member, weight)
        if listed and not any(self._weights):
            raise refuse("weights", each, "must hold a number above 0: nobody could be drawn")

    @property
    def members(self) -> tuple[Any, ...]:
        """The members, in the order in which they were added."""
        return tuple(self._members)

    @property
    def weights(self) -> tuple[float, ...]:
        """Their weights, as floats."""
        return tuple(self._weights)

    def add(self, member: Any, weight: float = 1.0) -> None:
        """Add a member, which later frames may draw; ValueError for a pool, or a weight below 0."""
        nobody = member is None or (isinstance(member, str) and member == "none")
        if nobody or isinstance(member, OpponentPool):
            allowed = "must be one opponent: a name, a model's file, a callable or a player"
            raise refuse("member", member, allowed)
        weight = number("weight", weight, 0.0)
        self._members.append(member)
        self._weights.append(weight)

    def set_weight(self, index: int, weight: float) -> None:
        """Change the weight of ``members[index]``, 0: not drawn any more; ValueError for a bad number."""
        self._weights[integer("index", index, 0, len(self._members) - 1)] = number("weight", weight, 0.0)


class PoolOpponent(Opponent):
    """The members of a pool as opponents; ``opponent_of`` makes a member ready to play."""

    def __init__(self, pool: OpponentPool, opponent_of: Callable[[Any], Any]):
        self.pool: OpponentPool = pool
        self._opponent_of = opponent_of
        self._ready: list[Any] = []
        self._complete()

    def _complete(self):
        for k, member in enumerate(self.pool.members[len(self._ready) :], len(self._ready)):
            try:
                self._ready.append(self._opponent_of(member))
            except ValueError as error:
                raise ValueError(f"members[{k}] of the OpponentPool: {error}") from error

    def prepare(self, frames: Frames, which: Ints, asked: Any, buffers: Any) -> Ints:
        """Nothing: its members play."""
        return which[:0]

    def turns(self, frames: Frames, which: Ints, generators: Generators) -> list[Turn]:
        """See ``Opponent.turns``: one entry for each member that plays."""
        self._complete()
        self._draw(frames, which)
        playing = frames.game[which, OPPONENT]
        turns: list[Turn] = []
        for number_ in np.unique(playing).tolist():
            if number_ > len(self._ready):
                allowed = f"must be below {len(self._ready)}, as many as the pool has"
                raise refuse("opponent", f"member {number_ - 1} of a pool", allowed)
            turns += self._ready[number_ - 1].turns(frames, which[playing == number_], generators)
        return turns

    def _draw(self, frames, which):
        """Draw an opponent where none has been drawn in this frame."""
        new = which[frames.game[which, OPPONENT] == 0]
        if not len(new):
            return
        shares = np.cumsum(self.pool.weights)
        if not len(shares) or shares[-1] <= 0.0:
            raise refuse("opponent", "an OpponentPool", "must have a member with a weight above 0")
        numbers = np.empty(len(new))
        drawn(new, frames.streams, numbers)
        frames.game[new, OPPONENT] = 1 + np.searchsorted(shares, numbers * shares[-1], side="right")
