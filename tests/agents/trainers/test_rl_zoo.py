"""Does RL Baselines3 Zoo train with our files of hyperparameters, and is its model evaluated by our
protocol?"""

import subprocess
import sys

import pytest
import yaml

from agents.evaluation import protocol
from agents.learning.hyperparameters import ENV_ID, FOLDER
from tests.trainers import needed

FILES = ("ppo_target", "tqc_target")


@pytest.mark.parametrize("name", FILES)
def test_what_the_zoo_does_not_know_stands_apart(name):
    found = yaml.safe_load((FOLDER / f"{name}.yml").read_text(encoding="utf-8"))
    assert not {"algo", "view", "imitation", "expert", "first_aim_std"} & set(found[ENV_ID])
    assert found["agent"]["algo"] in name


@pytest.mark.parametrize(
    ("name", "more"),
    [("ppo_target", ["n_steps:16", "batch_size:64", "n_epochs:1"]), ("tqc_target", ["learning_starts:32"])],
)
def test_it_trains_and_its_model_is_evaluated(tmp_path, name, more, capsys):
    needed("rl_zoo3")
    algorithm = name.partition("_")[0]
    command = [
        sys.executable,
        "-m",
        "rl_zoo3.train",
        "--algo",
        algorithm,
        "--env",
        "Snooker-v0",
        "--gym-packages",
        "snooker_env",
        "--conf-file",
        str(FOLDER / f"{name}.yml"),
        "--n-timesteps",
        "128",
        "--eval-freq",
        "-1",
        "--seed",
        "0",
        "--log-folder",
        str(tmp_path),
        "--hyperparams",
        "n_envs:4",
        *more,
    ]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert ran.returncode == 0, ran.stderr[-2000:]
    model = tmp_path / algorithm / "Snooker-v0_1" / "Snooker-v0.zip"
    visits = ["--visits", "4", "--layouts", "held_out", "--noise", "professional", "--resamples", "100"]
    assert protocol.main(["--agent", str(model), "--trust", "--options", "aim=target", *visits]) == 0
    capsys.readouterr()
