"""Does ``train.py`` learn, say so honestly, and survive whatever stops it?"""

import os
import pickle
import re
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from stable_baselines3 import PPO

import snooker_env as sn
import train
from agents.evaluation import training_summary
from agents.evaluation.visit_figures import summary
from agents.learning import agent_training, expert_iteration, hyperparameters
from agents.learning.agent_training import recipe_of
from agents.learning.loop import Loop
from agents.learning.settings import Settings
from agents.players.trained import load_player
from snooker_env.benchmark import play_visits
from snooker_env.benchmark.tasks import tables_of
from tests.agents.training import TINY, results, resume, run, weights
from tests.processes import ROOT, replace


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """The folder of an uninterrupted run."""
    out = tmp_path_factory.mktemp("runs") / "run"
    assert run(out) == 0
    return out


FILES = {"checkpoint.pkl", "curve.png", "model.zip", "results.json", "settings.json", "tb"}


def test_run_leaves_model_figures_and_curves(finished):
    out = finished
    assert {p.name for p in out.iterdir()} == FILES
    assert list((out / "tb").rglob("events.out.tfevents.*"))
    found = results(out)
    names = "command settings steps simulated_shots seconds parts learned evaluation curve imitation"
    assert sorted(found) == sorted(f"{names} commit seed machine load software".split())
    assert found["settings"]["agent"] == "ppo_target" and found["steps"] == 512 == found["simulated_shots"]
    (part,) = found["parts"]
    assert (part["part"], part["unit"], part["amount"]) == ("PPO", "shots", 512)
    assert part["seconds"] == found["seconds"] and part["per_second"] == pytest.approx(512 / found["seconds"])
    visits = {name: figures["visits"] for name, figures in found["evaluation"].items()}
    assert visits == {"trained": 4, "ghost_ball": 4, "random": 4, "planner": 2}
    for figures in found["evaluation"].values():
        pots = figures["visits"] * figures["pots_a_visit"]
        assert figures["pot_rate"] == pytest.approx(pots / figures["strokes"])
        assert all(figures[name + "_se"] >= 0 for name in ("pots_a_visit", "points_a_visit", "fouls_a_visit"))
    assert "512 shots" in found["learned"]
    assert found["evaluation"]["trained"] == summary(
        play_visits(load_player(out / "model.zip"), 4, cue="real")
    )


