"""How long does each shot take inside one kernel? The processor's cycle counter, read before and after each
shot.

A kernel plays shot after shot, each once, and notes the counter's ticks of each, so that no call from Python
is in the figures and caches and branch predictors are as cold as the other shots leave them. What reading the
counter costs, and making the work space (measured with an empty range of shots), is taken off. Ticks become
nanoseconds by comparison with ``time.perf_counter`` over the first 50 ms. The counter is x86's (RDTSC,
constant rate since about 2008); ``HAS_COUNTER`` is False on other machines.
"""

import platform
import time
from functools import cache
from typing import Any
from unittest import mock

import numba
import numpy as np
from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic

import snooker_env as sn
from snooker_env._jit import entry
from snooker_env.physics import engine
from snooker_env.physics.arrays import Law
from snooker_env.physics.columns import P_E_B
from snooker_env.physics.impact import contact
from snooker_env.physics.impact.polynomial import WORK
from snooker_env.simulation import MAX_EVENTS, _run

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
    _now()
    t, c = time.perf_counter_ns(), _now()
    while time.perf_counter_ns() - t < 50_000_000:
        pass
    return (time.perf_counter_ns() - t) / (_now() - c)


@entry
def _each_shot(cost, idle, arguments):
    n = len(cost)
    for k in range(n):
        before = ticks()
        engine.run_batch(*arguments, k, k)  # pyright: ignore[reportCallIssue]
        between = ticks()
        engine.run_batch(*arguments, k, k + 1)  # pyright: ignore[reportCallIssue]
        after = ticks()
        idle[k], cost[k] = between - before, after - between


@entry(what="the benchmark of impacts", uses=(contact.collide_balls,))
def _each_impact(cost, idle, x, normals, phys, code, n_steps):
    """With an empty ``cost`` the counter is not read."""
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


def kernel_arguments(p, v, w, physics, fidelity, module=engine, run=_run):
    """What ``simulation._run`` hands to the kernel ``run_batch`` for fresh copies of these shots, but for the
    range at the end."""
    caught = []
    state = [np.array(a) for a in (p, v, w, np.ones(p.shape[:2], bool))]
    with mock.patch.object(module, "run_batch", lambda *arguments: caught.append(arguments[:-2])):
        run(state, physics, sn.Table.preset("match"), contact.parse_fidelity(fidelity), MAX_EVENTS)
    return caught[0]


def _passes(work, n, passes):
    """(passes, n) microseconds: ``work(cost, idle)`` once unseen, then ``passes`` times."""
    cost, idle, found = np.zeros(n, np.int64), np.zeros(n, np.int64), []
    for _ in range(passes + 1):
        work(cost, idle)
        found.append((cost - np.median(idle)) * ns_per_tick() / 1e3)
    return np.array(found[1:])


def time_shots(p, v, w, fidelity="standard", passes=1, physics=None):
    """Kernel time of every shot [us], (passes, shots): in a pass each shot is played once, one after the
    other."""
    physics = sn.Physics.of(physics)
    return _passes(
        lambda cost, idle: _each_shot(cost, idle, kernel_arguments(p, v, w, physics, fidelity)),
        len(p),
        passes,
    )


def time_impacts(x, normals, phys, fidelity, passes=1):
    """Kernel time of every impact [us], (passes, impacts)."""
    code, steps = contact.parse_fidelity(fidelity)
    return _passes(lambda cost, idle: _each_impact(cost, idle, x, normals, phys, code, steps), len(x), passes)


def time_impact_set(x, normals, phys, fidelity, repeats=1):
    """Microseconds an impact when the set runs as a whole, the counter unread; the quickest of
    ``repeats``."""
    code, steps = contact.parse_fidelity(fidelity)
    none, found = np.zeros(0, np.int64), []
    for _ in range(repeats + 1):
        t = time.perf_counter()
        _each_impact(none, none, x, normals, phys, code, steps)
        found.append(time.perf_counter() - t)
    return min(found[1:]) / len(x) * 1e6
