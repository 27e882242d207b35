"""Does ``python -m agents.train_rllib`` train, save, go on, judge and refuse, by what its tables play?"""

import json
import re
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from agents.learning.policy_files import read_policy
from agents.players.trained import load_player
from commands.files import with_checksum
from tests.trainers import needed

ray = needed("ray")
config, run = needed("agents.trainers.rllib_config"), needed("agents.trainers.rllib_run")
from tests.flips import flipped  # noqa: E402

ROOT = Path(__file__).parents[3]
SHORT = ["--envs", "16", "--eval-visits", "4", "--checkpoint-every", "8000"]


def of_one_update(out):
    """The counters and the policy of a run with one runner, which was saved and judged."""
    assert run.main(["--steps", "8192", "--out", str(out), *SHORT]) == 0
    state, first = json.loads((out / run.STATE).read_text()), read_policy(out / "policy.npz", "out")
    progress = state["progress"]
    assert progress["shots"] >= 8192 and progress["updates"] == 1 and (out / progress["checkpoint"]).is_dir()
    untrained = read_policy(out / run.UNTRAINED, "out")
    assert untrained.num_timesteps == 0
    assert not np.array_equal(untrained.policy.weights[0][0], first.policy.weights[0][0])
    results = json.loads((out / run.RESULTS).read_text())
    assert set(results["evaluation"]) == {"trained", "untrained", "ghost_ball", "random"}
    assert results["versions"]["ray"] and not ray.is_initialized()
    return progress, first


class Saves:
    """Stands for RLlib's algorithm: it saves two files."""

    def save_to_path(self, folder):
        Path(folder, "part").mkdir(parents=True)
        Path(folder, "state.pkl").write_bytes(bytes(range(250)))
        Path(folder, "part/weights.pkl").write_bytes(bytes(range(99)))


def test_no_flipped_bit_of_a_checkpoint_is_used(tmp_path, monkeypatch):
    monkeypatch.setattr(run, "_write", lambda *given: None)
    run.save(tmp_path, run.RunSettings(seed=7), run.Counters(shots=9, updates=3), Saves())
    for name in (run.STATE, "checkpoint-000003/state.pkl", "checkpoint-000003/part/weights.pkl"):
        for _ in flipped(tmp_path / name):
            with pytest.raises(ValueError, match=rf"^out = '{tmp_path}': must be the folder of a run with a"):
                run.opened(tmp_path, {}, True)
    assert run.opened(tmp_path, {}, True)[1].shots == 9


def test_a_run_is_saved_and_judged(tmp_path):
    of_one_update(tmp_path / "run")


@pytest.mark.slow
def test_a_run_goes_on_with_more_runners(tmp_path, capsys):
    """With the weights and counters of the first part."""
    out = tmp_path / "run"
    progress, first = of_one_update(out)
    kept, algorithm_of, restore = [], run.algorithm_of, run.restore

    def of_runners(made):
        return made.env_runner_group.foreach_env_runner(
            lambda runner: runner.module.get_state()["pi.net.mlp.0.bias"], local_env_runner=False
        )

    def made_with(settings, seed):
        kept.extend((settings, seed))
        return algorithm_of(settings, seed)

    def restored(algorithm, folder):
        restore(algorithm, folder)
        kept.extend((config.layers_of(algorithm), of_runners(algorithm)))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(run, "algorithm_of", made_with)
        patch.setattr(run, "restore", restored)
        more = ["--steps", "16000", "--runners", "2", *SHORT[2:]]
        assert run.main(["--resume", "--out", str(out), *more]) == 0
    settings, seed, weights, there = kept
    # the runners play with them too
    assert len(there) == 2 and all(np.array_equal(bias, weights[-1][1]) for bias in there)
    asked = {"steps": 16000, "runners": 2, "envs": 16, "eval_visits": 4, "checkpoint_every": 8000}
    assert settings == replace(run.RunSettings(), **asked) and seed == run.SEEDS
    for mine, its in zip(first.policy.weights, weights, strict=True):
        assert len(mine) == len(its) and all(map(np.array_equal, mine, its))
    after = json.loads((out / run.STATE).read_text())["progress"]
    assert after["shots"] >= progress["shots"] + 7500 and after["updates"] == 2 and after["parts"] == 2
    left = [file.name for file in out.glob("checkpoint-*")]
    assert left == [after["checkpoint"]] != [progress["checkpoint"]]
    assert load_player(out).model.num_timesteps == after["shots"]
    assert run.main(["--resume", "--steps", "16000", "--out", str(out)]) == 0
    assert "nothing left to train" in capsys.readouterr().out
    assert not ray.is_initialized()


