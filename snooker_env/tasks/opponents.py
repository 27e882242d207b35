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
from .declarations import COLOURS
from .discrete_actions import SIZE as CHOICES
from .discrete_actions import Choices
from .frame import Frames, Generators, Opponent
from .stroke import ShotBuffers

Policy: TypeAlias = Callable[[Observation, np.random.Generator], Action]
"""A player in Python: maps the observation from its own side of the table, and a generator, to an action."""
SIDE = 1  # index of the opponent in the frame, and of its seat


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


@entry(what="uniform play", seconds=1)
def _uniform(which, streams, actions):
    """Each component of the actions (n, k) of the tables ``which`` uniform in [-1, 1)."""
    size = actions.shape[1]
    for j in range(which.shape[0]):
        k = which[j]
        for c in range(0, size, 2):
            u, v = pair(streams[k])
            actions[k, c] = 2.0 * u - 1.0
            if c + 1 < size:
                actions[k, c + 1] = 2.0 * v - 1.0


@entry
def _uniform_choice(which, streams, masks, actions):
    """A uniformly random available choice on each of the tables ``which``; masks (len(which), choices)."""
    for j in range(which.shape[0]):
        k, many = which[j], 0
        for c in range(masks.shape[1]):
            many += masks[j, c]
        u, _ = pair(streams[k])
        left = int(u * many)
        for c in range(masks.shape[1]):
            if masks[j, c]:
                if left == 0:
                    actions[k, 0] = c
                left -= 1


class UniformOpponent(Opponent):
    """Uniform random play: every component of a box action, or an available choice, but it never concedes."""

    def ask(self, frames: Frames, which: Ints, generators: Generators) -> Floats:
        """Empty actions: ``prepare`` draws them from each table's own stream."""
        return np.empty((frames.n, frames.seats[SIDE].actions.size))

    def prepare(self, frames: Frames, which: Ints, asked: Floats, buffers: ShotBuffers) -> Ints:
        reads = frames.seats[SIDE].actions
        if isinstance(reads, Choices):
            masks = frames.action_masks(which, SIDE)
            if reads.concede:
                masks[:, CHOICES * (1 + COLOURS * reads.nominate)] = False
            _uniform_choice(which, frames.streams, masks, asked)
        else:
            _uniform(which, frames.streams, asked)
            if reads.concede:
                asked[which, -1] = (5.0 * asked[which, -1] + 1.0) / 6.0  # [-1, 1) becomes [-2/3, 1)
        return frames.prepare(which, asked, buffers, SIDE)
