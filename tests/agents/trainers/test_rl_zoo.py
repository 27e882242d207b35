"""Does RL Baselines3 Zoo train with our files of hyperparameters, and do we evaluate its model?"""

import subprocess
import sys

from agents import evaluate
from agents.learning.hyperparameters import FOLDER
from tests.trainers import needed

NAME, MORE = "ppo_target", ["n_steps:16", "batch_size:64", "n_epochs:1"]


def test_it_trains_and_its_model_is_evaluated(tmp_path):
    needed("rl_zoo3")
    training = "-m rl_zoo3.train --algo ppo --env Snooker-v0 --gym-packages snooker_env --n-timesteps 128"
    folders = ["--conf-file", str(FOLDER / f"{NAME}.yml"), "--log-folder", str(tmp_path)]
    more = ["--eval-freq", "-1", "--seed", "0", "--hyperparams", "n_envs:4", *MORE]
    command = [sys.executable, *training.split(), *folders, *more]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert ran.returncode == 0, ran.stderr[-2000:]
    model = tmp_path / "ppo" / "Snooker-v0_1" / "Snooker-v0.zip"
    visits = "--options aim=target --visits 4 --layouts held_out --noise professional --resamples 100"
    assert evaluate.main(["--agent", str(model), "--trust", *visits.split()]) == 0
