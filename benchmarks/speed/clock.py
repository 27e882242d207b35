"""How long does each shot take inside one kernel? The kernel reads the processor's cycle counter before and after each
shot.

The kernel plays the shots one after another and records the ticks of each. The figures therefore contain no call from
Python, and caches and branch predictors are in the state left by the other shots. The cost of reading the counter and
of allocating the work space (measured with an empty range of shots) is subtracted. Comparison with
``time.perf_counter`` over the first 50 ms converts ticks to nanoseconds. The counter is x86's (RDTSC, constant rate
since about 2008). On other machines (``HAS_COUNTER`` False), each shot is one call from Python.
"""

import platform
import time
from functools import cache
from typing import Any, NamedTuple
from unittest import mock

import numba
import numpy as np
from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic

import snooker_env as sn
from snooker_env import simulation
from snooker_env._lib.jit import entry
from snooker_env.physics.arrays import Law
from snooker_env.physics.columns import P_E_B
from snooker_env.physics.impact import contact
from snooker_env.physics.impact.polynomial import WORK
from snooker_env.simulation import MAX_EVENTS

STANDARD = contact.parse_fidelity("standard")
HAS_COUNTER = platform.machine().lower() in ("x86_64", "amd64")


def _ticks(typing_context):
    def make(context, builder, signature, arguments):
        name = "llvm.readcyclecounter"
        read = builder.module.globals.get(name) or ir.Function(
            builder.module, ir.FunctionType(ir.IntType(64), []), name
        )
        return builder.call(read, [])

    return types.int64(), make


ticks: Any = intrinsic(_ticks)
"""The cycle counter now."""


@numba.njit(nogil=True)
def _now():
    return ticks()


@cache
def ns_per_tick():
    """Length of a tick [ns]."""
    if not HAS_COUNTER:
        return 1.0
    _now()
    t, c = time.perf_counter_ns(), _now()
    while time.perf_counter_ns() - t < 50_000_000:
        pass
    return (time.perf_counter_ns() - t) / (_now() - c)


@cache
def _each_shot(run_batch):
    """Make a kernel that plays shot after shot with this engine's ``run_batch`` and records the ticks of each."""

    @numba.njit(nogil=True, error_model="numpy")
    def each(cost, idle, arguments):
        for k in range(len(cost)):
            before = ticks()
            run_batch(*arguments, k, k)
            between = ticks()
            run_batch(*arguments, k, k + 1)
            after = ticks()
            idle[k], cost[k] = between - before, after - between

    return each


@entry(what="the benchmark of impacts", seconds=10)
def _each_impact(cost, idle, x, normals, phys, code, n_steps):
    """With an empty ``cost``, the counter is not read."""
    total, read = 0.0, len(cost) > 0
    before = between = 0
    law, work = Law(phys, code, n_steps), np.empty(WORK)
    for k in range(len(x)):
        v1, w1, still = (x[k, 0], x[k, 1], 0.0), (x[k, 2], x[k, 3], x[k, 4]), (0.0, 0.0, 0.0)
        if read:
            before = ticks()
            between = ticks()
        out = contact.collide_balls(
            v1, w1, still, still, (normals[k, 0], normals[k, 1]), law, phys[P_E_B], work
        )
        total += out[0][0]
        if read:
            after = ticks()
            idle[k], cost[k] = between - before, after - between
    return total


class Way(NamedTuple):
    """How to play shots: constants, table, ``(code, steps)`` of the fidelity, and the engine."""

    physics: sn.Physics
    solver: tuple[int, int] = STANDARD
    table: sn.Table = sn.Table.preset("match")
    simulation: Any = simulation


def kernel_arguments(start, way):
    """The arguments that ``simulation._run`` passes to the kernel ``run_batch`` for fresh copies of these shots
    (positions, velocities, spins), except the range at the end."""
    caught = []
    state = [np.array(a) for a in (*start, np.ones(start[0].shape[:2], bool))]
    if getattr(way.physics, "flight", False):  # another version may lack it
        state.append(np.zeros(start[0].shape))
    engine = way.simulation.engine
    with mock.patch.object(engine, "run_batch", lambda *arguments: caught.append(arguments[:-2])):
        way.simulation._run(state, way.physics, way.table, way.solver, MAX_EVENTS)
    return caught[0]


def _play(run_batch, cost, idle, arguments):
    """One pass over the shots: the ticks of each, and those of a call without shots."""
    if HAS_COUNTER:
        _each_shot(run_batch)(cost, idle, arguments)
        return
    for k in range(len(cost)):
        before = time.perf_counter_ns()
        run_batch(*arguments, k, k)
        between = time.perf_counter_ns()
        run_batch(*arguments, k, k + 1)
        idle[k], cost[k] = between - before, time.perf_counter_ns() - between


def _less_idle(cost, idle):
    return (cost - np.median(idle)) * ns_per_tick() / 1e3


def time_ways(ways, start, passes=1):
    """Kernel time of every shot [us], {name: (passes, shots)}, for each name of ``ways`` (name: ``Way``).

    In a pass each shot is played once, one after another. The ways take turns and alternate the first place from pass
    to pass, so that all see the same machine. The first pass is not counted.
    """
    cost, idle = np.zeros((2, len(start[0])), np.int64)
    names, times = list(ways), {name: [] for name in ways}
    for number in range(passes + 1):
        first = number % len(names)
        for name in names[first:] + names[:first]:
            way = ways[name]
            _play(way.simulation.engine.run_batch, cost, idle, kernel_arguments(start, way))
            if number > 0:
                times[name].append(_less_idle(cost, idle))
    return {name: np.array(of) for name, of in times.items()}


def time_shots(p, v, w, fidelity="standard", passes=1, physics=None):
    """Kernel time of every shot [us], (passes, shots), played in one way."""
    way = Way(sn.Physics.of(physics), contact.parse_fidelity(fidelity))
    return time_ways({fidelity: way}, (p, v, w), passes)[fidelity]


def time_impacts(x, normals, phys, fidelity, passes=1):
    """Kernel time of every impact [us], (passes, impacts)."""
    code, steps = contact.parse_fidelity(fidelity)
    cost, idle, times = np.zeros(len(x), np.int64), np.zeros(len(x), np.int64), []
    for _ in range(passes + 1):
        _each_impact(cost, idle, x, normals, phys, code, steps)
        times.append(_less_idle(cost, idle))
    return np.array(times[1:])


def time_impact_set(x, normals, phys, fidelity, repeats=1):
    """Microseconds per impact if the set runs as a whole without reading the counter; the fastest of
    ``repeats``."""
    code, steps = contact.parse_fidelity(fidelity)
    none, found = np.zeros(0, np.int64), []
    for _ in range(repeats + 1):
        t = time.perf_counter()
        _each_impact(none, none, x, normals, phys, code, steps)
        found.append(time.perf_counter() - t)
    return min(found[1:]) / len(x) * 1e6


def time_batch(p, v, w, fidelity, threads, repeats):
    """Microseconds per shot of a set played as one batch: the fastest of the repeats that fit into a second."""
    physics, table, found = sn.Physics.of(None), sn.Table.preset("match"), []
    while not found or (len(found) < repeats and sum(found) < 1.0):
        state = [np.array(a) for a in (p, v, w, np.ones(p.shape[:2], bool))]
        start = time.perf_counter()
        simulation._run(state, physics, table, contact.parse_fidelity(fidelity), MAX_EVENTS, threads=threads)
        found.append(time.perf_counter() - start)
    return min(found) / len(p) * 1e6