@pytest.mark.slow
def test_its_last_words_give_each_part_its_own_time(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(expert_iteration, "POOL", 64)
    more = ["--agent", "ppo_value", "--imitate", "64", "--steps", "256", "--out"]
    assert train.main([*TINY, *more, str(tmp_path / "run")]) == 0
    printed = capsys.readouterr().out
    found = results(tmp_path / "run")
    amounts = [(part["part"], part["amount"], part["unit"]) for part in found["parts"]]
    assert amounts == [("expert iteration", 64, "positions"), ("PPO", 256, "shots")]
    seconds = [part["seconds"] for part in found["parts"]]
    assert found["seconds"] == pytest.approx(sum(seconds)) and seconds[1] > 0
    assert seconds[0] == pytest.approx(found["imitation"][-1]["seconds"], abs=0.1)
    assert re.search(r"^expert iteration: 64 positions in \d+ s, [\d,]+ a second$", printed, re.M)
    assert re.search(r"^PPO: 256 shots in \d+ s, [\d,]+ a second \(learning included\)$", printed, re.M)


OFTEN = """
import sys, train
from agents.learning import loop
loop.LEAST, loop.SHARE = -1.0, 1e9
sys.exit(train.main(sys.argv[1:]))
"""
"""train.py with a checkpoint after every round."""


def launch(out, *options):
    """``python train.py`` in a session of its own, once its first checkpoint is there."""
    command = [sys.executable, "-c", OFTEN, *TINY, "--parallel", "auto", "--out", str(out)]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    pipes["env"] = os.environ | {"PYTHONPATH": str(ROOT)}
    process = subprocess.Popen([*command, *options], start_new_session=True, cwd=out.parent, **pipes)
    deadline = time.monotonic() + 120
    while not (out / "checkpoint.pkl").exists():
        assert process.poll() is None, process.stdout.read()
        assert time.monotonic() < deadline
        time.sleep(0.02)
    return process


@pytest.mark.slow
def test_kill_9_leaves_a_run_that_resume_finishes(finished, tmp_path):
    out = tmp_path / "run"
    process = launch(out)
    process.kill()
    process.communicate()
    assert process.returncode == -signal.SIGKILL and not (out / "results.json").exists()
    assert run(out, "--resume") == 0  # in one thread now: it plays the same shots
    assert results(out)["steps"] == 512
    assert np.array_equal(weights(out), weights(finished))
    assert results(out)["curve"] == results(finished)["curve"]


def test_resume_refuses_other_settings(finished, refused):
    again = [train.main, "--resume", "--out", finished]
    error = refused(*again, "--noise", "club")
    assert "--noise is 'club'" in error and "has ''" in error
    assert "--agent is 'ppo_value'" in refused(*again, "--agent", "ppo_value")


def test_existing_run_is_not_overwritten(finished, tmp_path, refused):
    before = (finished / "checkpoint.pkl").read_bytes()
    assert "continue it with --resume" in refused(train.main, "--out", finished)
    assert (finished / "checkpoint.pkl").read_bytes() == before
    (file := tmp_path / "thesis.txt").write_text("mine")
    assert "thesis.txt" in refused(train.main, "--out", tmp_path)
    assert "must be a new or empty folder" in refused(train.main, "--out", file)
    assert "must be a folder that can be written" in refused(train.main, "--out", file / "run")
    assert file.read_text() == "mine"
    assert "must be the folder of a run" in refused(train.main, "--resume", "--out", tmp_path)
    # wrong options are reported first
    assert "noise = 'pro'" in refused(train.main, "--noise", "pro", "--out", tmp_path)


def test_resume_refuses_a_broken_checkpoint(finished, tmp_path, refused):
    state = pickle.loads((finished / "checkpoint.pkl").read_bytes())
    older = {key: value for key, value in state.items() if key != "running"}
    whole, file = pickle.dumps(state), tmp_path / "checkpoint.pkl"
    shutil.copy(finished / "settings.json", tmp_path)
    for content in (
        b"junk",
        b"",
        whole[: len(whole) // 2],
        *map(pickle.dumps, (older, 3, state | {"model": b"x"})),
    ):
        file.write_bytes(content)
        error = refused(train.main, "--resume", "--out", tmp_path)
        assert f"resume = '{file}': must be a complete checkpoint" in error


def test_evaluation_plays_under_the_options_of_training(finished, monkeypatch):
    """All options but layout and reward, the environment's own noise where none is given, at the usual fidelity."""
    model, played = load_player(finished).model, []
    monkeypatch.setattr(training_summary, "play_visits", lambda player, n, **more: played.append(more))
    monkeypatch.setattr(training_summary, "summary", lambda visits: None)
    physics = {"preset": "paper", "mu_bb": "marlow"}
    level = {"noise": "club", "table": "tight", "physics": physics, "fidelity": "fast"}
    whole = {"action": "discrete", "layout": "line_up", "reward": "pots", **level}
    for settings, wanted in (
        ({}, {"noise": "professional", "cue": "real"}),
        (
            {"agent": "ppo_target", "fidelity": "fast"},
            {"noise": "professional", "cue": "real", "fidelity": "fast"},
        ),
        ({"set": (f"env_kwargs={whole}",)}, level),
        ({"set": ("env_kwargs={'action': 'discrete'}",)}, {"noise": "none"}),
    ):
        recipe = recipe_of(Settings(**{"agent": "ppo_value"} | settings))
        training_summary.evaluate(recipe, model, 2, Loop("", [], None, "", 1))
        seen = [{name: value for name, value in one.items() if name != "each"} for one in played]
        assert seen == [{"first_seed": tables_of("held_out", 2)} | wanted] * 4
        del played[:]


class AnyAction:
    """Any action of another player's own format."""

    def __init__(self, player):
        self.options = player.sees

    def act(self, observations, masks, seeds):
        size = sn.Options(**self.options).rules.actions.size
        return np.stack([np.random.default_rng(seed).uniform(-1.0, 1.0, size) for seed in seeds])


@pytest.mark.slow
def test_it_learns(tmp_path):
    assert run(tmp_path, "--steps", "100000", "--envs", "64", "--eval-visits", "300") == 0
    trained = results(tmp_path)["evaluation"]["trained"]
    chance = summary(play_visits(sn.player(AnyAction(load_player(tmp_path))), 300, cue="real"))
    gain = trained["points_a_visit"] - chance["points_a_visit"]
    assert gain > 0.3 and gain > 3 * trained["points_a_visit_se"]


def test_a_run_goes_on_with_the_tables_that_it_began_with(tmp_path, monkeypatch):
    """Whatever its recipe says by then."""
    folder, seen, original = tmp_path / "recipes", [], agent_training.training_tables
    shutil.copytree(hyperparameters.FOLDER, folder)
    monkeypatch.setattr(hyperparameters, "FOLDER", folder)
    recipe = folder / "ppo_target.yml"
    now = recipe.read_text()
    replace(recipe, "layout: opened", "layout: opened, fidelity: fast")
    assert run(tmp_path / "run", "--steps", "128") == 0
    recipe.write_text(now)
    monkeypatch.setattr(
        agent_training,
        "training_tables",
        lambda *args, **options: seen.append(options) or original(*args, **options),
    )
    assert resume(tmp_path / "run", "--steps", "256") == 0
    assert [options["fidelity"] for options in seen] == ["fast"]
    assert results(tmp_path / "run")["steps"] == 256


def test_hyperparameters_can_be_changed(tmp_path):
    assert run(tmp_path, "--set", "gamma=0", "n_steps=32") == 0
    # the zip stays one of Stable-Baselines3
    model = PPO.load(tmp_path / "model.zip", device="cpu")
    assert model.gamma == 0 and model.n_steps == 32 and load_player(tmp_path).model.gamma == 0
    assert results(tmp_path)["settings"]["set"] == ["gamma=0", "n_steps=32"]
    assert results(tmp_path)["command"].endswith(
        "--agent ppo_target --steps 512 --envs 2 --imitate 0 --set gamma=0 n_steps=32"
    )