@pytest.mark.slow
def test_a_signal_saves_and_the_run_goes_on(tmp_path):
    out = tmp_path / "run"
    command = [sys.executable, "-u", "-m", "agents.train_rllib", "--steps", "1000000", "--out", str(out)]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    with subprocess.Popen([*command, *SHORT], cwd=ROOT, **pipes) as process:
        assert process.stdout is not None
        lines = []
        for line in process.stdout:
            lines.append(line)
            if re.search(r"RLlib: [\d,]+ of 1,000,000 shots, update \d", line):
                process.send_signal(signal.SIGINT)
                break
        rest = process.stdout.read()
        assert process.wait(120) == 130, "".join(lines) + rest
    assert f"Continue with:  python -m agents.train_rllib --resume --out {out}" in rest
    assert "Traceback" not in rest
    progress = json.loads((out / run.STATE).read_text())["progress"]
    assert progress["shots"] > 8000 and (out / progress["checkpoint"]).is_dir()
    assert load_player(out).model.num_timesteps == progress["shots"]
    began = time.monotonic()
    while (out / "train.lock").exists() and time.monotonic() - began < 10:
        time.sleep(0.1)
    settings, again = run.opened(out, {"steps": 5}, True)
    assert settings.steps == 5 and again.shots == progress["shots"]


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ("--steps 0", "steps = 0: must be an integer in [1, "),
        ("--runners 0", "runners = 0: must be an integer in [1, 1024]"),
        ("--envs 9000", "envs = 9000: must be an integer in [1, 8192]"),
        ("--noise loud", "noise = 'loud'"),
        ("--layout moon", "layout = 'moon'"),
        ("--layout held_out", "layout = 'held_out': must be another for training"),
        ("--eval-visits 1", "eval_visits = 1"),
        ("--resume", "must be the folder of a run with a checkpoint"),
    ],
)
def test_wrong_options_are_refused_in_one_line_before_anything_starts(tmp_path, options, says, refused):
    assert says in refused(run.main, *options.split(), "--out", tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_an_update_without_a_sample_ends_the_run_in_one_line(tmp_path, monkeypatch):
    """What was played before is kept."""

    class Silent:
        def train(self):
            return {"learners": {}}

    saved = []
    monkeypatch.setattr(run, "save", lambda *parts: saved.append(parts))
    with pytest.raises(SystemExit, match=r"no env runner gave a sample in 600 s; saved at 7 shots"):
        run.train(tmp_path, run.RunSettings(), run.Counters(shots=7), Silent(), run.Stop())
    assert len(saved) == 1


def test_folders_that_do_not_fit_are_refused(tmp_path, refused):
    here = [run.main, "--out", tmp_path]
    (tmp_path / "mine.txt").write_text("mine")
    why = "is not empty (it holds mine.txt): --resume continues it, --out names another folder"
    assert why in refused(*here)
    (tmp_path / "state.json").write_text("{}")
    assert "must be the folder of a run with a checkpoint" in refused(*here, "--resume")
    progress = {"shots": 5, "updates": 1, "seconds": 1.0, "parts": 1, "checkpoint": "checkpoint-000001"}
    kept = {"settings": {"envs": 16}, "progress": progress}
    (tmp_path / "state.json").write_text(json.dumps(with_checksum(kept)))
    assert "checkpoint-000001 is missing" in refused(*here, "--resume")
    (tmp_path / "checkpoint-000001").mkdir()
    (tmp_path / "checkpoint-000001" / "part").write_text("RLlib's")
    progress["digest"] = run.digest_of(tmp_path / "checkpoint-000001")
    (tmp_path / "state.json").write_text(json.dumps(with_checksum(kept)))
    assert "envs = 32: must be 16, as in the run in" in refused(*here, "--resume", "--envs", "32")
