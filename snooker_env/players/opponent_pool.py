"""How does one train against several opponents? One is drawn for each frame, from the table's own stream."""

from collections.abc import Iterable
from pathlib import Path
from typing import TypeAlias

from .._lib.check import integer, number, refuse
from .player import Player

Member: TypeAlias = str | Path | Player
"""Whom a pool may hold: a player, or its name as ``snooker_env.player`` takes it."""


class OpponentPool:
    """Several opponents, one of whom is drawn for each table and frame, by their weights.

    The draw comes from the table's own stream and is part of its state: the same seed meets the same
    opponents. Members may be added at any time, as past selves during training.

    Parameters
    ----------
    members : iterable, optional
        Players, or their names. Default: none yet.
    weights : iterable of float, optional
        One weight for each member, at least 0; default 1 for each.

    Examples
    --------
    >>> from snooker_env.players import OpponentPool
    >>> pool = OpponentPool(["random", "ghost_ball"], weights=[1, 3])
    >>> pool.add("random")
    >>> pool.weights
    (1.0, 3.0, 1.0)
    """

    def __init__(self, members: Iterable[Member] | None = None, weights: Iterable[float] | None = None):
        self._members: list[Member] = []
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
    def members(self) -> tuple[Member, ...]:
        """The members, in the order in which they were added."""
        return tuple(self._members)

    @property
    def weights(self) -> tuple[float, ...]:
        """Their weights, as floats."""
        return tuple(self._weights)

    def add(self, member: Member, weight: float = 1.0) -> None:
        """Add a member, which later frames may draw; ValueError for a pool, or a weight below 0."""
        nobody = member is None or (isinstance(member, str) and member == "none")
        if nobody or isinstance(member, OpponentPool):
            allowed = "must be one opponent: a name or a player"
            raise refuse("member", member, allowed)
        weight = number("weight", weight, 0.0)
        self._members.append(member)
        self._weights.append(weight)

    def set_weight(self, index: int, weight: float) -> None:
        """Change the weight of ``members[index]``, 0: not drawn any more; ValueError for a bad number."""
        self._weights[integer("index", index, 0, len(self._members) - 1)] = number("weight", weight, 0.0)
