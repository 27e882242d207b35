"""How does a learned policy score strokes while it plays? By kernels on NumPy arrays: a table's scores depend
on that table alone. The network is that of ``agents.learning.networks``
(tests/agents/learning/test_fused.py): for each ball, for each pot, sums, a context, scores of strokes."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ..._lib.types import Bools, Ints, Singles
from ...game.balls import N_BALLS
from ...tasks.discrete_actions import POTS, STROKES
from ...tasks.discrete_actions import SIZE as CHOICES
from . import table_kernels
from .dense_layers import linear, relu
from .pot_view import POT_ENTRIES
from .table_kernels import BALL_INPUTS, STATE

LAYERS = ("ball_1", "ball_2", "pot_1", "pot_2", "context_1", "context_2", "shared", "joint", "scores")
"""The linear layers, in the order of their computation."""
BLOCK = 128  # tables that are scored together: their intermediate results stay in the processor's cache
SCORED = -(-STROKES // 16) * 16
"""Columns of the scores: 144 take less time than 135, because whole registers are written."""


class StrokePolicy:
    """Scores discrete choices; ``weights``: name in ``LAYERS`` -> (weight (out, in), bias (out,))."""

    def __init__(self, weights: Mapping[str, tuple[NDArray[np.float32], NDArray[np.float32]]]):
        self._layers = {}
        for name in LAYERS:
            weight, bias = weights[name]
            columns = SCORED if name == "scores" else len(bias)
            turned, shift = np.zeros((weight.shape[1], columns), np.float32), np.zeros(columns, np.float32)
            turned[:, : len(bias)], shift[: len(bias)] = weight.T, bias
            self._layers[name] = turned, shift

    def scores(self, seen: NDArray[np.float32], masks: NDArray[np.bool_]) -> NDArray[np.float32]:
        """Scores (n, CHOICES) on tables of ``with_pots`` (n, SHOWN); ``NEVER`` where masks are False."""
        scores = np.empty((len(seen), CHOICES), np.float32)
        for start in range(0, len(seen), BLOCK):
            rows = np.arange(start, min(start + BLOCK, len(seen)))
            self._score(rows, seen, masks, scores[rows[0] : rows[-1] + 1])
        return scores

    def _score(self, rows: Ints, seen: Singles, masks: Bools, out: Singles) -> None:
        """The scores of one block of tables."""
        n, width = len(rows), len(self._layers["ball_2"][1])
        state_at = 3 * width + len(self._layers["pot_2"][1])
        balls = np.empty((n * (N_BALLS - 1), BALL_INPUTS), np.float32)
        pots = np.empty((n * POTS, POT_ENTRIES), np.float32)
        groups, first = np.empty(len(balls), np.int64), np.empty(n + 1, np.int64)
        context, sides = np.empty((n, state_at + STATE + 3), np.float32), np.empty(n, np.float32)
        m = table_kernels.read_tables(rows, seen, (balls, groups, first, pots, context, sides), state_at)
        table_kernels.sum_balls(self._codes("ball", balls[:m]), groups, first, context, width)
        pot_codes = self._codes("pot", pots)
        table_kernels.sum_pots(pot_codes, pots, context, 3 * width)
        read = self._codes("context", context)
        relu(read)
        joint = self._linear("joint", pot_codes)
        table_kernels.join(joint, self._linear("shared", read), pots)
        table_kernels.mask_scores(rows, masks, sides, self._linear("scores", joint), out)
        table_kernels.exchange_sides(out, sides)

    def _codes(self, name: str, rows: Singles) -> Singles:
        """The results of two layers with a ReLU between them."""
        between = self._linear(f"{name}_1", rows)
        relu(between)
        return self._linear(f"{name}_2", between)

    def _linear(self, name: str, rows: Singles) -> Singles:
        weight, bias = self._layers[name]
        out = np.empty((len(rows), len(bias)), np.float32)
        linear(rows, weight, bias, out)
        return out
