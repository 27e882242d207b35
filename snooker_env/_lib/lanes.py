"""How does a kernel compute with four float64 at once? With a type for four: one instruction where there is AVX.

Each lane's operation is the IEEE one, with the results of four separate numbers. (``NUMBA_SLP_VECTORIZE`` gains
nothing here: it stores the numbers one by one, and a load of four waits.) With ``NUMBA_DISABLE_JIT`` the same
source works on small numpy arrays."""

import operator
from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import config, types
from numba.core.typing import templates
from numba.core.typing.templates import ConcreteTemplate, signature
from numba.extending import intrinsic, lower_builtin, models, register_model

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
    """The address of four numbers in an array."""
    array = context.make_array(signature.args[0])(context, builder, arguments[0])
    return builder.bitcast(builder.gep(array.data, [arguments[1]]), _VECTOR.as_pointer())


def _load(typing_context, array, i):
    def make(context, builder, signature, arguments):
        return builder.load(_place(context, builder, signature, arguments), align=8)

    return _LANES(array, types.intp), make


def _store(typing_context, array, i, x):
    def make(context, builder, signature, arguments):
        builder.store(arguments[2], _place(context, builder, signature, arguments), align=8)
        return context.get_dummy_value()

    return types.void(array, types.intp, _LANES), make


def _make(typing_context, a, b, c, d):
    def make(context, builder, signature, arguments):
        made = ir.Constant(_VECTOR, ir.Undefined)
        for k, number in enumerate(arguments):
            made = builder.insert_element(made, number, ir.Constant(_INT32, k))
        return made

    return _LANES(*[types.float64] * LANES), make


def _take(typing_context, x, k):
    if not isinstance(k, types.IntegerLiteral):
        return None

    def make(context, builder, signature, arguments):
        return builder.extract_element(arguments[0], ir.Constant(_INT32, k.literal_value))

    return types.float64(_LANES, k), make


def _no_more(typing_context, x, y):
    def make(context, builder, signature, arguments):
        flags = builder.fcmp_ordered("<=", *arguments)
        return builder.zext(builder.bitcast(flags, ir.IntType(LANES)), ir.IntType(64))

    return types.int64(_LANES, _LANES), make


def _lesser(typing_context, x, y):
    def make(context, builder, signature, arguments):
        return builder.select(builder.fcmp_ordered("<", *arguments), *arguments)

    return _LANES(_LANES, _LANES), make


class _Both(ConcreteTemplate):
    cases = [signature(_LANES, _LANES, _LANES)]  # noqa: RUF012 - numba's own convention


infer_global: Any = templates.infer_global
infer_global(operator.add)(_Both)
infer_global(operator.mul)(_Both)
lower_builtin(operator.add, _Lanes, _Lanes)(lambda context, builder, signature, both: builder.fadd(*both))
lower_builtin(operator.mul, _Lanes, _Lanes)(lambda context, builder, signature, both: builder.fmul(*both))

# Intrinsics, not overloads: numba would compile a function for each use of those.
lanes: Any = intrinsic(_make)  # four numbers side by side
lanes_at: Any = intrinsic(_load)
"""The numbers i to i + 3 of a float64 array, of several axes too, in one piece; ends are not checked."""
put_lanes: Any = intrinsic(_store)  # writes x to the places i to i + 3 of such an array; ends are not checked
lane: Any = intrinsic(prefer_literal=True)(_take)  # number k of the four; k is a constant
no_more: Any = intrinsic(_no_more)  # an integer whose bit k is 1 where lane k of x is at most that of y
lesser: Any = intrinsic(_lesser)  # the lesser of two numbers in each lane

if getattr(config, "DISABLE_JIT", 0):
    lanes = lambda a, b, c, d: np.array([a, b, c, d])  # noqa: E731
    lanes_at = lambda array, i: array.ravel()[i : i + LANES].copy()  # noqa: E731
    no_more = lambda x, y: int((x <= y) @ (1 << np.arange(LANES)))  # noqa: E731
    lesser = np.minimum
    put_lanes = lambda array, i, x: operator.setitem(array, slice(i, i + LANES), x)  # noqa: E731
    lane = operator.getitem
