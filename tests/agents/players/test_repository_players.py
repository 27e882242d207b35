"""Do the repository's players play as players, and are all of them known by name?"""

import json
import os

import numpy as np
import pytest

import snooker_env as sn
from agents.features.observed import training_tables
from agents.learning.hyperparameters import Recipe
from agents.learning.models import PRETRAINED, load_trained, pretrained_names
from agents.learning.networks import arrays_of
from agents.players.trained import load_player, read_model
from snooker_env.planning import Positions
from snooker_env.players.model_options import of_others
from snooker_env.players.weights import FOLDER, levels
from snooker_env.tasks import Noise
from tests.processes import ROOT, python


def at_tables(n=6, layout="random:6"):
    tables = sn.SnookerVectorEnv(n, layout=layout, threads=1)
    tables.reset(seed=1)
    return Positions.of(tables)


def test_every_pretrained_model_has_an_entry_point():
    assert {name for name in sn.players() if name.startswith("ppo_")} == set(pretrained_names())


@pytest.mark.parametrize("name", pretrained_names())
def test_a_player_is_a_function_of_a_position_and_a_seed(name):
    at, player, seeds = at_tables(), sn.player(name).at({"noise": "professional"}), np.arange(6)
    together = player.play(at, seeds)
    for k in range(6):
        assert np.array_equal(player.play(at[k : k + 1], seeds[k : k + 1]).values[0], together.values[k])
    for k, one in enumerate(player.rank(at, seeds)):
        assert np.array_equal(one.strokes.values[0], together.values[k])
        assert (np.diff(one.scores) <= 0).all()


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


def test_files_of_others_are_left_to_others(tmp_path):
    (tmp_path / "x.zip").write_bytes(b"no zip")
    assert read_model(tmp_path / "x.zip") is None
    assert of_others(tmp_path / "x.zip") and not of_others(
        "program:python -c " + 300 * "x"
    )  # a name too long for a file
    with pytest.raises(ValueError, match=r"must be a model's \.zip or a folder"):
        load_player(tmp_path)
    assert Noise().silent


PLAYERS = ["planner_60", "ppo_value"]
MEASURE = """if True:
    import json, os, sys, time
    import numpy as np, torch
    import snooker_env as sn
    from snooker_env.planning import Positions

    os.sched_setaffinity(0, [min(os.sched_getaffinity(0))])  # of this thread: the libraries have made theirs

    def share(act):  # of the processor time that other threads took
        act(), act()  # compiled and loaded
        time.sleep(0.2)  # a library's threads look for more work before they rest
        whole, own = time.process_time(), time.thread_time()
        while time.thread_time() - own < 0.15:
            act()
        return (time.process_time() - whole) / (time.thread_time() - own) - 1.0

    def decisions(name, tables):
        env = sn.SnookerVectorEnv(tables, noise="professional", threads=1)
        env.reset(seed=3)
        player, at = sn.player(name).at(env), Positions.of(env)
        return lambda: player.play(at, np.arange(tables))

    rows, weight = np.ones((2, 256, 256), np.float32)
    tensor = torch.from_numpy(rows)
    found = {"numpy": share(lambda: rows @ weight), "torch": share(lambda: tensor @ tensor)}
    for name in sys.argv[1:]:
        for tables in (1, 64):
            found[f"{name} {tables}"] = share(decisions(name, tables))
    print(json.dumps(found))
"""


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="on Linux alone threads can be bound")
def test_a_decision_takes_one_thread():
    code = f"import sys; sys.argv[1:] = {PLAYERS!r}\n{MEASURE}"
    libraries = {name: "2" for name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS")}
    found = json.loads(python(code, at=ROOT, **libraries)[0])
    seen = [found.pop(library) for library in ("numpy", "torch")]
    if min(seen) < 0.2:
        pytest.skip(f"the libraries use no second thread here: {seen}")
    assert len(found) == 2 * len(PLAYERS)
    assert not {what: round(share, 2) for what, share in found.items() if share > 0.05}
