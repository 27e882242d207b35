"""Are layers the sums as they are written, rounded after each operation, whatever rows stand beside?"""

import numpy as np
import pytest

from snooker_env.planning.learned.dense_layers import Layers, linear, relu


def drawn(*sizes, seed=0):
    rng = np.random.default_rng(seed)
    return [rng.normal(size=size).astype(np.float32) for size in sizes]


def by_hand(rows, weight, bias):
    """The same sums in NumPy, elementwise: each operation is rounded to float32."""
    sums = np.tile(bias, (len(rows), 1))
    for k in range(rows.shape[1]):
        sums = sums + rows[:, k : k + 1] * weight[k]
    return sums


@pytest.mark.parametrize("n", [0, 1, 5, 64])
@pytest.mark.parametrize(("a", "b"), [(1, 1), (3, 2), (142, 160)])
def test_a_layer_is_its_sums_bit_for_bit(n, a, b):
    """For odd numbers of rows, and of terms that are no multiple of those taken at a time."""
    rows, weight, bias = drawn((n, a), (a, b), (b,))
    out = np.full((n, b), np.nan, np.float32)
    linear(rows, weight, bias, out)
    assert np.array_equal(out, by_hand(rows, weight, bias))
    assert out == pytest.approx(rows.astype(float) @ weight.astype(float) + bias, abs=1e-4)


def test_nothing_is_fused_flushed_or_lost():
    """A product is rounded before it is added, and numbers too small for a normal float32 are kept."""
    one = np.float32(1.0)
    x = np.float32(1.0 + 2.0**-12)
    out = np.empty((1, 1), np.float32)
    linear(np.array([[x]]), np.array([[x]]), np.array([-one]), out)
    assert out[0, 0] == np.float32(x * x) - one != np.float32(float(x) * float(x) - 1.0)
    linear(np.array([[np.float32(1e-40)]]), np.ones((1, 1), np.float32), np.zeros(1, np.float32), out)
    assert out[0, 0] == np.float32(1e-40) > 0.0
    x = np.array([[-1.0, -0.0, 0.0, 2.0, np.nan, -np.inf, np.inf, -1e-45]], np.float32)
    relu(x)
    assert np.array_equal(x, np.array([[0, 0, 0, 2, np.nan, 0, np.inf, 0]], np.float32), equal_nan=True)


@pytest.mark.parametrize("activation", ["relu", "tanh"])
def test_a_rows_result_does_not_depend_on_the_rows_beside_it(activation):
    first, second, third, b1, b2, b3, rows = drawn((33, 21), (18, 33), (5, 18), 33, 18, 5, (1001, 21), seed=1)
    layers = Layers([(first, b1), (second, b2), (third, b3)], activation)
    together = layers(rows)
    assert together.shape == (1001, 5) and together.dtype == np.float32
    for part in (slice(0, 1), slice(7, 8), slice(1, 64), slice(500, 1001), slice(0, 0)):
        assert np.array_equal(layers(rows[part]), together[part])
    assert np.array_equal(layers(rows[::-1]), together[::-1])
    assert np.array_equal(layers(rows.astype(np.float64)), together)
    between = {"relu": lambda x: np.maximum(x, 0.0), "tanh": np.tanh}[activation]
    expected = between(between(rows @ first.T + b1) @ second.T + b2) @ third.T + b3
    assert together == pytest.approx(expected, abs=1e-4)
    assert not np.allclose(expected, rows @ first.T @ second.T @ third.T, atol=0.1)
