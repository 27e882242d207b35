"""How is a step of the impact's equations taken? Dormand & Prince 5(4) on seven numbers: its sums and its continuous extension.

Coefficients: Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I, II.5 and II.6. The state is a tuple of seven floats,
spelt out so that everything stays in registers.
"""

from .._jit import kernel

ZERO = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@kernel
def sum2(x, h, p, k, q, m):
    """x + h (p k + q m), componentwise; the kin below take more terms."""
    p *= h
    q *= h
    return (
        x[0] + p * k[0] + q * m[0], x[1] + p * k[1] + q * m[1], x[2] + p * k[2] + q * m[2], x[3] + p * k[3] + q * m[3],
        x[4] + p * k[4] + q * m[4], x[5] + p * k[5] + q * m[5], x[6] + p * k[6] + q * m[6],
    )  # fmt: skip


@kernel
def sum3(x, h, a, k, b, m, c, n):
    return sum2(sum2(x, h, a, k, b, m), h, c, n, 0.0, n)


@kernel
def sum4(x, h, a, k, b, m, c, n, d, o):
    return sum2(sum2(x, h, a, k, b, m), h, c, n, d, o)


@kernel
def sum5(x, h, a, k, b, m, c, n, d, o, e, q):
    return sum2(sum4(x, h, a, k, b, m, c, n, d, o), h, e, q, 0.0, q)


@kernel
def dense(r, i, s):
    """Component i of the step's continuous extension at the fraction s."""
    return value_at(r[0][i], r[1][i], r[2][i], r[3][i], r[4][i], s)


@kernel
def value_at(r0, r1, r2, r3, r4, s):
    q = 1.0 - s
    return r0 + s * (r1 + q * (r2 + s * (r3 + q * r4)))


@kernel
def dense_all(r, s):
    return (dense(r, 0, s), dense(r, 1, s), dense(r, 2, s), dense(r, 3, s), dense(r, 4, s), dense(r, 5, s), dense(r, 6, s))


@kernel
def continuous_extension(x, new, h, k1, k3, k4, k5, k6, k7):
    """Coefficients of the step's continuous extension, order 4 (Hairer, Norsett & Wanner, II.6)."""
    dx = sum2(ZERO, 1.0, 1.0, new, -1.0, x)
    bend = sum2(ZERO, 1.0, h, k1, -1.0, dx)
    twist = sum3(dx, 1.0, -h, k7, -1.0, bend, 0.0, bend)
    last = sum5(
        ZERO, h, -12715105075 / 11282082432, k1, 87487479700 / 32700410799, k3, -10690763975 / 1880347072, k4,
        701980252875 / 199316789632, k5, -1453857185 / 822651844, k6,
    )  # fmt: skip
    return x, dx, bend, twist, sum2(last, h, 69997945 / 29380423, k7, 0.0, k7)


@kernel
def secant(low, high, s, f, last, f_last):
    """The next guess at a zero between low and high."""
    step = s - f * (s - last) / (f - f_last) if f != f_last else low
    return step if low < step < high else 0.5 * (low + high)
