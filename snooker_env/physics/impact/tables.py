"""How is the impact of a rolling ball found without solving it? From a table: it depends on one number.

A rolling ball has no slip at the cloth, and its spin about the tangent follows from its velocity. So at a cushion
b = 0 and a2 / closing = -(1 + sin t) / cos t, always; a rolling ball on a resting one has b = 0 and a2 / closing = -1
(``inertia.py``, the frame and the slips). The equations of ``impulse.py`` scale with the closing speed. So at fixed
constants (friction, restitution, height of the nose; friction between balls that is constant) the five impulses over
the closing speed are functions of x = a1 / closing alone, F1 and G1 odd, F2, G2 and p even.

A table has 16 cells in each octave of |x| from 2^-20 to 2^10, in each a polynomial of degree 5 through the solution at
``reference`` in its Chebyshev nodes. Below, F1 and G1 are linear and the others constant. A cell is tested between its
nodes against ``reference`` when it is made; where it errs by more than ``WORST``, or the ball lifts off the cloth
(a slip that ends within the impact is a kink), it is empty: the impact is solved as any other. Errors of the
presets' are below 1e-10 (``tests/physics/test_rolling.py``), where "standard" promises 1e-6.

The tables of the presets come with the package. Those of other constants are made at the first need, in 5 to 200 ms. There
is none where the cloth's friction may hold the ball (frictions above about 0.25).
"""

from functools import cache, lru_cache
from math import cos, pi, sqrt
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..._lib.jit import entry, kernel
from ..._lib.lanes import lane, lanes, lanes_at
from ..._lib.types import Floats
from . import inertia
from .coulomb import Friction, Problem
from .impulse import NO_IMPULSE, OK, REFERENCE, outlook_of, solve
from .inertia import Impulses, Slips
from .polynomial import WORK

TABLED = (0, 1)
"""The codes of the fidelities that ask tables: "fast" and "standard"."""
LEAST_OCTAVE, OCTAVES, CELLS, DEGREE = -20, 30, 16, 5
"""|x| from 2^-20 to 2^10 (at which less than 0.1 % of the speed is into the cushion); in each octave 16 cells."""
IMPULSES = 5
CELL = (DEGREE + 1) * IMPULSES
"""Numbers of a cell: from the lowest coefficient, each of F1, F2, G1, G2 and p; NaN: empty."""
NEAR = OCTAVES * CELLS
"""The cell of all |x| below 2^-20; its polynomial is in |x| itself."""
SIZE = (NEAR + 1) * CELL
WORST = 1e-9
"""The largest error of a cell, over the closing speed."""
ROLLS = 1e-10
"""A slip that differs by this part of the closing speed from a rolling ball's is one of a rolling ball."""
_SHIFT = 52 - 4
"""The bits of a float64 below the four that number the cells of an octave."""
_FIRST = (1023 + LEAST_OCTAVE) * CELLS
_ONE = 1023 << 52
_BELOW = (1 << _SHIFT) - 1


class Rolling(NamedTuple):
    """The constants of a table; ``sin_t`` of the nose, or -1 for two balls."""

    sin_t: float
    mu: float
    """Friction between the bodies, which is constant."""
    mu_s: float
    e: float


PRESETS = (Rolling(0.4, 0.14, 0.21, 0.98), Rolling(-1.0, 0.05, 0.21, 0.89))
"""Whose tables are in the file ``KEPT``: all cushions and jaws, and the balls of "paper"."""
KEPT = Path(__file__).with_name("rolling.npy")


@kernel
def look_up(phys, at, x):
    """Whether the table at ``phys[at:]`` has the impact of x = a1 / closing; its impulses over the closing speed."""
    size = abs(x)
    bits = np.float64(size).view(np.int64)
    cell = (bits >> _SHIFT) - _FIRST
    if cell >= NEAR or size != size:
        return False, NO_IMPULSE
    if cell < 0:
        cell, u = NEAR, size
    else:
        # the place in the cell, -1 to 1
        u = 2.0 * np.int64(((bits & _BELOW) << 4) | _ONE).view(np.float64) - 3.0
    i = at + cell * CELL
    k = i + DEGREE * IMPULSES
    if phys[i] != phys[i]:
        return False, NO_IMPULSE
    friction, p, factor = lanes_at(phys, k), phys[k + 4], lanes(u, u, u, u)
    while k > i:
        k -= IMPULSES
        friction = friction * factor + lanes_at(phys, k)
        p = p * u + phys[k + 4]
    f1, g1 = lane(friction, 0), lane(friction, 2)
    if x < 0.0:
        f1, g1 = -f1, -g1
    return True, Impulses(f1, lane(friction, 1), g1, lane(friction, 3), p, 0.0, 0.0)


