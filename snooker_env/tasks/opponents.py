"""Who plays the other side of a frame? ``ask`` is called once for all tables at which it is the opponent's
turn, in Python; ``prepare`` then carries what it returned out up to the strike, on several threads."""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from .._check import refuse
from .._jit import entry
from .._types import Action, Floats, Ints, Observation
from ..game.philox import pair
from . import observations
from .discrete_actions import Choices
from .frame import Frames, Generators, Opponent
from .stroke import ShotBuffers

Policy: TypeAlias = Callable[[Observation, np.random.Generator], Action]
"""A player in Python: maps the observation from its own side of the table, and a generator, to an action."""
SIDE = 1
"""Index of the opponent in the frame, and of its seat."""


@entry
def drawn(which, streams, out):
    """One uniform number in [0, 1) from the stream of each of the tables ``which``: out (len(which),)."""
    for j in range(which.shape[0]):
        out[j], _ = pair(streams[which[j]])


class AskedOpponent(Opponent):
    """A policy ``policy(observation, rng) -> action``; one with ``many(observations, generators, masks) ->
    actions`` is called once for all tables that wait (masks None for box actions)."""

    def __init__(self, policy: Policy):
        self.policy = policy

    def ask(self, frames: Frames, which: Ints, generators: Generators) -> Floats:
        """See ``Opponent.ask``: (n, k). ValueError, naming "opponent's action", for an invalid one."""
        actions, k_of = frames.seats[SIDE].actions, which.tolist()
        seen = frames.observe(which, SIDE)
        wished = self._wishes(frames, which, seen, [generators[k] for k in k_of])
        out = np.zeros((frames.n, actions.size))
        for j, k in enumerate(k_of):
            try:
                out[k] = actions.check(wished[j])
            except ValueError as error:
                raise ValueError(f"opponent's {error}") from None
        return out

    def prepare(self, frames: Frames, which: Ints, asked: Floats, buffers: ShotBuffers) -> Ints:
        """See ``Opponent.prepare``."""
        return frames.prepare(which, asked, buffers, SIDE)

    def _wishes(self, frames, which, seen, generators):
        kind, many = frames.rules.observation, getattr(self.policy, "many", None)
        discrete = isinstance(frames.seats[SIDE].actions, Choices)
        wanted = discrete and (many is not None or kind == "masked")
        masks = frames.action_masks(which, SIDE) if wanted else None
        if many is None:
            shown = zip(seen, [None] * len(seen) if masks is None else masks, strict=True)
            views = [observations.shaped(kind, row.copy(), mask) for row, mask in shown]
            return [self.policy(view, rng) for view, rng in zip(views, generators, strict=True)]
        wished = many(observations.shaped(kind, seen, masks), generators, masks)
        if not hasattr(wished, "__len__") or len(wished) != len(which):
            raise refuse("opponent's actions", wished, f"must be {len(which)}, one for each table that waits")
        return wished
