"""Do the repository's players play as players, and are all of them known by name?"""

import numpy as np
import pytest

import snooker_env as sn
from agents.features.observed import training_tables
from agents.learning.hyperparameters import Recipe
from agents.learning.models import PRETRAINED, load_trained
from agents.learning.networks import arrays_of
from snooker_env.planning import Positions
from snooker_env.players.weights import FOLDER, levels


def at_tables(n=6, layout="random:6"):
    tables = sn.SnookerVectorEnv(n, layout=layout, threads=1)
    tables.reset(seed=1)
    return Positions.of(tables)


def test_a_policy_ranks_its_choices_by_probability():
    for one in sn.player("ppo_value").at({}).rank(at_tables(), np.arange(6)):
        assert 0.99 > one.scores[0] > 1.5 / len(one.scores) and one.scores.sum() <= 1.0 + 1e-9


@pytest.mark.parametrize("level", levels())
def test_the_package_holds_the_weights_of_the_pretrained_models(level):
    model = PRETRAINED / f"{'ppo_value' if level == 'professional' else f'ppo_value_{level}'}.zip"
    expected = arrays_of(load_trained(model, "agent").policy)
    with np.load(FOLDER / f"{level}.npz") as held:
        assert set(held.files) == set(expected)
        assert all(np.array_equal(held[name], array) for name, array in expected.items())


def test_a_planner_takes_the_value_of_a_model_of_your_own(tmp_path):
    at, seeds = at_tables(), np.arange(6)
    by_level, by_file = (
        sn.player(f"planner_30@{model}").at({"noise": "none"})
        for model in ("club", PRETRAINED / "ppo_value_club.zip")
    )
    assert np.array_equal(by_level.play(at, seeds).values, by_file.play(at, seeds).values)
    recipe = Recipe.of("ppo_target")
    tables = training_tables(2, **recipe.env_kwargs)
    recipe.new_model(tables, 0).save(tmp_path / "without_value.zip")
    tables.close()
    with pytest.raises(ValueError, match="must name a model with policy and value"):
        sn.player(f"planner@{tmp_path / 'without_value.zip'}")
