"""How does the package's agent of ``action="strokes"`` play? The network of ``snooker_env.sb3.StrokesPolicy`` in NumPy gives each
stroke on the menu a score; the highest is played (``train.py``; ``examples/self_play.py`` for frames)."""

import numpy as np

from .._lib.types import Bools, Ints, Observation
from ..planning.learned.dense_layers import Layers, Weights
from ..tasks.observations import STROKE_SIZE
from ..tasks.options import Options
from .seen import SeenPlayer
from .weights import learned_menu


class MenuNetwork:
    """Chooses from menus of a "visit" or a "frame", see ``Seen``, by ``layers`` that read a stroke and the state."""

    def __init__(self, layers: Weights, task: str) -> None:
        self.options: dict[str, str] = {"action": "strokes", "observation": "strokes", "task": task}
        self._layers = Layers(layers, "tanh")

    def act(self, observations: Observation, masks: Bools | None, seeds: Ints) -> Ints:
        """The choice with the highest score for each observation (n, K * 23 + S); ``masks`` (n, K): those on the menu."""
        seen, there = np.asarray(observations), np.asarray(masks, np.bool_)
        n, choices = there.shape
        strokes = seen[:, : choices * STROKE_SIZE].reshape(n, choices, STROKE_SIZE)
        state = np.repeat(seen[:, None, choices * STROKE_SIZE :], choices, axis=1)
        rows = np.concatenate([strokes, state], axis=2)
        scores = self._layers(rows.reshape(n * choices, rows.shape[2])).reshape(n, choices)
        return np.where(there, scores, -np.inf).argmax(axis=1)


class MenuPlayer(SeenPlayer):
    """``strokes``: one network for visits, another for frames."""

    def __init__(self) -> None:
        self._networks = [MenuNetwork(learned_menu(f"{task}s"), task) for task in ("visit", "frame")]
        super().__init__(self._networks[0], name="strokes")
        self.frames = True  # it knows them; bound, it sees what its options say

    def _bind(self, options: Options) -> None:
        self.frames = options.task != "visit"
        self.seen = self._networks[self.frames]
        super()._bind(options)
