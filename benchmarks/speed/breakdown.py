"""Where does the time of a shot go? The cycle counter around each piece of the engine, in a copy of the
package made for that.

In the copy every kernel of ``engine.py``, ``detection.py`` and ``meetings.py`` gets one more argument, the
address of the tally, and every statement that calls a function named in ``PIECES`` reads the counter before
and after. A piece's time is its own: what it calls, if that is a piece too, is taken off. What reading costs,
measured on an empty statement, is taken off as well; what then differs from the time of the untouched kernel
on the same shots is printed as the remainder (the readings keep the compiler from merging and reordering).
"""

import ast
from pathlib import Path
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic

import snooker_env
from snooker_env.physics.impact import contact

from .._common import package_copies
from .clock import Way, kernel_arguments, ns_per_tick, ticks, time_shots

PIECES = (
    ("run", "set-up, event loop, final state", "bookkeeping"),
    ("_next_event", "selection of the next event", "bookkeeping"),
    ("clear_box", "box without boundaries", "bookkeeping"),
    ("cloth.begin", "cloth: a phase begins", "bookkeeping"),
    ("cloth.next_phase", "cloth: a phase ends", "bookkeeping"),
    ("cloth.evaluate", "cloth: state at an event", "bookkeeping"),
    ("_predict", "partners: boxes, kept times", "root search"),
    ("_rescan", "partners: earliest again", "root search"),
    ("pair_time", "pair: rejection, closed form", "root search"),
    ("boundary_event", "boundary: rejection, noses", "root search"),
    ("quartic_crossing", "quartic", "root search"),
    ("collide_balls", "impact ball-ball", "impacts"),
    ("collide_cushion", "impact ball-cushion", "impacts"),
)
GROUPS = ("root search", "impacts", "bookkeeping")
_NUMBER = {name: k for k, (name, _, _) in enumerate(PIECES)}
_MODULES = ("physics/detection.py", "physics/engine.py", "physics/meetings.py")

_N = len(PIECES)
_NOW, _OTHERS = 2 * _N * _N, 2 * _N * _N + 1
"""Places in the tally, int64: n x n ticks (piece, caller), n x n calls, the piece that runs now, the ticks of
the pieces it has called."""


def _make_get(typing_context, address, place):
    def make(context, builder, signature, arguments):
        base = builder.inttoptr(arguments[0], ir.IntType(64).as_pointer())
        return builder.load(builder.gep(base, [arguments[1]]))

    return types.int64(types.int64, types.int64), make


def _make_put(typing_context, address, place, value):
    def make(context, builder, signature, arguments):
        base = builder.inttoptr(arguments[0], ir.IntType(64).as_pointer())
        builder.store(arguments[2], builder.gep(base, [arguments[1]]))
        return context.get_dummy_value()

    return types.void(types.int64, types.int64, types.int64), make


_get: Any = intrinsic(_make_get)
"""The int64 at a place after an address: unlike an array, an address costs no counting of references."""
_put: Any = intrinsic(_make_put)
"""Writes an int64 there."""


@numba.njit(nogil=True)
def enter(tally, piece):
    """A piece begins."""
    caller, others = _get(tally, _NOW), _get(tally, _OTHERS)
    _put(tally, _NOW, piece)
    _put(tally, _OTHERS, 0)
    return caller, others, ticks()


@numba.njit(nogil=True)
def leave(tally, piece, entered):
    """The piece ends; entered: what ``enter`` returned."""
    caller, others, begin = entered
    took = ticks() - begin
    place = piece * _N + caller
    _put(tally, place, _get(tally, place) + took - _get(tally, _OTHERS))
    _put(tally, place + _N * _N, _get(tally, place + _N * _N) + 1)
    _put(tally, _NOW, caller)
    _put(tally, _OTHERS, others + took)


def _is_kernel(node):
    marks = (d.func if isinstance(d, ast.Call) else d for d in getattr(node, "decorator_list", ()))
    names = {mark.id for mark in marks if isinstance(mark, ast.Name)}
    return isinstance(node, ast.FunctionDef) and not names.isdisjoint(("kernel", "inlined", "entry"))


def _callee(statement):
    """The name of the function that a statement is a plain call of (``f()``, ``x = f()``, ``return f()``), or
    None."""
    value = (
        getattr(statement, "value", None)
        if isinstance(statement, (ast.Assign, ast.Expr, ast.Return))
        else None
    )
    return ast.unparse(value.func) if isinstance(value, ast.Call) else None


