"""Does every training go on with the same bits, wherever it was stopped? Agents, the planner's value, strokes and the worth."""

import signal

import numpy as np
import pytest

import train
from agents import learn_worth
from agents.learning import expert_iteration, learn_strokes, loop
from agents.learning.frame_self_play import FRAME
from snooker_env.players import FRAMES
from tests.agents.training import TINY, results, weights

MENU = str.split("--agent strokes --envs 2 --steps 192 --eval-visits 4 --seed 3")
EXPERT = str.split("--agent ppo_value --envs 4 --imitate 64 --steps 512 --eval-visits 4 --seed 2")
STROKES = str.split("--agent stroke_value --eval-visits 4 --set rounds=1 tables=10 frame_rounds=1 frames=10")
WORTH = str.split("--rounds 2 --frames 16 --budget 30 --judged 0")


def start_training(command):
    return lambda out: train.main([*command, "--out", str(out)])


def go_on_training(out):
    return train.main(["--resume", "--out", str(out)])


def learn(out):
    return learn_worth.main([*WORTH, "--out", str(out)])


def arrays(name):
    return lambda out: np.concatenate([one.ravel() for one in np.load(out / name).values()])


TRAININGS = {
    "PPO": (start_training(TINY), go_on_training, weights, (1, 3)),
    "PPO that observes constants": (
        start_training([*TINY, "--conditions", "drawn", "--observe-conditions"]),
        go_on_training,
        weights,
        (2,),
    ),
    "PPO on the menu": (start_training(MENU), go_on_training, weights, (2,)),
    "expert iteration": (start_training(EXPERT), go_on_training, weights, (1, 11, 17, 18, 19)),
    "strokes": (start_training(STROKES), go_on_training, arrays("strokes.npz"), (12,)),
    "worth": (learn, learn, arrays("worth.npz"), (2,)),
}
"""How each is begun and gone on with, what it leaves, and before which rounds it is stopped."""


@pytest.fixture(autouse=True)
def small(monkeypatch):
    monkeypatch.setattr(expert_iteration, "POOL", 64)
    short = {"max_strokes": 24, "layout": "colours"}
    for name, value in short.items():
        monkeypatch.setitem(FRAME, name, value)
    monkeypatch.setattr(learn_strokes, "FRAMES", FRAMES | short)
    monkeypatch.setattr(learn_worth, "PASSES", 2)
    monkeypatch.setattr(learn_strokes, "PASSES", 2)
    monkeypatch.setattr(learn_strokes, "LAST_PASSES", {"visits": 3, "frames": 3})


LONG = ("PPO", "PPO that observes constants", "expert iteration", "strokes", "worth")


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.slow] * (n in LONG)) for n in TRAININGS])
def test_stopped_anywhere_it_goes_on_with_the_same_bits(name, tmp_path, monkeypatch, capsys):
    start, go_on, learned, rounds = TRAININGS[name]
    assert start(tmp_path / "whole") == 0
    expected = learned(tmp_path / "whole")
    for n, number in zip(rounds, (signal.SIGTERM, signal.SIGINT) * 3, strict=False):
        out, seen, at, before = tmp_path / f"at {n}", [], loop.Progress.at, signal.getsignal(number)
        with monkeypatch.context() as patch:

            def counted(self, *given, n=n, number=number, seen=seen, at=at):
                at(self, *given)
                seen.append(given)
                if len(seen) == n:
                    signal.raise_signal(number)

            patch.setattr(loop.Progress, "at", counted)
            capsys.readouterr()
            assert start(out) == 128 + number, n
        assert "Saved. " in capsys.readouterr().out and not (out / "results.json").exists()
        assert signal.getsignal(number) == before
        assert go_on(out) == 0
        assert np.array_equal(learned(out), expected), n
        if (out / "results.json").exists():
            one, other = results(out), results(tmp_path / "whole")
            same = ("evaluation", "settings", "steps", "simulated_shots", "curve", "learned")
            assert all(one[key] == other[key] for key in same)
