"""Is each entry kernel compiled for one signature, whatever the numbers that users give are made of?"""

import json

import pytest

from snooker_env.kernels import kernel
from tests.kernels import from_python
from tests.processes import python

INPUTS = """
import pickle
import numpy as np
import snooker_env as sn
from snooker_env._lib.jit import ENTRIES
from snooker_env.envs.snooker import SnookerEnv
from snooker_env.envs.vector import SnookerVectorEnv

def read_only(a):
    a = np.array(a)
    a.flags.writeable = False
    return a

def strided(a):
    a = np.array(a)
    wide = np.zeros([2 * n for n in a.shape], a.dtype)
    wide[tuple(slice(None, None, 2) for _ in a.shape)] = a
    return wide[tuple(slice(None, None, 2) for _ in a.shape)]

TYPES = (np.float64, np.float32, np.float16, np.longdouble, ">f8", ">f4", np.int64, np.int8, np.uint16, ">i4")
LAYOUTS = (np.array, np.asfortranarray, read_only, strided, np.ndarray.tolist, lambda a: tuple(a.tolist()))
NUMBERS = (int, float, np.float32, np.float16, np.longdouble, np.int8, np.uint64, lambda x: np.array(x, ">f4"))

def kinds(values):
    for dtype in TYPES:
        for layout in LAYOUTS:
            yield layout(np.array(values).astype(dtype))

def close(got, want):
    assert all(np.array_equal(a, b) for a, b in zip(got, want, strict=True)), (got, want)
"""

SHOTS = """
z = (0, 0, 0)
balls, cushion = sn.collide_balls((1, 0, 0), z, z, z, (1, 0, 0)), sn.collide_cushion((1, 0, 0), z, (1, 0, 0))
for v, w in zip(kinds((1, 0, 0)), kinds(z)):
    close(sn.collide_balls(v, w, w, w, v), balls)
    close(sn.collide_cushion(v, w, v), cushion)
for x in NUMBERS:
    close(sn.strike(x(2), x(1), side=x(0), top=x(0), elevation=x(1)), sn.strike(2.0, 1.0, 0.0, 0.0, 1.0))
r, v, w, on = [(0, 0), (0, 1)], [(1, 2), (0, 0)], np.zeros((2, 3), int), np.array([[True, True], [True, False]])
one, many = sn.simulate(r, v, w), sn.simulate_batch([r] * 2, [v] * 2, [w] * 2, events=True)
for R, V, W in zip(kinds(r), kinds(v), kinds(w)):
    shot = sn.simulate(R, V, W)
    close((shot.positions, shot.events), (one.positions, one.events))
for R, V, W in zip(kinds([r] * 2), kinds([v] * 2), kinds([w] * 2)):
    close(sn.simulate_batch(R, V, W).positions, many.positions)
for layout in LAYOUTS:
    sn.simulate_batch([r] * 2, [v] * 2, [w] * 2, on_table=layout(on), threads=2, max_events=np.int32(10**6))
    sn.simulate(r, v, w, on_table=layout(on[1]))
for n in (0, 1, 2):  # lengths of one make numpy call a column contiguous
    sn.simulate_batch(np.full((n, 1, 2), 0.1), np.ones((n, 1, 2)), np.zeros((n, 1, 3)))
for t in (*kinds([0, 1, 2]), *(x(1) for x in NUMBERS), [1], []):
    one.at(t)
seen = pickle.loads(pickle.dumps(one, protocol=5, buffer_callback=(buffers := []).append), buffers=[bytes(b.raw()) for b in buffers])
assert not seen.segments.flags.writeable  # as Ray passes arrays to its workers
close(seen.at(1), one.at(1))
preset = sn.Table.preset()
own = sn.Table("own", np.asfortranarray(preset.noses), preset.jaws.tolist(), preset.falls.astype(">f8"))
for table, fidelity in (("tight", "fast"), (None, "standard"), (own, "euler:50"), (pickle.loads(pickle.dumps(own)), "fast")):
    sn.simulate([(0, 0)], [(1, 2)], [z], table, {"e_b": np.float32(0.9), "mu_bb": np.longdouble(0.05)}, fidelity)
"""

