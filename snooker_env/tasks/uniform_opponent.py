"""How does the built-in opponent "random" play? Uniformly: any action, or one of the available choices."""

import numpy as np

from .._jit import entry
from .._types import Floats, Ints
from ..game.philox import pair
from .declarations import COLOURS
from .discrete_actions import SIZE as CHOICES
from .discrete_actions import Choices
from .frame import Frames, Generators, Opponent
from .opponents import SIDE
from .stroke import ShotBuffers


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
        """See ``Opponent.prepare``."""
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