@entry(what="the tables of rolling impacts", seconds=12)
def _solutions(x, rolling, out):
    """The impulses of each x = a1 / closing at ``reference`` -> out (m, 5); NaN where the ball lifts.

    False where the cloth may hold the ball: such an impact takes thousands of steps, and kinks are everywhere.
    """
    balls = rolling.sin_t < 0.0
    sin_t = max(0.0, rolling.sin_t)
    cos_t = sqrt(1.0 - sin_t * sin_t)
    contact = inertia.BALLS if balls else inertia.cushion(sin_t, cos_t)
    a2 = -1.0 if balls else -(1.0 + sin_t) / cos_t
    friction, series = Friction(rolling.mu, 0.0, 0.0), np.empty(WORK)
    for k in range(x.shape[0]):
        problem = Problem(contact, Slips(x[k], a2, 0.0, 0.0, 1.0), friction, rolling.mu_s, rolling.e)
        if not outlook_of(problem).analytic:
            return False
        made, status = solve(problem, REFERENCE, series)
        good = status == OK and made.Z == 0.0
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = made.F1, made.F2, made.G1, made.G2
        out[k, 4] = made.p if good else np.nan
    return True


def _solve(x, rolling):
    """``_solutions`` of an array of any shape: (..., 5)."""
    out = np.empty((x.size, IMPULSES))
    _solutions(x.ravel(), rolling, out)
    return out.reshape(*x.shape, IMPULSES)


def _lagrange(nodes):
    """The coefficients (m, m) of the polynomials that are 1 in one node and 0 in the others: column k of node k."""
    columns = []
    for k, node in enumerate(nodes):
        column = [1.0]
        for other in nodes[:k] + nodes[k + 1 :]:  # times (u - other) / (node - other)
            higher, lower = [0.0, *column], [*column, 0.0]
            column = [(h - other * c) / (node - other) for h, c in zip(higher, lower, strict=True)]
        columns.append(column)
    return np.array(columns).T


def _combine(weights, values):
    """``weights @ values`` in this order of sums: a matrix product has another on each kind of processor."""
    return sum(weights[:, j, None] * values[..., j, None, :] for j in range(weights.shape[1]))


def _values(u, coefficients):
    """The polynomials at the places u (m,): (..., m, 5)."""
    return _combine(np.vander(u, DEGREE + 1, increasing=True), coefficients)


@cache
def _load_presets() -> dict[Rolling, Floats]:
    """The tables that come with the package: of the presets."""
    return dict(zip(PRESETS, np.load(KEPT), strict=True))


@lru_cache(maxsize=64)
def table_of(rolling: Rolling) -> Floats | None:
    """The table of these constants (SIZE,), kept with the package or made now; None where the cloth may hold the ball."""
    return _load_presets()[rolling] if rolling in PRESETS else make(rolling)


def make(rolling: Rolling) -> Floats | None:
    """Make a table (SIZE,), from 13 solutions a cell; None where the cloth may hold the ball."""
    least = 2.0**LEAST_OCTAVE
    at_least = np.empty((1, IMPULSES))
    if not _solutions(np.array([least]), rolling, at_least):
        return None
    nodes = np.array([cos((2 * k + 1) * pi / (2 * DEGREE + 2)) for k in range(DEGREE + 1)])
    tests = np.array(
        [cos(k * pi / (DEGREE + 1)) for k in range(DEGREE + 2)]
    )  # the polynomial errs most there
    octaves = np.ldexp(1.0, np.arange(LEAST_OCTAVE, LEAST_OCTAVE + OCTAVES))
    low, width = np.outer(octaves, 1.0 + np.arange(CELLS) / CELLS).ravel(), np.repeat(octaves / CELLS, CELLS)
    at_nodes, at_tests = (
        _solve(low[:, None] + width[:, None] * (u + 1) / 2, rolling) for u in (nodes, tests)
    )
    table = np.empty((NEAR + 1, DEGREE + 1, IMPULSES))
    table[:NEAR] = _combine(_lagrange(nodes.tolist()), at_nodes)
    # below all cells: F1 and G1 in proportion to |x|, F2, G2 and p as for none
    table[NEAR] = 0.0
    table[NEAR, 0, [1, 3, 4]] = at_least[0, [1, 3, 4]]
    table[NEAR, 1, [0, 2]] = at_least[0, [0, 2]] / least
    small = least * np.array([0.0, 1e-6, 1e-3, 0.1, 0.5, 0.9])
    errors = np.abs(_values(tests, table[:NEAR]) - at_tests).max((1, 2))
    error_near = np.abs(_values(small, table[NEAR]) - _solve(small, rolling)).max()
    table[~(np.append(errors, error_near) <= WORST)] = np.nan
    return table.ravel()
