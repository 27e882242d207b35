"""Does the example of self-play learn from both sides, go on after an interruption, and write its results?"""

import json

import numpy as np
import pytest
import torch

from examples import self_play
from tests.flips import flipped

SHORT = ("--shots", "640", "--tables", "8", "--frames", "6", "--judged", "2", "--threads", "1")
"""Three rollouts of 256 strokes."""


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The folder of a run without interruption."""
    out = tmp_path_factory.mktemp("whole")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(self_play, "CRITIC", 1)
        patch.setattr(self_play, "OPPONENTS", ("ghost_ball",))
        assert self_play.main([*SHORT, "--out", str(out)]) == 0
    return out


@pytest.fixture
def short(monkeypatch):
    monkeypatch.setattr(self_play, "CRITIC", 1)
    monkeypatch.setattr(self_play, "OPPONENTS", ("ghost_ball",))


def test_a_short_run_writes_what_it_found(whole):
    results = json.loads((whole / "results.json").read_text())
    assert results["shots"] == 768 and "--shots 640" in results["command"]
    assert [point["shots"] for point in results["curve"]] == [0, 256, 512]
    assert results["judged"]["ghost_ball"]["frames"] == 6
    assert 0.0 <= results["judged"]["ghost_ball"]["won"] <= 1.0


@pytest.mark.slow
def test_an_interrupted_run_goes_on_exactly(whole, short, tmp_path, monkeypatch):
    learn, rounds = self_play.Run._learn, []

    def interrupted(run, *rows):
        rounds.append(run.shots)
        if len(rounds) == 2:
            raise KeyboardInterrupt
        learn(run, *rows)

    monkeypatch.setattr(self_play.Run, "_learn", interrupted)
    with pytest.raises(KeyboardInterrupt):
        self_play.main([*SHORT, "--out", str(tmp_path)])
    assert not (tmp_path / "results.json").exists()
    torch.manual_seed(9)  # the run must not depend on what was drawn in between
    assert self_play.main([*SHORT, "--out", str(tmp_path)]) == 0
    assert rounds == [256, 512, 512, 768]  # what was saved is not repeated
    one, other = (torch.load(out / "weights.pt", weights_only=True) for out in (whole, tmp_path))
    assert one.keys() == other.keys() and all(torch.equal(one[name], other[name]) for name in one)
    one, other = (json.loads((out / "results.json").read_text()) for out in (whole, tmp_path))
    assert one["judged"] == other["judged"]
    with pytest.raises(SystemExit, match="was made with --shots, --tables, --seed and --fresh"):
        self_play.main([*SHORT, "--seed", "5", "--out", str(tmp_path)])


def test_no_flipped_bit_of_a_checkpoint_is_used(whole):
    for _ in flipped(whole / "checkpoint.pkl", 20):
        with pytest.raises(SystemExit, match=r"checkpoint\.pkl: it is damaged"):
            self_play.main([*SHORT, "--out", str(whole)])


def test_advantages_are_sums_of_surprises_seen_from_the_side_of_each_stroke(monkeypatch):
    """A stroke of one player, a stroke of the other that ends the frame; by hand."""
    monkeypatch.setattr(self_play, "GAMMA", 0.9)
    monkeypatch.setattr(self_play, "LAMBDA", 0.5)
    rewards, values = np.array([[1.0], [2.0]]), np.array([[0.3], [0.7]])
    signs, last = np.array([[-1.0], [0.0]]), np.array([9.0])
    second = 2.0 - 0.7
    first = 1.0 - 0.9 * 0.7 - 0.3 - 0.9 * 0.5 * second
    made = self_play.advantages_of(rewards, values, signs, last)
    assert made == pytest.approx(np.array([[first], [second]]))
    assert self_play.advantages_of(rewards[:1], values[:1], -signs[:1] * 1.0, last)[0, 0] == pytest.approx(
        1.0 + 0.9 * 9.0 - 0.3
    )


def test_a_rollout_says_whose_stroke_came_next(tmp_path, monkeypatch):
    """Rewards are the striker's, and the sign is that of the next striker on the same table."""
    monkeypatch.setitem(self_play.GAME, "layout", "colours")
    args = self_play.parse([*SHORT, "--out", str(tmp_path)])
    run, noted = self_play.Run(args), []
    step = run.tables.step

    def note(actions):
        before = run.tables.strikers
        result = step(actions)
        noted.append(
            (before, run.tables.strikers, result[1].copy(), result[2].copy(), result[4]["winner"].copy())
        )
        return result

    monkeypatch.setattr(run.tables, "step", note)
    told = {}
    monkeypatch.setattr(
        self_play,
        "advantages_of",
        lambda rewards, values, signs, last: told.update(rewards=rewards, signs=signs) or rewards * 0.0,
    )
    run._play()
    assert len(noted) == self_play.STEPS
    for t, (before, after, gained, over, winner) in enumerate(noted):
        for k in range(8):
            wanted = 0 if over[k] else 1 if before[k] == after[k] else -1
            assert told["signs"][t, k] == wanted
            won = (1 if winner[k] == before[k] else -1) if over[k] else 0
            reward = 0.1 * gained[k, before[k]] + 2.0 * won
            assert told["rewards"][t, k] == pytest.approx(reward, abs=1e-5)
    ends = {
        (int(w), int(b))
        for before, _, _, over, win in noted
        for w, b, o in zip(win, before, over, strict=True)
        if o
    }
    assert len(ends) > 1  # won by the striker and by the other
    assert {-1.0, 1.0} <= set(told["signs"].ravel().tolist())


def test_it_begins_with_what_the_package_knows_of_visits(tmp_path):
    import snooker_env as sn

    tables = sn.MatchVectorEnv(8, layout="opened", **{k: v for k, v in self_play.GAME.items()})
    seen, _ = tables.reset(seed=4)
    policy = self_play.make_policy(tables)
    chosen = self_play.player_of(policy).seen.act(seen, tables.action_masks(), np.arange(8))
    visits = sn.SnookerVectorEnv(
        8, layout="opened", action="strokes", observation="strokes", noise="professional", cue="real"
    )
    shown, _ = visits.reset(seed=4)
    at = sn.player("strokes").at(visits)._networks[0].act(shown, visits.action_masks(), np.arange(8))
    assert seen.shape[1] > shown.shape[1] and (chosen == at).sum() >= 6  # safeties join the menu of a frame
