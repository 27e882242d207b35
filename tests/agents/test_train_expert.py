"""Does ``train.py`` train by expert iteration, judge what it learned honestly, and resume at any moment?"""

import pytest

import snooker_env as sn
from agents.evaluation.visit_figures import summary
from agents.learning import loop
from snooker_env.benchmark import count_shots, play_visits
from tests.agents import training
from tests.agents.training import results

EXPERT = ["--agent", "ppo_value", "--envs", "4", "--imitate", "64"]


def run(out, *options):
    return training.run(out, *EXPERT, *options)


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """The folder of an uninterrupted run; its file ``counted`` holds the shots that the engine counted."""
    out, original, counted = tmp_path_factory.mktemp("expert") / "run", loop.Loop.run, []

    def run_and_count(self):
        before = count_shots()
        original(self)
        counted.append(count_shots() - before)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(loop.Loop, "run", run_and_count)
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
    assert "after 64 positions of expert iteration, " in found["learned"]
    assert "a hand-written rule" in found["learned"]
    assert found["imitation"][-1]["states"] == 64 and found["imitation"][-1]["value_loss"] > 0
    for name in (f"planner@{finished}", "search"):
        again = summary(play_visits(sn.player(name), 4, cue="real"))
        assert again == found["evaluation"][name.partition("@")[0]]
