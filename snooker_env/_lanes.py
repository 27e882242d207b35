"""How does a kernel compute with four numbers at once? A type for four float64 side by side: one instruction where the processor has AVX.

``lanes(a, b, c, d)`` makes it, ``lanes_at(array, i)`` loads it and ``put_lanes(array, i, x)`` stores it; ``+`` and ``*`` work on each of
the four, and ``x[k]`` takes one, with k a constant. Every operation is the IEEE one of its lane, so the results are those of four separate
numbers, on any processor. (The compiler finds such sums itself if asked, ``NUMBA_SLP_VECTORIZE``, but it stores the numbers one by one, and
a load of four waits for that: nothing is gained.)

Without numba (``NUMBA_DISABLE_JIT``) the same source works on small numpy arrays.
"""

import operator
from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic as _intrinsic
from numba.extending import models, overload, register_model

intrinsic: Any = _intrinsic  # whose result takes no typing context, which a type checker cannot know
LANES = 4
_VECTOR = ir.VectorType(ir.DoubleType(), LANES)
_INT32 = ir.IntType(32)


class _Lanes(types.Type):
    """The type of four float64."""

    def __init__(self):
        super().__init__("Lanes")


_LANES = _Lanes()


@register_model(_Lanes)
class _Model(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, _VECTOR)


def _place(context, builder, signature, arguments):
    """The address of four numbers in an array, and its alignment."""
    array = context.make_array(signature.args[0])(context, builder, arguments[0])
    return builder.bitcast(builder.gep(array.data, [arguments[1]]), _VECTOR.as_pointer())


@intrinsic
def _load(typing_context, array, i):
    def make(context, builder, signature, arguments):
        return builder.load(_place(context, builder, signature, arguments), align=8)

    return _LANES(array, types.intp), make


@intrinsic
def _store(typing_context, array, i, x):
    def make(context, builder, signature, arguments):
        builder.store(arguments[2], _place(context, builder, signature, arguments), align=8)
        return context.get_dummy_value()

    return types.void(array, types.intp, _LANES), make


@intrinsic
def _make(typing_context, a, b, c, d):
    def make(context, builder, signature, arguments):
        made = ir.Constant(_VECTOR, ir.Undefined)
        for k, number in enumerate(arguments):
            made = builder.insert_element(made, number, ir.Constant(_INT32, k))
        return made

    return _LANES(*[types.float64] * LANES), make


@intrinsic
def _add(typing_context, x, y):
    return _LANES(_LANES, _LANES), lambda context, builder, signature, arguments: builder.fadd(*arguments)


@intrinsic
def _multiply(typing_context, x, y):
    return _LANES(_LANES, _LANES), lambda context, builder, signature, arguments: builder.fmul(*arguments)


@intrinsic(prefer_literal=True)
def _take(typing_context, x, k):
    if not isinstance(k, types.IntegerLiteral):
        return None
    which = ir.Constant(_INT32, k.literal_value)
    return types.float64(_LANES, k), lambda context, builder, signature, arguments: builder.extract_element(arguments[0], which)


def _both(x, y):
    return isinstance(x, _Lanes) and isinstance(y, _Lanes)


@overload(operator.add, inline="never")
def _overload_add(x, y):
    return (lambda x, y: _add(x, y)) if _both(x, y) else None


@overload(operator.mul)
def _overload_multiply(x, y):
    return (lambda x, y: _multiply(x, y)) if _both(x, y) else None


@overload(operator.getitem, prefer_literal=True)
def _overload_take(x, k):
    return (lambda x, k: _take(x, k)) if isinstance(x, _Lanes) else None


def lanes(a: Any, b: Any, c: Any, d: Any) -> Any:
    """Four numbers side by side."""
    return np.array([a, b, c, d])


def lanes_at(array: Any, i: int) -> Any:
    """The numbers i to i + 3 of a float64 array in one piece. Neither end of the array is checked."""
    return array[i : i + LANES].copy()


def put_lanes(array: Any, i: int, x: Any) -> None:
    """Write x to the places i to i + 3 of such an array. Neither end of the array is checked."""
    array[i : i + LANES] = x


@overload(lanes)
def _overload_lanes(a, b, c, d):
    return lambda a, b, c, d: _make(a, b, c, d)


@overload(lanes_at)
def _overload_lanes_at(array, i):
    return lambda array, i: _load(array, i)


@overload(put_lanes)
def _overload_put_lanes(array, i, x):
    return lambda array, i, x: _store(array, i, x)
