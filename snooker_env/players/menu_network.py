"""How does the package's agent of ``action="strokes"`` play? The network of ``snooker_env.sb3.StrokesPolicy`` in NumPy gives each
stroke on the menu a score; the highest is played. No shot is simulated. ``train.py`` trains it, and ``results/make.sh weights``
writes its numbers into the package."""

from typing import ClassVar

import numpy as np

from .._lib.types import Bools, Ints, Observation
from ..planning.learned.dense_layers import Layers
from ..tasks.observations import STROKE_SIZE
from .weights import learned_menu


class MenuNetwork:
    """Chooses from menus of visits, see ``Seen``."""

    options: ClassVar[dict[str, str]] = {"action": "strokes", "observation": "strokes"}

    def __init__(self) -> None:
        self._layers = Layers(learned_menu(), "tanh")

    def act(self, observations: Observation, masks: Bools | None, seeds: Ints) -> Ints:
        """The choice with the highest score for each observation (n, K * 23 + 11); ``masks`` (n, K): those on the menu."""
        seen, there = np.asarray(observations), np.asarray(masks, np.bool_)
        n, choices = there.shape
        strokes = seen[:, : choices * STROKE_SIZE].reshape(n, choices, STROKE_SIZE)
        state = np.repeat(seen[:, None, choices * STROKE_SIZE :], choices, axis=1)
        rows = np.concatenate([strokes, state], axis=2).reshape(n * choices, -1)
        return np.where(there, self._layers(rows).reshape(n, choices), -np.inf).argmax(axis=1)
