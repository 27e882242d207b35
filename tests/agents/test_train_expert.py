"""Does ``train.py`` train by expert iteration, judge what it learned honestly, and resume at any moment?"""

import pickle
import shutil
import signal

import numpy as np
import pytest

import snooker_env as sn
import train
from agents.learning import callback, expert_iteration
from snooker_env.benchmark import play_visits, simulated, summary
from tests.agents import training
from tests.agents.training import results, resume, weights

EXPERT = ["--agent", "ppo_value", "--envs", "4", "--imitate", "64"]


def run(out, *options):
    return training.run(out, *EXPERT, *options)


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """The folder of an uninterrupted run; its file ``counted`` holds the shots that the engine counted."""
    out, trained, counted = tmp_path_factory.mktemp("expert") / "run", train.train, []

    def train_and_count(*arguments, **options):
        before = simulated()
        made = trained(*arguments, **options)
        counted.append(simulated() - before)
        return made

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(train, "train", train_and_count)
        assert run(out) == 0
    (out / "counted").write_text(str(*counted))
    return out


def test_all_simulated_shots_are_counted(finished):
    """As the leaderboard's script sums them, but for choices that a position lacks: it counts 48 in each."""
    found, judged = results(finished), 64 - 12  # positions: at first there is no value to judge by
    shots = found["simulated_shots"]
    assert shots == int((finished / "counted").read_text()) and found["steps"] == 512
    assert 64 * 64 + 24 * judged + 512 < shots <= 64 * 64 + 48 * judged + 512


def test_the_run_says_what_the_planner_gains(finished):
    found = results(finished)
    assert set(found["evaluation"]) == {"trained", "ghost_ball", "random", "planner", "search"}
    assert "after 64 positions of expert iteration, ppo_value" in found["learned"]
    assert "a hand-written rule" in found["learned"]
    assert found["imitation"][-1]["states"] == 64 and found["imitation"][-1]["value_loss"] > 0
    for name in (f"planner@{finished}", "search"):
        again = summary(play_visits(sn.player(name), 4, cue="real"))
        assert again == found["evaluation"][name.partition("@")[0]]


@pytest.mark.parametrize("at", [8, 40])
def test_a_signal_in_expert_iteration_loses_nothing(finished, tmp_path, monkeypatch, capsys, at, refused):
    """Before and after the value has begun to learn."""
    original = expert_iteration.ExpertIteration.round

    def interrupted(self):
        original(self)
        if self.done == at:
            signal.raise_signal(signal.SIGTERM)

    with monkeypatch.context() as patch:
        patch.setattr(expert_iteration.ExpertIteration, "round", interrupted)
        assert run(tmp_path) == 128 + signal.SIGTERM
    assert f"Saved at {at} of 64 positions" in capsys.readouterr().out
    uncounted = shutil.copytree(tmp_path, tmp_path / "uncounted") / "checkpoint.pkl"
    state = pickle.loads(uncounted.read_bytes())
    del state["imitating"]["shots"]  # as in an older version
    uncounted.write_bytes(pickle.dumps(state))
    assert "start the run again" in refused(train.main, "--resume", "--out", uncounted.parent)
    assert resume(tmp_path) == 0
    assert np.array_equal(weights(tmp_path), weights(finished))
    shots = results(finished)["simulated_shots"]
    assert results(tmp_path)["simulated_shots"] == shots
    assert f"All simulated shots of the training: {shots:,}." in capsys.readouterr().out


def test_a_signal_in_ppo_loses_nothing_and_the_rewards_stay_judged(finished, tmp_path, monkeypatch):
    original, judged = callback.RunCallback._on_step, []

    def interrupted(self):
        judged.append(self.training_env.judge is not None)
        if self.num_timesteps == 260:
            signal.raise_signal(signal.SIGINT)
        return original(self)

    monkeypatch.setattr(callback.RunCallback, "_on_step", interrupted)
    assert run(tmp_path) == 128 + signal.SIGINT and resume(tmp_path) == 0
    assert judged and all(judged)
    assert np.array_equal(weights(tmp_path), weights(finished))
    assert results(tmp_path)["simulated_shots"] == results(finished)["simulated_shots"]


def test_ppo_without_a_learned_value_is_refused(tmp_path, refused):
    error = refused(train.main, *training.TINY, *EXPERT, "--imitate", "0", "--out", tmp_path / "run")
    assert "imitate = 0: must be 1 or more for ppo_value without --start" in error
    assert not (tmp_path / "run").exists()


def test_a_run_that_starts_from_a_model_has_its_value(finished, tmp_path):
    assert run(tmp_path, "--imitate", "0", "--start", str(finished), "--set", "learning_rate=0.0") == 0
    assert results(tmp_path)["simulated_shots"] == results(finished)["simulated_shots"] + 512
    assert np.array_equal(weights(tmp_path), weights(finished))