ENVS = """
options = {"elevation": True, "placement": True, "noise": "club", "aim": "target"}
for frame in ({}, {"task": "frame", "miss": "clear_path", "says": ["decision"]}):
    env = SnookerEnv(**frame, **options)
    env.reset(seed=1)
    state, ends = env.get_state(), set()
    for a in kinds(np.zeros(env.action_space.shape, int)):
        env.reset(options={"state": state})
        ends.add(env.step(a)[0].tobytes())
    assert len(ends) == 1
    state["positions"], state["on_table"] = np.asfortranarray(state["positions"]), read_only(state["on_table"])
    env.set_state(state)
    env.step(env.action_space.sample())
env = SnookerEnv(action="discrete", observation="balls", layout="break_off")
env.reset(seed=1)
for a in (0, np.int8(3), np.array(5), np.array([7]), np.array(7, ">i2"), np.uint64(9)):
    env.action_masks()
    if env.step(a)[2]:
        env.reset()
for n in (1, 2, 9):
    env = SnookerVectorEnv(n, **options)
    env.reset(seed=1, options={"reset_mask": strided(np.ones(n, bool))})
    for a in kinds(np.zeros((n, 7), int)):
        env.step(a)
    env = SnookerVectorEnv(n, action="discrete", autoreset_mode="SameStep", layout="random:3")
    env.reset(seed=np.int64(1))
    for layout in LAYOUTS:
        env.action_masks()
        env.step(layout(np.zeros(n, ">i4")))
"""

LAST = """
found = {kernel.__module__ + "." + kernel.__qualname__: kernel.signatures for kernel in ENTRIES if len(kernel.signatures) > 1}
assert not found, found
print(len([kernel for kernel in ENTRIES if kernel.signatures]))
"""


@pytest.mark.parametrize(("what", "least"), [(SHOTS, 5), (ENVS, 12)], ids=["shots", "environments"])
def test_no_kernel_is_compiled_twice_whatever_the_input_is_made_of(what, least):
    out, err = python(INPUTS + what + LAST)
    assert int(out) >= least and err == ""


PARTS = {"best_paths", "clear_path", "new_work", "_solutions"}
"""Other entry kernels alone call the first three, which make arrays: kept code holds them. The last makes tables of impacts
for constants that are no preset's."""


def test_a_warm_up_leaves_nothing_to_compile():
    code = """
import json, snooker_env as sn
from snooker_env._lib.jit import ENTRIES
sn.warmup()
for n in (1, 3):
    env = sn.SnookerVectorEnv(n)
    env.reset(seed=0)
    sn.players.player("stroke_value").at({}).play(env, list(range(n)))
print(json.dumps([[k.__qualname__ for k in ENTRIES if test(len(k.signatures))] for test in (lambda n: not n, lambda n: n > 1)]))
"""
    out, err = python(code)
    never, again = json.loads(out)
    assert set(never) <= PARTS and again == [] and err == ""


def test_an_inner_kernel_that_raises_is_refused():
    def checked(x):
        assert x > 0.0
        return x

    def drawn(x):
        if x < 0.0:
            raise ValueError(x)
        return x

    def caught(x):
        try:
            return 1.0 / x
        except ZeroDivisionError:
            return x

    for function in checked, drawn, caught:
        with pytest.raises(
            TypeError, match=f"{function.__name__} raises or catches errors, which no inner kernel"
        ):
            kernel(function)


def test_an_inner_kernel_may_return_none_or_a_number():
    """numba tells None by the code that says whether a kernel raised."""
    half = from_python(kernel(lambda x: None if x == 0.0 else 0.5 * x))
    assert half(0.0) is None and half(3.0) == 1.5
