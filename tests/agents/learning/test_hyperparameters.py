"""Is an agent made as its recipe says, and shown by its tables what it may see and play?"""

import numpy as np
import pytest

from agents.features.observed import training_tables
from agents.learning import hyperparameters
from snooker_env.planning.learned import stroke_policy as pot_view
from snooker_env.tasks.observations import SIZE


def test_a_linear_rate_falls_from_what_it_says_to_nearly_nothing():
    tables = training_tables(2, action="discrete")
    model = hyperparameters.Recipe.of("ppo_value", ["learning_rate=lin_1e-3"]).new_model(tables, 0)
    rates = [model.lr_schedule(1.0 - done) for done in (0.0, 0.25, 0.5, 1.0)]
    assert rates == pytest.approx([1e-3, 0.7525e-3, 0.505e-3, 1e-5])
    fixed = hyperparameters.Recipe.of("ppo_value", ["learning_rate=0.01"]).new_model(tables, 0)
    assert fixed.lr_schedule(1.0) == fixed.lr_schedule(0.0) == 0.01
    tables.close()


@pytest.mark.parametrize("conditions", [False, True])
def test_the_end_of_a_visit_is_shown_with_its_pots(conditions):
    """The last table, not the one after it; and its constants, if they are observed."""
    drawn = {"conditions": "drawn", "observe_conditions": True} if conditions else {}
    tables = training_tables(4, threads=1, action="discrete", noise="club", **drawn)
    tables.seed(3)
    tables.reset()
    ended = 0
    for _ in range(6):
        inner, kept = tables.venv.step_wait, []

        def watched(inner=inner, kept=kept):
            out = inner()
            kept.extend(info.get("terminal_observation") for info in out[3])
            return out

        tables.venv.step_wait = watched
        _, _, done, infos = tables.step(
            np.array([np.flatnonzero(mask)[0] for mask in tables.env_method("action_masks")])
        )
        tables.venv.step_wait = inner
        for k in np.flatnonzero(done):
            last, ended = infos[k]["terminal_observation"], ended + 1
            assert np.array_equal(last[: pot_view.SHOWN], pot_view.with_pots(kept[k][None])[0])
            assert last[: pot_view.SHOWN].any() and np.array_equal(last[pot_view.SHOWN :], kept[k][SIZE:])
            assert last.shape == tables.observation_space.shape
    assert ended > 0
    tables.close()
