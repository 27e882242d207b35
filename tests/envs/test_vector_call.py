"""Does ``call`` of the native vector environment give for each table what a single environment gives?"""

import inspect
import pickle

import numpy as np
import pytest

import snooker_env  # noqa: F401 - registers the id
from snooker_env import SnookerEnv
from snooker_env.envs.vector import NOT_OF_A_TABLE, SnookerVectorEnv
from tests.envs.one_by_one import OneByOne, native, same
from tests.refusals import refused
from tests.tables import begun

N = 4
METHODS = {"get_state", "action_masks", "has_wrapper_attr"}
"""What takes a call and changes nothing."""


def public(env):
    """All names of a ``SnookerEnv`` that do not start with an underscore."""
    return sorted(name for name in {*dir(env), *vars(env)} if not name.startswith("_"))


def alike(a, b):
    """Equal, or for objects that do not know what equal is, made of equal parts."""
    if type(a) is not type(b):
        return False
    if type(a).__eq__ is not object.__eq__ and not isinstance(a, np.ndarray | dict | list | tuple):
        return bool(a == b)
    if isinstance(a, np.random.Generator):
        return a.bit_generator.state == b.bit_generator.state
    if hasattr(a, "__dict__"):
        return set(vars(a)) == set(vars(b)) and all(alike(vars(a)[key], vars(b)[key]) for key in vars(a))
    return same(a, b)


MASKED = {"action": "discrete", "observation": "masked", "layout": "random:2", "task": "frame"}
PLAIN = {"placement": True, "table": "tight", "render_mode": "ansi", "layout": "break_off"}


@pytest.mark.parametrize("options", [MASKED, PLAIN], ids=["masked", "plain"])
def test_each_table_has_all_that_a_single_environment_has(options):
    """Every public name; shared state is ``Tables``, compared by its arrays."""
    ours, theirs = native(N, **options), OneByOne(N, **options)
    ours.reset(seed=3), theirs.reset(seed=3)
    for _ in range(2):
        for name in set(public(SnookerEnv())) - set(NOT_OF_A_TABLE):
            if name == "action_masks" and options is PLAIN:
                with pytest.raises(ValueError, match="a Box has no masks"):
                    ours.call(name)
                continue
            arguments = ("positions",) if name == "has_wrapper_attr" else ()
            want = [getattr(one, name) for one in theirs.envs]
            want = [one(*arguments) if callable(one) else one for one in want]
            got = ours.call(name, *arguments)
            assert isinstance(got, tuple) and len(got) == N
            if name == "tables":
                parts = ("positions", "on_table", "game", "streams", "begun", "n")
                got, want = ([[getattr(v, part) for part in parts] for v in each] for each in (got, want))
            assert all(map(alike, got, want)), name
        a = np.full(N, 67) if options is MASKED else np.full((N, 6), 0.1)
        ours.step(a), theirs.step(a)


def test_every_method_is_served_or_refused_by_name():
    methods = {name for name in public(SnookerEnv()) if inspect.ismethod(getattr(SnookerEnv(), name))}
    assert methods - set(NOT_OF_A_TABLE) == METHODS
    assert set(NOT_OF_A_TABLE) <= set(public(SnookerEnv()))


def test_what_belongs_to_all_tables_is_refused():
    env = begun(SnookerVectorEnv(2))
    before = pickle.dumps(env.get_state())
    for name, instead in NOT_OF_A_TABLE.items():
        refused(lambda name=name: env.call(name), "name", repr(name), f"; use {instead}")
        refused(lambda name=name: env.get_attr(name), "name", repr(name), "that a table has for itself")
    for name in ("_work", "__class__", 3, None):
        allowed = "must be something public that a table has for itself"
        refused(lambda name=name: env.call(name), "name", repr(name), allowed)
    assert pickle.dumps(env.get_state()) == before


def test_what_is_not_there_is_not_there_and_nothing_can_be_set():
    env = SnookerVectorEnv(2)
    for look in (env.call, env.get_attr):
        with pytest.raises(AttributeError, match="no_such"):
            look("no_such")
    for name in ("reward", "no_such"):
        with pytest.raises(AttributeError, match=f"{name} cannot be set: the tables share everything"):
            env.set_attr(name, ["pots", "pots"])


def test_what_is_given_is_the_callers_own():
    env = begun(SnookerVectorEnv(2, layout="random:3"))
    for a in (*env.call("positions"), *env.call("on_table")):
        a[:] = 0
    assert env.call("on_table")[0].sum() == 10 and np.abs(env.call("positions")[0]).sum() > 1


def test_looking_before_the_first_reset_is_looking_only():
    looked, blind = SnookerVectorEnv(3), SnookerVectorEnv(3)
    assert looked.get_attr("over") == (True, True, True)
    looked.get_attr("np_random"), looked.get_attr("positions")
    assert np.array_equal(looked.reset(seed=5)[0], blind.reset(seed=5)[0])
    assert len({row.tobytes() for row in SnookerVectorEnv(3).reset()[0]}) == 3