class _Instrument(ast.NodeTransformer):
    """Adds the tally to the kernels of one module and to their calls, and the readings to the pieces."""

    def __init__(self, tallied):
        self.tallied = tallied  # the kernels that take the tally
        self.read = 0

    def visit_FunctionDef(self, node):
        if not _is_kernel(node):
            return node
        self.generic_visit(node)
        node.args.args.insert(0, ast.arg("tally"))
        return node

    def visit_Call(self, node):
        self.generic_visit(node)
        if ast.unparse(node.func) in self.tallied:
            node.args.insert(0, ast.Name("tally", ast.Load()))
        return node

    def around(self, statement, name):
        self.read += 1
        before = ast.parse(f"entered = enter(tally, {_NUMBER[name]})").body
        after = ast.parse(f"leave(tally, {_NUMBER[name]}, entered)").body
        if isinstance(statement, ast.Return) and statement.value is not None:
            kept = ast.Assign([ast.Name("out", ast.Store())], statement.value)
            return [*before, kept, *after, ast.Return(ast.Name("out", ast.Load()))]
        return [*before, statement, *after]

    def statement(self, node):
        name = _callee(node)
        self.generic_visit(node)
        return self.around(node, name) if name in _NUMBER else node

    visit_Assign = visit_Expr = visit_Return = statement  # noqa: N815


def instrumented(texts):
    """The sources (path: text) with the modules of the engine instrumented."""
    trees = {name: ast.parse(texts[name]) for name in _MODULES}
    tallied = {node.name for tree in trees.values() for node in tree.body if _is_kernel(node)}
    out, read = dict(texts), 0
    calls = sum(
        isinstance(n, ast.Call) and ast.unparse(n.func) in _NUMBER
        for tree in trees.values()
        for n in ast.walk(tree)
    )
    for name, tree in trees.items():
        change = _Instrument(tallied)
        text = ast.unparse(ast.fix_missing_locations(change.visit(tree)))
        out[name] = text + "\nfrom benchmarks.speed.breakdown import enter, leave\n"
        read += change.read
    if read != calls:
        raise RuntimeError(
            f"{calls} calls of the pieces in the engine, {read} of them in plain statements: correct PIECES"
        )
    return out


def load():
    """The copy's ``engine`` and ``simulation`` modules."""
    more = Path(__file__).read_text(encoding="utf-8")  # ``enter`` and ``leave`` are compiled into the copy
    return package_copies.load(
        "snooker_env_profile", instrumented(package_copies.texts()), ["physics.engine", "simulation"], more
    )


@numba.njit
def _empty(tally, times):
    before = ticks()
    for _ in range(times):
        entered = enter(tally, 0)
        leave(tally, 0, entered)
    return ticks() - before


def _reading_cost():
    """What one pair of readings adds [ticks]: inside the piece's own time, and in its caller's."""
    times, inside, both = 10_000, [], []
    for _ in range(20):
        tally = np.zeros(2 * _N * _N + 2, np.int64)
        both.append(_empty(tally.ctypes.data, times) / times)
        inside.append(tally[0] / times)
    return min(inside[1:]), min(both[1:]) - min(inside[1:])


def profile(p, v, w, fidelity="standard", passes=3):
    """Means over these shots: for each piece its own us a shot and calls a shot, quartics by caller; medians
    of ``passes`` passes.

    The untouched kernel plays the same shots between these passes; ``kernel_us`` is its median.
    """
    engine, simulation = load()
    physics, (inside, outside) = snooker_env.Physics.preset("paper"), _reading_cost()
    way = Way(physics, contact.parse_fidelity(fidelity), simulation=simulation)
    untouched, tallies = [], []
    for _ in range(passes + 1):
        tally = np.zeros(2 * _N * _N + 2, np.int64)
        arguments = kernel_arguments((p, v, w), way)
        engine.run_batch(tally.ctypes.data, *arguments, 0, len(p))
        tallies.append(tally[:_NOW].reshape(2, _N, _N).astype(float))
        untouched.append(time_shots(p, v, w, fidelity, 1, physics).mean())
    time, calls = np.median(tallies[1:], axis=0)  # the first compiles
    own = time - calls * inside  # own[piece, caller]
    # a piece's calls of others are laid on its own callers by their share
    share = calls / np.maximum(calls.sum(1, keepdims=True), 1)
    own -= outside * calls.sum(0)[:, None] * share
    scale = ns_per_tick() / 1e3 / len(p)
    rows = []
    for k, (name, label, group) in enumerate(PIECES):
        if name == "quartic_crossing":
            for caller, of in (("pair_time", "pair: quartic"), ("boundary_event", "boundary: quartic")):
                j = _NUMBER[caller]
                rows.append(
                    {"piece": of, "group": group, "us": own[k, j] * scale, "calls": calls[k, j] / len(p)}
                )
        else:
            rows.append(
                {"piece": label, "group": group, "us": own[k].sum() * scale, "calls": calls[k].sum() / len(p)}
            )
    return {
        "rows": rows,
        "reading_ns": [inside * ns_per_tick(), outside * ns_per_tick()],
        "kernel_us": float(np.median(untouched[1:])),
    }
