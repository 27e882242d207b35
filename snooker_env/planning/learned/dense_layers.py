"""How are the layers of a small network computed while it plays? By a kernel, on the thread that calls it, in a fixed order
of sums: a row's result depends on that row alone. NumPy and torch wake a thread for each core, which costs more."""

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np

from ..._lib.jit import entry
from ..._lib.types import Singles

Weights: TypeAlias = Sequence[tuple[Singles, Singles]]  # (out, in) and (out,) of each layer


@entry(what="the layers of networks", seconds=2)
def linear(rows, weight, bias, out):
    """out (n, b) = rows (n, a) @ weight (a, b) + bias (b,), float32: bias + rows[0] weight[0] + ..., rounded after each. Two
    rows, four terms at a time: the sums stay in registers."""
    n, a = rows.shape
    b = weight.shape[1]
    spare = np.empty(b, np.float32)
    for j in range(0, n, 2):
        x, sums = rows[j], out[j]
        y, others = (rows[j + 1], out[j + 1]) if j + 1 < n else (x, spare)
        for c in range(b):
            sums[c] = bias[c]
            others[c] = bias[c]
        k = 0
        while k + 4 <= a:
            x0, x1, x2, x3 = x[k], x[k + 1], x[k + 2], x[k + 3]
            y0, y1, y2, y3 = y[k], y[k + 1], y[k + 2], y[k + 3]
            w0, w1, w2, w3 = weight[k], weight[k + 1], weight[k + 2], weight[k + 3]
            for c in range(b):
                sums[c] = (((sums[c] + x0 * w0[c]) + x1 * w1[c]) + x2 * w2[c]) + x3 * w3[c]
                others[c] = (((others[c] + y0 * w0[c]) + y1 * w1[c]) + y2 * w2[c]) + y3 * w3[c]
            k += 4
        while k < a:
            x0, y0, w0 = x[k], y[k], weight[k]
            for c in range(b):
                sums[c] += x0 * w0[c]
                others[c] += y0 * w0[c]
            k += 1


@entry
def relu(rows):
    """ReLU of an array (n, b), in place: an eighth of the time of ``numpy.maximum``. NaN stays NaN."""
    for j in range(rows.shape[0]):
        row = rows[j]
        for c in range(row.shape[0]):
            row[c] = np.float32(0.0) if row[c] < 0 else row[c]


ACTIVATIONS: dict[str, Any] = {"tanh": lambda x: np.tanh(x, out=x), "relu": relu}
"""Between two layers, in place; after the last one there is none."""


class Layers:
    """A multilayer perceptron, whose weights are copied, with "tanh" or "relu" between its layers."""

    def __init__(self, weights: Weights, activation: str):
        turned = [np.array(weight.T, np.float32, order="C") for weight, _ in weights]
        self._layers = [(w, np.array(bias, np.float32)) for w, (_, bias) in zip(turned, weights, strict=True)]
        self._between = activation  # by name: a lambda cannot be pickled

    def __call__(self, rows: Singles) -> Singles:
        """The last layer's results (n, out) for rows (n, in): float32."""
        for k, (weight, bias) in enumerate(self._layers):
            if k:
                ACTIVATIONS[self._between](rows)
            before = np.ascontiguousarray(rows, np.float32)
            rows = np.empty((len(rows), len(bias)), np.float32)
            linear(before, weight, bias, rows)
        return rows
