"""Does the example of self-play run, go on after an interruption, and write its results?"""

import json
import pickle

import numpy as np
import pytest
import torch

from examples import self_play
from snooker_env import SnookerVectorEnv
from snooker_env.players import SeenPlayer
from tests.flips import flipped

SHORT = ("--shots", "640", "--tables", "4", "--frames", "6", "--threads", "1")
"""Three rollouts of 256 shots."""


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The folder of a run without interruption."""
    out = tmp_path_factory.mktemp("whole")
    assert self_play.main([*SHORT, "--out", str(out)]) == 0
    return out


def test_a_short_run_writes_what_it_found(whole):
    results = json.loads((whole / "results.json").read_text())
    assert results["shots"] == 768 and "--shots 640" in results["command"]
    assert [point["shots"] for point in results["curve"]] == [0, 256, 512]
    for against in results["judged"].values():
        for judged in against.values():
            low, high = judged["interval"]
            assert judged["frames"] == 6 and 0.0 <= low <= judged["won"] <= high <= 1.0
            assert 2 * judged["won"] == pytest.approx(judged["won_breaking"] + judged["won_otherwise"])


def test_an_interrupted_run_goes_on_exactly(whole, tmp_path, monkeypatch):
    save, saves = self_play.Run.save, []

    def interrupted(run):
        save(run)
        saves.append(run.num_timesteps)
        if run.num_timesteps == 256 and len(saves) == 2:
            raise KeyboardInterrupt

    monkeypatch.setattr(self_play.Run, "save", interrupted)
    with pytest.raises(KeyboardInterrupt):
        self_play.main([*SHORT, "--out", str(tmp_path)])
    assert saves == [0, 256] and not (tmp_path / "results.json").exists()
    np.random.seed(9)  # noqa: NPY002 - the run must not depend on what was drawn in between
    torch.manual_seed(9)
    assert self_play.main([*SHORT, "--out", str(tmp_path)]) == 0
    assert saves == [0, 256, 512]  # what was saved is not repeated
    one, other = (torch.load(out / "weights.pt", weights_only=True) for out in (whole, tmp_path))
    assert one.keys() == other.keys() and all(torch.equal(one[name], other[name]) for name in one)
    one, other = (json.loads((out / "results.json").read_text()) for out in (whole, tmp_path))
    assert one["judged"] == other["judged"]
    for point in one["curve"] + other["curve"]:
        del point["seconds"]
    assert one["curve"] == other["curve"]


def test_no_flipped_bit_of_a_checkpoint_is_used(whole):
    for _ in flipped(whole / "checkpoint.pkl", 20):
        with pytest.raises(SystemExit, match=r"checkpoint\.pkl: it is damaged"):
            self_play.main([*SHORT, "--out", str(whole)])


def test_a_checkpoint_of_other_settings_is_refused(whole):
    with pytest.raises(SystemExit, match="--shots, --tables and --seed"):
        self_play.main([*SHORT, "--seed", "1", "--out", str(whole)])


def test_the_weights_move(whole):
    """The first past self is the untrained network; the last weights are not."""
    first = pickle.loads((whole / "checkpoint.pkl").read_bytes())["pool"][0]
    last = torch.load(whole / "weights.pt", weights_only=True)
    assert any(not torch.equal(first[name], last[name]) for name in last)


def test_without_a_pot_the_nearest_ball_on_stands_first():
    """At the break-off no red can be potted: the first pot shows the way to the nearest red."""
    tables = SnookerVectorEnv(3, threads=1, **self_play.GAME)
    observations, _ = tables.reset(seed=1)
    shown = self_play.view(observations)[:, self_play.OBSERVATION_SIZE :]
    for k in range(3):
        way = tables.tables.positions[k, 1:16] - tables.tables.positions[k, 0]
        far = np.hypot(*way.T)
        near = far.argmin()
        assert shown[k, 0] == 1.0 and (shown[k, 13::13] == 0.0).all()
        assert shown[k, 1:3] == pytest.approx(way[near] / far[near], abs=1e-5)
        assert shown[k, 5] == pytest.approx(far[near] / 1.7845 - 1.0, abs=1e-5)


def test_the_published_agent_is_an_opponent_that_a_constant_choice_does_not_beat():
    against = self_play.judge(self_play.Softly(), SeenPlayer(self_play.SelfPlayed()), 200, 1)
    assert against["won"] < 0.45
