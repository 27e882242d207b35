"""Is what a call is given left as it is, neither written into, repaired nor kept?"""

import copy

import numpy as np
import pytest

import snooker_env as sn
from snooker_env import SnookerEnv
from snooker_env.tasks.noise import Noise
from tests.tables import begun

Z = (0.0, 0.0, 0.0)


def frozen(*arrays):
    """Read-only copies: writing into them would raise."""
    out = [np.array(a, float) for a in arrays]
    for a in out:
        a.setflags(write=False)
    return out


def test_inputs_of_an_impact_are_left_as_they_are():
    args = frozen((1, 0.2, 0), (3, 4, 5), (-0.5, 0, 0), (1, 2, 3), (1, 0, 0))
    before = [a.tobytes() for a in args]
    one, two = sn.collide_balls(*args), sn.collide_balls(*args)
    assert all(np.array_equal(a, b) for a, b in zip(one, two, strict=True))
    one[0][:] = 7.0
    sn.collide_cushion(args[0], args[1], args[4])[0][:] = 7.0
    assert [a.tobytes() for a in args] == before
    apart = sn.collide_balls(*frozen((-1, 0, 0), Z, Z, Z, (1, 0, 0)))  # no impact: still fresh arrays
    apart[0][:] = 7.0
    assert sn.collide_balls((-1, 0, 0), Z, Z, Z, (1, 0, 0))[0].tolist() == [-1, 0, 0]


@pytest.mark.parametrize("many", [False, True])
def test_inputs_of_a_shot_are_left_as_they_are(many):
    r, v, w = frozen([(0.0, 0.0), (0.3, 0.01)], [(2.0, 0.0), (0.0, 0.0)], np.ones((2, 3)))
    here = np.array([True, True])
    here.setflags(write=False)
    if many:  # no memory of their own: writing would show
        r, v, w, here = (np.broadcast_to(a, (3, *a.shape)) for a in (r, v, w, here))
    before = [a.copy() for a in (r, v, w, here)]
    if many:
        out = sn.simulate_batch(r, v, w, on_table=here, events=True)
    else:
        out = sn.simulate(r, v, w, on_table=here)
        times = np.array([0.0, 0.5])
        out.at(times)[0][:] = 9.0
        assert times.tolist() == [0.0, 0.5] and not np.any(out.at(0.5)[0] == 9.0)
    assert all(np.array_equal(a, b) for a, b in zip((r, v, w, here), before, strict=True))
    assert not np.array_equal(out.positions, r)
    for mine in (out.positions, out.on_table, out.potted):
        assert not any(np.shares_memory(mine, a) for a in (r, v, w, here))


def test_any_real_dtype_and_memory_order_gives_the_same_shot():
    r, v, w = np.array([(0.0, 0.0), (0.5, 0.0625)]), np.array([(2.0, 0.0), (0.0, 0.0)]), np.ones((2, 3))
    want = sn.simulate(r, v, w).positions
    others = (lambda a: a.astype(np.float32), lambda a: a.astype(">f8"), lambda a: a[::-1][::-1])
    for change in (np.asfortranarray, list, *others):
        assert np.array_equal(sn.simulate(change(r), change(v), change(w)).positions, want)
    whole = np.zeros((1, 2), np.int32), np.array([(1, 0)], np.uint8), np.zeros((1, 3), np.int64)
    want = sn.simulate([(0.0, 0.0)], [(1.0, 0.0)], [Z]).positions
    assert np.array_equal(sn.simulate(*whole).positions, want)


def test_dicts_given_as_arguments_are_left_as_they_are():
    physics, noise = {"preset": "match", "mu_s": 0.2}, {"aim_deg": 0.1}
    env = SnookerEnv(physics=physics, noise=noise, layout="random:1")
    state = env.reset(seed=1) and env.get_state()
    options = {"state": copy.deepcopy(state)}
    env.reset(options=options)
    env.step(np.zeros(4, np.float32))
    assert physics == {"preset": "match", "mu_s": 0.2} and noise == {"aim_deg": 0.1}
    assert options == {"state": state}
    sn.Physics.of(physics)
    assert physics == {"preset": "match", "mu_s": 0.2}
    assert env.physics.e_b == 0.94 and env.physics.mu_s == 0.2 and env.noise == Noise(aim_deg=0.1)


def test_actions_and_states_given_are_left_as_they_are_and_not_kept():
    env = begun(SnookerEnv(layout="random:4"), 2)
    action = np.zeros(4, np.float32)
    action.setflags(write=False)
    positions, here = np.array(env.get_state()["positions"]), np.array(env.get_state()["on_table"])
    state = env.get_state() | {"positions": positions, "on_table": here}
    env.set_state(state)
    before = positions.copy()
    env.step(action)
    assert np.array_equal(positions, before) and here.all() == np.array(env.get_state()["on_table"]).all()
    env.set_state(state)
    positions[:] = 0.0
    here[:] = False
    assert np.array_equal(env.positions, before) and env.on_table.any()
