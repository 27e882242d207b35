"""Does ``train.py`` train what the recipe says, with the changes that were asked for, and refuse those that
do not fit it?"""

import shutil

from sb3_contrib import MaskablePPO

import train
from agents.learning import hyperparameters
from agents.players.trained import load_player
from snooker_env.benchmark import play_visits, summary
from tests.agents.test_train import TINY, refused, results, run


def test_a_run_goes_on_with_the_tables_that_it_began_with(tmp_path, monkeypatch):
    """Whatever its recipe says by then."""
    folder, seen = tmp_path / "recipes", []
    shutil.copytree(hyperparameters.FOLDER, folder)
    monkeypatch.setattr(hyperparameters, "FOLDER", folder)
    recipe = folder / "ppo_mask.yml"
    now = recipe.read_text()
    assert "fidelity: fast" in now
    recipe.write_text(now.replace("fidelity: fast", "fidelity: standard"))
    assert run(tmp_path / "run", "--steps", "64") == 0
    recipe.write_text(now)
    original = train.training_tables
    monkeypatch.setattr(
        train, "training_tables", lambda *args, **options: seen.append(options) or original(*args, **options)
    )
    assert train.main(["--resume", "--no-progress", "--steps", "128", "--out", str(tmp_path / "run")]) == 0
    assert [options["fidelity"] for options in seen] == ["standard"]
    assert results(tmp_path / "run")["steps"] == 128


def test_agents_with_longer_actions_are_judged(tmp_path):
    out, given = tmp_path / "run", "env_kwargs={'aim': 'target', 'elevation': True, 'placement': True}"
    assert run(out, "--agent", "ppo_target", "--steps", "128", "--set", given) == 0
    assert load_player(out).sees == {"aim": "target", "elevation": True, "placement": True}
    again = summary(play_visits(load_player(out), 4, noise="none"))
    assert again == results(out)["evaluation"]["trained"]


def test_imitation_comes_first_and_is_kept(tmp_path):
    few = ["--envs", "16", "--set", "n_steps=32"]  # of 512 shots a rollout
    assert (
        train.main([*TINY[:-1], "256", "--agent", "ppo_foresight", *few, "--out", str(tmp_path / "run")]) == 0
    )
    found = results(tmp_path / "run")
    assert found["settings"]["imitate"] == 256 and found["imitation"][-1]["states"] == 256
    assert "after 256 positions of imitation, ppo_" in found["learned"]
    assert train.main(["--resume", "--no-progress", "--steps", "1024", "--out", str(tmp_path / "run")]) == 0
    assert results(tmp_path / "run")["imitation"] == found["imitation"]
    assert "after 256 positions of imitation, ppo_" in results(tmp_path / "run")["learned"]


def test_what_starts_from_a_model_does_not_imitate_again(tmp_path, capsys):
    assert (
        train.recipe_of(train.Settings(start="x")).imitation
        == 0
        < train.recipe_of(train.Settings()).imitation
    )
    error = refused(capsys, "--start", "x", "--imitate", "5", "--out", str(tmp_path / "run"))
    assert "imitate = 5: must be 0 or left out with --start" in error


def test_start_refuses_a_model_with_other_actions(tmp_path, capsys):
    assert run(tmp_path / "run", "--agent", "ppo_target", "--steps", "128") == 0
    error = refused(
        capsys,
        "--agent",
        "ppo_target",
        "--start",
        str(tmp_path / "run"),
        "--out",
        str(tmp_path / "new"),
        "--set",
        "env_kwargs={'aim':'target','elevation':True}",
    )
    assert "start = " in error and "must be a model with actions" in error


def test_only_agents_with_masks_can_imitate(tmp_path, capsys):
    assert "imitate = 100: must be 0 for ppo_target" in refused(
        capsys, "--agent", "ppo_target", "--imitate", "100", "--out", str(tmp_path / "run")
    )


def test_hyperparameters_can_be_changed(tmp_path):
    assert run(tmp_path / "run", "--set", "gamma=0", "n_steps=32") == 0
    # the zip stays one of Stable-Baselines3
    model = MaskablePPO.load(tmp_path / "run" / "model.zip", device="cpu")
    assert model.gamma == 0 and model.n_steps == 32 and load_player(tmp_path / "run").model.gamma == 0
    assert results(tmp_path / "run")["settings"]["set"] == ["gamma=0", "n_steps=32"]
    assert results(tmp_path / "run")["command"].endswith(
        "--agent ppo_mask --steps 512 --envs 2 --imitate 0 --set gamma=0 n_steps=32"
    )
