"""Do many tables start from states as single ones do, and does a refusal change none of them?"""

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from tests.envs.test_vector import native, same, sync


@pytest.mark.parametrize("seed", [None, 40, [3, None, 8, None]])
def test_a_state_with_seeds_is_what_single_tables_make_of_it(seed):
    """Each seed draws the errors of its table anew; a table without one repeats those of the state."""
    options = {"noise": "professional", "layout": "random:6", "aim": "target"}
    env, other = native(4, **options), sync(4, AutoresetMode.NEXT_STEP, **options)
    for one in (env, other):
        one.reset(seed=1)
    state, a = env.get_state()[2], np.zeros((4, 4), np.float32)
    for _ in range(2):  # the second time from the middle of other visits
        assert same(
            env.reset(seed=seed, options={"state": state}), other.reset(seed=seed, options={"state": state})
        )
        first = env.step(a)
        assert same(first, other.step(a))
        assert len({row.tobytes() for row in first[0]}) == (1 if seed is None else 4 if seed == 40 else 3)
        assert all(same(env.step(a), other.step(a)) for _ in range(3))
    assert env.get_state() == [one.unwrapped.get_state() for one in other.envs]
    assert env.np_random_seed == other.np_random_seed


def test_a_wrong_seed_or_state_changes_no_table():
    env = native(3, noise="club")
    env.reset(seed=1)
    before, seeds = env.get_state(), env.np_random_seed
    good = before[0]
    faults = (
        ([4, -1, 5], {}),
        ([4, 5, -1], {"state": good}),
        (9, {"states": [good, good, good | {"points": 400}]}),
        (9, {"state": {}}),
    )
    for seed, options in faults:
        with pytest.raises((ValueError, gymnasium.error.Error)):
            env.reset(seed=seed, options=options)
        assert env.get_state() == before and env.np_random_seed == seeds
